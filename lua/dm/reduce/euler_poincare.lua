--- Reduced systems on groups: dm.euler_poincare makes the system on G whose Lagrangian does not see
-- g but by quantities that are carried along, a = g^-1 a0. Its runs start at the identity, so that
-- a step of lie(s) is the one of the reduced equations, mu1(f_(k-1)) = mu0(f_k) with f_k =
-- g_k^-1 g_(k+1) (Leok 5.4).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local linear = require "dm.base.linear"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.euler_poincare"
local abs, max = math.abs, math.max

---- invariance of a system that is given ----

local POINTS, SLACK = 5, 1e-10
local SPREADS, EACH = { 0.5, 3, 20 }, 40  -- of elements, as logarithms; how many of each
local LARGEST = 100  -- entries of g and its inverse

local function list(x) return "(" .. table.concat(core.vector(x):totable(), ", ") .. ")" end

-- element number i of a spread and what it is: exp(x), or far away one axis after the other, as
-- exp(x) of a large turn leads nowhere
local function far_element(kit, stream, i, spread)
  local x = kits.normals(stream, i, kit.dimension, spread)
  if spread < 1 then return kit.exp(x), "exp" .. list(x) end
  local g = kit.identity()
  for a = 1, kit.dimension do
    g = kit.compose(g, kit.exp(linear.unit(kit.dimension, a) * x[a]))
  end
  return g, "exp(x1 e1) exp(x2 e2) ..., x = " .. list(x)
end

-- can L be compared there? Not where its digits are those of large entries
local function is_tame(kit, g)
  local fine, inverse = blame.try(kit.inverse, g)
  return fine and max(kits.norm(kit.entries(g)), kits.norm(kit.entries(inverse))) <= LARGEST
end

-- the usual size of f at the identity, in the units that it has
local function usual_size(kit, f, stream)
  local e, sizes = kit.identity(), {}
  for i = 1, EACH do
    sizes[i] = abs(f(e, kits.normals(stream, 1000 + i + 100, kit.dimension, 1), 0))
  end
  return lists.middle(sizes)
end

-- f(g, x), L or H, at random elements, near and far, must be that at the identity
local function check_invariance(system, f, name)
  local kit, stream = system.place.kit, core.random(17)
  local e, argument = kit.identity(), name == "L" and "xi" or "p"
  local usual = usual_size(kit, f, stream)
  for k, spread in ipairs(SPREADS) do
    for i = 1, EACH do
      local g, text = far_element(kit, stream, 1000 * k + i, spread)
      local y = kits.normals(stream, 1000 * k + i + 100, kit.dimension, 1)
      local here = f(e, y, 0)
      local there = is_tame(kit, g) and f(g, y, 0) or here
      if not (abs(there - here) <= SLACK * max(usual, abs(here))) then
        error(("%s: %s is not invariant: at g = %s, %s = %s it is %.10g, at the identity %.10g (a "
          .. "difference of %.2g)"):format(WHERE, name, text, argument, list(y), there, here,
          there - here), 0)
      end
      if f(e, y, 0.7 * i) ~= here then
        error(("%s: %s depends on t, and a reduced system does not"):format(WHERE, name), 0)
      end
    end
  end
end

local function of_system(system)
  local own, given = system.place, system.given
  if not own then
    error(WHERE .. ": a system on a group is needed, such as dm.system { Q = dm.SO(3), L = ... }",
      0)
  end
  if own.right then
    error(WHERE .. ": xi of this system is the spatial velocity (trivialization = \"right\"), and "
      .. "reduced equations are those of the body: give L as a function of g^-1 g'", 0)
  end
  if given.constraint or given.rolling or given.force then
    error(WHERE .. ": this system has constraints or forces, and reduced equations have none: run "
      .. "the system itself", 0)
  end
  local name = given.H and "H" or "L"
  local f, e = bound(given[name], given.params), own.kit.identity()
  check_invariance(system, f, name)
  return { group = system.Q, name = system.name,
    [name:lower()] = function(x) return f(e, x, 0) end }
end

---- the system ----

-- a quantity of n entries that is carried along
local function quantity(a, n)
  return lists.numbers("field 'a'", a, n, "%s must be %d number%s (got %s)")
end

-- how g moves a quantity, a dm.action or a function of (g, a); and a quantity of its dimension
local function carrier(options)
  local advected, a = options.advected, options.a and lists.vector(options.a, "option 'a'")
  if advected == nil then
    return option.meaningless(options, "a", WHERE, "nothing is carried along without 'advected'")
  end
  local meta = type(advected) == "table" and getmetatable(advected)
  if meta and meta.__name == "dm.action" then
    return function(g, x) return advected(g, x) end, a or core.zeros(advected.dimension)
  end
  if type(advected) == "function" and a then return advected, a end
  error(WHERE .. ": option 'advected' must be a dm.action, or a function of (g, a), linear in a, "
    .. "with a = some such quantity", 0)
end

-- raises where carry is no linear action: at random elements and quantities
local function check_action(kit, carry, n)
  local stream = core.random(19)
  for i = 1, POINTS do
    local g, h = kit.exp(kits.normals(stream, i, kit.dimension, 0.4)),
      kit.exp(kits.normals(stream, i + 100, kit.dimension, 0.4))
    local x, y = kits.normals(stream, i + 200, n, 1), kits.normals(stream, i + 300, n, 1)
    local function image(k, z)
      return kits.vector(carry(k, z), n, WHERE .. ": what option 'advected' returns")
    end
    local sum, whole = image(g, x) + 2 * image(g, y), image(g, x + 2 * y)
    local twice, once = image(g, image(h, x)), image(kit.compose(g, h), x)
    local size = SLACK * max(1, sum:norm(), once:norm())
    if not ((whole - sum):norm() <= size) then
      error(("%s: option 'advected' must be linear in a, and is not: at a = %s, b = %s")
        :format(WHERE, list(x), list(y)), 0)
    end
    if not ((twice - once):norm() <= size) then
      error(("%s: option 'advected' must be a left action, g (h a) = (g h) a, and is not: at a = "
        .. "%s")
        :format(WHERE, list(x)), 0)
    end
  end
end

-- the function that is reduced, l or h, and its name in dm.system
local function function_of(options)
  local l, h = options.l, options.h
  if (l == nil) == (h == nil) or type(l or h) ~= "function" then
    error(WHERE .. ": option 'l' must be a function of (xi [, a]), or 'h' one of (mu [, a])", 0)
  end
  return l or h, l and "L" or "H"
end

-- the same system for members of ensembles: the entries of the quantity that is carried along are
-- its parameters a1, a2 ...; and their names
local function opened(options, f, name, carry, some)
  local kit, names, params = kits.of(options.group), {}, {}
  for i = 1, #some do
    names[i] = "a" .. i
    params[names[i]] = 0
  end
  local system = core.system { Q = options.group, name = options.name, params = params,
    [name] = function(g, x, _, given)
      local a = {}
      for i, key in ipairs(names) do a[i] = given[key] end
      return f(x, carry(kit.inverse(g), core.vector(a)))
    end }
  system.place.reduced = { start = function(given, out)
    if given.q == nil and (given.v ~= nil or given.p ~= nil) then out.q = kit.identity() end
  end }
  return system, names
end

local system_of

function system_of(options)
  local f, name = function_of(options)
  local kit = kits.of(options.group)
  local carry, some = carrier(options)
  if carry then check_action(kit, carry, #some) end
  local reduced = { a = some, f = f, name = name, carry = carry }
  local function of_element(g, x)
    if not carry then return f(x) end
    if not reduced.a then
      error(WHERE .. ": a run needs the advected quantity at its start, a =", 0)
    end
    return f(x, carry(kit.inverse(g), reduced.a))
  end
  reduced.usual = options.a and some
  -- a run begins at the identity, with its own quantity or the usual one; a run that goes on from a
  -- checkpoint gives neither v nor p, and has its element
  function reduced.start(given, out)
    if carry then
      local a = given.a or reduced.usual
      reduced.a, out.a = a ~= nil and quantity(a, #some) or nil, nil
    end
    if given.q == nil and (given.v ~= nil or given.p ~= nil) then out.q = kit.identity() end
  end
  local system = core.system { Q = options.group, [name] = of_element, name = options.name }
  if not system.place then
    error(("%s: on %s body velocities are those of the coordinates: dm.system{Q =, L = function(q, "
      .. "v) ... end} steps them"):format(WHERE, tostring(options.group)), 0)
  end
  system.place.reduced = reduced
  function reduced.open()
    if not carry then
      error("field 'a': this system carries no quantity along (dm.euler_poincare, advected =)", 0)
    end
    return opened(options, f, name, carry, some)
  end
  -- the same system with another usual quantity; `a` must be one
  function reduced.with(a)
    if not carry then
      error("field 'a': this system carries no quantity along (dm.euler_poincare, advected =)", 0)
    end
    local given, value = {}, quantity(a, #some)
    for key, option_ in pairs(options) do given[key] = option_ end
    given.a = value
    return system_of(given)
  end
  return system
end

M.euler_poincare = blame.caller(function(options)
  if kits.class_of(options) == "dm.system" then return system_of(of_system(options)) end
  option.check(options, { "group", "l", "h", "advected", "a", "name" }, WHERE,
    "{ group =, l = }, { group =, h = } or a system on a group")
  if kits.class_of(options.group) ~= "dm.space" or kits.of(options.group).manifold then
    error(WHERE .. ": option 'group' must be a group, such as dm.SO(3)", 0)
  end
  return system_of(options)
end)

core.docs[M.euler_poincare] = [[
dm.euler_poincare{group=, l=, h=, advected=, a=, name=} -> dm.system   or   (system) -> dm.system
The reduced system of a Lagrangian l(xi) of the body velocity on a group, or of a Hamiltonian h(mu)
of the body momentum (Lie-Poisson; h may be singular); l(xi, a) and h(mu, a) have a quantity a =
g^-1 a0 that is carried along by the linear action `advected` (a dm.action or a function of (g, a)),
as gravity in a heavy top. Or that of a system on a group whose L or H does not depend on g; raises
at the first point where it does. Runs take p or v (and a, the quantity at the start; in ensembles
one for all or, as a list or a function of the member, one for each, which are traced one by one)
and begin at the identity, as do ensembles, sections, charts, scenes, stability maps and all that
measures a run; path.p is the body momentum, also path.mu, which moves on a coadjoint orbit;
path:reconstruct{q = g0} is the path on the group that begins at g0. lie(s) steps mu1(f_(k-1)) =
mu0(f_k) (Leok 5.4).]]

return M
