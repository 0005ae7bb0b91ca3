--- A step of the discrete Lagrange-Poincare equations as a dm.step. The action of a step is S(x0,
-- V, h) of the stage velocities V_1 ... V_s in the chart tau, which does not see g; with xi = h sum
-- beta_j V_j and P = (p, mu) + S_x0,
--   S_(V_j) = h beta_j dtau_R(xi)^T P,   q1 = q0 tau(xi),   (p1, mu1) = Ad*_tau(xi) P,
-- so that mu moves by the coadjoint action alone: the spatial momentum is kept to round-off,
-- whatever is left of Newton's method (docs/theory/lie.md). Unknowns: V. Where the group knows what
-- a step adds to q and p (group/change.lua), it is summed to twice the digits.
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local place = require "dm.group.place"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

local part = lists.part

-- dtau_R^T P of one factor; the map of an abelian group by exp, and of R^n, is the identity
local function turned_factor(kit, tau, xi, P)
  if kit.euclidean or kit.abelian and tau == "exp" then return P end
  local slope = tau == "exp" and kit.dexp or kit.dcay
  return linear.matrix_of(function(e) return slope(xi, e) end, kit.dimension):transpose() * P
end

-- dtau_R^T P, factor by factor
local function turned(S, tau, xi, P)
  local out, first = {}, 0
  for _, factor in ipairs(S.factors) do
    local n = factor.dimension
    local here = turned_factor(kits.of(factor), tau, part(xi, first, n), part(P, first, n))
    for i = 1, n do out[first + i] = here[i] end
    first = first + n
  end
  return out
end

--- The rule that steps the action S(q0, V, h) of stage velocities on a system with the place P;
-- beta: the weights of the velocities in xi, tau: "exp" or "cayley".
function M.rule(S, P, action, beta, tau, facts)
  local s, D, N = #beta, S.D, P.size
  local _, finish = place.chart(P, tau)
  local change = place.change(P, tau)
  local slope = core.derivative(action, N, s * D, "number")
  -- S_V, P, P - p and xi at a state
  local function evaluate(y, V, h)
    local q0 = core.vector(P.flat(space.at_identity(S, y.q)))
    local G, xi = slope(q0, V, h), core.zeros(D)
    for j = 1, s do xi = xi + part(V, (j - 1) * D, D) * (h * beta[j]) end
    local x, mu = space.parts(S, y.p)
    local first = {}
    for k = 1, S.d do first[k] = G[facts.places[k]] end
    local gain = space.joined(S, core.vector(first), core.zeros(S.r))
    return G, space.joined(S, S.d > 0 and x + core.vector(first) or x, mu), gain, xi
  end
  local function equation(y, V, h)
    local G, moved, _, xi = evaluate(y, V, h)
    local S1, out = turned(S, tau, xi, moved), {}
    for j = 1, s do
      for a = 1, D do
        out[#out + 1] = G[N + (j - 1) * D + a] - S1[a] * (h * beta[j])
      end
    end
    return core.vector(out)
  end
  local function after(y, V, h)
    local _, moved, gain, xi = evaluate(y, V, h)
    local all = (change or finish)(y.flat, xi, moved)
    local p = part(all, N, D)
    return { flat = part(all, 0, N), p = change and p + gain or p, V = V, W = y.V,
      made = y.made + 1 }
  end
  local arcs = tau == "exp" and kits.of(S.Q).arcs
  if arcs and #arcs(core.zeros(D)) == 0 then arcs = nil end
  return core.step { name = facts.name, unknowns = s * D, order = facts.order,
    parts = { { "V", s * D }, { "W", s * D }, { "made", 1 } },
    start = function(y)
      local k = core.where(y.made - 1.5, 1, 0)
      if s * D == 1 then return { y.V + k * (y.V - y.W) } end
      return y.V + (y.V - y.W) * k
    end,
    equation = equation, next = after, sums = change ~= nil,
    inside = arcs and function(_, V, h)
      local xi, out = core.zeros(D), {}
      for j = 1, s do xi = xi + part(V, (j - 1) * D, D) * (h * beta[j]) end
      for k, x in ipairs(arcs(xi)) do out[k] = math.pi ^ 2 - x end
      return out
    end or nil }
end

return M
