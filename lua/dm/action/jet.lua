--- The prolongation of an action to jets of curves and of functions of several variables. An order
-- of derivatives follows from the one below by D_(X_i) = sum_l (DX)^-1_(i l) D_l, generators by
-- phi_(K, i) = D_i phi_K - sum_l u_(K, l) D_i xi^l (Olver).
local core = require "dm.core"
local actions = require "dm.action"
local kits = require "dm.group.kit"
local lift = require "dm.action.lift"
local multi_index = require "dm.action.multi_index"
local option = require "dm.base.options"
local points = require "dm.action.points"

local M = {}

local append, slice = lift.append, lift.slice

-- The jet space: `dependent` lists the entries of z that depend on the entries `independent` (none:
-- on one invariant parameter); K has the multi-indices, p variables.
local function jet_space(action, order, independent)
  local dependent, is_independent = {}, {}
  for _, i in ipairs(independent) do is_independent[i] = true end
  for i = 1, action.dimension do
    if not is_independent[i] then dependent[#dependent + 1] = i end
  end
  local p = math.max(1, #independent)
  return { m = action.dimension, dependent = dependent, count = #dependent, order = order, p = p,
    independent = independent, K = multi_index.up_to(p, order + 1) }
end

-- numbers of a jet of that order
local function length(space, order)
  return space.m + (multi_index.count(space.p, order) - 1) * space.count
end

-- how many derivatives of one entry have that order
local function width(space, order) return space.K.first[order + 1] - space.K.first[order] end

-- the place in a jet of derivative number `place` of dependent entry c
local function entry(space, c, place)
  return place == 1 and space.dependent[c] or space.m + (place - 2) * space.count + c
end

-- the total derivative by variable l of each coordinate of J^order, found in j of J^(order + 1)
local function rates(space, order, j, l)
  local out = {}
  for i, k in ipairs(space.independent) do out[k] = i == l and 1 or 0 end
  for place = 1, multi_index.count(space.p, order) do
    for c = 1, space.count do
      out[entry(space, c, place)] = j[entry(space, c, space.K.next[place][l])]
    end
  end
  return out
end

-- D f for row i of derivatives of f, whose first n columns are not of the jet
local function total(rows, i, n, rate)
  local sum = 0
  for c = 1, #rate do sum = sum + rows[i][n + c] * rate[c] end
  return sum
end

-- of every multi-index of that order the variable by which it is made, and the place, counted in
-- the order below, of what it is a derivative of
local function made_from(space, order)
  local out, K = {}, space.K
  for place = K.first[order], K.first[order + 1] - 1 do
    local i, before = table.unpack(K.from[place])
    out[#out + 1] = { i, before - K.first[order - 1] }
  end
  return out
end

---- the moved jet ----

-- (DX)^-1 at a jet of order 1, p x p; a number where p is 1
local function inverse_speed(space, clock, n, g, j)
  local rows, M1 = clock(g, slice(j, 0, space.m)), {}
  for l = 1, space.p do
    local rate = rates(space, 0, j, l)
    M1[l] = {}
    for i = 1, space.p do M1[l][i] = total(rows, i, n, rate) end
  end
  if space.p == 1 then return M1[1][1] end
  return core.matrix(M1):inverse()
end

-- d/dX_i of what has the total derivatives by_l[l]
local function moved_rate(space, speed, by_l, i)
  if space.p == 1 then return by_l[1] / speed end
  local sum = 0
  for l = 1, space.p do sum = sum + speed[i][l] * by_l[l] end
  return sum
end

-- derivatives of the entries that the variables are, by (entries of g, z)
local function clock_of(space, image, n)
  if #space.independent == 0 then return nil end
  return core.derivative(function(g, z)
    local w, out = image(g, z), {}
    for i, k in ipairs(space.independent) do out[i] = w[k] end
    return core.vector(out)
  end, n, space.m)
end

-- functions of (entries of g, jet of order k) for k = 0 .. order: all derivatives of order k of the
-- moved function
local function moved_derivatives(action, space)
  local n, image = lift.by_entries(action)
  local clock = clock_of(space, image, n)
  local levels = { [0] = function(g, j)
    local w, out = image(g, slice(j, 0, space.m)), {}
    for c, i in ipairs(space.dependent) do out[c] = w[i] end
    return core.vector(out)
  end }
  for k = 0, space.order - 1 do
    local J = core.derivative(function(g, j) return levels[k](g, j) end, n, length(space, k))
    local from = made_from(space, k + 1)
    levels[k + 1] = function(g, j)
      local rows, speed, rate, out = J(g, slice(j, 0, length(space, k))), nil, {}, {}
      speed = clock and inverse_speed(space, clock, n, g, j) or 1
      for l = 1, space.p do rate[l] = rates(space, k, j, l) end
      for _, made in ipairs(from) do
        for c = 1, space.count do
          local by_l = {}
          for l = 1, space.p do by_l[l] = total(rows, made[2] * space.count + c, n, rate[l]) end
          out[#out + 1] = moved_rate(space, speed, by_l, made[1])
        end
      end
      return core.vector(out)
    end
  end
  return levels
end

---- generators ----

-- functions of the jet of order k that give phi_K of all generators for all K of order k: generator
-- a of entry number e = (place within the order) count + c at (e - 1) r + a
local function prolonged_generators(action, space)
  local r = action.group.dimension
  local function of_point(entries_of)
    return function(j)
      local rows, out = actions.generator_rows(action, slice(j, 0, space.m)), {}
      for _, i in ipairs(entries_of) do append(out, rows[i]) end
      return core.vector(out)
    end
  end
  local clock = #space.independent > 0 and core.derivative(of_point(space.independent), space.m)
  local levels = { [0] = of_point(space.dependent) }
  for k = 0, space.order - 1 do
    local J = core.derivative(function(j) return levels[k](j) end, length(space, k))
    local from = made_from(space, k + 1)
    -- phi_(K, i), K = derivative number `place` of entry c
    local function next_phi(j, rows, slow, rate, first, made, c, a)
      local i, place = made[1], space.K.first[k] + made[2]
      local sum = total(rows, (made[2] * space.count + c - 1) * r + a, 0, rate[i])
      for l = 1, slow and space.p or 0 do
        sum = sum - j[entry(space, c, space.K.next[place][l])] * total(slow, (l - 1) * r + a, 0,
          first[i])
      end
      return sum
    end
    levels[k + 1] = function(j)
      local rate, first, out = {}, {}, {}
      local rows = J(slice(j, 0, length(space, k)))
      local slow = clock and clock(slice(j, 0, space.m))
      for l = 1, space.p do rate[l], first[l] = rates(space, k, j, l), rates(space, 0, j, l) end
      for e, made in ipairs(from) do
        for c = 1, space.count do
          for a = 1, r do
            out[((e - 1) * space.count + c - 1) * r + a] = next_phi(j, rows, slow, rate, first,
              made, c, a)
          end
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
      for e = 1, width(space, k) * space.count do
        out[#out + 1] = kits.list_of(slice(phi, (e - 1) * r, r))
      end
    end
    return out
  end
end

---- the method ----

local function check_independent(given, m, where)
  if given == nil then return {} end
  local list, seen = type(given) == "table" and given or { given }, {}
  for k = 1, #list do
    local i = math.tointeger(type(list[k]) == "number" and list[k])
    if not i or i < 1 or i > m or seen[i] then
      option.fail(where, "option 'independent' must be an entry of the point, a whole number "
        .. "from 1 "
        .. "to %d, or a list of different ones (got %s)", m, option.got(list[k]))
    end
    seen[i], list[k] = true, i
  end
  if #list == 0 then option.fail(where, "option 'independent' is an empty list") end
  if #list >= m then
    option.fail(where, "option 'independent' must be left out or name fewer entries: nothing else "
      .. "depends on the %d of a point", m)
  end
  return list
end

local MOST = 4000  -- numbers of a jet

local function check_jet(action, order, options)
  if math.type(order) ~= "integer" or order < 1 or order > 8 then
    error("action:jet(n) takes the order of the derivatives, a whole number from 1 to 8", 0)
  end
  local where = "action:jet"
  options = option.check(options or {}, { "independent" }, where)
  local given = options.independent
  if type(given) == "table" then given = { table.unpack(given) } end
  return check_independent(given, action.dimension, where), options.independent
end

actions.method("jet", function(action, order, options)
  local independent, given = check_jet(action, order, options)
  local space = jet_space(action, order, independent)
  if length(space, order) > MOST then
    error(("action:jet: %d numbers of a jet are too many"):format(length(space, order)), 0)
  end
  local levels = moved_derivatives(action, space)
  return lift.lifted(action, length(space, order) - space.m, function(g, j)
    local raw = lift.entries(action, g)
    local out = kits.list_of(points.image(action, g, slice(j, 0, space.m)))
    for k = 1, order do append(out, levels[k](raw, slice(j, 0, length(space, k)))) end
    return core.vector(out)
  end, { lift = "jet", order = order, independent = given,
    generator_by = jet_generator(action, space) })
end, [[
action:jet(n [, { independent = i | { i, j, ... } }]) -> dm.action
The action on jets of order n: the point z, then the first, ..., n-th derivatives. With independent
= i the curve is a graph over entry i of z, and the derivatives are of the other entries by it: U_x
= D U / D X; with a list they are functions of these entries, u(x, t) for {1, 2}, the derivatives of
one order in the order u_xx, u_xt, u_tt, of each all dependent entries. Else the curve has a
parameter that the group leaves alone, and all entries are differentiated by it. Generators by
phi_(K, i) = D_i phi_K - u_(K, l) D_i xi^l.]])

return M
