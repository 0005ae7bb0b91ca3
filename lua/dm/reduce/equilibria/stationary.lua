--- Relative equilibria of a reduced system, motions along the group alone: stationary points of the
-- amended potential, and how small motions about them behave. With R^ = M x'.x'/2 + gyroscopic
-- terms - V_mu: M y'' + S y' + K y = 0, S_ij = R_x'i xj - R_xi x'j, K = V_mu's Hessian. Stable by
-- energy where K is positive definite; spectrally where all characteristic values are imaginary
-- (Simo, Lewis & Marsden 1991).
local blame = require "dm.base.blame"
local branches = require "dm.reduce.equilibria.branch"
local core = require "dm.core"
local linear = require "dm.base.linear"
local model = require "dm.reduce.routh.model"

local M = {}

local abs, max, sqrt = math.abs, math.max, math.sqrt

-- what reduction knows, at the momentum mu (numbers or symbols)
local function at_momentum(info, mu)
  return setmetatable({ mu = mu }, { __index = info })
end

--- V_mu(x, mu) as a traced function of both, with exact derivatives.
function M.potential(info)
  model.derived(info)
  return core.trace(function(x, mu)
    return -model.routhian(at_momentum(info, mu), x, core.zeros(info.d), 0)
  end, info.d, info.m)
end

--- R(x, x', mu) likewise.
function M.routhian(info)
  return core.trace(function(x, u, mu)
    return model.routhian(at_momentum(info, mu), x, u, 0)
  end, info.d, info.d, info.m)
end

local MOST, SMALL = 40, 1e-13

local function rows_of(H, first, count, from)
  local out = {}
  for i = 1, count do
    out[i] = {}
    for k = 1, count do out[i][k] = H[first + i][from + k] end
  end
  return out
end

-- is a slope g none? Beside what it would be a length away, len[k] for each coordinate, and beside
-- what it is elsewhere, so that units do not matter
local function is_flat(g, H, d, scale)
  for i = 1, d do
    local size = 1e-6 * scale.slope[i]
    for k = 1, d do size = size + abs(H[i][k]) * scale.length[k] end
    if not (abs(g[i]) <= 1e-9 * size) then return false end
  end
  return true
end

local function length_of(step, d, scale)
  local size = 0
  for i = 1, d do size = max(size, abs(step[i]) / scale.length[i]) end
  return size
end

local function slope_of(g, d, scale)
  local size = 0
  for i = 1, d do
    size = max(size, scale.slope[i] > 0 and abs(g[i]) / scale.slope[i] or abs(g[i]))
  end
  return size
end

--- Lengths of the coordinates, and what the slopes of V are among the points: { length =, slope =
-- }, d numbers each.
function M.scale(V, points, lengths, mu, d)
  local seen, slope = {}, {}
  for i = 1, d do seen[i] = {} end
  for _, x in ipairs(points) do
    local fine, g = blame.try(V.gradient, V, core.vector(x), mu)
    for i = 1, fine and d or 0 do seen[i][#seen[i] + 1] = abs(g[i]) end
  end
  for i = 1, d do
    table.sort(seen[i])
    slope[i] = seen[i][#seen[i] // 2 + 1] or 0
  end
  return { length = lengths, slope = slope }
end

--- x with V_x = 0 by Newton's method from a start, with the step cut where the slope does not
-- shrink; nothing where it ends elsewhere.
function M.stationary(V, x, mu, d, scale)
  x = core.vector(x)
  local fine, g = blame.try(V.gradient, V, x, mu)
  if not fine then return nil end
  for _ = 1, MOST do
    local H = V:hessian(x, mu)
    local A, rest = rows_of(H, 0, d, 0), {}
    for i = 1, d do rest[i] = g[i] end
    local step = linear.solution(A, rest)
    if not step then return nil end
    local part, before = 1, slope_of(g, d, scale)
    local trial, slope
    repeat
      trial = core.vector(x)
      for i = 1, d do trial[i] = x[i] - part * step[i] end
      local there, new = blame.try(V.gradient, V, trial, mu)
      slope = there and new or nil
      part = part / 2
    until slope and (slope_of(slope, d, scale) < before
      or part == 0.5 and length_of(step, d, scale) < 1e-6) or part < 1e-3
    if not slope then return nil end
    local moved = length_of(trial - x, d, scale)
    x, g = trial, slope
    if moved <= SMALL then break end
    if part < 1e-3 then return nil end
  end
  return is_flat(g, V:hessian(x, mu), d, scale) and x or nil
end

--- The mass of the shape at rest, d2R/dx'2.
function M.mass(R, x, mu, d)
  return rows_of(R:hessian(core.vector(x), core.zeros(d), mu), d, d, d)
end

-- characteristic values of M y'' + S y' + K y = 0, as those of a matrix of twice the size
local function characteristic(mass, S, K, d)
  local order = linear.order(mass)
  if not order then return nil end
  local columns = {}
  for k = 1, d do
    columns[k], columns[d + k] = {}, {}
    for i = 1, d do columns[k][i], columns[d + k][i] = -K[i][k], -S[i][k] end
  end
  local solved, A = linear.solve(mass, columns, order), {}
  for i = 1, d do
    A[i], A[d + i] = {}, {}
    for k = 1, 2 * d do A[i][k], A[d + i][k] = k == d + i and 1 or 0, solved[k][i] end
  end
  return core.matrix(A):eigenvalues()
end

-- a value that is zero, relative to the largest: what round-off leaves along a family of equilibria
local FLAT = 1e-10

-- how many negative values K has, its index, and how many that are zero; in lengths of the mass, so
-- that units of coordinates do not matter
local function index_of(K, mass, d)
  local A, index, flat, size = {}, 0, 0, 0
  for i = 1, d do
    A[i] = {}
    for k = 1, d do A[i][k] = K[i][k] / sqrt(abs(mass[i][i] * mass[k][k])) end
  end
  local values = core.matrix(A):eigenvalues()
  for i = 1, d do size = max(size, abs(values[i])) end
  for i = 1, d do
    if abs(values[i]) <= FLAT * size then
      flat = flat + 1
    elseif values[i] < 0 then
      index = index + 1
    end
  end
  return index, flat
end

-- real part of a value that counts as imaginary, relative to the largest: double ones split by the
-- root of round-off
local CLOSE = 1e-6

--- What a stationary point is: energy, velocity of the group, characteristic values, stability.
-- Nothing where the mass or the locked inertia is singular: at a pole of the coordinates V_mu is
-- stationary along directions that are none.
function M.describe(info, R, V, x, mu)
  local d, u = info.d, core.zeros(info.d)
  local H = R:hessian(x, u, mu)
  local mass, cross, K = rows_of(H, d, d, d), rows_of(H, d, d, 0),
    rows_of(V:hessian(x, mu), 0, d, 0)
  local S = {}
  if not linear.order(mass) then return nil end
  for i = 1, d do
    S[i] = {}
    for k = 1, d do S[i][k] = cross[i][k] - cross[k][i] end
  end
  local list = {}
  for a = 1, info.m do list[a] = mu[a] end
  local rate = model.group_velocity(at_momentum(info, list), x, u, 0)
  for a = 1, info.m do
    if not (abs(rate[a]) < math.huge) then return nil end
  end
  local out = branches.equilibrium { x = x, mu = core.vector(list), energy = V(x, mu),
    velocity = core.vector(rate), values = {} }
  out.index, out.flat = index_of(K, mass, d)
  local re, im = characteristic(mass, S, K, d)
  local largest, growth = 1e-300, 0
  for i = 1, re and #re or 0 do
    out.values[i] = { re[i], im[i] }
    largest, growth = max(largest, sqrt(re[i] ^ 2 + im[i] ^ 2)), max(growth, re[i])
  end
  local spectral = re ~= nil and growth <= CLOSE * largest
  out.stable = out.index == 0 and out.flat == 0 and "energy" or spectral and "spectral" or false
  return out
end

return M
