-- spaces of curves of a script: dm.galerkin { functions = | curve = }
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, cos, sin, pi = math.abs, math.max, math.cos, math.sin, math.pi

local function line(V)
  return dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - V(q[1]) end }
end
local pendulum = line(function(x) return -cos(x) end)
-- two rods: a mass that changes, coordinates that are coupled
local double = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2])
    + 9.81 * (2 * cos(q[1]) + cos(q[2]))
end }
local function run(system, rule, h, steps, q, v, more)
  local given = { q = q, v = v, steps = steps }
  for key, value in pairs(more or {}) do given[key] = value end
  return system:solver { rule = rule, h = h }:run(given)
end
local function own(functions, quadrature) return dm.galerkin { functions = functions, quadrature = quadrature } end
local function apart(a, b)
  local worst = 0
  for i = 1, #a do worst = max(worst, (a.q[i] - b.q[i]):norm(), (a.p[i] - b.p[i]):norm()) end
  return worst
end

-- polynomials are the rule that has a name, whatever their basis
local cubic = own(function(t) return { 1, t, t ^ 2, t ^ 3 } end, "lobatto(4)")
local named = run(double, "galerkin(3, lobatto(4))", 0.05, 40, { 1, 0.5 }, { 0.3, -1 })
local path = run(double, cubic, 0.05, 40, { 1, 0.5 }, { 0.3, -1 })
ok(apart(path, named) < 1e-12, "{1, t, t^2, t^3} is galerkin(3, lobatto(4)) on two pendulums", apart(path, named))
path = run(double, own(function(t, h) return { (1 - t / h) ^ 3, t ^ 3, t, 1 } end, "lobatto(4)"),
  0.05, 40, { 1, 0.5 }, { 0.3, -1 })
ok(apart(path, named) < 1e-12, "  in another basis, too", apart(path, named))
local driven = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 * (1 + 0.3 * cos(t)) end }
path, named = run(driven, cubic, 0.1, 40, { 1 }, { 0 }), run(driven, "galerkin(3, lobatto(4))", 0.1, 40, { 1 }, { 0 })
ok(apart(path, named) < 1e-13, "  and where L depends on time", apart(path, named))

-- a space that has the motion steps it exactly, with coordinates that have spaces of their own
local springs = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + v[2] ^ 2) / 2 - 4.5 * q[1] ^ 2 - 0.5 * q[2] ^ 2
end }
local both = own({ function(t) return { 1, cos(3 * t), sin(3 * t) } end,
  function(t) return { cos(t), sin(t) } end }, "gauss(14)")
path = run(springs, both, 1.3, 15, { 1, 0.5 }, { 0.5, -1 })
local worst = 0
for i = 1, #path do
  local t = path.t[i]
  worst = max(worst, abs(path.q[i][1] - cos(3 * t) - sin(3 * t) / 6), abs(path.q[i][2] - 0.5 * cos(t) + sin(t)))
end
ok(worst < 1e-12, "two springs in spaces of their own", worst)
-- quadratures: pieces, own nodes
local function final(quadrature)
  local p = run(pendulum, own(function(t) return { 1, t, t ^ 2 } end, quadrature), 0.5, 20, { 1 }, { 0 })
  return p.q[21][1]
end
near(final { "gauss(3)", pieces = 1 }, final "gauss(3)", 1e-15, "one piece is none")
near(final { "gauss(3)", pieces = 4 }, final "gauss(12)", 1e-9, "pieces of a quadrature")
near(final { nodes = { 0, 0.5, 1 }, weights = { 1 / 6, 2 / 3, 1 / 6 } }, final "lobatto(3)", 1e-14, "nodes and weights")
near(final { { nodes = { 0.5 }, weights = { 1 } }, pieces = 2 }, final { "gauss(1)", pieces = 2 }, 1e-15, "pieces of own nodes")

-- curves that are not linear in their parameters: the same curves, other parameters
local bent = dm.galerkin { parameters = 3, quadrature = "gauss(2)",
  start = function(q, v, h) return { q[1], q[1] + h * v[1], 0 } end,
  curve = function(t, z, h) return { z[1] + (z[2] - z[1]) * t / h + t * (h - t) * (z[3] + z[3] ^ 3 / 10) } end }
path, named = run(pendulum, bent, 0.5, 20, { 1 }, { 0 }), run(pendulum, "gauss(2)", 0.5, 20, { 1 }, { 0 })
ok(apart(path, named) < 1e-12, "a curve with nonlinear parameters is gauss(2) again", apart(path, named))
-- polar curves of a free particle: its straight lines are among them
local free = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end }
local polar = dm.galerkin { parameters = 4, quadrature = "gauss(3)",
  start = function(q, v, h) return { q[1], q[2], q[1] + h * v[1], q[2] + h * v[2] } end,
  curve = function(t, z, h)
    local s = t / h
    return { z[1] * (1 - s) + z[3] * s, z[2] * (1 - s) + z[4] * s + 0 * z[1] }
  end }
path = run(free, polar, 0.5, 4, { 1, 2 }, { 3, -1 })
near(path.q[5][1], 7, 1e-13, "a curve in two coordinates")

-- runs
local solver = pendulum:solver { rule = own(function(t) return { 1, t, cos(t), sin(t) } end, "gauss(8)"), h = 0.5 }
path = solver:run { q = { 1 }, v = { 0 }, steps = 40 }
local seen = solver:run { q = { 1 }, v = { 0 }, steps = 40, events = { bottom = function(q) return q[1] end } }
ok(#seen.events == 6 and apart(path, seen) == 0, "events leave the run as it is", #seen.events)
near(solver:run { q = { 1 }, v = { 0 }, at = { 1.5 } }.q[1][1], path.q[4][1], 1e-15, "rows at times")
local half = solver:run { q = { 1 }, v = { 0 }, steps = 15 }
ok(dm.resume(half):run { steps = 25 }.q[26][1] == path.q[41][1], "a checkpoint goes on bit for bit")
local cloud = solver:ensemble { members = 3, q = { { 1 }, { 0.5 }, { 0.2 } }, v = function() return { 0 } end, steps = 10 }
ok(cloud.q[1][1] == path.q[11][1], "a member is a run of its own")
ok(solver:symplecticity { q = { 1 }, v = { 0.3 }, steps = 10 } < 1e-12, "a step is symplectic")

-- what is refused
local function line_space(functions, quadrature, h, system)
  return function() run(system or pendulum, own(functions, quadrature or "gauss(4)"), h or 0.5, 1, { 1 }, { 0 }) end
end
raises("number 3 is a combination", line_space(function(t) return { 1, t, 2 * t - 1 } end))
raises("cannot meet both ends", line_space(function(t) return { t, t ^ 2 } end))
raises("cannot meet both ends", line_space(function(t) return { 1, cos(t), sin(t) } end, "gauss(8)", 2 * pi))
raises("too coarse", line_space(function(t) return { 1, t, t ^ 2, t ^ 3, t ^ 4 } end, "gauss(2)"))
raises("function 2 of the space is inf", line_space(function(t) return { 1, 1 / t } end))
raises("returned 3 functions at first and 2", line_space(function(t) return t > 0.4 and t < 0.5 and { 1, t } or { 1, t, t ^ 2 } end))
raises("list of 2 spaces", line_space({ function(t) return { 1, t } end, function(t) return { 1, t } end }))
raises("unknown quadrature 'simson(2)'", dm.galerkin, { functions = function(t) return { 1, t } end, quadrature = "simson(2)" })
raises("quadrature is missing", dm.galerkin, { functions = function(t) return { 1, t } end })
raises("sum of the weights", dm.galerkin, { functions = function(t) return { 1, t } end, quadrature = { nodes = { 0, 1 }, weights = { 1, 1 } } })
raises("nodes lie in [0, 1]", dm.galerkin, { functions = function(t) return { 1, t } end, quadrature = { nodes = { 0, 2 }, weights = { 0.5, 0.5 } } })
raises("must return a list", dm.galerkin, { functions = function() return 3 end, quadrature = "gauss(2)" })
raises("two are needed", dm.galerkin, { functions = function() return { 1 } end, quadrature = "gauss(2)" })
raises("not both", dm.galerkin, { functions = function(t) return { 1, t } end, curve = print, quadrature = "gauss(2)" })
raises("'start' is missing", dm.galerkin, { curve = print, parameters = 3, quadrature = "gauss(2)" })
raises("'parameters' is missing", dm.galerkin, { curve = print, start = print, quadrature = "gauss(2)" })
raises("2 coordinates of the system (got 1)", run, double, bent, 0.1, 1, { 1, 1 }, { 0, 0 })
raises("parameters of the curve", run, pendulum, dm.galerkin { curve = function(_, z) return { z[1] } end, parameters = 3,
  start = function() return { 1 } end, quadrature = "gauss(2)" }, 0.1, 1, { 1 }, { 0 })
raises("forces", run, dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end, force = function(_, v) return { -v[1] } end }, cubic, 0.1, 1, { 1 }, { 0 })
raises("dm.galerkin { functions", function() pendulum:solver { rule = "trial", h = 0.1 } end)
-- a space whose curves cannot speed up: what Newton's method finds there is no motion
raises("do not follow the motion", function()
  dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }):solver { h = 0.2,
    rule = dm.galerkin { parameters = 3, quadrature = "gauss(6)", start = function(q, v, h) return { q[1], h * v[1], 1 } end,
      curve = function(t, z, h) return { z[1] + z[2] * dm.tanh(z[3] * t / h) } end } }:run { q = { 1 }, v = { 0 }, steps = 20 }
end)
tap.done()
