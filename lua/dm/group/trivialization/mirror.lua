--- A system in the right trivialization as one in the left, by h = 1/g: h^-1 h' = -xi and its
-- momentum -p. Rules of the group step exp(x) g as h exp(-x), stage by stage, so that all of them
-- take the same steps. Changes dg g^-1 and dp only change their signs, which linear maps of them do
-- not see.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

--- That system.
function M.system(system)
  local given, kit, out = system.given, system.place.kit, { Q = system.Q }
  local function own(key) return bound(given[key], given.params) end
  local function seen(key)
    local f = own(key)
    return f and function(h, x, ...) return f(kit.inverse(h), -x, ...) end
  end
  for _, key in ipairs { "L", "rolling", "control" } do out[key] = seen(key) end
  local constraint, force, reaction = own "constraint", seen "force", seen "reaction"
  out.constraint = constraint and function(h, ...) return constraint(kit.inverse(h), ...) end
  out.H = not out.L and seen "H" or nil
  out.force = force and function(...) return -core.vector(force(...)) end
  out.reaction = reaction and function(...)
    local rows = {}
    for i, row in ipairs(lists.entries(reaction(...))) do rows[i] = -core.vector(row) end
    return rows
  end
  return core.system(out)
end

--- A state { q, p, t } of it, or of the system itself where that is one of it.
function M.state(kit, s) return { q = kit.inverse(s.q), p = -core.vector(s.p), t = s.t } end

return M
