-- Eigenforms where cells have no dual volume: 1-forms on a torus of N^2 squares, whose diagonals
-- have no mass, have the eigenvalues 4 N^2 (sin^2 pi a/N + sin^2 pi b/N) of the five-point scheme,
-- each twice.
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local abs, max, pi, sin = math.abs, math.max, math.pi, math.sin

if not require "dm.core".solvers() then
  ok(true, "eigenforms of cells without mass # SKIP dm/sparse.so is not there")
  return tap.done()
end

local function spectrum(N)
  local out = {}
  for a = 0, N - 1 do
    for b = 0, N - 1 do
      local value = 4 * N ^ 2 * (sin(pi * a / N) ^ 2 + sin(pi * b / N) ^ 2)
      out[#out + 1], out[#out + 2] = value, value
    end
  end
  table.sort(out)
  return out
end

-- the largest part of delta d at cells without mass, where nothing balances it
local function pull(K, form)
  local massless, worst = K:star_weights(1), 0
  local curl = K:boundary_sum(2, K:star_values(2, form:d().values, "dual"))
  for i = 1, #massless do worst = massless[i] == 0 and max(worst, abs(curl[i])) or worst end
  return worst
end

for _, case in ipairs { { 3, 10 }, { 4, 10 }, { 5, 2 }, { 8, 6 }, { 12, 1 } } do
  local N, count = table.unpack(case)
  local K = dm.mesh { square_torus = N }
  local found, want = K:laplacian(1):eigen(count), spectrum(N)
  local value, residual, norm, pulled = 0, 0, 0, 0
  for i, form in ipairs(found.forms) do
    value = max(value, abs(found.values[i] - want[i]))
    residual = max(residual, found.residuals[i])
    norm, pulled = max(norm, abs(form:norm() - 1)), max(pulled, pull(K, form))
  end
  local name = (" of %d eigenforms on %d x %d squares"):format(count, N, N)
  ok(#found.forms == count and value < 1e-11, "values" .. name, value)
  near(residual, 0, 1e-11, "residuals" .. name)
  near(norm, 0, 1e-12, "norms" .. name)
  near(pulled, 0, 1e-11, "no curl pulls at the diagonals" .. name)
end
-- 18 edges of 27 have mass
local all = dm.mesh { square_torus = 3 }:laplacian(1):eigen(27)
ok(#all.values == 17 and all.note:find "left out", "the one that is left out is told", all.note)
ok(dm.mesh { square_torus = 3 }:laplacian(1):eigen(10).note == nil, "where it was asked for")
tap.raises("1 of the 1 cells that are left have zero dual volume", function()
  dm.mesh { grid = 1 }:laplacian(1, { fixed = "boundary" }):eigen(1)
end)
tap.done()
