--- Linear models with drag, gyroscopic terms and forcing: M x'' = D x' + K x + r(t) about an
-- equilibrium near the start, or about the start where L and the forces are quadratic and linear
-- anyway; with r(t) a sum of c t^k e^(mu t) (dm.scene.exponomials) the solution is a formula
-- (dm.scene.flow): variation of constants, forcing as further components of one matrix.
local blame = require "dm.base.blame"
local core = require "dm.core"
local equilibrium = require "dm.scene.equilibrium"
local exponomials = require "dm.scene.exponomials"
local flow = require "dm.scene.flow"
local modes = require "dm.scene.modes"

local M = {}

local abs, max, exp = math.abs, math.max, math.exp

local MOST = 66                -- components of the matrix, those of the forcing among them
local SAME = 1e-12             -- of the largest entry: derivatives at two places are equal
local NOTHING = 1e-4           -- tolerances: powers of time in a part of the solution

---- the equations ----

-- L and the force as sums of the terms that time is in, or is not in (still)
local function functions_of(problem, still)
  local n, L, force = problem.n, {}, {}
  for i = 1, n do force[i] = {} end
  for _, unit in ipairs(problem.units) do
    local list = unit.kind == "force" and force[unit.row] or L
    if unit.depends[3][1] ~= still then list[#list + 1] = unit.f end
  end
  local function sum(list, q, v, t)
    local out = 0
    for _, f in ipairs(list) do out = out + f(q, v, t) end
    return out
  end
  return { L = core.trace(function(q, v, t) return sum(L, q, v, t) end, n, n, "number"),
    F = core.trace(function(q, v, t)
      local out = {}
      for i = 1, n do out[i] = sum(force[i], q, v, t) end
      return core.vector(out)
    end, n, n, "number") }
end

-- M, D, K of M x'' = D x' + K x + ..., of what time is not in, by rows
local function matrices(problem, still, q)
  local n, rest, t = problem.n, core.zeros(problem.n), problem.t0
  local H, J = still.L:hessian(q, rest, t), still.F:jacobian(q, rest, t)
  local mass, D, K = {}, {}, {}
  for i = 1, n do
    mass[i], D[i], K[i] = {}, {}, {}
    for k = 1, n do
      mass[i][k] = H[n + i][n + k]
      D[i][k] = H[i][n + k] - H[n + i][k] + J[i][n + k]
      K[i][k] = H[i][k] + J[i][k]
    end
  end
  return core.matrix(mass), core.matrix(D), core.matrix(K)
end

-- are they the same everywhere?
local function is_linear(problem, still)
  local n, q = problem.n, problem.q + 0
  for i = 1, n do q[i] = q[i] + (1 + abs(q[i])) * (0.3 + i * 0.6180339887498949 % 1) end
  local a = { still.L:hessian(problem.q, problem.v, problem.t0),
    still.F:jacobian(problem.q, problem.v, problem.t0) }
  local b = { still.L:hessian(q, q, problem.t0), still.F:jacobian(q, q, problem.t0) }
  for k = 1, 2 do
    for i = 1, a[k].rows do
      local largest = 0
      for j = 1, a[k].columns do largest = max(largest, abs(a[k][i][j])) end
      for j = 1, a[k].columns do
        if not (abs(a[k][i][j] - b[k][i][j]) <= SAME * largest) then return false end
      end
    end
  end
  return true
end

-- what is at q, for dm.scene.equilibrium: the forces that time is not in, at rest
local function pull_of(problem, still)
  local n, rest = problem.n, core.zeros(problem.n)
  return function(q)
    local mass, _, K = matrices(problem, still, q)
    local slope = still.L:gradient(q, rest, problem.t0):slice(1, n)
    return slope + still.F(q, rest, problem.t0), -K, mass
  end
end

-- what pushes coordinate i at rest at q: L_q - d/dt L_v + F of the terms that time is in
local function push(problem, moving, q, i)
  local n, rest = problem.n, core.zeros(problem.n)
  local slope = core.derivative(moving.L, n, n, "number")
  local momentum = core.derivative(function(t) return slope(q, rest, t)[n + i] end, "number")
  return function(t) return slope(q, rest, t)[i] - momentum(t) + moving.F(q, rest, t)[i] end
end

-- the same of all terms, by coordinates; nil where one is no sum of exponomials
local function pushes(problem, still, q)
  local n, rest, out = problem.n, core.zeros(problem.n), {}
  local moving = functions_of(problem, false)
  local g, F = still.L:gradient(q, rest, problem.t0), still.F(q, rest, problem.t0)
  for i = 1, n do
    local terms = exponomials.of(push(problem, moving, q, i), problem.t0, problem.T)
    if not terms then return nil end
    terms[#terms + 1] = { k = 0, re = 0, im = 0, a = g[i] + F[i], b = 0 }
    out[i] = terms
  end
  return out
end

---- one matrix ----

-- z' = A z of z = (x, T v, forcing) in u = (t - t0)/T, by rows; z(0), eigenvalues, components;
-- nil where the forcing is no sum of such terms, or it is too long
local function equation(problem, still, q)
  local n, T, sums = problem.n, problem.T, pushes(problem, still, q)
  if not sums then return nil end
  local forcing, y, B, marks = exponomials.equation(sums, T)
  local N = 2 * n + #forcing
  if N > MOST then return nil end
  local mass, D, K = matrices(problem, still, q)
  local G = core.matrix(n, math.max(1, #forcing))
  for i = 1, n do for j, b in pairs(B[i]) do G[i][j] = b end end
  D, K, G = mass:solve(D), mass:solve(K), mass:solve(G)
  local A, z = {}, {}
  for i = 1, N do
    A[i] = {}
    for j = 1, N do A[i][j] = 0 end
  end
  for i = 1, n do
    A[i][n + i], z[i], z[n + i] = 1, problem.q[i] - q[i], T * problem.v[i]
    for k = 1, n do A[n + i][k], A[n + i][n + k] = T * T * K[i][k], T * D[i][k] end
    for j = 1, #forcing do A[n + i][2 * n + j] = T * T * G[i][j] end
  end
  for i, row in ipairs(forcing) do
    z[2 * n + i] = y[i]
    for j, a in pairs(row) do A[2 * n + i][2 * n + j] = a end
  end
  return A, z, marks, N
end

-- eigenvalues of the motion without forcing, then those of the forcing, marked
local function eigenvalues(A, n, marks)
  local rows = {}
  for i = 1, 2 * n do rows[i] = { table.unpack(A[i], 1, 2 * n) } end
  flow.balance(rows, 2 * n)
  local re, im = core.matrix(rows):eigenvalues()
  local out = {}
  for i = 1, 2 * n do out[i] = { re[i], im[i] } end
  for _, x in ipairs(marks) do out[#out + 1] = { x[1], x[2], forcing = true } end
  return out
end

---- what is watched ----

-- how much a complex vector moves what is watched, in tolerances
local function size_of(problem, p, rows)
  local n, worst = problem.n, 0
  for _, s in ipairs(rows) do
    local re, im = 0, 0
    for i = 1, n do
      re = re + s.row[i] * p.re[i] + s.row[n + i] * p.re[n + i] / problem.T
      im = im + s.row[i] * p.im[i] + s.row[n + i] * p.im[n + i] / problem.T
    end
    worst = max(worst, math.sqrt(re * re + im * im) / s.tolerance)
  end
  return worst
end

-- The same of a part of the solution. Powers of u that are nothing beside the tolerance fall off:
-- equal frequencies are one component.
local function seen(problem, part, rows)
  local growth, sum = max(1, exp(part.re)), 0
  for k = #part.P, 0, -1 do
    local size = growth * size_of(problem, part.P[k], rows)
    if sum + size <= NOTHING and k > 0 then part.P[k] = nil end
    sum = sum + size
  end
  part.count = math.min(part.count, (#part.P + 1) * (part.im == 0 and 1 or 2))
  return sum
end

-- entry i of the solution, z_i, at u
local function entry(parts, i, u)
  local out = 0
  for _, part in ipairs(parts) do
    local re, im = 0, 0
    for k = #part.P, 0, -1 do
      re, im = re * u + part.P[k].re[i], im * u + part.P[k].im[i]
    end
    local here = part.im == 0 and re or re * core.cos(part.im * u) - im * core.sin(part.im * u)
    out = out + (part.re == 0 and here or here * core.exp(part.re * u))
  end
  return out
end

-- q and v as functions of time
local function motion(problem, q, parts)
  local n, T = problem.n, problem.T
  return function(t)
    local u, x, v = (t - problem.t0) / T, {}, {}
    for i = 1, n do
      x[i] = q[i] + entry(parts, i, u)
      v[i] = entry(parts, n + i, u) / T
    end
    return core.vector(x), core.vector(v)
  end
end

---- models ----

local function is_plain(problem)
  local given = problem.given
  return problem.units and 2 * problem.n <= MOST and not (given.constraint or given.rolling
    or given.control or given.reaction or given.derivatives or problem.project)
end

local function model_of(problem, options)
  local n, still = problem.n, functions_of(problem, true)
  local is_exact = is_linear(problem, still)
  local q = equilibrium.near(problem.q, pull_of(problem, still)) or is_exact and problem.q
  if not q then return nil end
  local A, z, marks, N = equation(problem, still, q)
  if not A then return nil end
  local parts = flow.solve(A, z, eigenvalues(A, n, marks), N)
  if not parts then return nil end
  local rows, states = modes.sensitivities(problem, q, motion(problem, q, parts)), 0
  local left = modes.largest(parts, function(part) return seen(problem, part, rows) end)
  for _, part in ipairs(left) do states = states + part.count end
  return modes.solved(problem, options, math.min(n, max(1, (states + 1) // 2)),
    motion(problem, q, left), ("linear%s, %d of %d components, solved"):format(is_exact and ""
    or " about an equilibrium", states, 2 * n))
end

--- The linear model of a problem, solved, with the parts of the solution that are seen: a list,
-- empty where there is none. In modes where there is nothing but a potential, else by the whole
-- matrix, where no rules are named.
function M.models(problem, options)
  local in_modes = modes.models(problem, options)
  if #in_modes > 0 then return in_modes end
  if not is_plain(problem) or options.rules or options.frame then return {} end
  local fine, out = blame.try(model_of, problem, options)
  return fine and { out } or {}
end

return M
