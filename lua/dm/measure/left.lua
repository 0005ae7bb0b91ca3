--- A system in the right trivialization as one in the left: xi = Ad_g of the body velocity, and
-- covectors by the coadjoint action. Steps of lie(s) are the same, since exp(xi) g = g exp(Ad_(1/g)
-- xi); those of lifts are not, whose stages are off the group.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local part = lists.part

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

--- A solver that steps it alike.
function M.solver(solver, newton)
  return M.system(solver.system):solver { rule = solver.rule, h = solver.h, newton = newton }
end

--- A state { q, p, t } in the left trivialization.
function M.state(kit, s) return { q = s.q, p = body(kit, s.q, s.p), t = s.t } end

--- The momentum of such a state in the right one.
function M.momentum_right(kit, s) return kit.coAd(s.q, core.vector(s.p)) end

--- A change (u, dp) at a state s of the right trivialization as one of the left: mu = Ad*_g p moves
-- with g, too.
function M.change(kit, s, w)
  local d = kit.dimension
  local u, turned = kit.Ad(kit.inverse(s.q), part(w, 0, d)), part(w, d, d)
  return lists.joined(u, body(kit, s.q, turned) + kit.coad(u, body(kit, s.q, s.p))):totable()
end

--- The inverse of that, at a state s of the left trivialization.
function M.change_right(kit, s, w)
  local d = kit.dimension
  local u, dp = part(w, 0, d), part(w, d, d)
  return lists.joined(kit.Ad(s.q, u), kit.coAd(s.q, dp - kit.coad(u, core.vector(s.p)))):totable()
end

return M
