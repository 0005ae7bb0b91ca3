--- Reduced systems on groups: dm.euler_poincare makes the system on G whose Lagrangian does not see
-- g but by quantities that are carried along, a = g^-1 a0. Its runs start at the identity, so that
-- a step of lie(s) is the one of the reduced equations, mu1(f_(k-1)) = mu0(f_k) with f_k =
-- g_k^-1 g_(k+1) (Leok 5.4).
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.euler_poincare"
local abs, max = math.abs, math.max

---- invariance of a system that is given ----

local POINTS, SLACK = 5, 1e-10

local function list(x) return "(" .. table.concat(core.vector(x):totable(), ", ") .. ")" end

-- L at random elements must be that at the identity
local function check_invariance(system, L)
  local kit, stream = system.place.kit, core.random(17)
  local d, e = kit.dimension, kit.identity()
  for i = 1, POINTS do
    local x = kits.normals(stream, i, d, 0.5)
    local xi = kits.normals(stream, i + 100, d, 1)
    local there, here = L(kit.exp(x), xi, 0), L(e, xi, 0)
    if not (abs(there - here) <= SLACK * max(1, abs(here))) then
      error(("%s: L is not invariant: at g = exp%s, xi = %s it is %.10g, at the identity %.10g")
        :format(WHERE, list(x), list(xi), there, here), 0)
    end
  end
end

local function of_system(system)
  local own, given = system.place, system.given
  if not own then
    error(WHERE .. ": a system on a group is needed, such as dm.system { Q = dm.SO(3), L = ... }",
      0)
  end
  if own.right then error(WHERE .. ": for the left trivialization", 0) end
  if not given.L or given.constraint or given.rolling or given.force then
    error(WHERE .. ": for a Lagrangian without constraints and forces", 0)
  end
  local params = given.params
  local function L(g, xi, t) return given.L(g, xi, t, params) end
  check_invariance(system, L)
  local e = own.kit.identity()
  return { group = system.Q, name = system.name, l = function(xi) return L(e, xi, 0) end }
end

---- the system ----

-- how g moves a quantity, a dm.action or a function of (g, a); and a quantity of its dimension
local function carrier(options)
  local advected, a = options.advected, options.a and core.vector(options.a)
  if advected == nil then return end
  local meta = type(advected) == "table" and getmetatable(advected)
  if meta and meta.__name == "dm.action" then
    return function(g, x) return advected(g, x) end, a or core.zeros(advected.dimension)
  end
  if type(advected) == "function" and a then return advected, a end
  error(WHERE .. ": option 'advected' must be a dm.action, or a function of (g, a), linear in a, "
    .. "with a = some such quantity", 0)
end

local function system_of(options)
  local l, group = options.l, options.group
  if type(l) ~= "function" then
    error(WHERE .. ": option 'l' must be a function of (xi [, a])", 0)
  end
  local kit = kits.of(group)
  local carry, some = carrier(options)
  local reduced = { a = some, takes_a = carry ~= nil }
  local function L(g, xi)
    if not carry then return l(xi) end
    if not reduced.a then
      error(WHERE .. ": a run needs the advected quantity at its start, a =", 0)
    end
    return l(xi, carry(kit.inverse(g), reduced.a))
  end
  reduced.usual = options.a and some
  local system = core.system { Q = group, L = L, name = options.name }
  system.place.reduced = reduced
  return system
end

M.euler_poincare = blame.caller(function(options)
  if kits.class_of(options) == "dm.system" then return system_of(of_system(options)) end
  option.check(options, { "group", "l", "advected", "a", "name" }, WHERE,
    "{ group =, l = } or a system on a group")
  if kits.class_of(options.group) ~= "dm.space" or kits.of(options.group).manifold then
    error(WHERE .. ": option 'group' must be a group, such as dm.SO(3)", 0)
  end
  return system_of(options)
end)

core.docs[M.euler_poincare] = [[
dm.euler_poincare{group=, l=, advected=, a=, name=} -> dm.system   or   (system) -> dm.system
The reduced system of a Lagrangian l(xi) of the body velocity on a group, or l(xi, a) with a
quantity a = g^-1 a0 that is carried along by the linear action `advected` (a dm.action or a
function of (g, a)), as gravity in a heavy top. Or that of a system on a group whose L does not
depend on g; raises at the first point where it does. Runs take p or v (and a, the quantity at the
start) and begin at the identity; path.p is the body momentum, also path.mu, which moves on a
coadjoint orbit; path:reconstruct{q = g0} is the path on the group that begins at g0. lie(s) steps
mu1(f_(k-1)) = mu0(f_k) (Leok 5.4).]]

return M
