-- make bench: what a moving frame costs a step of a discrete Lagrangian, solved for and by its
-- formula, and what it costs to derive it. The plain side is the same Ld without frame; all sides
-- take turns, best of many short runs (the plain one fails later on).
--
--   build/dmlua tests/bench/frames.lua first
--
-- is about an action and its first frame in a process of their own, with the modules that are read
-- for them, and about the next one of the same: ms of CPU time, least of many processes that take
-- turns; behind a number and a name, "first 1 SO(2)" does it once in this process.
local dm = require "dm"
local cos, sin, sqrt, pi = math.cos, math.sin, math.sqrt, math.pi

local TIMES = 60

-- the Runge-Lenz action on momenta (Bogfjellmo 4.10), trapezoidal Ld with h = 2 pi/200
local function rotate(theta, w)
  local n = w:dot(w)
  local d = 1 + n - cos(theta) * (n - 1) - 2 * sin(theta) * w[2]
  return { 2 * w[1] / d, (-sin(theta) * (n - 1) + 2 * cos(theta) * w[2]) / d }
end
local h = 2 * pi / 200
local function kepler(w0, w1)
  return 2 * sqrt(h) * sqrt((w1 - w0):norm()) - h / 4 * (w0:dot(w0) + w1:dot(w1))
end

-- trapezoidal Ld of a particle in a well that has the symmetry only as far as the frame gives it
local function well(dimension, step)
  return dimension, step, function(a, b)
    return (b - a):dot(b - a) / (2 * step) - step / 2 * (a:dot(a) + b:dot(b)) / 2
      - step / 8 * (a:dot(a) ^ 2 + b:dot(b) ^ 2)
  end
end

-- group, points, numbers of a point, section, branch, map of an action of one's own
local firsts = {
  { "SO(2)", dm.SO(2), 1, 2, function(a) return { a[2] } end, function(a) return a[1] end },
  { "SE(2)", dm.SE(2), 2, 2, function(a, b) return { a[1], a[2], b[2] } end,
    function(_, b) return b[1] end },
  { "SO(3)", dm.SO(3), 2, 3, function(a, b) return { a[1], a[2], b[2] } end,
    function(a, b) return { a[3], b[1] } end },
  { "SE(3)", dm.SE(3), 3, 3,
    function(a, b, c) return { a[1], a[2], a[3], b[2], b[3], c[3] } end,
    function(_, b, c) return { b[1], c[2] } end },
  { "SL(2)", dm.SL(2), 3, 1, function(a, b, c) return { a[1] + 1, b[1], c[1] - 1 } end },
  { "Runge-Lenz", dm.SO(2), 2, 2, function(w) return { w:dot(w) - 1 } end,
    function(w) return w[2] end, rotate },
}

-- ms for an action and its frame, `times` times
local function make(row, times)
  local out = {}
  for i = 1, times do
    local began = dm.cpu()
    dm.moving_frame { action = dm.action { group = row[2], on = dm.R(row[4]), map = row[7] },
      points = row[3], cross_section = row[5], branch = row[6] }
    out[i] = 1e3 * (dm.cpu() - began)
  end
  return out
end

local PROCESSES = 24

local function in_fresh_processes()
  local least = {}
  for _ = 1, PROCESSES do
    for _, row in ipairs(firsts) do
      local pipe = assert(io.popen(("'%s' '%s' first 1 '%s'"):format(arg[-1], arg[0], row[1])))
      local best = least[row[1]] or { math.huge, math.huge }
      for i = 1, 2 do best[i] = math.min(best[i], pipe:read "n") end
      pipe:close()
      least[row[1]] = best
    end
  end
  print(("%-10s %6s %8s %8s"):format("group", "points", "first ms", "next ms"))
  for _, row in ipairs(firsts) do
    print(("%-10s %6d %8.2f %8.2f"):format(row[1], row[3], table.unpack(least[row[1]])))
  end
end

if arg[1] == "first" then
  for _, row in ipairs(arg[2] and firsts or {}) do
    if row[1] == arg[3] then print(table.concat(make(row, 1 + arg[2]), " ")) end
  end
  if not arg[2] then in_fresh_processes() end
  return
end

local function lagrangian(n, step, Ld)
  return dm.discrete_lagrangian { Q = dm.R(n), h = step, Ld = Ld }
end

local problems = {
  { "Runge-Lenz, SO(2)", { 2, h, kepler }, { q = { 0.96, 0.28 }, p = { -0.8, -0.6 }, steps = 100 },
    { action = function() return dm.action { group = dm.SO(2), on = dm.R(2), map = rotate } end,
    points = 2,
      cross_section = function(w) return { w:dot(w) - 1 } end,
      branch = function(w) return w[2] end },
    function(a) return -math.atan(a:dot(a) - 1, 2 * a[2]) end },
  { "SE(2) in the plane", { well(2, 0.1) }, { q = { 0.4, 0.3 }, p = { 0.1, -0.4 }, steps = 1000 },
    { action = function() return dm.action { group = dm.SE(2), on = dm.R(2) } end, points = 2,
      cross_section = function(a, b) return { a[1], a[2], b[2] } end,
      branch = function(_, b) return b[1] end } },
  { "SO(3) in space", { well(3, 0.1) },
  { q = { 0.4, 0.3, 0.5 }, p = { 0.1, -0.4, 0.3 }, steps = 1000 },
    { action = function() return dm.action { group = dm.SO(3), on = dm.R(3) } end, points = 2,
      cross_section = function(a, b) return { a[1], a[2], b[2] } end,
      branch = function(a, b) return { a[3], b[1] } end } },
}

local function best_of(sides)
  local out = {}
  for i, side in ipairs(sides) do
    out[i] = { step = math.huge, build = math.huge, solver = dm.solver { side } }
  end
  return out
end

-- ns a step and ms of kernels, the sides in turn
local function measure(sides, start)
  local out = best_of(sides)
  for _ = 1, TIMES do
    for _, x in ipairs(out) do
      x.solver:run { q = start.q, p = start.p, steps = start.steps, every = start.steps }
      x.report = x.solver:report()
      x.step = math.min(x.step, x.report.ns_per_step)
    end
  end
  return out
end

-- ms of CPU time from the options of the action to the first step
local function derive(p)
  local options, L = p[4], lagrangian(table.unpack(p[2]))
  local least = { frame = math.huge, kernels = math.huge }
  for _ = 1, 9 do
    local action = options.action()
    local began = os.clock()
    local frame = dm.moving_frame { action = action, points = options.points,
      cross_section = options.cross_section, branch = options.branch }
    local Ld = frame:invariantize(L)
    least.frame = math.min(least.frame, 1e3 * (os.clock() - began))
    began = os.clock()
    dm.solver({ Ld }):run { q = p[3].q, p = p[3].p, steps = 0 }
    least.kernels = math.min(least.kernels, 1e3 * (os.clock() - began))
    least.Ld = Ld
  end
  return least
end

print(("%-20s %9s %9s %7s %9s %7s %8s %10s %10s")
  :format("a step of a frame", "plain ns", "solved", "ratio", "formula", "ratio",
  "kernel", "frame ms", "kernels ms"))
for _, p in ipairs(problems) do
  local made = derive(p)
  local sides = { lagrangian(table.unpack(p[2])), made.Ld }
  if p[5] then
    sides[3] = dm.moving_frame({ action = p[4].action(), points = p[4].points,
      cross_section = p[4].cross_section, branch = p[4].branch,
      solution = p[5] }):invariantize(sides[1])
  end
  local x = measure(sides, p[3])
  local formula = x[3] and ("%9.0f %7.2f"):format(x[3].step, x[3].step / x[1].step)
    or ("%9s %7s"):format("-", "-")
  print(("%-20s %9.0f %9.0f %7.2f %s %8d %10.2f %10.2f")
    :format(p[1], x[1].step, x[2].step, x[2].step / x[1].step, formula,
    x[2].report.operations, made.frame, made.kernels))
end
