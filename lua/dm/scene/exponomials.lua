--- Functions of time that are sums of c s^k e^(mu s), s = t - t0, mu complex: what forces an
-- equation with constant coefficients and leaves its solution a formula. Sines, exponentials,
-- powers of t and products of them are recognized by the equation b'' = kappa b that they solve.
-- A term { k, re, im, a, b } stands for s^k e^(re s) (a cos(im s) + b sin(im s)), im >= 0.
local core = require "dm.core"

local M = {}

local abs, sqrt, max = math.abs, math.sqrt, math.max

local SAMPLES = 61      -- times at which an equation must hold
local SOLVES = 1e-11    -- of the sizes of its terms
local EQUAL = 4e-15     -- of exponents: round-off
local MOST_POWER = 8

-- x and y have one exponent and one power
local function alike(x, y)
  local size = EQUAL * (abs(x.re) + abs(x.im))
  return x.k == y.k and abs(x.re - y.re) <= size and abs(x.im - y.im) <= size
end

local function add(sum, x)
  if x.im < 0 then x.im, x.b = -x.im, -x.b end
  if x.im == 0 then x.b = 0 end
  for _, y in ipairs(sum) do
    if alike(x, y) then
      y.a, y.b = y.a + x.a, y.b + x.b
      return
    end
  end
  if x.a ~= 0 or x.b ~= 0 then sum[#sum + 1] = x end
end

-- Re(C e^x) Re(D e^y) = Re(C D e^(x + y) + C D* e^(x + y*))/2, C = a - i b
local function product(f, g)
  local out = {}
  for _, x in ipairs(f) do
    for _, y in ipairs(g) do
      local k, re = x.k + y.k, x.re + y.re
      for _, sign in ipairs { 1, -1 } do
        add(out, { k = k, re = re, im = x.im + sign * y.im,
          a = (x.a * y.a - sign * x.b * y.b) / 2, b = (x.b * y.a + sign * x.a * y.b) / 2 })
      end
    end
  end
  return out
end

-- s, value, first and second derivative of a function of time at irregular times
local function samples_of(f, t0, T)
  local out = {}
  for i = 0, SAMPLES do
    local s = i == 0 and 0 or T * (i % 3 == 0 and 10 ^ (-6 * i / SAMPLES)
      or (i - i * 0.6180339887498949 % 1) / SAMPLES)
    out[i + 1] = { s, f(t0 + s), f:gradient(t0 + s)[1], f:hessian(t0 + s)[1][1] }
  end
  return out
end

-- { c + d s } where it is that
local function line_of(samples)
  local c, d = samples[1][2], samples[1][3]
  for _, x in ipairs(samples) do
    if not (x[4] == 0 and abs(x[2] - c - d * x[1]) <= SOLVES * (abs(c) + abs(d * x[1]))) then
      return nil
    end
  end
  return { { k = 0, re = 0, im = 0, a = c, b = 0 }, { k = 1, re = 0, im = 0, a = d, b = 0 } }
end

-- kappa where b'' = kappa b at all samples
local function kappa_of(samples)
  local most, kappa = 0, nil
  for _, x in ipairs(samples) do
    if abs(x[2]) > most then most, kappa = abs(x[2]), x[4] / x[2] end
  end
  if not kappa or kappa == 0 or kappa ~= kappa then return nil end
  for _, x in ipairs(samples) do
    local size = abs(kappa) * abs(x[2]) + sqrt(abs(kappa)) * abs(x[3])
    if not (abs(x[4] - kappa * x[2]) <= SOLVES * size) then return nil end
  end
  return kappa
end

-- the rate r where b' = r b at all samples, r^2 = kappa
local function rate_of(samples, kappa)
  for _, rate in ipairs { sqrt(kappa), -sqrt(kappa) } do
    local fits = true
    for _, x in ipairs(samples) do
      fits = fits and abs(x[3] - rate * x[2]) <= SOLVES * abs(rate * x[2])
    end
    if fits then return rate end
  end
end

-- a function that is no sum or product, and the rate where it is one exponential
local function recognized(samples)
  local line = line_of(samples)
  if line then return line end
  local kappa, c, d = kappa_of(samples), samples[1][2], samples[1][3]
  if not kappa then return nil end
  local w = sqrt(abs(kappa))
  if kappa < 0 then return { { k = 0, re = 0, im = w, a = c, b = d / w } } end
  local rate = rate_of(samples, kappa)
  if rate then return { { k = 0, re = rate, im = 0, a = c, b = 0 } }, rate end
  return { { k = 0, re = w, im = 0, a = (c + d / w) / 2, b = 0 },
    { k = 0, re = -w, im = 0, a = (c - d / w) / 2, b = 0 } }
end

-- base^power; nil where it is no such function
local function power_of(base, power, t0, T)
  local x, rate = recognized(samples_of(base, t0, T))
  if not x then return nil end
  if rate and x[1].a > 0 then
    return { { k = 0, re = power * rate, im = 0, a = x[1].a ^ power, b = 0 } }
  end
  if power % 1 ~= 0 or power < 1 or power > MOST_POWER then return nil end
  local out = x
  for _ = 2, power do out = product(out, x) end
  return out
end

-- one term of a sum
local function term_of(f, t0, T)
  local c, factors = f:factors()
  local out = { { k = 0, re = 0, im = 0, a = c, b = 0 } }
  for _, factor in ipairs(factors) do
    local x = power_of(factor.base, factor.power, t0, T)
    if not x then return nil end
    out = product(out, x)
  end
  return out
end

--- The terms of a function f(t) on [t0, t0 + T], a list; nil where some part of it is unlike them.
function M.of(f, t0, T)
  local out = {}
  for _, term in ipairs(core.trace(f, "number"):terms()) do
    local parts = term_of(term, t0, T)
    if not parts then return nil end
    for _, x in ipairs(parts) do add(out, x) end
  end
  return out
end

---- as an equation ----

-- { re, im, highest power } of all terms of several sums
local function exponents(sums)
  local out = {}
  for _, sum in ipairs(sums) do
    for _, x in ipairs(sum) do
      local known
      for _, y in ipairs(out) do
        if alike({ k = 0, re = x.re, im = x.im }, y) then known = y end
      end
      if not known then
        known = { k = 0, re = x.re, im = x.im, most = 0 }
        out[#out + 1] = known
      end
      known.most, x.of = max(known.most, x.k), known
    end
  end
  return out
end

--- Equation and values of the terms of several sums in u = s/T: y' = A y, y(0), sum_i = B_i . y;
-- A by rows, and the eigenvalues { re, im } of A. s^k is kept as u^k.
function M.equation(sums, T)
  local A, y, values, N = {}, {}, {}, 0
  local function row() N = N + 1; A[N], y[N] = {}, 0; return N end
  local list = exponents(sums)
  for _, e in ipairs(list) do
    e.cos, e.sin = {}, {}
    for k = 0, e.most do
      e.cos[k], e.sin[k] = row(), e.im > 0 and row() or nil
      local c, s = e.cos[k], e.sin[k]
      A[c][c], values[#values + 1] = e.re * T, { e.re * T, e.im * T }
      if s then
        A[c][s], A[s][c], A[s][s] = -e.im * T, e.im * T, e.re * T
        values[#values + 1] = { e.re * T, -e.im * T }
      end
      if k > 0 then A[c][e.cos[k - 1]] = k end
      if k > 0 and s then A[s][e.sin[k - 1]] = k end
    end
    y[e.cos[0]] = 1
  end
  local B = {}
  for i, sum in ipairs(sums) do
    B[i] = {}
    for _, x in ipairs(sum) do
      local c, s = x.of.cos[x.k], x.of.sin[x.k]
      B[i][c] = (B[i][c] or 0) + x.a * T ^ x.k
      if s then B[i][s] = (B[i][s] or 0) + x.b * T ^ x.k end
    end
  end
  return A, y, B, values
end

return M
