-- runs with steps of their own, over uneven slices and of flows: checkpoints, what goes on from them, rows in files, and
-- files that were changed
local tap = require "tap"
local dm = require "dm"
local state_file = require "dm.data.state_file"
local ok, raises = tap.ok, tap.raises
local sin, cos, exp = math.sin, math.cos, math.exp

local name = os.tmpname()
local rows_file = name .. ".npy"
local K = dm.mesh { triangle = 4 }
local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end

-- options with a start
local function with(start, options)
  for key, value in pairs(start) do options[key] = value end
  return options
end

-- are these rows of a run (or of a file) the last ones of another?
local function ends_as(part, whole, first)
  for i = first or 2, #part.t do
    local k = #whole.t - #part.t + i
    if part.t[i] ~= whole.t[k] or part.q[i] ~= whole.q[k] or part.p[i] ~= whole.p[k] then return false end
  end
  return true
end

---- asynchronous steps: #rows do not depend on where a run was cut, nor does a bit ----

local springs = K:field { form = 0, L = function(u, v) return v:dot(v) / 2
  - K:sum(1, function(a, cell) local d = a[2] - a[1] return cell.star * (d ^ 2 / 2 + d ^ 4 / 4) end, u) end }
local start = { q = function(x, y) return exp(-20 * ((x - 0.5) ^ 2 + (y - 0.3) ^ 2)) end, v = function() return 0 end }
for _, begin in ipairs { "whole", "half" } do
  local solver = springs:solver { rule = "avi", start = begin }
  local whole = solver:run(with(start, { t = 2 }))
  local part = solver:run(with(start, { t = 0.9, checkpoint = name }))
  for _, from in ipairs { part, name } do
    local rest = dm.resume(from, springs):run { t = 1.1 }
    ok(ends_as(rest, whole) and rest.q[1] == part.q[#part] and rest.p[1] == part.p[#part], "avi goes on, start = " .. begin)
  end
  local first = solver:run(with(start, { t = 0.9, file = rows_file }))
  local second = dm.resume(first):run { t = 1.1, file = rows_file }
  local rows = dm.load(rows_file)
  ok(#first == 1 and #second == 1 and #rows.t == #whole + 1 and ends_as(second, whole, 1)
    and rows.q[#rows.t] == whole.q[#whole] and rows.p[5] == whole.p[5], "its rows in one file")
end
raises("its own state", function() dm.resume(name, springs):run(with(start, { t = 1 })) end)
raises("its L was", function() dm.resume(name, K:field { form = 0, L = wave }) end)
raises("its fixed was", function() dm.resume(name, K:field { form = 0, fixed = "boundary", L = wave }) end)
raises("its degree was 0 and is 1", function() dm.resume(name, K:field { form = 1, L = wave }) end)
raises("the field that the run is of", function() dm.resume(name) end)
raises("there are no options", function() dm.resume(name, springs, { rule = "verlet" }) end)
raises("growing times", function() dm.resume(name, springs):run { at = { 2, 1 } } end)

-- a file with other lines and the checksum of those
local text = assert(io.open(name)):read "a"
local function changed(pattern, by)
  local body, count = text:match "^(.*\n)end %x+\n$":gsub(pattern, by, 1)
  ok(count == 1, "changed: " .. pattern:gsub("\n", " "))
  local file = assert(io.open(name, "w"))
  file:write(body, "end ", state_file.checksum(body), "\n")
  file:close()
  return function() dm.resume(name, springs):run { t = 0.1 } end
end
raises("'t0' must be a finite number", changed("\nt0 [^\n]*", "\nt0 nan"))
raises("no state of these cells", changed("\nt [^\n]*", "\nt 0x1p+9"))
raises("missing, or too many", changed("steps %d+", "steps 3"))
raises("a whole number >= 0", changed("steps %d+", "steps -3"))
raises("'start'", changed("start %l+", "start never"))
raises("no finite number", changed("\n0x[^\n]*\n", "\n1e999\n"))
raises("no state of these cells", changed("\n[^\n]*\n$", "\n0x1.8p+0\n"))
raises("no state of these cells", changed("\n0x[^\n]*\n", "\n-0x1p+0\n"))

---- uneven slices: forms of degree 0 with friction, 1, and values on a sphere ----

local times, cut = { 0 }, {}
for i = 1, 30 do times[i + 1] = times[i] + 0.01 * (i < 20 and 1 + 0.5 * sin(i) or 1) end
for i = 1, 13 do cut[i] = times[i] end
local cases = {
  { K:field { form = 0, L = wave, force = function(_, V) return -0.1 * V end }, { q = function(x, y) return sin(3 * x + y) end, v = function() return 0 end } },
  { K:field { form = 1, L = wave }, { q = function(x, y) return { sin(3 * x + y), x * y } end, v = function() return { 0, 0 } end } },
  { K:field { form = 0, on = dm.S(2), L = wave }, { q = function(x) return { cos(3 * x), sin(3 * x), 0 } end,
    v = function(x, y) return { -sin(3 * x) * y, cos(3 * x) * y, 0.1 } end } },
}
for k, case in ipairs(cases) do
  local field, all = case[1], { rule = dm.prismal(times) }
  local whole = field:solver(all):run(with(case[2], {}))
  local part = field:solver { rule = dm.prismal(cut) }:run(with(case[2], { checkpoint = name, file = rows_file }))
  local fine = ends_as(dm.resume(part, field, all):run {}, whole) and ends_as(dm.resume(name, field, all):run { file = rows_file }, whole, 1)
  local rows = dm.load(rows_file)
  ok(fine and #part == 1 and #rows.t == 31 and ends_as(rows, whole, 1), "slices, field " .. k)
  raises("all its slices are done", function() dm.resume(part) end)
  raises("none that begins there", function() dm.resume(part, field, { rule = dm.prismal { 0, 1 } }) end)
end
raises("its own state", function() dm.resume(name, cases[3][1], { rule = dm.prismal(times) }):run { q = 1 } end)

---- flows ----

local ball = dm.mesh { icosphere = 1 }
local function flow(K1) return K1:euler { vorticity = function(x, y, z) return 2 * z + 4 * x * y * z end } end
local solver = flow(ball):solver { h = 0.1 }
local whole = solver:run { steps = 20 }
local part = solver:run { steps = 9, checkpoint = name, file = rows_file }
for _, from in ipairs { part, name } do
  local rest = dm.resume(from, solver.euler):run { t = 1.1, file = rows_file }
  local rows = dm.load(rows_file)
  local same = #rows.t == 21 and rest.w[#rest] == whole.w[21] and rest.t[1] == part.t[#part]
  for i = 1, 21 do
    same = same and rows.w[i] == whole.w[i] and rows.t[i] == whole.t[i] and rows.energy[i] == whole:column "energy"[i]
  end
  ok(same, "a flow goes on, and its rows in one file")
end
local longer = ball:points()
for i = 1, #longer do longer[i] = { 2 * longer[i][1], longer[i][2], longer[i][3] } end
raises("its lengths was", function() flow(dm.mesh { simplices = ball:simplices(2), points = longer }):resume(name) end)
raises("its vertices was 42", function() flow(dm.mesh { icosphere = 2 }):resume(name) end)
raises("its own state", function() dm.resume(part):run { t = 3, t0 = 1 } end)
raises("other columns", function() dm.resume(part):run { t = 1, file = arg[0] } end)

---- L, forces and masses are those with which a run was made, not those of the day it is saved ----

local k, c, m = 1, 0.1, 1
local function changing(force)
  return K:field { form = 0, force = force and function(_, V) return -c * V end or nil,
    L = function(u, v) return m * v:dot(v) / 2 - k * u:d():dot(u:d()) / 2 end }
end
local from = { q = function(x, y) return x * y end, v = function() return 0 end }
for _, case in ipairs { { "avi", { rule = "avi" }, 0.03, "L" }, { "prismal", { rule = dm.prismal { 0, 0.01, 0.02 } }, nil, "L" },
  { "prismal", { rule = dm.prismal { 0, 0.01, 0.02 } }, nil, "L", true }, { "verlet", { rule = "verlet", h = 0.01 }, 0.03, "force", true },
  { "midpoint", { rule = "midpoint", h = 0.01 }, 0.03, "force", true } } do
  k, c, m = 1, 0.1, 1
  local field = changing(case[5])
  local run = field:solver(case[2]):run(with(from, { t = case[3] }))
  local on = case[1] == "prismal" and { rule = dm.prismal { 0.02, 0.03 } } or nil
  local function go(solver) return solver:run { t = case[3] } end
  local function both(what)
    run:checkpoint(name)
    raises(what, function() go(dm.resume(name, field, on)) end)
    raises(what, function() go(dm.resume(run, field, on)) end)
  end
  if case[5] then c = 0.5 else k = 2 end
  both(case[4] .. " was")
  k, c = 1, 0.1
  if case[1] == "avi" then m = 2 both "masses was" m = 1 end
  ok(ends_as(go(dm.resume(run, field, on)), go(dm.resume(name, field, on)), 1), case[1] .. ": and back")
  local solver = dm.resume(run, field, on)
  k, c = case[5] and 1 or 3, case[5] and 0.9 or 0.1
  raises(case[4] .. " was", function() go(solver) end)
end
for _, file in ipairs { name, rows_file } do os.remove(file) end
tap.done()
