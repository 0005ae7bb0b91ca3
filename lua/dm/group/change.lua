--- What a step g0 tau(xi) adds to the coordinates of g0 and to mu, without a difference of numbers
-- that are nearly equal: a run sums it to twice the digits (numbers/compensated.h), so that far
-- from the origin a spatial momentum such as m + x times p keeps its own.
--
-- Products are at most quadratic in the coordinates of either factor, and a quadratic f has
-- f(e + d) - f(e) = Df(e + d/2) d. The momentum: maps tau with g tau(xi) g^-1 = tau(Ad_g xi) have
-- Ad_tau(xi) - 1 = dtau_R(xi) ad_xi, by the derivative of that at g = 1.
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"

local M = {}

local list_of = kits.list_of

local MOST = 24  -- dimensions; bodies in numbers go by entries (src/integ/lie/lie_joints.h)

-- of flat coordinates that are no product (group/flat.lua)
local function simple(place, right)
  local e = place.flat(place.kit.identity())
  local N = #e
  local slope = core.derivative(function(a, b)
    return core.vector(place.carry(list_of(a), list_of(b)))
  end, N, N)
  local first = right and 0 or N
  return function(q0, d)
    local half, out = {}, {}
    for i = 1, N do half[i] = e[i] + 0.5 * d[i] end
    local a, b = core.vector(q0), core.vector(half)
    if right then a, b = b, a end
    local J = slope(a, b)
    for i = 1, N do
      out[i] = 0
      for j = 1, N do out[i] = out[i] + J[i][first + j] * d[j] end
    end
    return out
  end
end

-- are products quadratic? Told by two random elements
local function is_quadratic(place, right, moved)
  local kit, stream = place.kit, core.random(97)
  local a, b = place.flat(kit.sample(stream, 1)), place.flat(kit.sample(stream, 2))
  local out = right and place.carry(b, a) or place.carry(a, b)
  local gain = moved(a, place.apart(b))
  for i = 1, #a do
    local gap = math.abs(out[i] - a[i] - gain[i])
    if not (gap <= 1e-9 * (1 + math.abs(out[i]))) then return false end
  end
  return true
end

-- coordinates of g0 f less those of g0 (right: of f g0) as a function of those of g0 and of those
-- of f less those of the identity; nothing where products are not quadratic
local function moved_of(place, right)
  if not place.parts then
    local moved = simple(place, right)
    return is_quadratic(place, right, moved) and moved or nil
  end
  local each = {}
  for k, part in ipairs(place.parts) do
    each[k] = moved_of(part, right)
    if not each[k] then return end
  end
  return function(q0, d)
    local out, first = {}, 0
    for k, n in ipairs(place.counts) do
      local gain = each[k](lists.part(q0, first, n), lists.part(d, first, n))
      for i = 1, n do out[first + i] = gain[i] end
      first = first + n
    end
    return out
  end
end

-- ad(xi)* dtau_R(xi)* mu, of a map with the differential `slope`
local function carried_of(kit, slope)
  local D = kit.dimension
  local pulled = core.derivative(function(xi, rate, mu)
    return core.vector(slope(xi, rate)):dot(mu)
  end, D, D, D)
  return function(xi, mu)
    return kit.coad(xi, lists.part(pulled(xi, core.zeros(D), mu), D, D))
  end
end

-- is that Ad_tau(xi)* mu - mu? Not for a map that knows one basis from another
local function is_equivariant(kit, element, carried)
  local stream = core.random(98)
  local xi = kits.normals(stream, 1, kit.dimension, 0.3)
  local mu = kits.normals(stream, 2, kit.dimension, 1)
  local gap = kit.coAd(kit.inverse(element(xi)), mu) - mu - carried(xi, mu)
  return gap:norm() <= 1e-9 * (1 + mu:norm())
end

--- change(q0, xi, mu) of a place and its map tau on coordinates, with the differential `slope`, tau
-- on elements and the squares of angles `arcs`: what g0 tau(xi) and mu carried there are more than
-- g0 and mu, then these squares. Nothing where products are not quadratic, where tau is not
-- equivariant, and of very many dimensions.
function M.of(place, map, slope, element, arcs)
  local kit = place.kit
  local moved = kit.dimension <= MOST and moved_of(place, place.right)
  if not moved then return end
  local carried = carried_of(kit, slope)
  if not is_equivariant(kit, element, carried) then return end
  return function(q0, xi, mu)
    local out = moved(q0, place.apart(map(xi)))
    for i, x in ipairs(place.mend(list_of(q0))) do out[i] = out[i] + x end
    for _, x in ipairs(list_of(carried(place.right and -xi or xi, mu))) do out[#out + 1] = x end
    for _, x in ipairs(arcs and arcs(xi) or {}) do out[#out + 1] = x end
    return out
  end
end

return M
