-- rows of a run whose file cannot grow any more: every row is in the file or in failure.path, none in both; and a
-- checkpoint between two blocks leaves the path its last row
local tap = require "tap"
local ok = tap.ok

local SCRIPT = [[
local dm = require "dm"
local name = arg[1]
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 end }
local pendulum = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end,
  constraint = function(q) return q:dot(q) - 1 end }
local K = dm.mesh { grid = 4 }
local wave = K:field { form = 0, L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
local bump = { q = function(x, y) return x * y end, v = function() return 0 end }
local slices = {}
for i = 1, 9000 do slices[i] = 0.01 * (i - 1) end

local function with(a, b)
  local out = {}
  for key, value in pairs(a) do out[key] = value end
  for key, value in pairs(b) do out[key] = value end
  return out
end
local function same(path, i, row, k)
  return path.t[i] == row.t[k] and path.q[i] == row.q[k] and path.p[i] == row.p[k]
end

local function try(what, solver, options)
  local whole = solver:run(options)
  local fine, failure = pcall(solver.run, solver, with(options, { file = name }))
  local path, file = fine and failure or failure.path, dm.load(name)
  local n, good, columns = #file.t, true, path.columns
  for k = 1, #path.q do good = good and same(path, k, whole, (fine and n - 1 or n) + k) end
  for k = 1, n do good = good and file.t[k] == whole.t[k] and (not file.q1 or file.q1[k] == whole.q[k][1]) end
  print(what, fine, n, #path.q, good, fine and n == #whole.q or n + #path.q <= #whole.q)
  os.remove(name)
end
local start = { q = { 1 }, v = { 0 }, steps = 30000 }
local verlet = oscillator:solver { rule = "verlet", h = 0.1 }
try("every step", verlet, start)
try("every third", verlet, with(start, { every = 3 }))
try("at", verlet, { q = { 1 }, v = { 0 }, at = slices })
try("impulses", pendulum:solver { rule = "rattle", h = 0.01 }, { q = { 1, 0 }, v = { 0, 0 }, steps = 9000, record = { "impulses" } })
try("avi", wave:solver { rule = "avi" }, with(bump, { t = 100 }))
try("slices", wave:solver { rule = dm.prismal(table.move(slices, 1, 3000, 1, {})) }, bump)
]]

-- lines of what the script prints where files hold at most so many blocks of 512 bytes
local function lines_of(script, blocks)
  local source, file = os.tmpname(), os.tmpname() .. ".npy"
  local handle = assert(io.open(source, "w"))
  handle:write(script)
  handle:close()
  local command = ("sh -c \"ulimit -f %s; %s %s %s 2>&1\""):format(blocks, os.getenv "DMLUA" or "build/dmlua",
    source, file)
  local pipe = assert(io.popen(command))
  local out = {}
  for line in pipe:lines() do out[#out + 1] = line end
  pipe:close()
  os.remove(source)
  os.remove(file)
  return out
end
local RUNS = { "every step", "every third", "at", "impulses", "avi", "slices" }
local full, free = lines_of(SCRIPT, 300), lines_of(SCRIPT, "unlimited")
ok(#full == #RUNS and #free == #RUNS, "every run says a line", #full)
for k, line in ipairs(full) do
  local what, fine, filed, kept, same, all = line:match "^(.-)\t(%w+)\t(%d+)\t(%d+)\t(%w+)\t(%w+)$"
  ok(what == RUNS[k] and fine == "false" and tonumber(kept) > 1, "a full disk ends the run: " .. (RUNS[k] or "?"), line)
  ok(same == "true" and all == "true" and tonumber(filed) + tonumber(kept) > 1, "its rows are those of a run in memory", line)
end
for k, line in ipairs(free) do
  ok(line:find(RUNS[k] .. "\ttrue\t%d+\t1\ttrue\ttrue$"), "all rows in the file, the last one kept: " .. RUNS[k], line)
end

-- what is written at once takes the place of an old file when all of it is on the disk; what a link leads to is written through it
local AT_ONCE = [[
local dm = require "dm"
local name = arg[1]
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 end }
local solver = oscillator:solver { rule = "verlet", h = 0.1 }
local little, much = solver:run { q = { 1 }, v = { 0 }, steps = 10 }, solver:run { q = { 1 }, v = { 0 }, steps = 20000 }
local function text() local f = io.open(name, "rb") local s = f:read "a" f:close() return s end
for _, kind in ipairs { "csv", "npy" } do
  little[kind](little, name)
  local old = text()
  local fine, why = pcall(much[kind], much, name)
  print(kind, fine, text() == old, tostring(why):find "cannot write" ~= nil)
end
os.execute("ln -s " .. name .. " " .. name .. ".link")
os.remove(name)
little:csv(name .. ".link")
print(text() == little:csv())
os.execute("chmod 600 " .. name)
little:csv(name)
os.execute("stat -c %a " .. name)
os.execute("ls " .. name .. ".*")
os.remove(name .. ".link")
]]
local said = table.concat(lines_of(AT_ONCE, 300), " ")
ok(said:find "csv%sfalse%strue%strue npy%sfalse%strue%strue true 600 %S+%.link$", "an old file stays where the new one is not whole, and its mode", said)

-- between two blocks: a checkpoint every few milliseconds
local dm = require "dm"
local name = os.tmpname()
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 end }
local solver = oscillator:solver { rule = "verlet", h = 0.1 }
for every, steps in pairs { 200000, [3] = 600000, [1000] = 1000000 } do
  local whole = solver:run { q = { 1 }, v = { 0 }, steps = steps, every = steps }
  local path = solver:run { q = { 1 }, v = { 0 }, steps = steps, every = every, file = name .. ".npy",
    checkpoint = { file = name, every = 0.001 } }
  local rows = dm.load(name .. ".npy")
  ok(#path.t == 1 and path.t[1] == whole.t[2] and path.q[1] == whole.q[2], "the last row beside a checkpoint", path.t[1])
  ok(rows.t[#rows.t] == whole.t[2] and rows.q1[#rows.q1] == whole.q[2][1], "and in the file")
end
os.remove(name)
os.remove(name .. ".npy")
tap.done()
