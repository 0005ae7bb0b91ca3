--- A:eigen: eigenvalues and eigenforms of self-adjoint operators in the product of their forms,
-- from S x = lambda M x. Small problems by dense rotations, which know every multiplicity; large
-- ones by Lanczos iterations with shift and invert.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local mass = require "dm.dec.equations.mass"
local matrices = require "dm.dec.equations.matrices"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local solver = require "dm.dec.equations.solver"

local M = {}

local WHERE = "operator:eigen"
local SMALL = 300 -- unknowns up to which dense rotations are always taken
local ASYMMETRY = 1e-9 -- of a self-adjoint operator, at most

local function fail(...) option.fail(WHERE, ...) end

-- the masses of the forms that A maps, all >= 0
local function masses(A)
  local K, cells = A.mesh, operator.listed(A.mesh, A.from)
  local values = mass.positive(K, cells, WHERE)
  return A.from.side == "primal" and values or mass.inverse(K, cells, false, WHERE)
end

-- a length of the mesh, to the power -2: what low eigenvalues of Laplacians are measured in
local function low(K) return K:volume(K.dimension):sum() ^ (-2 / K.dimension) end

local LEAST = 1e-280 -- what S is made of keeps its digits down to here

-- entries of S are masses times eigenvalues, and doubles
local function check_size(K, weights)
  local most = 0
  for i = 1, #weights do most = math.max(most, weights[i]) end
  local size = most * low(K)
  if most > 0 and not (size > LEAST and size < 1 / LEAST) then
    fail("masses times eigenvalues are about %.1e, which leaves the range of numbers: measure the "
      .. "mesh in another unit of length", size)
  end
end

-- S and M of what is free
local function pencil(A)
  if A.from.degree ~= A.to.degree or A.from.side ~= A.to.side then
    fail("the operator maps %s %d-forms to %s %d-forms: it has no eigenvalues", A.from.side,
      A.from.degree, A.to.side, A.to.degree)
  end
  local weights = A.weights or masses(A)
  check_size(A.mesh, weights)
  local S = A.stiffness or A.matrix:scale(weights)
  local asymmetry = S:asymmetry()
  if asymmetry > ASYMMETRY then
    fail("the operator is not self-adjoint: a . (A b) and (A a) . b differ by %.2g", asymmetry)
  end
  if not A.keep then return S, weights end
  return S:pick(A.keep, A.keep), core.pick(weights, A.keep)
end

-- which eigenvalues are asked for: a number that says how good each is, the less the better;
-- nothing for one that is not asked for
local function order_of(options)
  local above, near = options.above, options.near
  if above then return function(x) return x > above and x - above or nil end end
  near = near or 0
  return function(x) return math.abs(x - near) end
end

-- the m best of a list of pairs
local function best(pairs_, m, rank)
  local list = {}
  for _, pair in ipairs(pairs_) do
    pair.rank = rank(pair.value)
    if pair.rank then list[#list + 1] = pair end
  end
  table.sort(list, function(a, b) return a.rank < b.rank end)
  return table.move(list, 1, math.min(m, #list), 1, {})
end

local function zipped(values, vectors, residuals)
  local out = {}
  for i = 1, #vectors do
    out[i] = { value = values[i], vector = vectors[i], residual = residuals[i] }
  end
  return out
end

local function at_eigenvalue(shift)
  fail("the shift %.12g is an eigenvalue: move it a little", shift)
end

local function count_zeros(weights)
  local zeros = 0
  for i = 1, #weights do zeros = zeros + (weights[i] == 0 and 1 or 0) end
  return zeros
end

local NEAR = 1e-13 -- of the largest eigenvalue: nothing tells values that are nearer apart

local function dense(S, weights, m, options)
  local values, vectors, residuals = S:all_eigenpairs(weights)
  local shift = options.above or options.near
  local size = math.max(math.abs(values[1]), math.abs(values[#values]))
  for i = 1, shift and #values or 0 do
    if math.abs(values[i] - shift) <= NEAR * size then at_eigenvalue(shift) end
  end
  return best(zipped(values, vectors, residuals), m, order_of(options)), "dense rotations"
end

-- the distance from the shift to the nearest eigenvalue, by inverse iterations
local function distance(factor, M_)
  local x = core.start_vector(factor.unknowns)
  for _ = 1, 3 do x = factor:solve(M_ * x) / x:norm() end
  return 1 / x:norm()
end

-- an estimate of the largest eigenvalue
local function largest(S, weights)
  local diagonal, most = S:diagonal(), 0
  for i = 1, #weights do
    if weights[i] > 0 then most = math.max(most, math.abs(diagonal[i]) / weights[i]) end
  end
  return most
end

-- the factor of S - shift M; Cholesky where no eigenvalue should be below the shift
local function factored(S, weights, shift, lowest)
  local M_ = matrices.diagonal(weights)
  local shifted = S - shift * M_
  local factor = lowest and shifted:factor "cholesky" or shifted:factor "lu"
  local zeros = not factor and count_zeros(weights) or 0
  if zeros > 0 then
    fail("%d cells have zero dual volume and leave the eigenvalue problem singular: %s", zeros,
      mass.REMEDY)
  end
  if not factor or distance(factor, M_) < NEAR * largest(S, weights) then at_eigenvalue(shift) end
  return factor
end

local FACTORS = { cholesky = "Cholesky factors (CHOLMOD)",
  lu = "LU factors (UMFPACK) of an indefinite matrix" }

-- how many eigenvalues lie below x, or nothing
local function below(S, weights, x) return (S - x * matrices.diagonal(weights)):negatives() end

-- How many eigenvalues the iteration has left out that are better than the worst it found: by the
-- law of inertia, up to a little before that one, so that a cluster may be cut: of zeros too, which
-- rounding spreads, so that little is at least a part of `unit`.
local function left_out(S, weights, pairs_, options, unit)
  local from, worst = options.above or options.near, pairs_[#pairs_].value
  local reach = options.near and pairs_[#pairs_].rank or worst - (from or 0)
  local high, low_ = (from or 0) + reach, options.near and from - reach or from
  local margin = 1e-7 * math.max(math.abs(high), math.abs(low_ or 0), unit)
  high, low_ = high - margin, low_ and options.near and low_ + margin or low_
  if low_ and high <= low_ then return 0 end
  local found, there = 0, below(S, weights, high)
  for _, pair in ipairs(pairs_) do
    if pair.value < high and pair.value > (low_ or -math.huge) then found = found + 1 end
  end
  local less = low_ and below(S, weights, low_) or not low_ and 0
  return there and less and there - less - found or 0
end

local ROUNDS = 4

-- around a given shift, or from a shift below all eigenvalues (above those of negative operators)
local function lanczos(A, S, weights, m, options)
  local given, most = options.above or options.near, S.rows - 1 - count_zeros(weights)
  local sign = not given and S:diagonal():sum() < 0 and -1 or 1
  local unit = low(A.mesh)
  local shift = given or -unit
  if sign < 0 then S = -1 * S end
  local factor = factored(S, weights, shift, not given)
  local rank, count, pairs_, missing, all = order_of(options), m, nil, 0, 0
  for _ = 1, ROUNDS do
    local values, vectors, residuals, solves =
      S:eigenpairs(weights, factor, shift, count, options.above ~= nil)
    pairs_, all = best(zipped(values, vectors, residuals), m, rank), all + solves
    local counts = given or factor.kind == "cholesky"
    missing = #pairs_ > 0 and counts and left_out(S, weights, pairs_, options, unit) or 0
    if missing <= 0 or count == most then break end
    count = math.min(most, count + missing + 2)
  end
  if missing > 0 then fail("%d eigenvalues are left out: ask for more, or for fewer", missing) end
  for _, pair in ipairs(pairs_) do pair.value = sign * pair.value end
  return pairs_, ("Lanczos iterations (ARPACK), %s"):format(FACTORS[factor.kind]), all
end

local ONE_LESS = "Lanczos iterations have one less than there are: the farthest is left out"

-- pairs, which solver found them, its solves and what to know of them
local function find(A, m, options)
  local S, weights = pencil(A)
  local n, zeros = S.rows, count_zeros(weights)
  local has_library, why = core.solvers()
  local can_be_dense = n <= solver.MOST_DENSE and zeros == 0
  if n == 0 then fail("every cell is fixed: nothing is left") end
  if can_be_dense and (n <= SMALL or m > n // 4 or not has_library) then
    return dense(S, weights, m, options)
  end
  if not has_library then
    fail("eigenvalues of %d unknowns%s: %s", n, zeros > 0 and ", some of zero dual volume," or "",
      why)
  end
  -- what has no mass has no eigenvalue that is finite
  local most = n - 1 - zeros
  if most < 1 then
    fail("%d of the %d cells that are left have zero dual volume: %s", zeros, n, mass.REMEDY)
  end
  local pairs_, name, solves = lanczos(A, S, weights, math.min(m, most), options)
  return pairs_, name, solves, m > most and #pairs_ == most and ONE_LESS or nil
end

local SURE = 1e-6 -- of an eigenvalue, or of the least beside it that is not 0
local TOLD = 10   -- times the residual: such an eigenvalue is not 0

-- what eigenvalues that may be 0 are measured in: the least that is not, in the units of A; without
-- one that of Laplacians of a wave across the longest edge
local function least(K, values, residuals)
  local out, longest, lengths = math.huge, 0, K:volume(1)
  for i = 1, #values do
    local size = math.abs(values[i])
    if size > TOLD * residuals[i] then out = math.min(out, size) end
  end
  if out < math.huge then return out end
  for i = 1, #lengths do longest = math.max(longest, lengths[i]) end
  return longest ^ -2
end

-- Low eigenvalues of meshes of needles and flakes are round-off of the largest ones.
local function doubt(K, values, residuals)
  local unit, doubtful, worst = least(K, values, residuals), 0, 0
  for i = 1, #values do
    if residuals[i] > SURE * math.max(math.abs(values[i]), unit) then
      doubtful, worst = doubtful + 1, math.max(worst, residuals[i])
    end
  end
  return doubtful > 0 and ("%d of %d values are known to %.1e only (residuals): round-off of the "
    .. "largest eigenvalues; cells are too thin, or too many in a row"):format(doubtful, #values,
    worst) or nil
end

local function check(m, options)
  if math.type(m) ~= "integer" or m < 1 then
    fail("how many eigenvalues must be a whole number >= 1 (got %s)", option.got(m))
  end
  option.check(options, { "above", "near" }, WHERE)
  option.number(options, "above", WHERE)
  option.number(options, "near", WHERE)
  if options.above and options.near then fail("give one of 'above' and 'near'") end
end

class.method("dm.operator", "eigen", function(A, m, options)
  options = options or {}
  check(m, options)
  local pairs_, name, solves, note = find(A, m, options)
  local values, residuals, forms = {}, {}, core.result {}
  for i, pair in ipairs(pairs_) do
    local x = A.keep and core.spread(pair.vector, A.keep) or pair.vector
    values[i], residuals[i] = pair.value, pair.residual
    forms[i] = form.new(A.mesh, A.from.degree, A.from.side, x)
  end
  return core.result { values = core.vector(values), forms = forms,
    residuals = core.vector(residuals), solver = name, solves = solves,
    note = doubt(A.mesh, values, residuals) or mass.note(A.mesh) or note }
end, [[
A:eigen(m, {above=, near=}) -> { values, forms, residuals, solver, note }
m eigenvalues of a self-adjoint operator, in the product of the forms that it maps, and eigenforms
of norm 1: those nearest to 0, with near = x nearest to x, with above = x the least beyond x; the
best first. Fewer where there are no more. residuals: |A a - lambda a|, and an eigenvalue is no
farther away. note: values are round-off of the largest ones, as in a mesh of very thin cells, duals
are barycentric, with which eigenvalues do not converge, or the farthest of all is left out. Up to
300 unknowns (1200 where many are asked for) by dense rotations, else by Lanczos iterations, which
need dm/sparse.so (libsuitesparse-dev, libarpack2-dev). Raises where x is an eigenvalue, where the
operator is not self-adjoint, and where negative stars leave the forms without a norm. u' = -A u,
with A = K:laplacian(0) heat or the gradient flow of |du|^2/2, has the solution sum_k exp(-values[k]
t) (forms[k] . u0) forms[k].]])

return M
