--- Discrete Lagrange-Poincare equations (Leok 4.7.1): dm.lagrange_poincare of a formula l(x0, x1,
-- f, h), system:reduce of a system and a rule. The state is (x, p, mu) with p = D2 l at fixed f and
-- the body momentum mu; f = g0^-1 g1. What steps is, on Q = base x group, a dm.step of a formula
-- (step.lua) or the rule of a system whose L has no g.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local paths = require "dm.reduce.lagrange_poincare.path"
local residual = require "dm.reduce.lagrange_poincare.residual"
local source = require "dm.reduce.lagrange_poincare.source"
local space = require "dm.reduce.lagrange_poincare.space"
local step = require "dm.reduce.lagrange_poincare.step"

local M = {}

local WHERE = "dm.lagrange_poincare"

local Class = core.class({ __name = "dm.lagrange_poincare" }, [[
dm.lagrange_poincare: a discrete Lagrangian reduced by a group, made by dm.lagrange_poincare{group=,
base=, h=, l=} or system:reduce{group=, rule=, h=}
fields: group, base, h, connection, system (on Q = base x group, its L without g) and rule (of a
formula a dm.step), for whatever
takes these: charts, events, checkpoints of the unreduced motion.]])

function Class.__tostring(lp) return paths.text(lp, lp.h) end

local function method(name, f, doc) core.method("dm.lagrange_poincare", name, blame.caller(f),
  doc) end

---- making one ----

-- where the coordinates of the shape stand among the flat ones of Q
local function places_of(S, P)
  local out, first = {}, 0
  for i, part in ipairs(S.factors) do
    local kit = kits.of(part)
    local n = #kit.flat(kit.identity())
    if i ~= S.factor then
      for j = 1, n do out[#out + 1] = first + j end
    end
    first = first + n
  end
  if #out ~= S.d or first ~= P.size then error("a factor of Q has no coordinates of its own", 0) end
  return out
end

-- is A a connection of this bundle?
local function check_connection(S, A, where)
  if A == nil then return end
  local connections = require "dm.connection"
  if not connections.is_connection(A) then
    option.fail(where, "option 'connection' must be a dm.connection (got %s)", option.got(A))
  end
  if kits.of(A.group) ~= S.kit or A.base and A.base.dimension ~= S.d then
    option.fail(where, "option 'connection' is %s, which is of another bundle", tostring(A))
  end
end

local function assemble(S, system, given, way, where)
  check_connection(S, given.connection, where)
  local P, rule = system.place, way.rule
  if not rule then
    rule = step.rule(S, P, way.action, way.beta, way.tau,
      { places = places_of(S, P), name = "lagrange-poincare", order = 1 })
    require "dm.measure.declared_order".trust(rule, system) -- that of l is the script's
  end
  return setmetatable({ space = S, group = given.group, base = S.base, h = given.h, way = way,
    system = system, rule = rule, connection = given.connection, by = way.name, name = given.name },
    Class)
end

local function check_group(o, where)
  option.demand(kits.class_of(o.group) == "dm.space", o, "group", where,
    "a group, for instance dm.SO(3)")
  if kits.of(o.group).manifold then option.fail(where, "%s is no group", tostring(o.group)) end
  option.positive(o, "h", where, "a step")
  option.need(o, "h", where, "the time of a step")
end

M.lagrange_poincare = blame.caller(function(o)
  option.check(o, { "group", "base", "h", "l", "connection", "name" }, WHERE,
    "{ group =, base =, h =, l = }")
  check_group(o, WHERE)
  option.callable(o, "l", WHERE, "(x0, x1, f, h), or of (f, h) without a base")
  option.need(o, "l", WHERE, "a function of (x0, x1, f, h), or of (f, h) without a base")
  option.demand(o.base == nil or kits.class_of(o.base) == "dm.space", o, "base", WHERE,
    "dm.R(n) or dm.T(n), the space of shapes")
  local l = core.one(o.l, "l")
  local Q = o.base and core.product(o.base, o.group) or o.group
  local S = space.of(Q, o.group, Q.parts and #Q.parts or nil, WHERE)
  local function square(_, v) return v:dot(v) end
  if not core.system { Q = Q, L = square }.place then
    option.fail(WHERE, "%s is a vector space: its discrete Lagrangian is dm.discrete_lagrangian's",
      tostring(o.group))
  end
  local system = core.system { Q = Q, L = source.lagrangian_of(S, l, o.h), name = o.name }
  return assemble(S, system, o, source.of_formula(S, system.place, l, WHERE), WHERE)
end)

core.docs[M.lagrange_poincare] = [[
dm.lagrange_poincare{group=, base=, h=, l=, connection=, name=} -> dm.lagrange_poincare
The discrete Lagrange-Poincare equations of l(x0, x1, f, h), a discrete Lagrangian on base x group
that sees the elements as f = g0^-1 g1 alone (without a base: of l(f, h), discrete Euler-Poincare).
p0 = -D1 l, p1 = D2 l at fixed f, whatever the connection is (left out: the trivial one), which
enters lp:residual alone; mu1 is the left derivative by f, mu0 = Ad*(f^-1) mu1, kept on its
coadjoint orbit to round-off. lp:solver():run{x=, p=, mu=, steps=}. The reduced equations are not
canonical: an ordinary symplectic rule applied to them is not this one, and does not keep the orbit.
]]

local REDUCE = "system:reduce"

M.reduce = blame.caller(function(system, o)
  option.check(o, { "group", "rule", "h", "factor", "connection" }, REDUCE,
    "{ group =, rule =, h = }")
  check_group(o, REDUCE)
  option.need(o, "rule", REDUCE, "that of the unreduced steps, \"lie(1)\"")
  option.whole(o, "factor", REDUCE, 1, 99)
  local given = system.given
  if not system.place then
    option.fail(REDUCE, "%s is no product with %s as a factor, Q = dm.product(base, group): "
      .. "systems "
      .. "on coordinates are reduced by system:routh", tostring(system.Q), tostring(o.group))
  end
  for _, key in ipairs { "constraint", "rolling", "force", "control" } do
    if given[key] then option.fail(REDUCE, "is for systems without '%s'", key) end
  end
  if not given.L then option.fail(REDUCE, "needs a Lagrangian; this system is given by H") end
  if system.place.right then option.fail(REDUCE, "is for the left trivialization") end
  local S = space.of(system.Q, o.group, o.factor, REDUCE)
  if not system:structure().autonomous then
    option.fail(REDUCE, "L depends on the time, and the reduced steps do not know it")
  end
  source.check_invariance(S, system, REDUCE)
  local way = source.of_rule(S, system, o.rule, o.h, REDUCE)
  return assemble(S, way.system, o, way, REDUCE)
end)

---- runs ----

-- the start { x, p, mu, g, momentum, v } in the options of a run, as q and p of Q; i: a member
local function start_of(lp, o, i, where)
  local S = lp.space
  local function value(key)
    local x = o[key]
    if i and type(x) == "function" then return core.one(x, key)(i) end
    return x
  end
  local function vector(key, n, words)
    local x = value(key)
    if x == nil then return nil end
    if type(x) == "number" then x = { x } end
    return lists.numbers(("%s: field '%s'"):format(where, key), x, n,
      "%s must be %d number%s" .. (words or "") .. " (got %s)")
  end
  local x = vector("x", S.d, ", the shape") or S.d == 0 and core.vector {}
  if not x then option.fail(where, "field 'x' is missing, the shape at the start") end
  local g = value "g"
  g = g == nil and S.kit.identity() or require "dm.group".element(lp.group, g)
  local q = space.element(S, x, g)
  local v = vector("v", S.D)
  for _, key in ipairs { "p", "mu", "momentum" } do
    if v and value(key) ~= nil then option.fail(where, "give 'v' or '%s', not both", key) end
  end
  if v then return q, nil, v end
  local p = vector("p", S.d, ", the momentum of the shape") or S.d == 0 and core.vector {}
  if not p then option.fail(where, "field 'p' is missing, the momentum of the shape at the "
    .. "start") end
  local mu, J = vector("mu", S.r, ", the body momentum"), vector("momentum", S.r,
    ", the spatial one")
  if mu and J then option.fail(where, "give 'mu', the body momentum, or 'momentum', the spatial "
    .. "one") end
  if J then mu = S.kit.coAd(S.kit.inverse(g), J) end
  if not mu then
    option.fail(where, "field 'mu' is missing, the body momentum at the start (or 'momentum', the "
      .. "spatial one)")
  end
  return q, space.joined(S, p, mu)
end

local OWN = { x = true, p = true, mu = true, g = true, momentum = true, v = true }

local function others(o)
  local out = {}
  for key, value in pairs(o) do
    if not OWN[key] then out[key] = value end
  end
  return out
end

local Solver = core.class({ __name = "dm.reduced_solver" }, [[
dm.reduced_solver: what steps a reduced system, made by lp:solver()
fields: solver (the dm.solver on Q, for what is not listed here), system, rule, h; its other methods
are those of solver.]])

function Solver.__index(self, key)
  local own = Solver.methods[key]
  if own then return own end
  local value = rawget(self, "solver")[key]
  if type(value) ~= "function" then return value end
  return function(_, ...) return value(self.solver, ...) end
end

function Solver.__tostring(self) return paths.text(self.lp, self.h) end

local function run(self, o)
  local where = "solver:run"
  if type(o) ~= "table" then option.fail(where, "takes a table { x =, p =, mu =, steps = }") end
  if o.q ~= nil then
    option.fail(where, "a reduced run starts from x, p, mu (and g), not from q")
  end
  local options = others(o)
  options.q, options.p, options.v = start_of(self.lp, o, nil, where)
  return paths.new(self.lp, self.solver:run(options))
end

core.method("dm.reduced_solver", "run", blame.caller(run), [[
solver:run{x=, p=, mu=, steps=, ...} -> dm.reduced_path
A run of the reduced equations from the shape x, its momentum p and the body momentum mu; or from g=
and momentum= J, the spatial momentum, mu = Ad*_g J: the level of J reduced by a group that is not
abelian (Routh); or from v = (x', xi), where the system has velocities. g is the element at the
start (default: the identity). Other options are those of a dm.solver: t, every, at, watch, events.
]])

local function ensemble(self, o)
  local where = "solver:ensemble"
  if type(o) ~= "table" then option.fail(where, "takes a table { members =, x =, p =, mu =, "
    .. "steps = }") end
  local options, made = others(o), {}
  local function member(i)
    if made.i ~= i then made = { i = i, start_of(self.lp, o, i, where) } end
    return made
  end
  options.q = function(i) return member(i)[1] end
  options[o.v and "v" or "p"] = function(i) return member(i)[o.v and 3 or 2] end
  return self.solver:ensemble(options)
end

core.method("dm.reduced_solver", "ensemble", blame.caller(ensemble), [[
solver:ensemble{members=, x=, p=, mu=, g=, momentum=, steps=, ...} -> dm.ensemble
Members of the reduced system: x, p, mu, g and momentum as of solver:run, each a value for all or a
function of the member's number. The dm.ensemble is one on Q.]])

method("solver", function(lp, o)
  o = option.check(o or {}, { "newton", "h" }, "lp:solver", "{ newton =, h = }")
  local options = { rule = lp.rule, h = o.h or lp.h, newton = o.newton }
  return setmetatable({ lp = lp, solver = lp.system:solver(options) }, Solver)
end, [[
lp:solver([{h=, newton=}]) -> dm.reduced_solver
What steps the reduced equations, with the step h of lp where none is given; newton as of
system:solver.]])

method("residual", residual.residual, [[
lp:residual({x0, x1, x2}, {f0, f1}) -> Ver, Hor
The discrete Lagrange-Poincare operators (Leok 4.7.1) at x1: Ver = mu1(x0, x1, f0) - mu0(x1, x2,
f1), dim G numbers, and Hor = p1(x0, x1, f0) - p0(x1, x2, f1) - <Ver, A(x1)>, dim S numbers, with
the continuous limit A of lp's connection (none: the trivial one, A = 0). Both vanish on solutions.
]])

class.method("dm.system", "reduce", M.reduce, [[
system:reduce{group=, rule=, h=, factor=, connection=} -> dm.lagrange_poincare
The discrete Lagrange-Poincare equations of a system on a product with the group as a factor (of
equal ones the first, or number `factor`), whose other factors are shapes: dm.R(n), dm.T(n) or
dm.SO(2). rule: "lie(s [, quadrature] [, exp | cayley])" (abelian groups: also gauss(s)):
its steps are those of the unreduced rule, to round-off, without the group elements in
the equations. Raises where L is not invariant under the group.]])

return M
