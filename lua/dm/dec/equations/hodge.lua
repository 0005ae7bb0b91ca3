--- Harmonic forms and the decomposition of Hodge: a = d alpha + delta beta + h. With M the masses,
--   S = d^T M d + M d M^-1 d^T M,   S u = M (a - h),   alpha = delta u,   beta = d u.
-- S is positive semidefinite wherever the masses of the degrees above and below are positive, also
-- where some of its own are not, and its null space are the harmonic forms. It is made regular by a
-- little of a norm R: with F = (S + epsilon R)^-1 the error of x - F S x in what is not harmonic
-- shrinks by epsilon over an eigenvalue each time.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local linear = require "dm.base.linear"
local mass = require "dm.dec.equations.mass"
local matrices = require "dm.dec.equations.matrices"
local option = require "dm.base.options"
local solver = require "dm.dec.equations.solver"

local M = {}

-- of the largest eigenvalue of S in the norm R: of factors, and where conjugate gradients feel it
local EPSILON, EPSILON_GRADIENTS = 1e-10, 1e-8
local ROUNDS = 60      -- slivers have eigenvalues that are small beside epsilon: it takes many
local SETTLED = 1e-15  -- of the size of S x for a random x: S x is 0
local PART = 1e-7      -- of a random form: less is no harmonic part

-- S, the solver of S + epsilon R and the norm R of k-forms; once for a mesh
local function setting(K, k, pinv, where)
  return solver.once(K, ("hodge %d %s"):format(k, pinv and "pinv" or ""), function()
    local S, R = matrices.stiffness(K, k, nil, nil, pinv, where), mass.norm(K, k)
    local diagonal, most = S:diagonal(), 0
    for i = 1, #R do most = math.max(most, diagonal[i] / R[i]) end
    local shift = (core.solvers() and EPSILON or EPSILON_GRADIENTS) * math.max(most, 1e-300)
    local A = S + shift * matrices.diagonal(R)
    return { S = S, R = matrices.diagonal(R), M = matrices.diagonal(mass.of(K, k).values),
      solver = solver.new(A, nil, where), size = most }
  end)
end

-- x + F (b - S x) again and again, until b - S x is rounding or shrinks no more
local function refined(at, x, b)
  local r = b - at.S * x
  local first, last = r:norm(), math.huge
  for _ = 1, ROUNDS do
    local now = r:norm()
    if now <= SETTLED * first or now > 0.9 * last then break end
    last, x = now, x + at.solver:solve(r)
    r = b - at.S * x
  end
  return x
end

-- x without what it has of the others, in the product of A
local function orthogonal(x, others, A)
  for _ = 1, 2 do
    for _, h in ipairs(others) do x = x - (h:dot(A * x) / h:dot(A * h)) * h end
  end
  return x
end

local SPARE = 4 -- random forms more than are needed: one may have next to no harmonic part

-- A basis of the null space of S: what is left of one random form after the other. How many there
-- are is known from homology, in integers.
local function null_space(K, k, at, where)
  local basis, n, wanted = {}, K:count(k), K:betti()[k + 1]
  for which = 0, wanted + SPARE do
    if #basis == wanted then break end
    local x = orthogonal(core.start_vector(n, which), basis, at.R)
    local length = x:norm()
    x = orthogonal(refined(at, x, 0 * x), basis, at.R)
    if x:norm() > PART * length then basis[#basis + 1] = x / x:norm() end
  end
  if #basis < wanted then
    option.fail(where, "%d harmonic forms are there, %d were found: some cells are too flat",
      wanted, #basis)
  end
  return basis
end

-- orthonormal in the product of forms; where negative masses leave them without a norm, in that of
-- the moduli
local function orthonormal(basis, at)
  local out = {}
  for i, x in ipairs(basis) do
    x = orthogonal(x, out, at.M)
    local square = x:dot(at.M * x)
    if not (square > 1e-10 * x:dot(at.R * x)) then
      for j, y in ipairs(basis) do out[j] = y / y:dot(at.R * y) ^ 0.5 end
      return out
    end
    out[i] = x / square ^ 0.5
  end
  return out
end

local function harmonic_values(K, k, pinv, where)
  return solver.once(K, ("harmonic %d %s"):format(k, pinv and "pinv" or ""), function()
    local at = setting(K, k, pinv, where)
    return orthonormal(null_space(K, k, at, where), at)
  end)
end

class.method("dm.mesh", "harmonic", function(K, k, options)
  if math.type(k) ~= "integer" or k < 0 or k > K.dimension then
    option.fail("mesh:harmonic", "a degree from 0 to %d is needed (got %s)", K.dimension,
      option.got(k))
  end
  local pinv = option.check(options or {}, { "pinv" }, "mesh:harmonic").pinv
  local out = core.result {}
  for i, values in ipairs(harmonic_values(K, k, pinv, "mesh:harmonic")) do
    out[i] = form.new(K, k, "primal", values)
  end
  return out
end, [[
K:harmonic(k, {pinv=}) -> list of dm.form
A basis of the forms with d h = 0 and delta h = 0 of degree k, of norm 1 and orthogonal, as many as
the Betti number: with natural conditions at the boundary. Also where stars are negative, as long as
the forms have a norm. Raises "zero dual volume" with the cell where delta needs an inverse, unless
pinv = true.]])

---- decomposition ----

-- b - d alpha - delta beta = h: the coefficients of a in the basis, in the product of forms
local function projected(a, basis, at)
  if #basis == 0 then return 0 * a end
  local G, right = {}, {}
  for i, h in ipairs(basis) do
    G[i], right[i] = {}, h:dot(at.M * a)
    for j, g in ipairs(basis) do G[i][j] = h:dot(at.M * g) end
  end
  local c = linear.solution(G, right)
  if not c then
    option.fail("form:hodge",
      "the harmonic forms have no norm: the mesh has negative or zero stars")
  end
  local out = 0 * a
  for i, h in ipairs(basis) do out = out + c[i] * h end
  return out
end

-- u with S u = M b
local function potential_of(at, b)
  return refined(at, 0 * b, at.M * b)
end

-- of a primal form
local function decomposed(a, pinv)
  local K, k = a.mesh, a.degree
  local at = setting(K, k, pinv, "form:hodge")
  local basis = harmonic_values(K, k, pinv, "form:hodge")
  local h = projected(a.values, basis, at)
  local function of(values) return form.new(K, k, "primal", values) end
  local u = of(potential_of(at, a.values - h))
  local alpha = k > 0 and u:delta { pinv = pinv } or nil
  local beta = k < K.dimension and u:d() or nil
  local exact = alpha and alpha:d() or of(0 * a.values)
  return { exact = exact, coexact = beta and a - of(h) - exact or of(0 * a.values),
    harmonic = of(h), potential = alpha, copotential = beta, report = at.solver:report() }
end

-- Of a dual form of degree n - k: that of its star, whose coexact part is the star of the exact
-- one. The signs are those of star star and of delta = +- star d star.
local function decomposed_dual(a, pinv)
  local n, k = a.mesh.dimension, a.mesh.dimension - a.degree
  local b = decomposed(a:star { pinv = pinv }, pinv)
  local function sign(power) return power % 2 == 0 and 1 or -1 end
  local function back(part) return sign(k * (n - k)) * part:star { pinv = pinv } end
  local up = k * (n - k) + n * (n - k) + 1 + (k - 1) * (n - k + 1)
  return { exact = back(b.coexact), coexact = back(b.exact), harmonic = back(b.harmonic),
    potential = b.copotential and sign(n * k + 1) * b.copotential:star { pinv = pinv },
    copotential = b.potential and sign(up) * b.potential:star { pinv = pinv }, report = b.report }
end

class.method("dm.form", "hodge", function(a, options)
  local pinv = option.check(options or {}, { "pinv" }, "form:hodge").pinv
  return core.result(a.side == "dual" and decomposed_dual(a, pinv) or decomposed(a, pinv))
end, [[
a:hodge{pinv=} -> { exact, coexact, harmonic, potential, copotential, report }
The decomposition of Hodge: a = exact + coexact + harmonic, orthogonal; exact = d potential, coexact
= delta copotential. Degree 0 has no potential, degree n no copotential. report says which solver
ran. Raises "zero dual volume" with the cell where delta needs an inverse, unless pinv = true, and
where negative stars leave the harmonic forms without a norm (Leok 3.12).]])

return M
