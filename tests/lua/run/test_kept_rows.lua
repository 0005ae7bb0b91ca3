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

-- A full disk, as a limit of the size of files, of which only an error is left: the path says which
-- rows are where, and what goes on leaves no gap in the file.
local function on_full_disk(blocks, body)
  local script = at "child.lua"
  local f <close> = assert(io.open(script, "w"))
  f:write(([[local dm = require "dm"
local file, state, more = %q, %q, nil
%s
more = more or { t = 1 }
more.file = file
print(failure.path, pcall(function() dm.resume(failure.path):run(more) end))]]):format(
    at "full.npy", at "full.state", body))
  f:close()
  os.remove(at "full.npy")
  os.remove(at "full.state")
  local pipe <close> = assert(io.popen(("trap '' XFSZ; ulimit -f %d; '%s' %s 2>&1"):format(blocks, arg[-1], script)))
  return pipe:read "a"
end
local KEPLER = [[
local k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local _, failure = pcall(function() return k:solver { rule = "verlet", h = .01 }:run {
  q = { .4, 0 }, v = { 0, 2 }, steps = %s, file = file, checkpoint = { file = state, every = %s } } end)]]
local said = on_full_disk(8, KEPLER:format("400", "60"))
ok(said:find("those before them in", 1, true), "which rows are where", said)
ok(said:find("401 rows before t = 4.0 are missing in", 1, true), "a run that goes on does not skip them", said)
ok(not io.open(at "full.state"), "no checkpoint is behind rows that are missing")
said = on_full_disk(1000, KEPLER:format("1e6", "1e-4"))
ok(said:find("are missing in", 1, true), "nor after blocks of rows", said)
dm.resume(at "full.state", kepler):run { steps = 9000, file = at "full.npy" }
local data, gap = dm.load(at "full.npy"), 0
for i = 2, #data.t do gap = math.max(gap, data.t[i] - data.t[i - 1]) end
ok(#data.t > 9000 and math.abs(gap - 0.01) < 1e-9, "what goes on from the last checkpoint leaves no gap", gap)
for name, solver in pairs { avi = [["avi"]], slices = "dm.prismal(slices)" } do
  said = on_full_disk(100, ([[
local slices = {}
for i = 1, 9000 do slices[i] = 0.01 * (i - 1) end
local K = dm.mesh { grid = 4 }
local wave = K:field { form = 0, L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
local rule = %s
if rule ~= "avi" then more = {} end
local _, failure = pcall(function() return wave:solver { rule = rule }:run { q = function(x, y) return x * y end,
  v = function() return 0 end, t = rule == "avi" and 300 or nil, file = file, checkpoint = state } end)]]):format(solver))
  ok(said:find("those before them in", 1, true) and not io.open(at "full.state"), name .. ": no checkpoint, either", said)
  ok(said:find("rows before t = .* are missing in"), name .. ": a run that goes on does not skip them, either", said)
end
-- rows that Lua writes, of a flow: those that are in the file are counted, and the error says why
said = on_full_disk(100, [[
local K = dm.mesh { icosphere = 2 }
local E = K:euler { vorticity = K:form(0, function(x, y, z) return x * y + z end) }
print(pcall(function() E:solver { h = 0.05 }:run { steps = 400, file = file } end))
local failure = {}]])
local full = dm.load(at "full.npy")
local size = io.open(at "full.npy"):seek "end"
ok(said:find("cannot write", 1, true) and #full.t > 5 and size - 8 * 166 * (#full.t + 1) < 1000
  and math.abs(full.t[#full.t] - 0.05 * (#full.t - 1)) < 1e-9, "rows of a flow are counted", said .. #full.t)
os.execute("rm -r " .. folder)
tap.done()
