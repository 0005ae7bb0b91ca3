--- What constraints push with, as far as it may be narrow: a constraint whose second derivative
-- along the motion is D and whose gradient by q is G pushes with about G D / (G . G/m), were it
-- alone, m the diagonal of the masses; a rolling one with its first derivative and its gradient by
-- v. What is polynomial has nothing narrow.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"
local polynomial = require "dm.reference.polynomial"

local M = {}

local function vector_of(f)
  return function(...) return core.vector(lists.entries(f(...))) end
end

-- J (q, v, t), of which rates are (v, 0, 1): the derivative along a motion without forces
local function along(J, v, n)
  local out = {}
  for r = 1, J.rows do
    out[r] = J[r][J.columns]
    for i = 1, n do out[r] = out[r] + J[r][i] * v[i] end
  end
  return out
end

-- columns first + 1 .. first + n of J
local function block(J, first, n)
  local out = {}
  for r = 1, J.rows do
    out[r] = {}
    for i = 1, n do out[r][i] = J[r][first + i] end
  end
  return out
end

-- gradients by q, D of constraints, as a function of (q, v, t)
local function of_positions(g, n)
  local G = core.derivative(vector_of(g), n, "number")
  local rates = core.derivative(core.trace(function(q, v, t)
    return core.vector(along(G(q, t), v, n))
  end, n, n, "number"), n, n, "number")
  return function(q, v, t) return block(G(q, t), 0, n), along(rates(q, v, t), v, n) end
end

-- gradients by v, D of rolling ones
local function of_rates(phi, n)
  local J = core.derivative(vector_of(phi), n, n, "number")
  return function(q, v, t)
    local here = J(q, v, t)
    return block(here, n, n), along(here, v, n)
  end
end

-- the diagonal of L_vv as a function of (q, v, t)
local function masses(L, n)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local second = core.derivative(core.trace(function(q, v, t) return slope(q, v, t) end, n, n,
    "number"), n, n, "number")
  return function(q, v, t)
    local H, out = second(q, v, t), {}
    for i = 1, n do out[i] = H[n + i][n + i] end
    return out
  end
end

-- G D / (G . G/m), row after row
local function pushes(G, D, m)
  local out = {}
  for r, row in ipairs(G) do
    local size = 0
    for i, x in ipairs(row) do size = size + x * x / m[i] end
    for _, x in ipairs(row) do out[#out + 1] = x * D[r] / size end
  end
  return out
end

-- is nothing narrow in gradients and derivatives?
local function is_smooth(f, n)
  return polynomial.is(core.trace(function(q, v, t)
    local G, D = f(q, v, t)
    for _, row in ipairs(G) do table.move(row, 1, n, #D + 1, D) end
    return core.vector(D)
  end, n, n, "number"))
end

--- A function (q, v, t) -> list of what constraints and rolling ones of a system on R^n push with;
-- nil where nothing of it may be narrow.
function M.of(given, n, L)
  local all, m = {}, nil
  local function add(f, make)
    local pushing = f and make(bound(f, given.params), n)
    if pushing and not is_smooth(pushing, n) then all[#all + 1] = pushing end
  end
  add(given.constraint, of_positions)
  add(given.rolling, of_rates)
  if #all == 0 then return nil end
  return function(q, v, t)
    m = m or masses(L, n)
    local out, here = {}, m(q, v, t)
    for _, f in ipairs(all) do
      local G, D = f(q, v, t)
      local list = pushes(G, D, here)
      table.move(list, 1, #list, #out + 1, out)
    end
    return out
  end
end

return M
