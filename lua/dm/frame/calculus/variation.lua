--- How normalized invariants and the invariant volume change with the curve (Kogan & Olver 2003,
-- Bogfjellmo 5.2-5.4): with theta^b = iota(du^b - u^b_x dx), the normalized variations, and nu^a =
-- R_i^a omega^i + S^a(theta), S = -(J psi)^-1 J theta_z,
--   d_V iota(u_K) = theta_K + sum_a iota(phi_K^a) S^a,
--   D_i theta_K = theta_(K,i) + R_i^a M_a theta,
--   d_V omega^k = B^k_j(theta) omega^j,
--   d_V D_j F = D_j d_V F - (D_i F) B^i_j,
-- where M_a theta_K is how the prolonged generator a moves the contact form theta_K.
local F = require "dm.frame.calculus.field"
local layout = require "dm.frame.calculus.layout"
local normal = require "dm.frame.calculus.normal"
local O = require "dm.frame.calculus.operators"
local multi_index = require "dm.action.multi_index"
local series = require "dm.frame.calculus.series"

local M = {}

---- contact forms ----

-- d phi/du - xi_u u_x of generator a, component c by b, as series at the normalized jet
local function moving(C, g, order)
  if C.moving and C.moving.order >= order then return C.moving end
  local n, r, out = C.n, C.r, { order = order }
  local flat = C.read_slopes(g.z, series.apply)
  local function slope(i, a, j)
    local x = flat[((i - 1) * r + a - 1) * n + j]
    return type(x) == "table" and x.terms and x or series.of(g.space, x ~= 0 and { x } or {})
  end
  for a = 1, r do
    out[a] = {}
    for c, k in ipairs(C.dependent) do
      out[a][c] = {}
      for b, l in ipairs(C.dependent) do
        local sum = slope(k, a, l)
        for i, clock in ipairs(C.independent) do
          sum = sum - slope(clock, a, l) * series.derivative(g.z[k], i)
        end
        out[a][c][b] = sum
      end
    end
  end
  out.clock = function(a, i, b) return slope(C.independent[i], a, C.dependent[b]).terms[1] or 0 end
  C.moving = out
  return out
end

local function expression(C, x) return F.is(x) and x or F.number(C.field, x) end

-- the places of L <= K with K - L and the factor K!/((K - L)! L!) * (K - L)! = K!/L!
local function below(C, place)
  local out, K = {}, C.words.list[place]
  for l, L in ipairs(C.words.list) do
    if C.words.order[l] > C.words.order[place] then break end
    local rest, factor = {}, 1
    for i = 1, C.p do
      rest[i] = K[i] - L[i]
      for j = L[i] + 1, K[i] do factor = factor * j end
    end
    if math.min(table.unpack(rest)) >= 0 then
      out[#out + 1] = { l, C.words.place[multi_index.key(rest)], factor }
    end
  end
  return out
end

-- M_a theta_K for component c: the operator
local function moved_form(C, a, c, place)
  local order = C.words.order[place]
  local g = normal.generators(C, order + 1)
  local slopes, out = moving(C, g, order + 1), O.identity(C)
  for _, row in ipairs(below(C, place)) do
    local l, rest, factor = row[1], row[2], row[3]
    for b = 1, C.q do
      local x = slopes[a][c][b].terms[rest]
      if x then out = O.add(C, out, M.theta(C, b, l), expression(C, x) * factor) end
    end
    for i = 1, rest ~= 1 and #C.independent or 0 do
      local x = g.xi[a][i].terms[rest]
      if x then
        out = O.add(C, out, M.theta(C, c, C.words.next[l][i]), expression(C, x) * -factor)
      end
    end
  end
  return out
end

--- theta_K of component c as an operator on the variations.
function M.theta(C, c, place)
  local key = place * 64 + c
  if C.thetas[key] then return C.thetas[key] end
  local out
  if place == 1 then
    out = O.identity(C, c)
  else
    local i, before = table.unpack(C.words.from[place])
    out = O.D(C, i, M.theta(C, c, before))
    for a = 1, C.r do
      local form = moved_form(C, a, c, before)
      if not O.is_zero(C, form) then
        local R = normal.rate(C, i, a)
        if not R:is_zero() then out = O.add(C, out, form, -R) end
      end
    end
  end
  C.thetas[key] = out
  return out
end

-- S^a(theta)
local function turning(C, a)
  if C.turned[a] then return C.turned[a] end
  local out = O.identity(C)
  for c, k in ipairs(C.section.entries) do
    local t, at = C.turning[a][c], layout.at(C, k)
    if not t:is_zero() and at.component then
      out = O.add(C, out, M.theta(C, at.component, at.place), normal.express(C, t))
    end
  end
  C.turned[a] = out
  return out
end

--- d_V iota(entry k).
function M.of_entry(C, k)
  local at = layout.at(C, k)
  local out = at.component and M.theta(C, at.component, at.place) or O.identity(C)
  for a = 1, C.r do
    local phi = normal.phi(C, a, k)
    if not phi:is_zero() then out = O.add(C, out, turning(C, a), phi) end
  end
  return out
end

--- B^k_j: d_V omega^k = B^k_j(theta) omega^j.
function M.of_clock(C, k, j)
  local key = k * 100 + j
  if C.clocks[key] then return C.clocks[key] end
  local out = O.identity(C)
  for a = 1, #C.independent > 0 and C.r or 0 do
    local x = normal.slope_of_clock(C, a, k, j)
    if not x:is_zero() then out = O.add(C, out, turning(C, a), x) end
    local slopes = moving(C, normal.generators(C, 1), 1)
    for b = 1, C.q do
      local slope = slopes.clock(a, k, b)
      if slope ~= 0 and not (F.is(slope) and slope:is_zero()) then
        local R = normal.rate(C, j, a)
        if not R:is_zero() then
          out = O.add(C, out, O.identity(C, b), R * expression(C, slope) * -1)
        end
      end
    end
  end
  C.clocks[key] = out
  return out
end

--- d_V of the variable D^K of invariant j.
function M.of_variable(C, j, place)
  local key = place * 64 + j
  if C.varied[key] then return C.varied[key] end
  local out
  if place == 1 then
    out = M.of_entry(C, C.named[j].entry)
  else
    local i, before = table.unpack(C.words.from[place])
    out = O.D(C, i, M.of_variable(C, j, before))
    local X = normal.invariant(C, j, before)
    for k = 1, C.p do
      local B = M.of_clock(C, k, i)
      if not O.is_zero(C, B) then out = O.add(C, out, B, -normal.D(C, k, X)) end
    end
  end
  C.varied[key] = out
  return out
end

---- of a Lagrangian ----

--- d_V(L omega) = P(theta) omega: the operator P.
function M.of_lagrangian(C, L)
  local out = O.identity(C)
  local uses = {}
  for v, info in pairs(L:uses()) do
    if info.invariant then uses[#uses + 1] = v end
  end
  table.sort(uses)
  for _, v in ipairs(uses) do
    local info = C.field.variables[v]
    local slope = F.partial(L, v)
    if not slope:is_zero() then
      out = O.add(C, out, M.of_variable(C, info.invariant, info.place), slope)
    end
  end
  for k = 1, C.p do
    local B = M.of_clock(C, k, k)
    if not O.is_zero(C, B) then out = O.add(C, out, B, L) end
  end
  return out
end

--- E_b(L), a list: the coefficient of each normalized variation.
function M.euler_lagrange(C, L)
  local P, out = M.of_lagrangian(C, L), {}
  for b = 1, C.q do out[b] = O.adjoint(C, P, b) end
  return out
end

return M
