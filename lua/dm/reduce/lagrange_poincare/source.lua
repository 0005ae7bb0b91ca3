--- Where a reduced step comes from: a formula l(x0, x1, f, h), as an action S(q0, V, h) of the
-- stage velocity V in a chart tau, or a system and a rule lie(s) (Leok 5.3).
local blame = require "dm.base.blame"
local core = require "dm.core"
local bound = require "dm.base.bound"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local place = require "dm.group.place"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

---- a formula ----

--- S = l(x0, x1, f, h), (x1, f) = (x0, e) tau(h V): one stage, weight 1.
function M.of_formula(S, P, l, where)
  local tau = kits.of(S.Q).cayley and "cayley" or "exp"
  local chart = place.chart(P, tau)
  local function value(x0, x1, f, h)
    local out
    if S.single then out = l(f, h) else out = l(x0, x1, f, h) end
    if not kits.is_scalar(out) then
      option.fail(where, "l must return a number (got %s)", kits.class_of(out))
    end
    return out
  end
  local function action(q0, V, h)
    local x0 = space.split(S, P.element(q0))
    local y = chart(q0, nil, V * h, V)
    local x1, f = space.split(S, P.element(lists.part(y, 0, P.size)))
    return value(x0, x1, f, h)
  end
  return { action = action, beta = { 1 }, tau = tau, value = value }
end

--- A Lagrangian of Q that has the formula's motion as h goes to 0, for energies and starts from
-- velocities: l about the middle of a step, divided by h.
function M.lagrangian_of(S, l, h)
  return function(q, v)
    local x = space.split(S, q)
    local rate, xi = space.parts(S, v)
    local half = S.d > 0 and rate * (h / 2) or x
    local f = S.kit.exp(xi * h)
    local value = S.single and l(f, h)
    if not S.single then value = l(x - half, x + half, f, h) end
    if value == nil or type(value) == "table" then
      option.fail("dm.lagrange_poincare", "l must return a number (got %s)", option.got(value))
    end
    return value / h
  end
end

---- a system and a rule ----

-- the name of a rule as those of groups are called
local function name_of(name, S, where)
  local text = tostring(name):gsub("%s", "")
  local flat = S.kit.euclidean or S.kit.abelian
  local stages = flat and text:match "^gauss%((%d+)%)$"
  if stages then text = ("lie(%s)"):format(stages) end
  if not text:find "^lie%(%d" then
    option.fail(where, "the rule must be lie(s [, quadrature] [, exp | cayley])%s (got %s)",
      flat and " or gauss(s)" or ", on a group that is not abelian", tostring(name))
  end
  return text
end

--- The system with the identity in the place of g, and the rule's name on it: an L that does not
-- see g has the same steps, without g in their equations.
function M.of_rule(S, system, name, h, where)
  local text = name_of(name, S, where)
  local L = bound(system.given.L, system.given.params)
  local reduced = core.system { Q = S.Q, name = system.name,
    L = function(q, v) return L(space.at_identity(S, q), v, 0) end }
  local _ = reduced:solver { rule = text, h = h } -- raises for a rule that there is not
  return { system = reduced, rule = text, name = text }
end

---- invariance ----

local TRIES, ENOUGH, SLACK = 60, 8, 1e-9

--- Raises where L(h g, xi) is not L(g, xi), at the first of some random points.
function M.check_invariance(S, system, where)
  local L, stream = bound(system.given.L, system.given.params), core.random(4710)
  local kit, whole, seen, sizes = S.kit, kits.of(S.Q), {}, {}
  for i = 1, TRIES do
    local x = kits.normals(stream, 4 * i, math.max(S.d, 1), 0.5)
    local v = kits.normals(stream, 4 * i + 1, whole.dimension, 1)
    local g = kit.exp(kits.normals(stream, 4 * i + 2, S.r, 0.5))
    local h = kit.exp(kits.normals(stream, 4 * i + 3, S.r, 0.7))
    local fine, a, b = blame.try(function()
      return L(space.element(S, x, g), v, 0), L(space.element(S, x, kit.compose(h, g)), v, 0)
    end)
    if fine and math.abs(a) < math.huge and math.abs(b) < math.huge then
      seen[#seen + 1] = { a = a, b = b, x = x, g = g, h = h }
      sizes[#seen] = math.abs(a)
    end
    if #seen == ENOUGH then break end
  end
  if #seen == 0 then option.fail(where, "L is finite at none of %d random points", TRIES) end
  local usual = lists.middle(sizes)
  for k, s in ipairs(seen) do
    if math.abs(s.a - s.b) > SLACK * math.max(sizes[k], usual) then
      option.fail(where, "L is not invariant under %s: it goes from %.9g to %.9g at %sg = %s "
        .. "when h = %s moves g; what breaks the symmetry may be carried along by "
        .. "dm.euler_poincare, advected =", tostring(S.group), s.a, s.b,
        S.d > 0 and ("x = %s, "):format(tostring(s.x)) or "", (tostring(s.g):gsub("%s+", " ")),
        (tostring(s.h):gsub("%s+", " ")))
    end
  end
end

return M
