-- a picture that does not fit on the disk: the message says so, and no part of it stands under its name
local tap = require "tap"
local ok = tap.ok

local SCRIPT = [[
local dm = require "dm"
local line = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local path = line:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = tonumber(arg[2]) }
print(pcall(path.plot, path, "q1", "p1", { file = arg[1] }))
]]

local source = os.tmpname()
local handle = assert(io.open(source, "w"))
handle:write(SCRIPT)
handle:close()

-- what the script prints where files hold at most so many blocks of 512 bytes, and the size of its picture
local function draw(kind, steps, blocks)
  local file = source .. "." .. kind
  local pipe = assert(io.popen(("sh -c \"trap '' XFSZ; ulimit -f %s; %s %s %s %d 2>&1\""):format(blocks, os.getenv "DMLUA" or "build/dmlua", source, file, steps)))
  local said = pipe:read "a"
  pipe:close()
  local made = io.open(file, "rb")
  local size = made and made:seek "end"
  if made then made:close() end
  os.remove(file)
  return said, size
end

for _, kind in ipairs { "png", "svg", "pdf" } do
  local said, size = draw(kind, 40, "unlimited")
  ok(said:find "^true" and size and size > 4096, kind .. ": a picture that fits", said)
  said, size = draw(kind, 40, 8)
  ok(said:find("cannot write " .. source .. "." .. kind .. ": File too large", 1, true) and not size, kind .. ": one that does not", said)
end
-- the script that gnuplot reads is a file as well
local said, size = draw("png", 4000, 8)
ok(said:find("cannot write the script of a picture", 1, true) and said:find("File too large", 1, true) and not size, "nor its script", said)
os.remove(source)
tap.done()
