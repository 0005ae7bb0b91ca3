--- psi_mu of a discrete Lagrangian that the group leaves as it is: the angle for which dLd/dpsi
-- (x0, x1, psi) = mu, and its derivatives. Ld depends on theta1 - theta0 alone, so that the second
-- derivatives by psi follow from the mixed ones, -D1D2 Ld.
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local linear = require "dm.base.linear"
local model = require "dm.reduce.routh.model"
local shape_of = require "dm.reduce.routh.shape"

local M = {}

local abs, max = math.abs, math.max

---- Ld in (theta, x) ----

local function transposed_times(J, p, n)
  local out = {}
  for k = 1, n do
    out[k] = 0
    for i = 1, n do out[k] = out[k] + J[i][k] * p[i] end
  end
  return out
end

-- J0^T T J1
local function sandwich(J0, T, J1, n)
  local out = {}
  for i = 1, n do
    out[i] = {}
    for k = 1, n do
      local sum = 0
      for a = 1, n do
        for b = 1, n do sum = sum + J0[a][i] * T[a][b] * J1[b][k] end
      end
      out[i][k] = sum
    end
  end
  return out
end

--- The function of (q0, q1) -> -D1 Ld, D2 Ld, -D1D2 Ld, lists: of a formula traced once, of a rule
-- by its solver.
function M.slopes(Ld)
  local n, f, h, params = Ld.Q.dimension, Ld.Ld, Ld.h, Ld.params
  if not f then
    return function(q0, q1)
      return Ld:legendre_minus(q0, q1), Ld:legendre_plus(q0, q1), Ld:two_form(q0, q1)
    end
  end
  local traced = core.trace(function(q0, q1) return f(q0, q1, h, params) end, n, n)
  return function(q0, q1)
    local g, H, p0, p1, T = traced:gradient(q0, q1), traced:hessian(q0, q1), {}, {}, {}
    for i = 1, n do
      p0[i], p1[i], T[i] = -g[i], g[n + i], {}
      for k = 1, n do T[i][k] = -H[i][n + k] end
    end
    return p0, p1, T
  end
end

-- p0 = -D1 Ld, p1 = D2 Ld, T = -D1D2 Ld at ((0, x0), (psi, x1)), in the order of (theta, x) of the
-- reduction
local function ends(D, x0, x1, psi)
  local info = D.info
  local q0, q1 = model.embed(info, x0), model.embed(info, x1, psi)
  if not info.ambient then
    local p0, p1, T = D.slopes(q0, q1)
    return p0, p1, T, q0, q1
  end
  local ones = info.ambient.frame
  local Q0, J0 = ones(q0)
  local Q1, J1 = ones(q1)
  local n, p0, p1, T = info.n, D.slopes(Q0, Q1)
  return transposed_times(J0, p0, n), transposed_times(J1, p1, n), sandwich(J0, T, J1, n), Q0, Q1
end

--- Does a formula Ld depend on theta1 - theta0 alone, -D1 Ld = D2 Ld along the group? At the points
-- at which L was looked at, which are in its domain.
function M.check_invariance(D)
  local info = D.info
  for _, p in ipairs(info.points) do
    local x, u, psi = model.split(info, p.q), model.split(info, p.v), {}
    for a = 1, info.m do psi[a] = 0.2 + 0.1 * a end
    local y = {}
    for j = 1, info.d do y[j] = x[j] + math.min(D.h, 0.1) * u[j] end
    local fine, p0, p1 = pcall(ends, D, x, y, psi)
    for _, i in ipairs(fine and info.cyclic or {}) do
      if abs(p0[i] - p1[i]) > 1e-8 * max(1, abs(p0[i])) then
        error(("this Ld is not invariant: its momenta along '%s' are %.6g at q0 and %.6g at q1, "
          .. "for x0 = %s, x1 = %s")
          :format(info.names[i], p0[i], p1[i], check.text(x), check.text(y)), 0)
      end
    end
  end
end

---- psi_mu ----

local MOST = 60

-- d2Ld/dpsi2, m x m
local function bend(info, T)
  local out = {}
  for a, i in ipairs(info.cyclic) do
    out[a] = {}
    for b, k in ipairs(info.cyclic) do out[a][b] = T[i][k] end
  end
  return out
end

local function no_solution(D, x0, x1, why)
  error(("no psi_mu between x0 = %s and x1 = %s: %s; is the step too long for this momentum (h "
    .. "= %.6g)?")
    :format(tostring(core.vector(x0)), tostring(core.vector(x1)), why, D.h), 0)
end

-- psi with dLd/dpsi = mu, and what belongs to it; Newton's method from `guess`, halved where it
-- does not come nearer
local function solve(D, x0, x1, guess)
  local info, psi = D.info, {}
  for a = 1, info.m do psi[a] = guess[a] end
  local function rest(at)
    local p0, p1, T, q0, q1 = ends(D, x0, x1, at)
    local r, size = {}, 0
    for a, i in ipairs(info.cyclic) do r[a] = info.mu[a] - p1[i]; size = max(size, abs(r[a])) end
    return { p0 = p0, p1 = p1, T = T, q0 = q0, q1 = q1, r = r, size = size, psi = at }
  end
  local now = rest(psi)
  for _ = 1, MOST do
    local I = bend(info, now.T)
    local order = linear.order(I)
    if not order then no_solution(D, x0, x1, "d2Ld/dpsi2 is singular on the way") end
    local step, part, next_one = linear.solve(I, { now.r }, order)[1], 1, nil
    repeat
      local trial = {}
      for a = 1, info.m do
        trial[a] = now.psi[a] + part * step[a]
        if not (abs(trial[a]) < math.huge) then
          no_solution(D, x0, x1, "d2Ld/dpsi2 vanishes, so that no angle gives the momentum")
        end
      end
      next_one = rest(trial)
      part = part / 2
    until next_one.size < now.size or part < 1e-4
    local moved, scale = 0, 1e-300
    for a = 1, info.m do
      moved, scale = max(moved, abs(next_one.psi[a] - now.psi[a])), max(scale, abs(next_one.psi[a]))
    end
    local done = moved <= 4e-16 * scale or next_one.size >= now.size
    if next_one.size < now.size then now = next_one end
    if done then break end
  end
  local scale = 1
  for a = 1, info.m do scale = max(scale, abs(info.mu[a])) end
  if not (now.size <= 1e-10 * scale) then
    no_solution(D, x0, x1, ("what is left of dLd/dpsi - mu is %.3g"):format(now.size))
  end
  return now
end

-- h theta' of the straight line from x0 to x1
local function first_guess(D, x0, x1)
  local info, x, u = D.info, {}, {}
  for j = 1, info.d do x[j], u[j] = (x0[j] + x1[j]) / 2, (x1[j] - x0[j]) / D.h end
  local fine, rate = pcall(function() return shape_of.rate_of(info)(x, u, 0) end)
  local out = {}
  for a = 1, info.m do out[a] = fine and abs(rate[a]) < math.huge and D.h * rate[a] or 0 end
  return out
end

-- all of a pair: p0, p1, T, psi, and psi_x0, psi_x1 (lists of d rows of m)
function M.pair(D, x0, x1, guess)
  local info = D.info
  local s = solve(D, x0, x1, guess or first_guess(D, x0, x1))
  local I, columns = bend(info, s.T), {}
  local order = linear.order(I)
  for j, k in ipairs(info.shape) do  -- -L_psi,x0 = T[x0][theta], -L_psi,x1 = -T[theta][x1]
    columns[j], columns[info.d + j] = {}, {}
    for a, i in ipairs(info.cyclic) do
      columns[j][a], columns[info.d + j][a] = s.T[k][i], -s.T[i][k]
    end
  end
  local solved = linear.solve(I, columns, order)
  s.by0, s.by1 = {}, {}
  for j = 1, info.d do s.by0[j], s.by1[j] = solved[j], solved[info.d + j] end
  return s
end

return M
