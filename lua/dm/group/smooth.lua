--- Functions that the exponential and its differential are made of, for numbers, symbols and
-- hyper-dual numbers: each is a power series of t with a closed form away from t = 0, and exact
-- derivatives on both sides.
local core = require "dm.core"

local M = {}

local sqrt, sin, cos, sinh, cosh = core.sqrt, core.sin, core.cos, core.sinh, core.cosh
local where, type = core.where, type

--- a where c > 0, else b; functions, so that numbers take one side only
local function choose(c, a, b)
  if type(c) == "number" then return c > 0 and a() or b() end
  return where(c, a(), b())
end

-- x where c > 0, else 1: what the side that is not taken computes with
local function guarded(c, x)
  if type(c) == "number" then return x end
  return where(c, x, 1)
end

local NEAR = 1  -- |t| below which the series stand: 12 terms leave 1e-20

-- coefficients 1/(2j + k)! of c_k, the last first
local series = {}
for k = 0, 5 do
  local list, factorial = {}, 1
  for i = 2, k do factorial = factorial * i end
  for j = 0, 11 do
    list[j] = (j % 2 == 0 and 1 or -1) / factorial
    factorial = factorial * (2 * j + k + 1) * (2 * j + k + 2)
  end
  series[k] = list
end

local function horner(list, t)
  local sum = list[#list]
  for j = #list - 1, 0, -1 do sum = sum * t + list[j] end
  return sum
end

local INVERSE_FACTORIAL = { [0] = 1, 1, 1 / 2, 1 / 6 }

-- c_0 .. c_5 away from 0, x = sqrt|t|, from the trigonometric functions or the hyperbolic ones
local closed = {}
closed[0] = function(x, _, hyper) return hyper and cosh(x) or cos(x) end
closed[1] = function(x, _, hyper) return (hyper and sinh(x) or sin(x)) / x end
-- (1 - cos x)/x^2 = 2 sin^2(x/2)/x^2 without the difference
closed[2] = function(x, _, hyper)
  local half = (hyper and sinh(0.5 * x) or sin(0.5 * x)) / x
  return 2 * half * half
end
for k = 3, 5 do
  closed[k] = function(x, t, hyper)
    return (INVERSE_FACTORIAL[k - 2] - closed[k - 2](x, t, hyper)) / t
  end
end

--- Stumpff's functions c_k(t) = sum_j (-t)^j / (2j + k)!, k = 0 .. 5: cos x, sin x / x, (1 - cos
-- x)/x^2, (x - sin x)/x^3 ... at t = x^2, hyperbolic for t < 0. c_k = 1/k! - t c_{k+2}, dc_k/dt =
-- (k c_{k+2} - c_{k+1})/2.
function M.stumpff(k, t)
  local far, below = t - NEAR, -NEAR - t
  return choose(far, function() return closed[k](sqrt(guarded(far, t)), t, false) end, function()
    return choose(below, function() return closed[k](sqrt(guarded(below, -t)), t, true) end,
      function() return horner(series[k], t) end)
  end)
end

-- coefficients (-1)^j/(2j + k)! of the same, the first first
local within = {}
for k = 0, 5 do
  local list, term = {}, series[k][0]
  for j = 0, 14 do
    list[j] = (j % 2 == 0 and 1 or -1) * term
    term = term / ((2 * j + k + 1) * (2 * j + k + 2))
  end
  within[k] = list
end

--- The same for 0 <= t <= pi^2, as within a chart: one polynomial of `terms` terms, no branch; four
-- of t^4, whose operations do not wait for each other (lie(1) in docs/benchmarks/groups.md).
function M.stumpff_within(k, t, terms)
  local t2 = t * t
  local t4, parts = t2 * t2, {}
  for i = 0, 3 do
    local list = {}
    for j = 0, (terms - 1 - i) // 4 do list[j] = within[k][4 * j + i] end
    parts[i] = horner(list, t4)
  end
  return (parts[0] + parts[1] * t) + (parts[2] + parts[3] * t) * t2
end

--- The same for t >= 0: two branches instead of three.
function M.stumpff_circular(k, t)
  local far = t - NEAR
  if type(t) == "number" then
    return far > 0 and closed[k](sqrt(t), t, false) or horner(series[k], t)
  end
  return choose(far, function()
    local safe = guarded(far, t)
    return closed[k](sqrt(safe), safe, false)
  end, function() return horner(series[k], t) end)
end

-- (1 - (x/2) cot(x/2))/x^2 = sum_j |B_2j|/(2j)! t^(j-1) with |B_2j|/(2j)! = 2 zeta(2j)/(2 pi)^(2j)
local bernoulli = { [0] = 1 / 12, 1 / 720, 1 / 30240, 1 / 1209600 }
for j = 5, 18 do
  local zeta = 1
  for n = 2, 63 do
    local term = n ^ (-2 * j)
    if term < 0x1p-53 then break end -- it and those behind it change nothing
    zeta = zeta + term
  end
  bernoulli[j - 1] = 2 * zeta / (2 * math.pi) ^ (2 * j)
end

local BERNOULLI_NEAR = 4  -- (4/(2 pi)^2)^18 is 1e-18

--- (1 - (x/2) cot(x/2))/x^2 at t = x^2 >= 0: dexpinv of so(3) is 1 - hat/2 + it hat^2. Infinite at
-- x = 2 pi.
function M.half_cotangent(t)
  local far = t - BERNOULLI_NEAR
  return choose(far, function()
    local safe = guarded(far, t)
    local x = 0.5 * sqrt(safe)
    local s = sin(x)
    if type(s) == "number" and math.abs(s) < 1e-13 * x then
      error("the differential of exp has no inverse here: the algebra element is a rotation by a "
        .. "multiple of 2 pi", 0)
    end
    return (1 - x * cos(x) / s) / safe
  end, function() return horner(bernoulli, t) end)
end

-- atan(y)/y = sum_j (-t)^j/(2j + 1), t = y^2 <= 1/25
local arc = {}
for j = 0, 11 do arc[j] = (j % 2 == 0 and 1 or -1) / (2 * j + 1) end

--- angle/|v| for the angle of (w, |v|), |v|^2 + w^2 = 1, w >= 0, s = |v|^2: two halvings of the
-- angle make it a quarter, whose tangent is at most tan(pi/8); another gives 8 atan(y)/y with y <=
-- 0.2. Smooth through s = 0.
function M.arc(w, s)
  local half = sqrt(2 * (1 + w))              -- 2 cos(angle/2)
  local quarter = 1 + w + half
  local d = quarter + sqrt(quarter * quarter + s)
  return 8 * horner(arc, s / (d * d)) / d
end

--- x/sin x where c = cos x, t = sin^2 x <= 1/16 of either sign (x/sinh x): atan(y)/y at y =
-- tan(x/2), doubled
function M.arc_signed(c, t)
  local d = 1 + c
  return 2 * horner(arc, t / (d * d)) / d
end

M.choose, M.guarded = choose, guarded

return M
