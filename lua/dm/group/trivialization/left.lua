--- A system in the right trivialization as one in the left: xi = Ad_g of the body velocity, and
-- covectors by the coadjoint action: the same motion. Steps are those of mirror.lua.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local function body(kit, g, f) return kit.coAd(kit.inverse(g), core.vector(f)) end

--- That system.
function M.system(system)
  local given, kit, out = system.given, system.place.kit, { Q = system.Q }
  local function own(key) return bound(given[key], given.params) end
  for _, key in ipairs { "L", "rolling", "control" } do
    local f = own(key)
    out[key] = f and function(g, xi, t) return f(g, kit.Ad(g, xi), t) end
  end
  out.constraint = own "constraint"
  local H, force, reaction = own "H", own "force", own "reaction"
  out.H = not out.L and function(g, mu, t) return H(g, kit.coAd(g, mu), t) end or nil
  out.force = force and function(g, xi, t, ...)
    return body(kit, g, force(g, kit.Ad(g, xi), t, ...))
  end
  out.reaction = reaction and function(g, xi, t)
    local rows = {}
    for i, row in ipairs(lists.entries(reaction(g, kit.Ad(g, xi), t))) do
      rows[i] = body(kit, g, row)
    end
    return rows
  end
  return core.system(out)
end

--- xi at g, or mu of a system with only H, as it is in the left trivialization.
function M.moved(system, g, x)
  local kit = system.place.kit
  if system.given.L then return core.vector(kit.Ad(kit.inverse(g), x)) end
  return core.vector(body(kit, g, x))
end

return M
