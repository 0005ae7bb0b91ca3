--- Noether's theorem in invariants, for curves: Ad(rho)^-1 v = c (Bogfjellmo 5.4; Goncalves &
-- Mansfield 2012). With P = sum c_K D^K of d_V(L omega) = P(theta) omega and w_a the variation
-- theta(v_a) = iota(phi_a - u_x xi_a) of the generator a at normalized jets,
--   v_a = sum_K sum_(j < K) (-D)^j c_K  D^(K - 1 - j) w_a + L iota(xi_a),
-- where D w_a stands for D w_a + (ad_R)_ca w_c, since generators at the curve are those at the
-- normalized one turned by Ad(rho). On extremals D v + ad_R^T v = 0.
local core = require "dm.core"
local groups = require "dm.group"
local F = require "dm.frame.calculus.field"
local linear = require "dm.base.linear"
local layout = require "dm.frame.calculus.layout"
local normal = require "dm.frame.calculus.normal"
local variation = require "dm.frame.calculus.variation"

local M = {}

-- c[b][a][k]: [e_b, e_a] = sum c e_k
local function structure(C)
  if C.structure then return C.structure end
  local kit, out = groups.kit(C.action.group), {}
  for b = 1, C.r do
    out[b] = {}
    for a = 1, C.r do
      out[b][a] = kit.ad(linear.unit(C.r, b), linear.unit(C.r, a))
    end
  end
  C.structure = out
  return out
end

-- d/ds of the row x (r expressions) that is turned by Ad(rho): D x_a + sum R^b c_ba^k x_k
function M.derivative(C, x)
  local c, out = structure(C), {}
  for a = 1, C.r do
    local sum = normal.D(C, 1, x[a])
    for b = 1, C.r do
      for k = 1, C.r do
        if c[b][a][k] ~= 0 and not x[k]:is_zero() then
          sum = sum + normal.rate(C, 1, b) * x[k] * c[b][a][k]
        end
      end
    end
    out[a] = sum
  end
  return out
end

-- iota(phi_a^c - u_x xi_a), all a
local function variations(C, c)
  local k, out = C.dependent[c], {}
  for a = 1, C.r do
    out[a] = normal.phi(C, a, k)
    if #C.independent > 0 then
      local xi = normal.phi(C, a, C.independent[1])
      if not xi:is_zero() then
        out[a] = out[a] - normal.entry(C, layout.derivative(C, k, 1)) * xi
      end
    end
  end
  return out
end

--- v_1 ... v_r, and w[c], of an L.
function M.of(C, L)
  local P, v, w = variation.of_lagrangian(C, L), {}, {}
  for a = 1, C.r do
    local xi = #C.independent > 0 and normal.phi(C, a, C.independent[1])
    v[a] = xi and L * xi or F.number(C.field, 0)
  end
  for c = 1, C.q do
    local rates, most = { [0] = variations(C, c) }, 0
    w[c] = rates[0]
    for place in pairs(P[c]) do most = math.max(most, C.words.order[place]) end
    for m = 1, most - 1 do rates[m] = M.derivative(C, rates[m - 1]) end
    for place, coefficient in pairs(P[c]) do
      local factor = coefficient
      for m = C.words.order[place] - 1, 0, -1 do
        for a = 1, C.r do v[a] = v[a] + factor * rates[m][a] end
        factor = -normal.D(C, 1, factor)
      end
    end
  end
  return v, w
end

---- at a jet ----

--- The frame of a jet of numbers: a group element.
function M.frame(C, jet)
  if not C.frame then
    local order = math.max(1, C.section.order)
    local lifted = C.section.order == 0 and C.action
      or C.action:jet(order, C.parametrized and nil or { independent = C.given_independent })
    C.frame = require "dm.frame".near_identity { action = lifted,
      cross_section = C.given.cross_section,
      branch = C.given.branch, solution = C.given.solution }
    C.frame_length = C.section.order == 0 and C.n or layout.length(C, order)
  end
  local short = {}
  for i = 1, C.frame_length do short[i] = jet[i] end
  return C.frame(core.vector(short))
end

--- The jet moved by its frame.
function M.normalized(C, jet, rho)
  local order = 0
  while layout.length(C, order) < #jet do order = order + 1 end
  if order == 0 then return C.action(rho, jet) end
  C.lifts[order] = C.lifts[order]
    or C.action:jet(order, C.parametrized and nil or { independent = C.given_independent })
  return C.lifts[order](rho, jet)
end

-- E of iota(u_J) = D^K kappa_j + E, and the entry u_J, the derivative K of that of the invariant:
-- D_i iota(u_J) = iota(u_(J,i)) + sum_a R_i^a iota(phi_J^a), along the word of K
local function rest_of(C, j, place)
  if place == 1 then return F.number(C.field, 0), C.named[j].entry end
  local key = j * 100000 + place
  local known = C.rests[key]
  if known then return known[1], known[2] end
  local i, less = table.unpack(C.words.from[place])
  local before, k = rest_of(C, j, less)
  local sum = normal.D(C, i, before)
  for a = 1, C.r do
    local phi = normal.phi(C, a, k)
    if not phi:is_zero() then sum = sum - normal.rate(C, i, a) * phi end
  end
  known = { F.reduced(sum), layout.derivative(C, k, i) }
  C.rests[key] = known
  return known[1], known[2]
end

--- The variable of invariant j, place, as it is at a normalized jet I: iota of the entry that is
-- the derivative of the invariant's, less what else is in its formula.
function M.invariant(C, I, known, j, place)
  local key = j * 100000 + place
  if known[key] then return known[key] end
  local order = layout.order(C, C.named[j].entry) + C.words.order[place]
  if layout.length(C, order) > #I then
    error(("the jet is too short: it needs derivatives of order %d"):format(order), 0)
  end
  if known[key] == false then error("an invariant is needed for its own value", 0) end
  known[key] = false
  local rest, k = rest_of(C, j, place)
  known[key] = I[k] - F.map(rest, function(_, info)
    return M.invariant(C, I, known, info.invariant, info.place)
  end)
  return known[key]
end

return M
