--- Roots of polynomials, and what they say of a linear recurrence.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, sqrt, huge = math.abs, math.sqrt, math.huge

local function modulus(re, im) return sqrt(re * re + im * im) end

-- one step of Newton for root i of the polynomial c[1] + c[2] x + ..., where that makes the value
-- smaller
local function polish(c, re, im, i)
  local function value(x, y)
    local fr, fi, gr, gi = 0, 0, 0, 0
    for k = #c, 1, -1 do
      gr, gi = gr * x - gi * y + fr, gr * y + gi * x + fi
      fr, fi = fr * x - fi * y + c[k], fr * y + fi * x
    end
    return fr, fi, gr, gi
  end
  local fr, fi, gr, gi = value(re[i], im[i])
  local d = gr * gr + gi * gi
  if not (d > 0) then return end
  local x, y = re[i] - (fr * gr + fi * gi) / d, im[i] - (fi * gr - fr * gi) / d
  local nr, ni = value(x, y)
  if modulus(nr, ni) < modulus(fr, fi) then re[i], im[i] = x, y end
end

local function check_coefficients(c, what)
  if type(c) ~= "table" or #c < 2 then
    error(what .. " takes a table of at least two coefficients { c0, c1, ... }", 0)
  end
  for k = 1, #c do
    local x = c[k]
    if type(x) ~= "number" or not (abs(x) < huge) then
      error(("%s: coefficient %d must be a finite number"):format(what, k - 1), 0)
    end
  end
  local n = #c
  while n > 1 and c[n] == 0 do n = n - 1 end
  if n < 2 then error(what .. ": the polynomial is a constant", 0) end
  return n
end

local doc_roots = [[
dm.polynomial_roots{c0, c1, ..., cn} -> dm.vector, dm.vector
Real and imaginary parts of the roots of c0 + c1 x + ... + cn x^n, as eigenvalues of its companion
matrix, with a step of Newton.]]

-- c without leading zeros, and the eigenvalues of its companion matrix
local function raw_roots(given, what)
  local n = check_coefficients(given, what) - 1
  local c = table.move(given, 1, n + 1, 1, {})
  local companion = core.matrix(n, n)
  for i = 1, n do
    companion[i][n] = -c[i] / c[n + 1]
    if i < n then companion[i + 1][i] = 1 end
  end
  return c, companion:eigenvalues()
end

M.polynomial_roots = blame.caller(function(given)
  local c, re, im = raw_roots(given, "dm.polynomial_roots")
  for i = 1, #re do polish(c, re, im, i) end
  return re, im
end)

---- multiple roots ----

-- a root of multiplicity m scatters by the m-th root of round-off; its mean does not
local NEAR, VANISHES = 5e-3, 1e-11

-- value of the j-th derivative of the polynomial at x + iy over what its terms add up to without
-- signs
local function relative_derivative(c, j, x, y)
  local vr, vi, size, r = 0, 0, 0, modulus(x, y)
  for k = #c, j + 1, -1 do
    local f = c[k]
    for i = 0, j - 1 do f = f * (k - 1 - i) end
    vr, vi = vr * x - vi * y + f, vr * y + vi * x
    size = size * r + abs(f)
  end
  return size > 0 and modulus(vr, vi) / size or 0
end

local function is_multiple(c, x, y, m)
  for j = 0, m - 1 do
    if relative_derivative(c, j, x, y) > VANISHES then return false end
  end
  return true
end

-- roots that are one become their mean; how often each is one
local function join(c, re, im)
  local times, seen = {}, {}
  for i = 1, #re do
    if not seen[i] then
      local group = {}
      for k = i, #re do
        local apart = modulus(re[k] - re[i], im[k] - im[i])
        if not seen[k] and apart < NEAR * (1 + modulus(re[i], im[i])) then group[#group + 1] = k end
      end
      local x, y, m = 0, 0, #group
      for _, k in ipairs(group) do x, y = x + re[k] / m, y + im[k] / m end
      local one = m > 1 and is_multiple(c, x, y, m)
      for _, k in ipairs(one and group or { i }) do
        seen[k], times[k] = true, one and m or 1
        if one then re[k], im[k] = x, y end
      end
    end
  end
  return times
end

local CLOSE = 1e-9  -- of the unit circle

local doc_recurrence = [[
dm.recurrence{c0, c1, ..., cn} -> {stable, why, largest, re, im, times}
The linear recurrence c0 x_k + c1 x_(k+1) + ... + cn x_(k+n) = 0 by its characteristic roots:
bounded when none is outside the unit circle and none on it is multiple (times: multiplicities); the
sentence `why` says which it is.]]

M.recurrence = blame.caller(function(given)
  local c, re, im = raw_roots(given, "dm.recurrence")
  local times, at, multiple = join(c, re, im), 1, nil
  for i = 1, #re do
    if times[i] == 1 then polish(c, re, im, i) end
    if modulus(re[i], im[i]) > modulus(re[at], im[at]) then at = i end
    if times[i] > 1 and abs(modulus(re[i], im[i]) - 1) < CLOSE
      and times[i] > (multiple and times[multiple] or 1) then
      multiple = i
    end
  end
  local largest = modulus(re[at], im[at])
  local out = core.result { largest = largest, re = re, im = im, times = times,
    stable = largest <= 1 + CLOSE and not multiple }
  if largest > 1 + CLOSE then
    out.why = ("unstable: the root %.6g%+.6gi has modulus %.6g and grows by that factor in every "
      .. "step"):format(re[at], im[at], largest)
  elseif multiple then
    out.why = ("not bounded: the root %.6g%+.6gi on the unit circle has multiplicity %d, and "
      .. "what is fed into it, round-off too, grows like k^%d over k steps")
      :format(re[multiple], im[multiple], times[multiple], times[multiple] - 1)
  else
    out.why = ("bounded: all %d roots are in the closed unit circle, those on it simple")
      :format(#re)
  end
  return out
end)

core.docs[M.polynomial_roots], core.docs[M.recurrence] = doc_roots, doc_recurrence

return M
