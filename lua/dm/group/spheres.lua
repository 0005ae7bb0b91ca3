--- Spheres among the factors of a product of groups: vectors of R(n + 1) with the constraint
-- x . x = 1, which lie(s) keeps.
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"

local M = {}

local function joined(out, more)
  for _, x in ipairs(lists.entries(more)) do out[#out + 1] = x end
  return out
end

-- the same product with R(n + 1) for S(n); the places of these in its elements, as lists of indices
local function without_spheres(space, found, at)
  if not space.parts then
    if not kits.of(space).manifold then return space end
    found[#found + 1] = at
    return core.R(space.n + 1)
  end
  local parts = {}
  for k, part in ipairs(space.parts) do
    local there = table.move(at, 1, #at, 1, {})
    there[#there + 1] = k
    parts[k] = without_spheres(part, found, there)
  end
  return core.product(table.unpack(parts))
end

-- the constraint, behind x . x - 1 of every sphere
local function with_spheres(constraint, found)
  return function(q, ...)
    local out = {}
    for _, at in ipairs(found) do
      local x = q
      for _, k in ipairs(at) do x = x[k] end
      out[#out + 1] = x:dot(x) - 1
    end
    return constraint and joined(out, constraint(q, ...)) or out
  end
end

--- The options of a system in a copy, without spheres.
function M.unfold(options)
  local out, found = {}, {}
  for key, value in pairs(options) do out[key] = value end
  if not options.Q.parts or not kits.of(options.Q).manifold then return out end
  out.Q = without_spheres(options.Q, found, {})
  out.constraint = with_spheres(options.constraint, found)
  return out
end

return M
