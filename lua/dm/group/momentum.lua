--- Noether's momenta along a path on a group, from the body momentum of its rows.
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local places = require "dm.group.place"

local M = {}

-- momenta of the standard actions of other groups on this space, by their names
local function standard(kit, name, g, mu)
  if kit.momenta and kit.momenta[name] then return kit.momenta[name](g, mu) end
  if not kit.parts then return end
  local sum, first = nil, 0
  for k, part in ipairs(kit.parts) do
    local own = {}
    for i = 1, part.dimension do own[i] = mu[first + i] end
    local J = standard(part, name, g[k], core.vector(own))
    if J then sum = sum and sum + J or J end
    first = first + part.dimension
  end
  return sum
end

-- of a group K that moves elements by move(k, g): <J, eta> = <mu, u>, where u is the body velocity
-- of move(exp(s eta), g) at s = 0
local function of_action(place, group, move)
  local P, K = places.of(place.space, { columns = "matrix" }), kits.of(group)
  local r, d, N = K.dimension, place.dimension, P.size
  local moved = core.derivative(function(s, q)
    return core.vector(P.flat(place.kit.element(move(K.near(s), P.element(q)))))
  end, r, N)
  local along = core.derivative(function(e, q)
    return core.vector(P.carry(q, P.near(e)))
  end, d, N)
  local function columns(slope, count, q)
    local J = slope(core.zeros(count), q)
    return linear.fill(N, count, function(i, j) return J[i][j] end)
  end
  return function(g, mu)
    local q = core.vector(P.flat(g))
    local X, Z = columns(along, d, q), columns(moved, r, q)
    return Z:transpose() * X * (X:transpose() * X):solve(core.vector(mu))
  end
end

-- an action, on the left or on the right: the identity moves nothing, a b moves as both, one after
-- the other
local function check_action(kit, K, move)
  local stream = core.random(5)
  local function some(k, i) return k.exp(kits.normals(stream, i, k.dimension, 0.3)) end
  local function moved(k, g) return kit.element(move(k, g)) end
  local g, a, b = some(kit, 0), some(K, 1), some(K, 2)
  if not (kit.distance(moved(K.identity(), g), g) <= 1e-12) then
    error("option 'action': the identity must not move an element", 0)
  end
  local both = moved(K.compose(a, b), g)
  local left, right = moved(a, moved(b, g)), moved(b, moved(a, g))
  if not (kit.distance(both, left) <= 1e-9 or kit.distance(both, right) <= 1e-9) then
    error("option 'action': a b must move an element as b and then a do, or as a and then b do", 0)
  end
end

-- the action in the options, where there is one
local function given_action(place, group, options)
  local move = type(options) == "table" and options.action or nil
  if move == nil then return end
  if type(move) ~= "function" or kits.class_of(group) ~= "dm.space" then
    error("option 'action' must be a function of (k, g) that returns the moved element, behind the "
      .. "group that acts", 0)
  end
  local K = kits.of(group)
  check_action(place.kit, K, move)
  return of_action(place, group, move), K.dimension
end

-- J of a row: f(g, mu) with the body momentum mu
local function map_of(place, group, side)
  local kit = place.kit
  if type(group) == "function" then
    local rate = core.one(group, "the generator")
    return function(g, mu)
      local xi = kits.vector(rate(g), kit.dimension, "what the generator returns")
      return core.vector { xi:dot(mu) }
    end, 1
  end
  if group == place.space then
    if side == "right" then return function(_, mu) return mu end, kit.dimension end
    return kit.coAd, kit.dimension
  end
  if kits.class_of(group) ~= "dm.space" then return end
  local name, d = tostring(group), group.dimension
  local e, zero = kit.identity(), core.zeros(kit.dimension)
  if not standard(kit, name, e, zero) then return end
  -- of subgroups on the right: what is spatial at the identity
  if side == "right" then return function(_, mu) return standard(kit, name, e, mu) end, d end
  return function(g, mu) return standard(kit, name, g, mu) end, d
end

-- J and its dimension; raises where there is none, and for options that would change nothing
local function found(place, group, given, known)
  local options = require "dm.base.options".check(given or {}, known or { "side", "action" },
    "momentum", "{ side =, action = }")
  local side = options.side or "left"
  if side ~= "left" and side ~= "right" then
    error(([[option 'side' must be "left" or "right" (got %s)]]):format(tostring(side)), 0)
  end
  local J, d = given_action(place, group, options)
  if options.side and (J or type(group) == "function") then
    error("momentum: 'side' is of groups by their own action; leave it out for an action or a "
      .. "generator of one's own", 0)
  end
  if not J then J, d = map_of(place, group, side) end
  if J then return J, d end
  error(("%s has no standard action on %s: give path:momentum(G, { action = function(k, g) ... "
    .. "end }), or the generator as a function of the element that returns the body velocity of "
    .. "its field")
    :format(tostring(group), tostring(place.space)), 0)
end

--- That of one element g with the body momentum mu, of somebody whose options have a time, too.
function M.at(place, group, options, g, mu)
  return (found(place, group, options, { "side", "action", "t" }))(g, mu)
end

--- Noether's momentum of every row: of the group itself on its left (spatial) or right (body), of
-- rotations and translations of space (right: of the body), of any group by its action on elements,
-- of one generator g -> the body velocity of its field.
function M.momentum(place, path, group, options)
  local J, d = found(place, group, options)
  local rows, q, p = {}, path.q, path.p
  for i = 1, #path do
    local g, mu = q[i], p[i]
    if place.right then mu = place.kit.coAd(place.kit.inverse(g), mu) end
    local value = J(g, mu)
    rows[i] = d == 1 and value[1] or value
  end
  return d == 1 and core.vector(rows) or core.matrix(rows)
end

return M
