--- Flat coordinates of elements as a run keeps them: their products and maps from the algebra
-- without a branch, so that they go on smoothly where `kit.flat` of an element would choose a sign.
-- Where multiples of them stand for an element too, as those of a quaternion do, or where they have
-- no relation, they are homogeneous (src/mech/group_homogeneous.c):
--   scale(list)            what to divide each of them by, 1 on the group; with `scales` of them
--   velocity(list, rates)  g^-1 g' of coordinates on the group, then the rates of log(scale)
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"

local M = {}

local function nothing(list)
  local out = {}
  for i = 1, #list do out[i] = 0 end
  return out
end

-- products and maps of entries, or of whatever flat coordinates have no choice in them
local function plain(kit, flat, unflat)
  return { flat = flat, element = unflat,
    turn = kit.euclidean and function(a, x) return linear.unit(kit.dimension, a) * x end,
    turned = kit.euclidean and function(_, _, mu) return nothing(mu) end,
    carry = function(a, b) return flat(kit.compose(unflat(a), unflat(b))) end,
    exp = function(xi) return flat(kit.exp(xi)) end,
    near = function(xi) return flat(kit.near(xi)) end,
    cayley = kit.cayley and function(xi) return flat(kit.cayley(xi)) end }
end

local function cut(list, first, n)
  local out = {}
  for i = 1, n do out[i] = list[first + i] end
  return out
end

local function append(out, list)
  for i = 1, #list do out[#out + 1] = list[i] end
  return out
end

-- d(coordinates of q near(e))/de at e = 0, N x d, as a function of q; right: of near(e) q
local function directions(place, N, d, right)
  local moved = core.derivative(function(q, e)
    if right then return core.vector(place.carry(place.near(e), q)) end
    return core.vector(place.carry(q, place.near(e)))
  end, N, d)
  return function(q)
    local J = moved(core.vector(q), core.zeros(d))
    return linear.fill(N, d, function(i, a) return J[i][N + a] end)
  end
end

local function ones(list)
  local out = {}
  for i = 1, #list do out[i] = 1 end
  return out
end

-- of coordinates without a relation: those of v in the directions of the algebra
local function without_relation(place, N)
  local X
  local function velocity(q, v)
    X = X or directions(place, N, N)
    local at = X(q)
    local across = at:transpose()
    return kits.list_of((across * at):solve(across * core.vector(v)))
  end
  return ones, velocity, 0
end

-- turns about the axes of the algebra one after the other: of their factor alone
local function turns_of(parts, counts, dimensions)
  for _, part in ipairs(parts) do
    if not part.turn then return end
  end
  local function turn(a, x, q, right)
    local out, first = {}, 0
    for k, part in ipairs(parts) do
      local own, here = cut(q, first, counts[k]), a >= 1 and a <= dimensions[k]
      append(out, here and part.turn(a, x, own, right) or nothing(own))
      a, first = a - dimensions[k], first + counts[k]
    end
    return out
  end
  local function turned(a, x, mu)
    local out, first = {}, 0
    for k, part in ipairs(parts) do
      local own, here = core.vector(cut(mu, first, dimensions[k])), a - first
      local turns = here >= 1 and here <= dimensions[k]
      append(out, turns and part.turned(here, x, own) or nothing(own))
      first = first + dimensions[k]
    end
    return out
  end
  return turn, turned
end

-- velocities factor by factor, behind them the rates of all scales
local function homogeneous_product(parts, counts, dimensions)
  local scales = 0
  for _, part in ipairs(parts) do
    if not part.velocity then return end
    scales = scales + part.scales
  end
  local function scale(list)
    local out, first = {}, 0
    for k, part in ipairs(parts) do
      append(out, part.scale(cut(list, first, counts[k])))
      first = first + counts[k]
    end
    return out
  end
  local function velocity(list, rates)
    local out, behind, first = {}, {}, 0
    for k, part in ipairs(parts) do
      local own = part.velocity(cut(list, first, counts[k]), cut(rates, first, counts[k]))
      append(out, cut(own, 0, dimensions[k]))
      append(behind, cut(own, dimensions[k], part.scales))
      first = first + counts[k]
    end
    return append(out, behind)
  end
  return scale, velocity, scales
end

-- factor by factor
local function product(kit, matrix)
  local parts, counts, dimensions, cayley = {}, {}, {}, true
  for k, part in ipairs(kit.parts) do
    parts[k] = M.of(part, matrix)
    counts[k] = #parts[k].flat(part.identity())
  end
  -- f of each factor, whose arguments are cut to pieces of `sizes`
  local function by_factor(name, sizes)
    return function(...)
      local out, first, given = {}, 0, { ... }
      for k, part in ipairs(parts) do
        local arguments = {}
        for i, x in ipairs(given) do arguments[i] = cut(x, first, sizes[k]) end
        if sizes == dimensions then arguments[1] = core.vector(arguments[1]) end
        append(out, part[name](table.unpack(arguments)))
        first = first + sizes[k]
      end
      return out
    end
  end
  for k, part in ipairs(kit.parts) do
    dimensions[k], cayley = part.dimension, cayley and parts[k].cayley
  end
  local turn, turned = turns_of(parts, counts, dimensions)
  local scale, velocity, scales = homogeneous_product(parts, counts, dimensions)
  local jumps = false
  for _, part in ipairs(parts) do jumps = jumps or part.jumps end
  return { parts = parts, scale = scale, velocity = velocity, scales = scales, jumps = jumps,
    counts = counts, turn = turn, turned = turned,
    carry = by_factor("carry", counts),
    exp = by_factor("exp", dimensions),
    near = by_factor("near", dimensions), cayley = cayley and by_factor("cayley", dimensions),
    tidy = by_factor("tidy", counts), mend = by_factor("mend", counts),
    apart = by_factor("apart", counts), follow = by_factor("follow", counts),
    flat = function(g)
      local out = {}
      for k, part in ipairs(parts) do append(out, part.flat(g[k])) end
      return out
    end,
    element = function(list)
      local out, first = {}, 0
      for k, part in ipairs(parts) do
        out[k] = part.element(cut(list, first, counts[k]))
        first = first + counts[k]
      end
      return out
    end }
end

-- coordinates of an element near the identity less those of the identity
local function difference(kit, flat)
  local e = flat(kit.identity())
  return function(list)
    local out = {}
    for i = 1, #e do out[i] = list[i] - e[i] end
    return out
  end
end

--- What a place is made of (group/place.lua), of a kit: `kit.smooth` where it has closed forms, or
-- by entries where `matrix` is asked for. Where they are known for angles of any
-- size, turn(a, x, q, right) is what q exp(x e_a) (right: exp(x e_a) q) has more than q, and
-- turned(a, x, mu) what mu carried there has more than mu, both without a difference of numbers
-- that are nearly equal. jumps: may the
-- coordinates of an element by itself have another sign than those of a run?
function M.of(kit, matrix)
  local out
  if kit.parts then
    out = product(kit, matrix)
  elseif matrix then
    out = plain(kit, kit.entries, kit.rebuild)
  else
    out = plain(kit, kit.flat, kit.unflat)
    for name, f in pairs(kit.smooth or {}) do out[name] = f end
  end
  out.kit = kit
  local N = #out.flat(kit.identity())
  if not out.velocity and not kit.parts and N == kit.dimension then
    out.scale, out.velocity, out.scales = without_relation(out, N)
  end
  out.jumps = out.jumps or not kit.parts and out.follow ~= nil
  out.follow = out.follow or function(list) return list end
  out.tidy = out.tidy or function(list) return list end
  out.mend = out.mend or nothing
  out.apart = out.apart or difference(kit, out.flat)
  return out
end

M.list_of, M.directions = kits.list_of, directions

return M
