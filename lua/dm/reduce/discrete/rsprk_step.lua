--- The reduced symplectic partitioned Runge-Kutta step as it is written down (Leok 2.5.14), with
-- the connection and the magnetic form: in x, s = p - mu A, with the Routhian R^ = R - B . x', B =
-- mu A, beta = dB,
--   S_i = R^_x'(X_i, X'_i),  S'_i = R^_x - i_X'i beta,  X_i = x0 + h sum a_ij X'_j,
--   S_i = s0 + h sum A_ij (S'_j + dB(X_j) X'_j) - (B(X_i) - B(x0)),
--   x1 = x0 + h sum b_j X'_j,  s1 = s0 + h sum b_j (S'_j + dB(X_j) X'_j) - (B(x1) - B(x0)).
-- It is the classical Routhian's step moved by B, which is what shape:solver takes; here is the
-- thing itself, to check that.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local model = require "dm.reduce.routh.model"
local option = require "dm.base.options"
local routh = require "dm.reduce.routh"
local tableau = require "dm.reduce.discrete.tableau"

local M = {}

-- B, dB (rows: component, columns: direction), beta and the slopes of R^, each of numbers or
-- symbols
local function ingredients(info, beta)
  local d = info.d
  local B = core.trace(function(x)
    local A, out = model.connection(info, x, 0), {}
    for j = 1, d do
      out[j] = 0
      for a = 1, info.m do out[j] = out[j] + info.mu[a] * A[a][j] end
    end
    return core.vector(out)
  end, d)
  local function magnetic(x, u) return model.routhian(info, x, u, 0) - B(x):dot(u) end
  local slope = core.derivative(magnetic, d, d)
  local dB = core.derivative(function(x) return B(x) end, d)
  local function exact(x)
    local J, out = dB(x), {}
    for i = 1, d do
      out[i] = {}
      for j = 1, d do out[i][j] = J[j][i] - J[i][j] end
    end
    return out
  end
  return { B = B, slope = slope, dB = dB, beta = beta or exact, d = d }
end

local function stage(k, X, U)
  local d, g, J, beta = k.d, k.slope(X, U), k.dB(X), k.beta(X)
  local S, rate = {}, {}
  for i = 1, d do
    S[i], rate[i] = g[d + i], g[i]
    for j = 1, d do rate[i] = rate[i] - beta[j][i] * U[j] + J[i][j] * U[j] end
  end
  return S, rate
end

-- sum of h w_j v_j over the stages, added to x
local function moved(x, h, w, v, d)
  local out = {}
  for i = 1, d do
    out[i] = x[i]
    for j = 1, #v do out[i] = out[i] + h * w[j] * v[j][i] end
  end
  return core.vector(out)
end

-- residuals of the stages, then x1, s1, as one function of (velocities, x0, s0)
local function make(k, a, A, b, h)
  local d, s = k.d, #b
  return core.trace(function(V, x0, s0)
    local U, X, S, rate, out = {}, {}, {}, {}, {}
    for i = 1, s do
      U[i] = {}
      for j = 1, d do U[i][j] = V[(i - 1) * d + j] end
      U[i] = core.vector(U[i])
    end
    for i = 1, s do
      X[i] = moved(x0, h, a[i], U, d)
      S[i], rate[i] = stage(k, X[i], U[i])
    end
    local B0 = k.B(x0)
    for i = 1, s do
      local right = moved(s0, h, A[i], rate, d) - (k.B(X[i]) - B0)
      for j = 1, d do out[#out + 1] = S[i][j] - right[j] end
    end
    local x1 = moved(x0, h, b, U, d)
    local s1 = moved(s0, h, b, rate, d) - (k.B(x1) - B0)
    for j = 1, d do out[#out + 1] = x1[j] end
    for j = 1, d do out[#out + 1] = s1[j] end
    return core.vector(out)
  end, s * d, d, d)
end

local MOST = 40

local function solve(f, V, x0, s0, count)
  local last = math.huge
  for _ = 1, MOST do
    local r, J, A, rest = f(V, x0, s0), f:jacobian(V, x0, s0), {}, {}
    for i = 1, count do
      A[i], rest[i] = {}, r[i]
      for j = 1, count do A[i][j] = J[i][j] end
    end
    local move, size, scale = linear.solution(A, rest), 0, 1
    if not move then error("rsprk: the equations of the stages are singular here", 0) end
    for i = 1, count do
      V[i] = V[i] - move[i]
      size, scale = math.max(size, math.abs(move[i])), math.max(scale, math.abs(V[i]))
    end
    if size <= 4e-16 * scale or (size >= last and size < 1e-11 * scale) then return f(V, x0, s0) end
    last = size
  end
  error("rsprk: the equations of the stages were not solved; is the step too long?", 0)
end

M.rsprk = blame.caller(function(shape, options)
  local info = routh.need(shape, "rsprk")
  option.check(options, { "rule", "h", "a", "b", "A", "beta" }, "shape:rsprk")
  option.need(options, "h", "shape:rsprk", "a step > 0")
  option.callable(options, "beta", "shape:rsprk", "x, that returns a matrix")
  option.positive(options, "h", "shape:rsprk", "a step")
  routh.need_free(info, "rsprk")
  routh.need_autonomous(info, "rsprk")
  local a, A, b = tableau.read(options)
  local k = ingredients(info, options.beta)
  local d, s = info.d, #b
  local f = make(k, a, A, b, options.h)
  return blame.caller(function(x0, s0)
    x0, s0 = kits.vector(x0, d, "x0"), kits.vector(s0, d, "s0")
    local u, V = shape:velocity(x0, s0 + k.B(x0)), {}
    for i = 1, s do for j = 1, d do V[(i - 1) * d + j] = u[j] end end
    local all, x1, s1 = solve(f, V, x0, s0, s * d), {}, {}
    for j = 1, d do x1[j], s1[j] = all[s * d + j], all[s * d + d + j] end
    return core.vector(x1), core.vector(s1)
  end)
end)

class.method("dm.system", "rsprk", M.rsprk, [[
shape:rsprk{rule=, h=, a=, b=, A=, beta=} -> function(x0, s0) -> x1, s1
One step of the reduced symplectic partitioned Runge-Kutta rule as it is written down (Leok 2.5.14),
in the momentum s = p - mu A(x) of the magnetic form (shape:magnetic_momentum): a check of
shape:solver{rule = "rsprk(...)"}, which takes the same steps quickly. rule: gauss(s) or lobatto(s);
or the coefficients a, b and, if they are not the partner, A, refused where they are not symplectic.
beta(x): another magnetic form, to see what it changes.]])

return M
