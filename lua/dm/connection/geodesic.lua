--- The geodesic construction (Leok, Example 4.1): the geodesic of an invariant metric from q0 to q1
-- is projected to S and lifted from q0 by the connection AA; A_d takes the end of the lift to q1.
-- In a trivialization, with w = (x', xi), xi = g^-1 g', the metric M(x) and momenta (p, mu) = M w,
--   x' = u, p' = dT/dx, T = w.M w/2, mu' = coad(xi, mu),
--   theta' = dexpinv(-theta, xi), phi' = dexpinv(-phi, -AA u),
-- exp(theta) and exp(phi) being what g0 of the geodesic and of the lift are multiplied by. It is
-- horizontal where theta = phi, which completes it.
local bundles = require "dm.connection.bundle"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local WHERE = "dm.connection"

---- the metric ----

local function metric_of(given, B)
  local m = B.n + B.d
  local metric = options.need(given, "metric", WHERE,
    ("that of the geodesics, metric(x) -> matrix of %d x %d in (x', g^-1 g')"):format(m, m))
  local f = type(metric) == "function" and core.one(metric, "metric")
  local what = f and "what metric(x) returns" or "option 'metric'"
  local function at(x) return kits.matrix(f and f(x) or metric, m, what) end
  local here = at(core.zeros(B.n))
  for i = 1, m do
    for j = 1, i do
      local a, b = here[i][j], here[j][i]
      if type(a) == "number" and type(b) == "number"
        and math.abs(a - b) > 1e-12 * (1 + math.abs(a)) then
        options.fail(WHERE, "%s is not symmetric: entries (%d, %d) and (%d, %d) are %.6g and %.6g",
          what, i, j, j, i, a, b)
      end
    end
  end
  return at
end

-- the mechanical connection of the metric, M_gg^-1 M_gx
local function mechanical(B, metric)
  return function(x)
    local whole, n, d = metric(x), B.n, B.d
    local function block(from, rows, to, columns)
      local out = {}
      for i = 1, rows do
        out[i] = {}
        for j = 1, columns do out[i][j] = whole[from + i][to + j] end
      end
      return core.matrix(out)
    end
    return block(n, d, n, d):solve(block(n, d, 0, n))
  end
end

---- the flow over one unit of time ----

-- the right-hand side on y = (x, p, mu, theta, phi)
local function field(B, metric, form)
  local n, d, kit = B.n, B.d, B.kit
  local slope = core.derivative(function(x, w) return 0.5 * w:dot(metric(x) * w) end, n, n + d)
  return function(y)
    local x, momenta = lists.part(y, 0, n), lists.part(y, n, n + d)
    local theta, phi = lists.part(y, 2 * n + d, d), lists.part(y, 2 * (n + d), d)
    local w = metric(x):solve(momenta)
    local u, xi = lists.part(w, 0, n), lists.part(w, n, d)
    return lists.joined(u, lists.part(slope(x, w), 0, n), kit.coad(xi, lists.part(momenta, n, d)),
      kit.dexpinv(-theta, xi), kit.dexpinv(-phi, -(form(x) * u)))
  end
end

-- the modified midpoint rule of Gragg with m steps over one unit of time
local function gragg(f, y, m)
  local h = 1 / m
  local before, now = y, y + h * f(y)
  for _ = 2, m do before, now = now, before + (2 * h) * f(now) end
  return 0.5 * (now + before + h * f(now))
end

-- numbers of steps, for an order of twice as many; of large groups less, as the graph would be
-- too large
local STEPS, FEWER, LARGE = { 2, 4, 6, 8, 10 }, { 2, 4, 6 }, 7

-- what the result of m steps is weighted by: the sum over m of c_m T(1/m^2) is T(0) to that order
local function weight(steps, m)
  local c = 1
  for _, other in ipairs(steps) do
    if other ~= m then c = c * m ^ 2 / (m ^ 2 - other ^ 2) end
  end
  return c
end

-- y(1), extrapolated to steps of 0 (Gragg, Bulirsch and Stoer)
local function flow(f, y, size)
  local steps = size > LARGE and FEWER or STEPS
  local sum = weight(steps, steps[1]) * gragg(f, y, steps[1])
  for k = 2, #steps do sum = sum + weight(steps, steps[k]) * gragg(f, y, steps[k]) end
  return sum
end

---- shooting ----

-- x(1), theta(1) and phi(1) of the geodesic that begins at x with the velocity w
local function shoot(B, metric, f, x, w)
  local y = flow(f, lists.joined(x, metric(x) * w, lists.zeros(2 * B.d)), B.n + B.d)
  return lists.part(y, 0, B.n), lists.part(y, 2 * B.n + B.d, B.d),
    lists.part(y, 2 * (B.n + B.d), B.d)
end

local FAR = "are the points near enough for one geodesic between them?"

-- phi(1) of the geodesic from (x0, e) to (x1, exp(theta))
local function to_a_point(B, metric, f)
  local m = B.n + B.d
  local root = core.root { name = "the geodesic", unknowns = m, failure = FAR,
    start = function(x0, x1, theta) return lists.joined(x1 - x0, theta) end,
    equations = function(w, x0, x1, theta)
      local x, turned = shoot(B, metric, f, core.vector(x0), core.vector(w))
      return lists.joined(x - core.vector(x1), turned - core.vector(theta))
    end }
  return core.trace(function(x0, x1, theta)
    return (select(3, shoot(B, metric, f, x0, core.vector(root(x0, x1, theta)))))
  end, B.n, B.n, B.d)
end

-- phi(1) of the geodesic from (x0, e) to the fibre of x1 that is horizontal, theta = phi
local function to_a_fibre(B, metric, form, f)
  local m = B.n + B.d
  local root = core.root { name = "the horizontal geodesic", unknowns = m, failure = FAR,
    start = function(x0, x1)
      local u = core.vector(x1) - core.vector(x0)
      return lists.joined(u, -(form(core.vector(x0)) * u))
    end,
    equations = function(w, x0, x1)
      local x, theta, phi = shoot(B, metric, f, core.vector(x0), core.vector(w))
      return lists.joined(x - core.vector(x1), theta - phi)
    end }
  return core.trace(function(x0, x1)
    return (select(3, shoot(B, metric, f, x0, core.vector(root(x0, x1)))))
  end, B.n, B.n)
end

--- The local form, completed or of the raw one-form, and that of raw ones.
function M.of(given, B, form)
  if given.log ~= nil then
    options.fail(WHERE, "option 'log' does not go with by = \"geodesic\"")
  end
  local metric, kit = metric_of(given, B), B.kit
  form = form or mechanical(B, metric)
  local f = field(B, metric, form)
  if not given.raw then
    local lifted = to_a_fibre(B, metric, form, f)
    return function(x0, x1) return kit.exp(-lifted(x0, x1)) end
  end
  local lifted = to_a_point(B, metric, f)
  local function raw(q0, q1)
    local g = kit.compose(kit.inverse(q0[2]), q1[2])
    local back = kit.exp(-lifted(q0[1], q1[1], kit.log(g)))
    return bundles.conjugate(B, q0[2], kit.compose(g, back))
  end
  local e = kit.identity()
  return function(x0, x1) return raw({ x0, e }, { x1, e }) end, raw
end

return M
