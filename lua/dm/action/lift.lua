--- Prolongations of an action: to tangent and cotangent vectors. Each is a dm.action whose map is
-- made of exact derivatives of the one that is lifted; those to jets are in dm.action.jet.
local core = require "dm.core"
local actions = require "dm.action"
local groups = require "dm.group"
local kits = require "dm.group.kit"
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

M.lifted, M.entries, M.by_entries, M.slice, M.append = lifted, entries, by_entries, slice, append

return M
