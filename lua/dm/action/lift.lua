--- Prolongations of an action: to tangent and cotangent vectors and to jets of curves. Each is a
-- dm.action whose map is made of exact derivatives of the one that is lifted.
local core = require "dm.core"
local actions = require "dm.action"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local option = require "dm.base.options"
local points = require "dm.action.points"

local M = {}

local function slice(x, first, n)
  local out = {}
  for i = 1, n do out[i] = x[first + i] end
  return core.vector(out)
end

local function append(out, list)
  for i = 1, #list do out[#out + 1] = list[i] end
  return out
end

-- the domain of the base, asked at the point that the longer vector begins with
local function lifted_domain(action)
  if not action.domain then return nil end
  return function(z) return action.domain(slice(z, 0, action.dimension)) end
end

-- a lifted action on `more` numbers beside the point
local function lifted(action, more, map, fields)
  local out = actions.assemble {
    group = action.group, on = core.product(action.on, core.R(more)), map = map, side = action.side,
    domain = lifted_domain(action), name = action.name, base = action,
    generator_by = fields.generator_by }
  out.lift = fields.lift
  out.order, out.independent = fields.order, fields.independent
  return out
end

-- entries of a group element as a vector: arguments of a trace
local function entries(action, g) return core.vector(groups.kit(action.group).entries(g)) end

-- number of these, and (entries of g, z) -> image
local function by_entries(action)
  local kit = groups.kit(action.group)
  return #kit.entries(kit.identity()),
    function(g, z) return points.image(action, kit.rebuild(g), z) end
end

-- dm.function of (entries of g, z): rows d image_i/d(g, z); and how many columns belong to g
local function slope(action)
  local n, image = by_entries(action)
  return core.derivative(image, n, action.dimension), n
end

---- tangent and cotangent vectors ----

actions.method("tangent", function(action)
  local m, J, n = action.dimension, slope(action)
  return lifted(action, m, function(g, zu)
    local z, u = slice(zu, 0, m), slice(zu, m, m)
    local out, rows = kits.list_of(points.image(action, g, z)), J(entries(action, g), z)
    for i = 1, m do
      local sum = 0
      for k = 1, m do sum = sum + rows[i][n + k] * u[k] end
      out[m + i] = sum
    end
    return core.vector(out)
  end, { lift = "tangent" })
end, [[
action:tangent() -> dm.action
The action on tangent vectors (z, u), 2 dim z numbers: (map(g, z), T map u).]])

-- <p', T map u> = <p, u>: p' = (T map(g^-1, .) at map(g, z))^T p
actions.method("cotangent", function(action)
  local kit = groups.kit(action.group)
  local m, J, n = action.dimension, slope(action)
  return lifted(action, m, function(g, zp)
    local z, p = slice(zp, 0, m), slice(zp, m, m)
    local w = points.image(action, g, z)
    local out, rows = kits.list_of(w), J(entries(action, kit.inverse(g)), w)
    for k = 1, m do
      local sum = 0
      for i = 1, m do sum = sum + rows[i][n + k] * p[i] end
      out[m + k] = sum
    end
    return core.vector(out)
  end, { lift = "cotangent" })
end, [[
action:cotangent() -> dm.action
The cotangent lift on (z, p), 2 dim z numbers: (map(g, z), p') with <p', T map u> = <p, u>, that is
p' = (T map)^-T p, on the side of the action itself; its momentum map is action:momentum.
(Bogfjellmo's lift pulls p back, by T map^T: that of the inverse.)]])

---- jets ----

-- the jet space of curves: `dependent` lists the entries of z that depend on entry `independent`
-- (nil: on an invariant parameter)
local function jet_space(action, order, independent)
  local dependent = {}
  for i = 1, action.dimension do
    if i ~= independent then dependent[#dependent + 1] = i end
  end
  return { m = action.dimension, dependent = dependent, count = #dependent, order = order,
    independent = independent }
end

local function length(space, order) return space.m + order * space.count end

-- total derivative of each coordinate of J^order, found in j of J^(order + 1)
local function rates(space, order, j)
  local out = {}
  if space.independent then out[space.independent] = 1 end
  for c, i in ipairs(space.dependent) do out[i] = j[space.m + c] end
  for k = 1, order * space.count do out[space.m + k] = j[space.m + space.count + k] end
  return out
end

-- D f for the rows of derivatives of f, whose first n columns are not of the jet
local function total(rows, i, n, rate)
  local sum = 0
  for c = 1, #rate do sum = sum + rows[i][n + c] * rate[c] end
  return sum
end

-- functions of (entries of g, jet of order k) for k = 0 .. order: the k-th derivatives of the moved
-- curve, U_(k+1) = D U_k / D X
local function moved_derivatives(action, space)
  local n, image = by_entries(action)
  local clock = space.independent and core.derivative(function(g, z)
    return core.vector { image(g, z)[space.independent] }
  end, n, space.m)
  local levels = { [0] = function(g, j)
    local w, out = image(g, slice(j, 0, space.m)), {}
    for c, i in ipairs(space.dependent) do out[c] = w[i] end
    return core.vector(out)
  end }
  for k = 0, space.order - 1 do
    local J = core.derivative(function(g, j) return levels[k](g, j) end, n, length(space, k))
    levels[k + 1] = function(g, j)
      local rate, inner = rates(space, k, j), slice(j, 0, length(space, k))
      local rows, speed, out = J(g, inner), 1, {}
      if clock then speed = total(clock(g, slice(j, 0, space.m)), 1, n, rates(space, 0, j)) end
      for c = 1, space.count do out[c] = total(rows, c, n, rate) / speed end
      return core.vector(out)
    end
  end
  return levels
end

-- generators by phi_(K+1) = D phi_K - u_(K+1) D xi, which is phi_K = D_K(phi - xi u_x) + xi
-- u_(K,x): functions of the jet of order k that give phi_K of all generators, entry c of generator
-- a at (c - 1) r + a
local function prolonged_generators(action, space)
  local r = action.group.dimension
  local function of_point(entries_of)
    return function(j)
      local rows, out = actions.generator_rows(action, slice(j, 0, space.m)), {}
      for _, i in ipairs(entries_of) do append(out, rows[i]) end
      return core.vector(out)
    end
  end
  local clock = space.independent and core.derivative(of_point { space.independent }, space.m)
  local levels = { [0] = of_point(space.dependent) }
  for k = 0, space.order - 1 do
    local J = core.derivative(function(j) return levels[k](j) end, length(space, k))
    levels[k + 1] = function(j)
      local rate, rows, out = rates(space, k, j), J(slice(j, 0, length(space, k))), {}
      local slow = clock and clock(slice(j, 0, space.m))
      for c = 1, space.count do
        local next_derivative = j[space.m + k * space.count + c]
        for a = 1, r do
          local i = (c - 1) * r + a
          out[i] = total(rows, i, 0, rate)
          if slow then out[i] = out[i] - next_derivative * total(slow, a, 0, rates(space, 0, j)) end
        end
      end
      return core.vector(out)
    end
  end
  return levels
end

local function jet_generator(action, space)
  local levels, r = prolonged_generators(action, space), action.group.dimension
  return function(j)
    local out = actions.generator_rows(action, slice(j, 0, space.m))
    for k = 1, space.order do
      local phi = levels[k](slice(j, 0, length(space, k)))
      for c = 1, space.count do out[#out + 1] = kits.list_of(slice(phi, (c - 1) * r, r)) end
    end
    return out
  end
end

local function check_jet(action, order, options)
  if math.type(order) ~= "integer" or order < 1 or order > 8 then
    error("action:jet(n) takes the order of the derivatives, a whole number from 1 to 8", 0)
  end
  local where, m = "action:jet", action.dimension
  options = option.check(options or {}, { "independent" }, where)
  option.demand(options.independent == nil or m > 1, options, "independent", where,
    "left out, since nothing else depends on the one number of a point")
  return option.whole(options, "independent", where, 1, m)
end

actions.method("jet", function(action, order, options)
  local independent = check_jet(action, order, options)
  local space = jet_space(action, order, independent)
  local levels = moved_derivatives(action, space)
  return lifted(action, order * space.count, function(g, j)
    local out, raw = kits.list_of(points.image(action, g, slice(j, 0, space.m))), entries(action, g)
    for k = 1, order do append(out, levels[k](raw, slice(j, 0, length(space, k)))) end
    return core.vector(out)
  end, { lift = "jet", order = order, independent = independent,
    generator_by = jet_generator(action, space) })
end, [[
action:jet(n [, { independent = i }]) -> dm.action
The action on jets of curves of order n: the point z, then the first, ..., n-th derivatives. With
independent = i the curve is a graph over entry i of z, and the derivatives are of the other entries
by it: U_x = D U / D X. Else the curve has a parameter that the group leaves alone, and all entries
are differentiated by it. Generators by phi_K = D_K(phi - xi u_x) + xi u_(K,x).]])

return M
