--- The changes (u, dv) and (u, dp) of a state that constraints allow: those that leave g, G v + g_t
-- and phi as they are. On a group u is g^-1 dg.
local core = require "dm.core"
local lists = require "dm.base.lists"
local multipliers = require "dm.measure.multipliers"

local M = {}

local function dot(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i] * b[i] end
  return sum
end

-- x less its part along the unit vectors e, twice for round-off
local function without(x, e)
  x = core.vector(x)
  for _ = 1, 2 do
    for _, y in ipairs(e) do x = x - y * dot(x, y) end
  end
  return x
end

local DEPENDENT = 1e-10  -- of a row: what is left of one that depends on those before it

-- orthonormal vectors that span the rows
local function span(rows)
  local out = {}
  for _, row in ipairs(rows) do
    local left, size = without(row, out), core.vector(row):norm()
    if left:norm() > DEPENDENT * size then out[#out + 1] = left * (1 / left:norm()) end
  end
  return out
end

--- Rows that a change (u, dv) must be orthogonal to, at (q, v, t); none without constraints.
function M.of_velocity(system, q, v, t)
  local given = system.given
  if not (given.constraint or given.rolling) then return {} end
  return multipliers.conditions(system)(q, v, t)
end

--- The same of (u, dp) with dp = P u + M dv.
function M.of_momentum(system, q, v, t, P, mass)
  local rows, n = M.of_velocity(system, q, v, t), #v
  for i, row in ipairs(rows) do
    local of_p = mass:transpose():solve(lists.part(row, n, n))
    rows[i] = lists.joined(lists.part(row, 0, n) - P:transpose() * of_p, of_p)
  end
  return rows
end

--- x -> the change nearest to x that these rows leave, a list.
function M.projection(rows)
  local e = span(rows)
  if #e == 0 then return function(x) return x end end
  return function(x) return without(x, e):totable() end
end

--- (q, t) -> (w -> w followed by what lengths and volumes of it are taken of): of w = (u, dp) the
-- part D (u, P dp), D = diag(weights), P dp what G^T leaves of dp in these weights. On the surface
-- g = 0 the two-form sees no more of dp, so that these volumes are those of Liouville, which a
-- symplectic step keeps.
function M.measured(system, weights)
  local n, slope = #weights // 2, multipliers.slope(system)
  local function scaled(row, first)
    local out = {}
    for i = 1, n do out[i] = row[i] * weights[first + i] end
    return out
  end
  return function(q, t)
    local rows = slope and slope(q, t) or {}
    for c, row in ipairs(rows) do rows[c] = scaled(row, n) end
    local e = span(rows)
    return function(w)
      local dp = scaled(lists.part(w, n, n), n)
      if #e > 0 then dp = without(dp, e) end
      return lists.joined(w, scaled(w, 0), dp):totable()
    end
  end
end

--- Orthonormal changes of 2 n entries that span all that these rows leave.
function M.basis(rows, n)
  local e, out = span(rows), {}
  local first = #e
  for i = 1, 2 * n do
    local unit = core.zeros(2 * n)
    unit[i] = 1
    local left = without(unit, e)
    if left:norm() > 1e-6 and #e < 2 * n then
      e[#e + 1] = left * (1 / left:norm())
      out[#out + 1] = e[#e]
    end
  end
  assert(#out == 2 * n - first)
  return out
end

return M
