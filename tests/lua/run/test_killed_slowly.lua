-- a run that is killed before its first block of 4096 rows is full: its file counts the rows that were there a second before
local tap = require "tap"
local ok = tap.ok

local RUNS = {
  path = [[dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
    :solver({ rule = "verlet", h = 0.01 }):run { q = { 1 }, v = { 0 }, steps = 1e13, every = 1e7, file = arg[1] }]],
  flow = [[dm.mesh { icosphere = 2 }:euler { vorticity = function(x, y, z) return z + x * y end }
    :solver({ h = 0.01 }):run { steps = 1e9, every = 100, file = arg[1] }]],
}
local MOST = 200 -- s

-- how many rows the head of a .npy file counts, 0 where there is none
local function rows_in(file)
  local handle = io.open(file, "rb")
  local head = handle and handle:read(400) or ""
  if handle then handle:close() end
  return tonumber(head:match "'shape': %((%d+)") or 0
end

local dm = require "dm"
for kind, run in pairs(RUNS) do
  local source, file = os.tmpname(), os.tmpname() .. ".npy"
  local handle = assert(io.open(source, "w"))
  handle:write("local dm = require 'dm'\n", run)
  handle:close()
  local pipe = assert(io.popen(("%s %s %s >/dev/null 2>&1 & echo $!"):format(os.getenv "DMLUA" or "build/dmlua", source, file)))
  local id = pipe:read "n"
  pipe:close()
  local begun = os.time()
  while rows_in(file) < 2 and os.time() < begun + MOST do os.execute "sleep 0.2" end
  os.execute(("kill -9 %d"):format(id))
  os.execute "sleep 0.2"
  local rows = rows_in(file)
  ok(rows >= 2 and rows < 4096, kind .. ": rows that wait for a full block are in the file", rows)
  local fine, loaded = pcall(dm.load, file)
  ok(fine and #loaded.t == rows, "and dm.load reads them", fine and "" or loaded)
  os.remove(source)
  os.remove(file)
end
tap.done()
