--- Roots of polynomials, and what they say of a linear recurrence.
local blame = require "dm.blame"
local core = require "dm.core"

local M = {}

local abs, sqrt, huge = math.abs, math.sqrt, math.huge

local function modulus(re, im) return sqrt(re * re + im * im) end

-- one step of Newton for each root of the polynomial c[1] + c[2] x + ..., where that makes the value smaller
local function polish(c, re, im)
  local function value(x, y)
    local fr, fi, gr, gi = 0, 0, 0, 0
    for k = #c, 1, -1 do
      gr, gi = gr * x - gi * y + fr, gr * y + gi * x + fi
      fr, fi = fr * x - fi * y + c[k], fr * y + fi * x
    end
    return fr, fi, gr, gi
  end
  for i = 1, #re do
    local fr, fi, gr, gi = value(re[i], im[i])
    local d = gr * gr + gi * gi
    if d > 0 then
      local x, y = re[i] - (fr * gr + fi * gi) / d, im[i] - (fi * gr - fr * gi) / d
      local nr, ni = value(x, y)
      if modulus(nr, ni) < modulus(fr, fi) then re[i], im[i] = x, y end
    end
  end
end

local function check_coefficients(c, what)
  if type(c) ~= "table" or #c < 2 then error(what .. " takes a table of at least two coefficients { c0, c1, ... }", 0) end
  for k, x in ipairs(c) do
    if type(x) ~= "number" or not (abs(x) < huge) then error(("%s: coefficient %d must be a finite number"):format(what, k - 1), 0) end
  end
  local n = #c
  while n > 1 and c[n] == 0 do n = n - 1 end
  if n < 2 then error(what .. ": the polynomial is a constant", 0) end
  return n
end

local doc_roots = [[
dm.polynomial_roots{c0, c1, ..., cn} -> dm.vector, dm.vector
Real and imaginary parts of the roots of c0 + c1 x + ... + cn x^n, as eigenvalues of its companion matrix, with a step of Newton.]]

M.polynomial_roots = blame.caller(function(c)
  local n = check_coefficients(c, "dm.polynomial_roots") - 1
  local companion = core.matrix(n, n)
  for i = 1, n do
    companion[i][n] = -c[i] / c[n + 1]
    if i < n then companion[i + 1][i] = 1 end
  end
  local re, im = companion:eigenvalues()
  polish(table.move(c, 1, n + 1, 1, {}), re, im)
  return re, im
end)

local CLOSE = 1e-6  -- roots nearer than this are one: a double root is known to the root of round-off

local doc_recurrence = [[
dm.recurrence{c0, c1, ..., cn} -> {stable, why, largest, re, im}
The linear recurrence c0 x_k + c1 x_(k+1) + ... + cn x_(k+n) = 0 by its characteristic roots: bounded when none is outside the unit circle and
none on it is double; the sentence `why` says which it is.]]

M.recurrence = blame.caller(function(c)
  check_coefficients(c, "dm.recurrence")
  local re, im = M.polynomial_roots(c)
  local largest, at = 0, 1
  for i = 1, #re do
    local m = modulus(re[i], im[i])
    if m > largest then largest, at = m, i end
  end
  local double
  for i = 1, #re do
    for k = i + 1, #re do
      if modulus(re[i] - re[k], im[i] - im[k]) < CLOSE and modulus(re[i], im[i]) > 1 - CLOSE then double = i end
    end
  end
  local out = { largest = largest, re = re, im = im, stable = largest <= 1 + CLOSE and not double }
  if largest > 1 + CLOSE then
    out.why = ("unstable: the root %.6g%+.6gi has modulus %.6g and grows by that factor in every step"):format(re[at], im[at], largest)
  elseif double then
    out.why = ("not bounded: the root %.6g%+.6gi on the unit circle is double and grows in proportion to the steps"):format(re[double], im[double])
  else
    out.why = ("bounded: all %d roots are in the closed unit circle, those on it simple"):format(#re)
  end
  return out
end)

core.docs[M.polynomial_roots], core.docs[M.recurrence] = doc_roots, doc_recurrence

return M
