--- Q as a product with the group as a factor: points as { x, g }, x the coordinates of the other
-- factors one after the other; momenta as p of these and mu, the body momentum of the group.
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

-- factors of Q: Q itself where it is no direct product
local function factors_of(Q) return kits.of(Q).parts and Q.parts or { Q } end

-- which factor is the group: of equal ones the first, or number `wanted`
local function find(Q, group, wanted, where)
  local kit, found = kits.of(group), nil
  for k, part in ipairs(factors_of(Q)) do
    if kits.of(part) == kit and (wanted == k or wanted == nil and not found) then found = k end
  end
  if not found then
    option.fail(where, "%s has no factor %s%s: Q must be a product with the group as a factor, "
      .. "such "
      .. "as dm.product(dm.R(1), %s)", tostring(Q), tostring(group),
      wanted and " at place " .. wanted or "", tostring(group))
  end
  return found
end

-- the other factors must have coordinates
local function check_base(part, where)
  local kit = kits.of(part)
  if kit.manifold or not (kit.abelian or kit.euclidean) or not kit.vectors then
    option.fail(where, "the shapes are vectors, so the other factors of Q must be dm.R(n), "
      .. "dm.T(n) or dm.SO(2), not %s: take a chart of it", tostring(part))
  end
end

--- How Q splits: { Q, group, kit, factor, d (of the base), r (of the group), shape and body (lists
-- of places in velocities and momenta), factors, rest (those of the base), base (nil: none) }.
function M.of(Q, group, wanted, where)
  local k, first = find(Q, group, wanted, where), 0
  local out = { Q = Q, group = group, kit = kits.of(group), factor = k, shape = {}, body = {},
    factors = factors_of(Q), rest = {}, single = kits.of(Q).parts == nil }
  for i, part in ipairs(out.factors) do
    if i ~= k then
      check_base(part, where)
      out.rest[#out.rest + 1] = part
    end
    local places = i == k and out.body or out.shape
    for j = 1, part.dimension do places[#places + 1] = first + j end
    first = first + part.dimension
  end
  out.base = #out.rest > 1 and core.product(table.unpack(out.rest)) or out.rest[1]
  out.d, out.r, out.D = #out.shape, #out.body, first
  return out
end

--- The element of Q at x, g.
function M.element(S, x, g)
  if S.single then return g end
  local out, first = {}, 0
  for i, part in ipairs(S.factors) do
    if i == S.factor then
      out[i] = g
    else
      out[i] = kits.of(part).unflat(lists.entries(lists.part(x, first, part.dimension)))
      first = first + part.dimension
    end
  end
  return out
end

--- x and g of an element of Q.
function M.split(S, q)
  if S.single then return core.vector {}, q end
  local x = {}
  for i, part in ipairs(S.factors) do
    if i ~= S.factor then
      for _, value in ipairs(lists.entries(kits.of(part).flat(q[i]))) do x[#x + 1] = value end
    end
  end
  return core.vector(x), q[S.factor]
end

--- Entries of a velocity or momentum of Q that belong to the shape, and to the group.
function M.parts(S, v)
  local x, mu = {}, {}
  for k, i in ipairs(S.shape) do x[k] = v[i] end
  for k, i in ipairs(S.body) do mu[k] = v[i] end
  return core.vector(x), core.vector(mu)
end

--- Both together again.
function M.joined(S, x, mu)
  local out = {}
  for k, i in ipairs(S.shape) do out[i] = x[k] end
  for k, i in ipairs(S.body) do out[i] = mu[k] end
  return core.vector(out)
end

--- q of an element with the identity in the place of g.
function M.at_identity(S, q)
  if S.single then return S.kit.identity() end
  local out = { table.unpack(q) }
  out[S.factor] = S.kit.identity()
  return out
end

return M
