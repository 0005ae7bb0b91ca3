--- Routh reduction at a value J of a momentum map whose group is not abelian. The reduced space is
-- T*S x the coadjoint orbit of J: a shape x with its momentum and the body momentum nu = Ad*_g J.
-- L(x, x', xi) with I = L_xixi and c = L_xi at rest gives xi = I^-1 (nu - c - C x') and the amended
-- potential V_nu = V + (nu - c).I^-1 (nu - c)/2, whose critical points on S x orbit are the
-- relative equilibria (Marsden 1992).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local equilibria = require "dm.reduce.lagrange_poincare.equilibria"
local source = require "dm.reduce.lagrange_poincare.source"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

local WHERE = "system:routh"

local Class = core.class({ __name = "dm.level" }, [[
dm.level: a system reduced at the spatial momentum J by a group that is not abelian, made by
system:routh{group=, mu=} or system:routh{action=, section=, mu=}
fields: group, base, mu (J), isotropy (a basis of the algebra of the isotropy group of J), orbit
(the dimension of its coadjoint orbit), dimension (of the reduced space), system (on base x group).
]])

function Class.__tostring(self)
  return ("reduced by %s at J = %s: %d shape%s, a coadjoint orbit of dimension %d, an isotropy "
    .. "group "
    .. "of dimension %d"):format(tostring(self.group), tostring(self.mu), self.space.d,
    self.space.d == 1 and "" or "s", self.orbit, #self.isotropy)
end

local function method(name, f, doc) core.method("dm.level", name, blame.caller(f), doc) end

---- L at the identity ----

local part = lists.part

-- what is asked of L(x, u, xi), g the identity
local function functions_of(S, system)
  local L = bound(system.given.L, system.given.params)
  local n, r = math.max(S.d, 1), S.r
  local function f(x, u, xi)
    local shape = S.d > 0 and x or core.vector {}
    return L(space.element(S, shape, S.kit.identity()), space.joined(S, u, xi), 0)
  end
  local slope = core.derivative(function(x, u, xi) return f(x, u, xi) end, n, n, r)
  local second = core.derivative(function(x, u, xi) return part(slope(x, u, xi), 2 * n, r) end, n,
    n, r)
  local out = { value = f, n = n }
  -- L_xi, L_xixi and L_xix' at rest, by rows
  function out.momentum(x, u, xi) return part(slope(x, u, xi), 2 * n, r) end
  function out.inertia(x, u, xi)
    local J = second(x, u, xi)
    return linear.fill(r, r, function(i, j) return J[i][2 * n + j] end),
      S.d > 0 and linear.fill(r, S.d, function(i, j) return J[i][n + j] end)
  end
  return out
end

local function rest(self) return core.zeros(self.f.n), core.zeros(self.space.r) end

-- I must not depend on xi, and have an inverse at some shape
local function check_inertia(self)
  local S, f = self.space, self.f
  for i = 1, 8 do
    local x = kits.normals(core.random(88), i, f.n, 0.6)
    local u, xi = rest(self)
    local fine, I = blame.try(f.inertia, x, u, xi)
    if fine then
      local again = f.inertia(x, u, kits.normals(core.random(88), 100 + i, S.r, 1))
      if linear.largest(again - I) > 1e-9 * linear.largest(I) then
        option.fail(WHERE, "L is not quadratic in the velocity of the group: only mechanical "
          .. "systems "
          .. "are reduced by groups that are not abelian")
      end
      if blame.try(I.inverse, I) then return end
    end
  end
  option.fail(WHERE, "the locked inertia is singular: some turns of the group cost no momentum")
end

---- making one ----

-- the algebra of the isotropy group of J under the coadjoint action
local function isotropy_of(kit, J)
  local r = kit.dimension
  local values, vectors = linear.singular_values(linear.matrix_of(function(xi)
    return kit.coad(xi, J)
  end, r))
  local largest, out = 0, {}
  for _, s in ipairs(values) do largest = math.max(largest, s) end
  for k, s in ipairs(values) do
    if s <= 1e-10 * math.max(largest, J:norm()) then out[#out + 1] = vectors[k] end
  end
  return out
end

local function read_mu(given, r)
  option.need(given, "mu", WHERE, "the spatial momentum J, a list of numbers")
  return lists.numbers(WHERE .. ": option 'mu'", given.mu, r,
    "%s must be %d finite number%s, the spatial momentum (got %s)")
end

local function assemble(system, given, S)
  local J = read_mu(given, S.r)
  local isotropy = isotropy_of(S.kit, J)
  local self = setmetatable({ space = S, system = system, group = S.group, base = S.base, mu = J,
    isotropy = isotropy, orbit = S.r - #isotropy, dimension = 2 * S.d + S.r - #isotropy,
    f = functions_of(S, system) }, Class)
  check_inertia(self)
  return self
end

-- coordinates of Q by a free action: q = g section(x), and L on R^d x G
local function by_action(system, given)
  local action = given.action
  local n, m = system.Q.dimension, action.dimension
  if n % m ~= 0 then
    option.fail(WHERE, "%s moves points of %d coordinates, and Q has %d", tostring(action), m, n)
  end
  if n ~= m then action = action:on_points(n // m) end
  local r = action.group.dimension
  local z = require "dm.action.points".sample_point(action.on, core.random(12), 4)
  local isotropy = action:isotropy(z).dimension
  if isotropy > 0 then
    option.fail(WHERE, "the action of %s is not free: points such as %s have an isotropy group of "
      .. "dimension %d; reduce by a subgroup that acts freely, or describe shapes by a frame up to "
      .. "isotropy, dm.moving_frame { partial = true }", tostring(action.group),
      tostring(z), isotropy)
  end
  if system.place then option.fail(WHERE, "an action is reduced on coordinates, dm.R(n)") end
  local fine, why = action:invariant(system)
  if not fine then option.fail(WHERE, "L is not invariant: %s", tostring(why)) end
  local d = n - r
  if d < 1 then option.fail(WHERE, "no shape would be left: Q has %d dimensions, as %s", n,
    tostring(action.group)) end
  option.callable(given, "section", WHERE, "the shape")
  option.need(given, "section", WHERE, ("a function of the shape, %d number%s, that gives a "
    .. "point of "
    .. "Q for every one"):format(d, d == 1 and "" or "s"))
  local section = core.one(given.section, "section")
  local function point(x)
    return lists.numbers(WHERE .. ": the section", section(x), n,
      "%s must give %d number%s, a point of Q (got %s)")
  end
  local slope = core.derivative(point, d)
  local rows = require "dm.action".generator_rows
  local L0 = bound(system.given.L, system.given.params)
  local function L(q, v)
    local x = q[1]
    local s, J, psi, rate = point(x), slope(x), nil, {}
    psi = rows(action, s)
    for i = 1, n do
      local sum = 0
      for j = 1, d do sum = sum + J[i][j] * v[j] end
      for a = 1, r do sum = sum + psi[i][a] * v[d + a] end
      rate[i] = sum
    end
    return L0(s, core.vector(rate), 0)
  end
  return core.system { Q = core.product(core.R(d), action.group), L = L, name = system.name },
    action.group
end

local KNOWN = { "group", "action", "section", "mu", "factor" }

M.level = blame.caller(function(system, given)
  option.check(given, KNOWN, WHERE, "{ group =, mu = } or { action =, section =, mu = }")
  option.object(given, "group", WHERE, "dm.space", "a group, such as dm.SO(3)")
  option.object(given, "action", WHERE, "dm.action", "a dm.action")
  option.whole(given, "factor", WHERE, 1)
  for _, key in ipairs { "constraint", "rolling", "force", "control" } do
    if system.given[key] then
      option.fail(WHERE, "groups that are not abelian reduce systems without '%s'", key)
    end
  end
  if not system:structure().autonomous then
    option.fail(WHERE, "L depends on the time, which groups that are not abelian do not reduce")
  end
  local group = given.group
  if not group and not given.action then option.need(given, "group", WHERE, "a group") end
  if given.action then
    system, group = by_action(system, given)
  elseif not system.place then
    option.fail(WHERE, "%s is no product with %s as a factor: give the action = dm.action { ... "
      .. "} of "
      .. "the group on Q, and section =", tostring(system.Q), tostring(group))
  end
  local S = space.of(system.Q, group, given.factor, WHERE)
  if given.group then source.check_invariance(S, system, WHERE) end
  return assemble(system, given, S)
end)

---- what it knows ----

local function shape_of(self, x, what)
  if self.space.d == 0 then return core.zeros(1) end
  if type(x) == "number" then x = { x } end
  return lists.numbers(what, x, self.space.d, "%s: the shape must be %d number%s (got %s)")
end

-- nu, or the momentum J itself
local function momentum_of(self, nu, what)
  if nu == nil then return self.mu end
  return lists.numbers(what, nu, self.space.r, "%s: the body momentum must be %d number%s (got %s)")
end

-- I^-1 b at the shape x
local function by_inertia(I, b, x)
  local fine, out = blame.try(I.solve, I, b)
  if fine then return out end
  if not linear.is_plain(I) then error(out, 0) end
  option.fail("dm.level", "the locked inertia is singular at the shape %s: a turn of the group "
    .. "costs "
    .. "no momentum there", tostring(x))
end

method("locked_inertia", function(self, x)
  local u, xi = rest(self)
  return (self.f.inertia(shape_of(self, x, "level:locked_inertia"), u, xi))
end, [[
level:locked_inertia(x) -> dm.matrix, dim G x dim G
L_xixi at the shape x, xi the body velocity.]])

method("connection", function(self, x)
  local u, xi = rest(self)
  x = shape_of(self, x, "level:connection")
  local I, C = self.f.inertia(x, u, xi)
  return by_inertia(I, C, x)
end, [[
level:connection(x) -> dm.matrix, dim G x dim S
The mechanical connection I^-1 L_xix' at the shape x.]])

-- xi at rest of the shape, and V_nu
local function amended(self, x, nu)
  local u, zero = rest(self)
  local I = self.f.inertia(x, u, zero)
  local xi = by_inertia(I, nu - self.f.momentum(x, u, zero), x)
  return nu:dot(xi) - self.f.value(x, u, xi), xi
end

method("amended_potential", function(self, x, nu)
  local what = "level:amended_potential"
  return (amended(self, shape_of(self, x, what), momentum_of(self, nu, what)))
end, [[
level:amended_potential(x [, nu]) -> number
V + (nu - c).I^-1 (nu - c)/2 at the shape x and the body momentum nu (default: J), a point of the
coadjoint orbit of J.]])

method("routhian", function(self, x, u, nu)
  local what = "level:routhian"
  x, nu = shape_of(self, x, what), momentum_of(self, nu, what)
  u = shape_of(self, u, what)
  local _, zero = rest(self)
  local I = self.f.inertia(x, u, zero)
  local xi = by_inertia(I, nu - self.f.momentum(x, u, zero), x)
  return self.f.value(x, u, xi) - nu:dot(xi)
end, [[
level:routhian(x, x' [, nu]) -> number
L - <nu, xi> at the velocity xi of the group that has the body momentum nu (default: J).]])

method("relative_equilibria", function(self, o)
  return equilibria.find(self, amended, o)
end, [[
level:relative_equilibria{x=, spread=, starts=} -> list of {x, nu, xi, energy, stable}
Motions along the group alone: critical points of the amended potential on S x the coadjoint orbit
of J, by Newton's method from `starts` (40) random shapes about x (default 0, with deviation spread
= 1) and body momenta on the orbit. nu and xi: body momentum and velocity, the motion from g is g
exp(xi t); stable: true where the second variation is definite (then it is, modulo the isotropy
group of J), else nothing is said.]])

method("solver", function(self, o)
  o = option.check(o, { "rule", "h", "newton" }, "level:solver", "{ rule =, h = }")
  local lp = self.system:reduce { group = self.group, rule = o.rule, h = o.h,
    factor = self.space.factor }
  local solver, J = lp:solver { newton = o.newton }, self.mu
  local run = solver.run
  rawset(solver, "run", function(s, options)
    local given = lists.copy(options)
    if given.mu ~= nil then error("solver:run: mu follows from J and g", 0) end
    given.momentum = J
    return run(s, given)
  end)
  return solver
end, [[
level:solver{rule=, h=} -> dm.reduced_solver
Steps the reduced system at J by a rule of system:reduce: run{x=, p=, g=, steps=}, with mu = Ad*_g J
(g: by default the identity).]])

class.method("dm.system", "level", M.level, [[
system:level{group=, mu=, factor=} -> dm.level   or   {action=, section=, mu=} -> dm.level
What system:routh makes for a group that is not abelian: the system at the spatial momentum J = mu.
Q is a product with the group as a factor; or coordinates with a free left action (a dm.action; of
one body, or of all bodies alike) and section(x), a point of Q for every shape. Raises where L is
not invariant, the locked inertia singular, or the action not free (the dimension of the isotropy).
]])

return M
