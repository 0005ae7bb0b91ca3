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
local linear = require "dm.base.linear"
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

-- T(0) from the results of the first `count` numbers of steps
local function extrapolated(results, steps, count)
  local first = { table.unpack(steps, 1, count) }
  local sum = weight(first, first[1]) * results[1]
  for k = 2, count do sum = sum + weight(first, first[k]) * results[k] end
  return sum
end

-- y(1), extrapolated to steps of 0 (Gragg, Bulirsch and Stoer), and behind it the squares of what
-- the last two numbers of steps changed
local function flow(f, y, size)
  local steps, results = size > LARGE and FEWER or STEPS, {}
  local N = #steps
  for k, m in ipairs(steps) do results[k] = gragg(f, y, m) end
  local less, out = extrapolated(results, steps, N - 1), extrapolated(results, steps, N)
  local last, before = out - less, less - extrapolated(results, steps, N - 2)
  return out, { last:dot(last), before:dot(before) }
end

-- The error of an extrapolation that changed by a, then by b, goes on as b^2/a.
local function error_of(last, before) return last > 0 and last / math.sqrt(before) or 0 end

---- shooting ----

local FAR = "are the points near enough for one geodesic between them?"
local AGREED, ESTIMATED = 1e-12, 5e-14 -- error of y(1), and its estimate, which may be too small
local MOST, ROUNDS = 64, 30            -- intervals, corrections at most

-- (x, p, mu, theta, phi) of the geodesic that begins at x with the velocity w
local function beginning(B, metric, x, w)
  return lists.joined(x, metric(x) * w, lists.zeros(2 * B.d))
end

-- x, theta, phi of y
local function ending(B, y)
  local n, d = B.n, B.d
  return lists.part(y, 0, n), lists.part(y, 2 * n + d, d), lists.part(y, 2 * (n + d), d)
end

-- y(1) of numbers by short intervals, as many as AGREED needs: far(y) -> y(1), or nothing
local function by_intervals(B, f)
  local size = B.n + B.d
  local N, short = 2 * size + B.d, nil
  return function(y, intervals)
    short = short or core.trace(function(z, h)
      local out, changes = flow(function(x) return h * f(x) end, z, size)
      return lists.joined(out, changes)
    end, N, "number")
    repeat
      local z, off = y, 0
      for _ = 1, intervals do
        local out = short(z, 1 / intervals)
        z, off = lists.part(out, 0, N), off + error_of(out[N + 1], out[N + 2])
      end
      if off <= ESTIMATED * (1 + z:norm()) then return z, intervals end
      intervals = 2 * intervals
    until intervals > MOST
  end
end

-- phi(1) of the geodesic from (x0, e) to x(1) = x1, second(theta, phi) = s. The root takes one
-- interval; where that is not enough for numbers, it is aimed at what more intervals miss.
local function shooting(B, metric, f, name, second, start)
  local n, d = B.n, B.d
  local function once(x, w) return flow(f, beginning(B, metric, x, w), n + d) end
  local root = core.root { name = name, unknowns = n + d, failure = FAR, start = start,
    equations = function(w, x0, x1, s)
      local x, theta, phi = ending(B, (once(core.vector(x0), core.vector(w))))
      return lists.joined(x - core.vector(x1), second(theta, phi) - core.vector(s))
    end }
  local short = core.trace(function(x0, x1, s)
    local y, changes = once(x0, core.vector(root(x0, x1, s)))
    return lists.joined(select(3, ending(B, y)), changes)
  end, n, n, d)
  local far = by_intervals(B, f)
  local function corrected(x0, x1, s)
    local aim, behind, intervals, y = x1, s, 2, nil
    for _ = 1, ROUNDS do
      local w = core.vector(root(x0, aim, behind))
      y, intervals = far(beginning(B, metric, x0, w), intervals)
      if not y then break end
      local x, theta, phi = ending(B, y)
      local off, other = x1 - x, s - second(theta, phi)
      if off:norm() + other:norm() <= AGREED / 5 then return phi end
      aim, behind = aim + off, behind + other
    end
    error(("%s is not known to %g: %s"):format(name, AGREED, FAR), 0)
  end
  return function(x0, x1, s)
    local out = short(x0, x1, s)
    local phi = lists.part(out, 0, d)
    if not linear.is_plain(core.matrix { phi })
      or error_of(out[d + 1], out[d + 2]) <= ESTIMATED * (1 + phi:norm()) then
      return phi
    end
    return corrected(core.vector(x0), core.vector(x1), core.vector(s))
  end
end

-- to (x1, exp(s))
local function to_a_point(B, metric, f)
  return shooting(B, metric, f, "the geodesic", function(theta) return theta end,
    function(x0, x1, s) return lists.joined(x1 - x0, s) end)
end

-- to the fibre of x1, horizontal there: theta = phi
local function to_a_fibre(B, metric, form, f)
  local none = core.zeros(B.d)
  local reach = shooting(B, metric, f, "the horizontal geodesic",
    function(theta, phi) return theta - phi end, function(x0, x1)
      local u = core.vector(x1) - core.vector(x0)
      return lists.joined(u, -(form(core.vector(x0)) * u))
    end)
  return function(x0, x1) return reach(x0, x1, none) end
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
