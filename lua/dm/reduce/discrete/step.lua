--- The step of a reduced discrete Lagrangian: the next shape and psi, solved for together, by the
-- unreduced equations in the coordinates of Q. From (x0, y0) over the group's identity:
--   D1 Ld(q0, q1) + F1 + G(q0)^T lambda + E^T kappa = -p0,  g(q1) = 0,  phi(q0, q1) = 0,
-- q0 = section(x0), p0 over (mu, y0), an implicit function of n unknowns q1 (and lambda, kappa and
-- inner variables of Ld) that begins where the step of Ld does, at q1 = q0; then q1 = psi .
-- section(x1), and y1 is D2 Ld + F2 there (Leok 2.3, 2.8).
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local parameters = require "dm.reduce.routh.params"

local M = {}

---- the chart (theta, x) -> Q ----

local function identity(z) return z end

-- the point of Q at (theta, x), and the derivative of that; no derivative: Q has these coordinates
local function chart_of(info)
  if info.ambient then return info.ambient.chart, info.ambient.slope end
  return identity, nil
end

-- J^T p, of the first n entries of p behind `first`
local function pulled_back(J, p, first, n)
  local out = {}
  for k = 1, n do
    if not J then
      out[k] = p[first + k]
    else
      out[k] = 0
      for i = 1, n do out[k] = out[k] + J[i][k] * p[first + i] end
    end
  end
  return out
end

---- q1 ----

-- the constraint of the unreduced system and its derivative, or nothing
local function constraint_of(info)
  local given = parameters.unreduced(info).given
  if not given.constraint then return nil end
  local constraint = bound(given.constraint, given.params)
  local function g(q) return core.vector(lists.entries(constraint(q, 0))) end
  return g, core.derivative(g, info.n)
end

-- all that stands beside D1 Ld at the start of a step, to be added to p: forces and reactions
local function beside_of(D, constraints)
  local acting, _, G = D.forces or {}, constraint_of(D.info)
  return function(p, q0, q1, multipliers)
    local rows, F1 = G and G(q0) or {}, acting.push and acting.push(q0, q1)
    for i = 1, F1 and #p or 0 do p[i] = p[i] + F1[i] end
    for c = 1, constraints do
      for i = 1, #p do p[i] = p[i] + rows[c][i] * multipliers[c] end
    end
    for c, E in ipairs(acting.reaction and acting.reaction(q0, q1) or {}) do
      for i = 1, #p do p[i] = p[i] + E[i] * multipliers[constraints + c] end
    end
    return p
  end
end

-- g(q1), then phi(q0, q1)
local function constraints_of(D)
  local g, rolling = constraint_of(D.info), D.forces and D.forces.rolling
  return function(q0, q1)
    local out = g and lists.entries(g(q1)) or {}
    for _, phi in ipairs(rolling and rolling(q0, q1) or {}) do out[#out + 1] = phi end
    return out
  end
end

-- the unit of each multiplier, a power of 2: that of momenta over what pulls, so that unknowns of L
-- in any units are about as large as coordinates
local function units_of(D, constraints, count)
  local info, acting, units = D.info, D.forces or {}, {}
  if count == 0 then return units end
  local A, p, _, G = info.ambient, info.sample, constraint_of(info)
  local q, v = p.q, p.v
  if A then q, v = A.lift(q, v) end
  local momentum = parameters.unreduced(info):momentum(q, v, p.t):norm()
  local rows = G and G(q) or {}
  local pulls = acting.reaction and acting.reaction(q, q + D.h * core.vector(v)) or {}
  for c = 1, count do
    local row = c <= constraints and rows[c] or core.vector(pulls[c - constraints])
    local unit = momentum / row:norm()
    units[c] = unit > 0 and unit < math.huge and 2.0 ^ math.floor(math.log(unit, 2)) or 1
  end
  return units
end

local function in_units(multipliers, units)
  local out = {}
  for c, unit in ipairs(units) do out[c] = multipliers[c] * unit end
  return out
end

-- what is left of the equations at z = (q1, w, lambda, kappa), in the coordinates (theta, x) of q0
local function equations_of(D, constraints, count, units)
  local info, A = D.info, D.action
  local chart, slope = chart_of(info)
  local add_beside, left_of = beside_of(D, constraints), constraints_of(D)
  local n, inner = info.n, A.inner
  return function(z, x, y)
    local at = model.embed(info, x)
    local q0, q1 = chart(at), lists.part(z, 0, n)
    local D1 = A.slope(q0, q1, inner > 0 and lists.part(z, n, inner) or nil)
    local p = {}
    for i = 1, n do p[i] = D1[i] end
    add_beside(p, q0, q1, in_units(lists.part(z, n + inner, count), units))
    local out = pulled_back(slope and slope(at), p, 0, n)
    for a, i in ipairs(info.cyclic) do out[i] = out[i] + info.mu[a] end
    for j, i in ipairs(info.shape) do out[i] = out[i] + y[j] end
    for i = 1, inner do out[n + i] = D1[2 * n + i] end
    for c, left in ipairs(left_of(q0, q1)) do out[n + inner + c] = left end
    return out
  end
end

-- at rest, as the step of Ld begins
local function start_of(D, count)
  local info, A = D.info, D.action
  local chart = chart_of(info)
  return function(x)
    local q = chart(model.embed(info, x))
    local out = lists.entries(q)
    for _, w in ipairs(A.start(q, q)) do out[#out + 1] = w end
    for _ = 1, count do out[#out + 1] = 0 end
    return out
  end
end

---- psi and x1 ----

local TURNS = 8 -- angles that are tried around the circle, of each coordinate of the group

-- theta for which the group moves the shape x nearest to q, of some; so that of several charts of
-- one point, as r and -r, the one near x is found
local function nearest(info, chart, q, x)
  local theta, best = lists.zeros(info.m), nil
  local function distance()
    local gap = chart(model.embed(info, x, theta)) - q
    return gap:dot(gap)
  end
  best = distance()
  for a = 1, info.m do
    local found = theta[a]
    for k = 1, TURNS - 1 do
      theta[a] = 2 * math.pi * (k > TURNS / 2 and k - TURNS or k) / TURNS
      local now = distance()
      found = core.where(best - now, theta[a], found)
      best = core.where(best - now, now, best)
    end
    theta[a] = found
  end
  return theta
end

-- (q, x) -> (theta, shape) of q, near the shape x
local function inverse_of(info)
  local chart, slope = chart_of(info)
  if not slope then return identity end
  return core.root { name = "the shape of q1", unknowns = info.n,
    failure = "does the orbit of this point meet the section?",
    start = function(q, x) return model.embed(info, x, nearest(info, chart, q, x)) end,
    equations = function(z, q) return chart(z) - q end }
end

---- the step ----

local function make(D)
  local info, A = D.info, D.action
  local n, d = info.n, info.d
  local constraints = D.constraint and D.shape:structure().constraints or 0
  local push, count = D.forces and D.forces.push, constraints + (D.forces and D.forces.rolls or 0)
  local units = units_of(D, constraints, count)
  local root = core.root { name = "the next point", unknowns = n + A.inner + count,
    failure = "is the step too long for this momentum?",
    start = start_of(D, count), equations = equations_of(D, constraints, count, units) }
  local inverse, chart, slope = inverse_of(info), chart_of(info)
  local function step(x, y, near)
    local z = root(x, y)
    local q1, w = lists.part(z, 0, n), A.inner > 0 and lists.part(z, n, A.inner) or nil
    local there = inverse(q1, near)
    local q0, out = chart(model.embed(info, x)), {}
    local p1, F2 = lists.part(A.slope(q0, q1, w), n, n), nil
    if push then F2 = select(2, push(q0, q1)) end
    local p = pulled_back(slope and slope(there), F2 and p1 + F2 or p1, 0, n)
    for j, i in ipairs(info.shape) do out[j], out[d + j] = there[i], p[i] end
    for c = 1, count do out[2 * d + c] = z[n + A.inner + c] * units[c] end
    for _, i in ipairs(info.cyclic) do out[#out + 1] = there[i] end
    return core.vector(out)
  end
  return core.trace(step, d, d, d), 2 * d + count
end

--- The step of D, a function (x0, y0, near) -> x1, y1, impulses, psi, as one vector, and how many
-- entries are before psi. Where a point of Q has several shapes, x1 is the one that is near.
function M.of(D)
  if not rawget(D, "next_step") then D.next_step, D.before_psi = make(D) end
  return D.next_step, D.before_psi
end

return M
