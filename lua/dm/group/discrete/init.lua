--- Discrete Lagrangians Ld(g0, g1) on groups: a formula of a script, or the action of lie(s)
-- between two elements (Leok 5.3). Momenta are body covectors: p0 = -D1 Ld, p1 = D2 Ld along
-- g exp(e).
local actions = require "dm.group.discrete.action"
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local class = require "dm.base.class"
local core = require "dm.core"
local formula = require "dm.group.discrete.formula"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local momentum = require "dm.group.momentum"
local options = require "dm.base.options"
local place = require "dm.group.place"

local M = {}

local WHERE = "dm.discrete_lagrangian"

local Class = core.class({ __name = "dm.group_lagrangian" }, [[
dm.group_lagrangian: Ld(g0, g1) on a group, made by dm.discrete_lagrangian{Q=, h=, Ld=} or
dm.discrete_lagrangian(system, {rule = "lie(2)", h=})
fields: Q, h, name, Ld, constraint, rolling, reaction, force, or system and rule; Ld(g0, g1) is its
value.]])

function Class.__tostring(Ld)
  local by = Ld.rule and (", by %s"):format(tostring(Ld.rule)) or ""
  return ("discrete Lagrangian on %s, h = %g%s"):format(tostring(Ld.Q), Ld.h, by)
end

local part = lists.part

-- g0, g1 as coordinates of matrices
local function ends_of(Ld, g0, g1)
  local element, out, given = require("dm.group").element, {}, { g0, g1 }
  for k = 1, 2 do
    local fine, x = blame.try(element, Ld.Q, given[k])
    if not fine then error(("g%d: %s"):format(k - 1, x), 0) end
    out[k] = core.vector(Ld.place.flat(x))
  end
  return out[1], out[2]
end

---- what stays while a trace stays ----

-- what `make` gives, made again when the trace of f is another one: upvalues and params may have
-- changed since
local function while_same(f, lengths, make)
  local text, made
  local of = table.move(lengths, 1, #lengths, 1, {})
  of[#of + 1] = "unchecked" -- `make` compares what it traces with calls
  return function()
    local now = core.trace(f, table.unpack(of)):graph()
    if now ~= text then made = make() end
    text = now
    return made
  end
end

---- the action of lie(s) ----

-- the action with its derivatives, the same as long as L is
local function traced_action(Ld, tau, c)
  local P, given = Ld.place, Ld.system.given
  local function L(g, xi, t) return bound(given.L, given.params)(g, xi, t) end
  return while_same(place.of_velocity(P, L), { P.size, P.dimension, "number" }, function()
    return actions.derived(Ld, L, tau, c)
  end)
end

local function by_rule(Ld)
  local kit, P, d = kits.of(Ld.Q), Ld.place, Ld.place.dimension
  local tau, c = actions.curves(Ld.rule)
  local action_now = traced_action(Ld, tau, c)
  local back, inverse = actions.map(kit, tau)
  local function between(q0, q1, t)
    local S, g0, g1 = action_now(), P.element(q0), P.element(q1)
    local xi = back(kit.compose(kit.inverse(g0), g1))
    local V, S1 = actions.stationary(S, c, Ld.h, q0, xi, t)
    return S, V, S1, xi
  end
  local function transposed(xi, mu)
    return linear.matrix_of(function(x) return inverse(xi, x) end, d):transpose() * mu
  end
  local way = {}
  function way.value(q0, q1, t)
    local S, V = between(q0, q1, t)
    return S.value(q0, V, t)
  end
  function way.momenta(q0, q1, t)
    local S, V, S1, xi = between(q0, q1, t)
    return transposed(xi, S1) - part(S.gradient(q0, V, t), 0, d), transposed(-xi, S1)
  end
  -- dp0 = Omega u1 at u0 = 0: xi moves by dtau_L^-1 u1, V and S1 by the equations that they solve
  local turned = actions.slope_of_transport(inverse, d)
  function way.two_form(q0, q1, t)
    local S, V, S1, xi = between(q0, q1, t)
    local H, m, slope = S.hessian(q0, V, t), #c.beta * d, turned(xi, S1)
    local J = actions.slope_of_stationary(H, c, Ld.h, d)
    return linear.matrix_of(function(u)
      local dxi = core.vector(inverse(-xi, u))
      local dz = J:solve(lists.joined(core.zeros(m), dxi))
      local out = slope * dxi + transposed(xi, part(dz, m, d))
      for i = 1, d do
        for k = 1, m do out[i] = out[i] - H[i][d + k] * dz[k] end
      end
      return out
    end, d)
  end
  return way
end

---- the object ----

local function method(name, f, doc)
  core.method("dm.group_lagrangian", name, blame.caller(f), doc)
end

-- q0, q1 and the time of q0, 0 where none is given; a formula has none
local function asked(Ld, g0, g1, t)
  if t ~= nil and not Ld.system then error("Ld: a formula Ld(g0, g1) has no time", 0) end
  options.number({ t = t }, "t", "Ld", "the time of g0, a finite number")
  local q0, q1 = ends_of(Ld, g0, g1)
  return q0, q1, t or 0
end

function Class.__call(Ld, g0, g1, t) return Ld.way.value(asked(Ld, g0, g1, t)) end

method("value", function(Ld, g0, g1, t) return Ld.way.value(asked(Ld, g0, g1, t)) end, [[
Ld:value(g0, g1 [, t]) -> number
The same as Ld(g0, g1 [, t]): approximately the action between two elements in the time h. t: of an
L that depends on time, when it begins (0).]])
method("legendre_minus", function(Ld, g0, g1, t)
  return (Ld.way.momenta(asked(Ld, g0, g1, t)))
end, [[
Ld:legendre_minus(g0, g1 [, t]) -> dm.vector of dim G entries
The body momentum at g0, -D1 Ld - F1 along g0 exp(e), F1 the discrete force. t: the time at g0
(0).]])
method("legendre_plus", function(Ld, g0, g1, t)
  local _, p1 = Ld.way.momenta(asked(Ld, g0, g1, t))
  return p1
end, [[
Ld:legendre_plus(g0, g1 [, t]) -> dm.vector of dim G entries
The body momentum at g1, D2 Ld + F2 along g1 exp(e), F2 the discrete force. t: the time at g0
(0).]])
method("two_form", function(Ld, g0, g1, t) return Ld.way.two_form(asked(Ld, g0, g1, t)) end, [[
Ld:two_form(g0, g1 [, t]) -> dm.matrix, dim G x dim G
-D1 D2 Ld, row e0, column e1: the discrete symplectic form in the left-invariant frames at g0 and
g1. t: the time at g0 (0).]])
method("momentum", function(Ld, group, g0, g1, given)
  local q0, q1, t = asked(Ld, g0, g1, type(given) == "table" and given.t or nil)
  local _, p1 = Ld.way.momenta(q0, q1, t)
  return momentum.at(Ld.place, group, given, Ld.place.element(q1), p1)
end, [[
Ld:momentum(group, g0, g1 [, {side=, action=, t=}]) -> dm.vector
Noether's momentum at g1, as path:momentum: of the group itself spatial, { side = "right" } body. t:
the time at g0 (0).]])
-- of a formula one for all solvers: its order is measured once
local function own_rule(Ld)
  Ld.own_rule = Ld.own_rule or formula.rule(Ld, while_same)
  return Ld.own_rule
end

method("solver", function(Ld, given)
  given = options.check(given or {}, { "newton", "backend" }, "Ld:solver",
    "{ newton =, backend = }: rule and h are those of Ld")
  local out = { h = Ld.h, newton = given.newton, backend = given.backend }
  if Ld.system then
    out.rule = Ld.rule
    return Ld.system:solver(out)
  end
  out.rule = own_rule(Ld)
  return Ld.frame:solver(out)
end, [[
Ld:solver{newton=, backend=} -> dm.solver
Its steps, D2 Ld(g0, g1) + D1 Ld(g1, g2) = 0, with the forces and impulses of constraints that were
given (Leok 2.8, 5.3). Runs take q and p (the body momentum). Of a formula
they have no energy and no velocity.]])

local function check_left(Q, given)
  if given and given.right then
    error(WHERE .. ": on groups with the left trivialization only", 0)
  end
  return place.of(Q, { columns = "matrix" })
end

local OWN = { "Q", "h", "Ld", "name", "constraint", "rolling", "reaction", "force",
  "crossings" }

local function of_formula(given)
  options.check(given, OWN, WHERE, "{ Q =, h =, Ld = }")
  options.need(given, "h", WHERE, "the time between two elements")
  options.positive(given, "h", WHERE, "a step")
  options.need(given, "Ld", WHERE, "a function of (g0, g1 [, h])")
  options.callable(given, "Ld", WHERE, "(g0, g1 [, h])")
  formula.check(given, WHERE)
  local place = check_left(given.Q)
  local Ld = setmetatable(lists.copy(given), Class)
  Ld.place = place
  Ld.frame = formula.frame(Ld)
  Ld.way = formula.way(Ld, while_same)
  if Ld.force then formula.try_forces(Ld) end
  return Ld
end

local function of_system(system, given)
  options.check(given, { "rule", "h", "name" }, WHERE, "(system, { rule =, h = })")
  options.need(given, "h", WHERE, "the time between two elements")
  options.positive(given, "h", WHERE, "a step")
  local own = system.given
  if not own.L or own.constraint or own.rolling or own.force or own.control then
    error(WHERE .. ": on groups of an L without constraints and forces", 0)
  end
  local Ld = setmetatable({ Q = system.Q, h = given.h, rule = given.rule, system = system,
    name = given.name, place = check_left(system.Q, system.place) }, Class)
  Ld.way = by_rule(Ld)
  return Ld
end

-- does it live on a group that has no coordinates of its own?
local function is_group(Q)
  return kits.class_of(Q) == "dm.space" and not Q.chart and not kits.of(Q).manifold
end

-- the discrete Lagrangian of these arguments, or nothing where it is none on a group
local function on_group(first, given)
  local of = kits.class_of(first)
  if of == "dm.system" and first.place then return of_system(first, given or {}) end
  if of == "table" and is_group(first.Q) then return of_formula(first) end
end

---- functions of the core ----

local plain, plain_doc, put = class.wraps("dm.group.discrete", "discrete_lagrangian")
M.discrete_lagrangian = blame.caller(function(...) return on_group(...) or plain(...) end)
put(M.discrete_lagrangian, plain_doc .. " On a group elements take the place of q, and covectors "
  .. "(momenta, F1 and F2, rows of reactions) are those of the body, d numbers along g exp(e); of "
  .. "a system rule is lie(s): class dm.group_lagrangian.")

-- runs of a formula are those of a system of its own
local resume, resume_doc, put_resume = class.wraps("dm.group.discrete", "resume")
put_resume(function(from, model, given)
  if options.got(model) ~= "dm.group_lagrangian" then return resume(from, model, given) end
  if model.system then return resume(from, model.system, given) end
  local out = lists.copy(options.check(given or {}, { "rule", "backend" }, "dm.resume",
    "{ rule =, backend = }"))
  out.rule = out.rule or own_rule(model) -- another one is refused by its name
  return resume(from, model.frame, out)
end, resume_doc)

return M
