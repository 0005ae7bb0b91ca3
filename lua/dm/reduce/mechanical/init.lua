--- Discrete mechanical connections (Leok 4.6.4): horizontal are the pairs whose discrete momentum
-- J_d along the group is mu, 0 but for abelian groups. Of a discrete Lagrangian with cyclic
-- coordinates (cyclic.lua), of a system on a product with a group (on_group.lua).
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local kits = require "dm.group.kit"
local options = require "dm.base.options"

local M = {}

local WHERE = "system:mechanical_connection"

M.connection = blame.caller(function(Ld, given)
  return require "dm.reduce.mechanical.cyclic".connection(Ld, given or {})
end)

-- the factor of Q that is the group: its number, of equal ones the first or the one that is asked
-- for
local function factor_of(Q, given)
  local kit, found = kits.of(given.group), nil
  for k, part in ipairs(Q.parts or {}) do
    if kits.of(part) == kit and (not found or given.factor == k) then found = k end
  end
  if not found or given.factor and given.factor ~= found then
    options.fail(WHERE, "%s is no product with %s as %s: Q = dm.product(base, group); of cyclic "
      .. "coordinates take dm.discrete_lagrangian(system, { rule =, h = }):connection { cyclic = }",
      tostring(Q), tostring(given.group), given.factor and "factor " .. given.factor or "a factor")
  end
  return found
end

M.mechanical_connection = blame.caller(function(system, given)
  options.check(given, { "group", "rule", "h", "factor" }, WHERE, "{ group =, rule =, h = }")
  options.demand(kits.class_of(given.group) == "dm.space", given, "group", WHERE,
    "a space, for instance dm.SO(3)")
  options.whole(given, "factor", WHERE, 1, 99)
  options.text(given, "rule", WHERE)
  options.need(given, "rule", WHERE, "that of the discrete Lagrangian, \"lie(2)\"; where Q has "
    .. "coordinates, \"gauss(2)\"")
  options.positive(given, "h", WHERE, "a step")
  options.need(given, "h", WHERE, "the time between the points of a pair")
  local k = factor_of(system.Q, given)
  local way = system.place and "dm.reduce.mechanical.on_group" or "dm.reduce.mechanical.cyclic"
  return require(way).of_factor(system, given, k)
end)

class.method("dm.discrete_lagrangian", "connection", M.connection, [[
Ld:connection{cyclic=, mu=} -> dm.connection
The discrete mechanical connection theta1 - theta0 - psi_mu(x0, x1) of a discrete Lagrangian that
does not depend on where the cyclic coordinates theta (numbers or names; left out: all that are)
begin: psi_mu is how far theta goes from x0 to x1 with the momentum mu (0, else a number or list).
It is called with points of Q and gives a vector; A:lift and A:holonomy take shapes, the coordinates
that are left. For T = (I theta'^2 + 2 b.x' theta' + ...)/2 the midpoint rule has psi = -a((x0 +
x1)/2).(x1 - x0), a = b/I. Raises where Ld is not invariant; a value where the locked inertia is
singular.]])

class.method("dm.system", "mechanical_connection", M.mechanical_connection, [[
system:mechanical_connection{group=, rule=, h=, factor=} -> dm.connection
The discrete mechanical connection of a system whose Q is a product of coordinates (R^n, T^n) and
the group, of equal factors the first or number `factor`: A_d(q0, q1) takes q1 = { x1, g1 } to the
end of the curve of the rule from q0 to the shape x1, in the time h, that has the momentum 0 along
the group. rule: "lie(s)", of order 2s; where the group is R^m or T^m any rule of Ld:connection.
Raises where L is not invariant under the group, where its locked inertia is singular.]])

return M
