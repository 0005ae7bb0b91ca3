-- Rows in a file: the path keeps the last one, with checkpoints between and where a step fails; on a
-- disk that is full it says which rows are where.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local folder = os.tmpname()
os.remove(folder)
os.execute("mkdir " .. folder)
local function at(name) return folder .. "/" .. name end
local function with(start, options)
  for key, value in pairs(start) do options[key] = value end
  return options
end
local start = { q = { 0.4, 0 }, v = { 0, 2 } }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }

local function same_row(a, i, b, j)
  local same = a.t[i] == b.t[j]
  for k = 1, #a.q[i] do
    same = same and a.q[i][k] == b.q[j][k] and a.p[i][k] == b.p[j][k]
  end
  return same
end

-- the row that a path keeps of its file is the last one
local function keeps_last(solver, options, what)
  local whole = solver:run(with(start, options()))
  local o = with(start, options())
  o.file, o.checkpoint = at "rows.npy", { file = at "state", every = 1e-3 }
  local path = solver:run(o)
  local rows = dm.load(o.file)
  ok(#path == 1 and same_row(path, 1, whole, #whole) and #rows.t == #whole
    and rows.t[#whole] == whole.t[#whole], what, ("%d, t = %g"):format(#path, path.t[1]))
  ok(tostring(path):find("all of them in", 1, true), what .. ": and says where all are")
end
local verlet = kepler:solver { rule = "verlet", h = 0.05 }
keeps_last(verlet, function() return { steps = 3e6, every = 1e5 } end, "rows between checkpoints")
keeps_last(verlet, function() return { steps = 3e6, every = 7e5 } end, "and one for the end")
keeps_last(verlet, function() return { steps = 8191 } end, "two blocks but one")
keeps_last(verlet, function() return { steps = 8192 } end, "two blocks and one")
keeps_last(verlet, function() return { t = 5000, every = 3 } end, "for a time")
local bead = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end,
  constraint = function(q) return q:dot(q) - 0.16 end }
keeps_last(bead:solver { rule = "rattle", h = 0.01 }, function()
  return { steps = 3e5, every = 1e4, record = { "impulses" } }
end, "impulses, whose row waits for the next step")

-- a step that fails: as without a file
local fall = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - 1e-3 * (1 - q[1]) ^ 0.5 end }
local function failed(options)
  local done, failure = pcall(function()
    return fall:solver({ rule = "midpoint", h = 1e-4 }):run(with({ q = { 0 }, v = { 0.3 } }, options))
  end)
  return not done and failure
end
local bare = failed { steps = 1e5 }
local filed = failed { steps = 1e5, file = at "fall.npy", checkpoint = { file = at "state", every = 1e-3 } }
local rows = dm.load(at "fall.npy")
ok(bare and filed and bare.step == filed.step and #rows.t == #bare.path
  and same_row(filed.path, 1, bare.path, #bare.path) and #filed.path == 1,
  "a step that fails leaves the rows before it", bare and filed and tostring(filed))

-- a full disk, as a limit of the size of files, of which only an error is left
local script = at "child.lua"
do
  local f <close> = assert(io.open(script, "w"))
  f:write(([[local dm = require "dm"
local k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local done, failure = pcall(function() return k:solver { rule = "verlet", h = .01 }:run {
  q = { .4, 0 }, v = { 0, 2 }, steps = 400, file = %q } end)
print(done, #failure.path, failure.path)]]):format(at "full.npy"))
end
local pipe <close> = assert(io.popen(("trap '' XFSZ; ulimit -f 8; '%s' %s 2>&1"):format(arg[-1], script)))
local said = pipe:read "a"
ok(said:find("^false\t401\t") and said:find("those before them in", 1, true), "which rows are where", said)
os.execute("rm -r " .. folder)
tap.done()
