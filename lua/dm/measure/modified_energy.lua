--- The modified energy of a symplectic rule, from a run: what the rule conserves in place of H.
--
-- A symplectic rule follows, up to exponentially small terms, the exact flow of a modified
-- Hamiltonian H~ (Hairer, Lubich & Wanner IX). Along it dS = p dq - H~ dt, and S over a step is the
-- discrete Lagrangian Ld. So
--   H~ = (int p dq - sum Ld) / (2 h)  over two steps,
-- int p dq of the polynomials through 2 k + 1 points of the run (error h^2k). Ld is had from the
-- rule itself by a passive coordinate y = 0 with the momentum P_y: with z' y' + (1 + y) L in place
-- of L, P_y grows by Ld in every step; for L = v M v/2 - V(q), where explicit rules want no product
-- with v, with z' y' + L - y (V - q . V_q/2), and Ld is the growth of P_y + q . p/2.
-- Constraints do not see y, and what they do to p is no work along the motion.
-- On a group p dq is <mu, g^-1 dg>: that of its flat coordinates with any p above mu.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local flats = require "dm.group.flat"
local has_own_time = require "dm.base.own_time"
local lifts = require "dm.measure.lifts"
local option = require "dm.base.options"
local starts = require "dm.base.start"

local M = {}

local abs, max, cos, pi = math.abs, math.max, math.cos, math.pi

---- int over [-1, 1] of l_i(s) l'_j(s) for the nodes -k .. k ----

-- nodes and weights of Gauss on [-1, 1]
local function gauss(r)
  local x, w = {}, {}
  for i = 1, r do
    local z, slope = cos(pi * (i - 0.25) / (r + 0.5)), nil
    for _ = 1, 100 do
      local p0, p1 = 1, z
      for j = 2, r do p0, p1 = p1, ((2 * j - 1) * z * p1 - (j - 1) * p0) / j end
      slope = r * (z * p1 - p0) / (z * z - 1)
      local step = p1 / slope
      z = z - step
      if abs(step) < 1e-16 then break end
    end
    x[i], w[i] = z, 2 / ((1 - z * z) * slope * slope)
  end
  return x, w
end

-- l_i(s) and l'_i(s) of the nodes -k .. k
local function lagrange(k, s)
  local value, slope = {}, {}
  for i = -k, k do
    local product, sum = 1, 0
    for j = -k, k do
      if j ~= i then product = product * (s - j) / (i - j) end
    end
    for m = -k, k do
      if m ~= i then
        local term = 1 / (i - m)
        for j = -k, k do
          if j ~= i and j ~= m then term = term * (s - j) / (i - j) end
        end
        sum = sum + term
      end
    end
    value[i], slope[i] = product, sum
  end
  return value, slope
end

local function weights(k)
  local x, w = gauss(2 * k + 1)
  local W = {}
  for i = -k, k do W[i] = {} for j = -k, k do W[i][j] = 0 end end
  for g = 1, #x do
    local value, slope = lagrange(k, x[g])
    for i = -k, k do
      for j = -k, k do W[i][j] = W[i][j] + w[g] * value[i] * slope[j] end
    end
  end
  return W
end

---- the system with y and z ----

local function head(x, n)
  local out = {}
  for i = 1, n do out[i] = x[i] end
  return core.vector(out)
end

local function extended(system, separable)
  local given, n = system.given, system.Q.dimension
  local held = bound(given.constraint, given.params)
  local L = function(q, v) return given.L(q, v, 0, given.params) end
  local y, z = n + 1, n + 2
  if not separable then
    return core.system { Q = core.R(n + 2), L = function(x, u)
      return u[y] * u[z] + (1 + x[y]) * L(head(x, n), head(u, n))
    end, constraint = held and function(x) return held(head(x, n), 0) end }
  end
  local rest = {}
  for i = 1, n do rest[i] = 0 end
  rest = core.vector(rest)
  local V = function(q) return -L(q, rest) end
  local slope = core.derivative(V, n)
  return core.system { Q = core.R(n + 2), L = function(x, u)
    local q = head(x, n)
    return u[y] * u[z] + L(q, head(u, n)) - x[y] * (V(q) - 0.5 * q:dot(slope(q)))
  end }
end

-- is L = v M v/2 - V(q)?
local function is_simple(system)
  local s = system:structure()
  if not (s.separable and s.constant_mass) then return false end
  local n, rest, here = system.Q.dimension, {}, {}
  for i = 1, n do rest[i], here[i] = 0, 0.1 * i end
  local fine, p = blame.try(system.momentum, system, here, rest)
  return fine and p:norm() == 0
end

-- on a group, on G x R^2
local function extended_on_group(system)
  local given, n = system.given, system.place.dimension
  local held = bound(given.constraint, given.params)
  return core.system { Q = core.product(system.Q, core.R(2)),
    L = function(g, u)
      local L = given.L(g[1], head(u, n), 0, given.params)
      return u[n + 1] * u[n + 2] + (1 + g[2][1]) * L
    end,
    constraint = held and function(g) return held(g[1], 0) end,
    trivialization = system.place.right and "right" or "left" }
end

---- along the run ----

local function columns(path, n)
  local q, p = {}, {}
  for i = 1, n do q[i], p[i] = path:column("q" .. i):totable(), path:column("p" .. i):totable() end
  return q, p
end

-- flat coordinates of the group in every row, and a p with p . dq = <mu, g^-1 dg>
local function columns_on_group(path, own)
  local N, d = own.size, own.dimension
  local X = flats.directions(own, N, d, own.right)
  local q, p, rows, mu = {}, {}, {}, {}
  for i = 1, N do q[i], p[i] = path:column("q" .. i):totable(), {} end
  for a = 1, d do mu[a] = path:column("p" .. a):totable() end
  for r = 1, #path do
    for i = 1, N do rows[i] = q[i][r] end
    local here, at = {}, X(rows)
    for a = 1, d do here[a] = mu[a][r] end
    local above = at * (at:transpose() * at):solve(core.vector(here))
    for i = 1, N do p[i][r] = above[i] end
  end
  return q, p
end

-- S up to every row
local function actions(path, q, p, n, simple)
  local S = path:column("p" .. n + 1):totable()
  if not simple then return S end
  for r = 1, #S do
    local sum = 0
    for i = 1, n do sum = sum + q[i][r] * p[i][r] end
    S[r] = S[r] + 0.5 * sum
  end
  return S
end

local function series(path, system, k, h, simple)
  local own, n = system.place, system.Q.dimension
  local S, W, out, q, p
  if own then q, p = columns_on_group(path, own) else q, p = columns(path, n) end
  S, W, out = actions(path, q, p, n, simple), weights(k), {}
  for r = 1 + k, #S - k do
    local sum = 0
    for i = 1, #q do
      local qi, pi_, q0 = q[i], p[i], q[i][r]
      for a = -k, k do
        local row, inner = W[a], 0
        for b = -k, k do inner = inner + row[b] * (qi[r + b] - q0) end
        sum = sum + inner * pi_[r + a]
      end
    end
    out[#out + 1] = (sum - (S[r + 1] - S[r - 1])) / (2 * h)
  end
  return out
end

local function check(solver, options)
  local what = "solver:modified_energy"
  option.check(options, { "q", "v", "p", "steps", "points" }, what, "{ q =, v =, steps = }")
  local system = solver.system
  local given = system.given
  local s = given and given.L and system:structure()
  if tostring(solver.rule):find "^degenerate" then
    error(what .. ": not for rule '" .. tostring(solver.rule)
      .. "': L is linear in v, and its H is the energy itself", 0)
  end
  if not s or not s.autonomous or given.rolling or given.force then
    error(what .. " needs a Lagrangian without time, rolling and forces", 0)
  end
  if has_own_time(solver) then
    error(what .. ": '" .. tostring(solver.rule)
      .. "' has a time of its own; the energy it keeps is H itself", 0)
  end
  local k = option.whole(options, "points", what, 1, 10, 6)
  option.whole(options, "steps", what, 2 * k + 3, 2 ^ 24) -- all rows are kept
  option.need(options, "q", what, "the start is q and v, or q and p")
  if not (options.v or options.p) then
    error(what .. ": give the start as q and v or as q and p", 0)
  end
  option.need(options, "steps", what, ("at least %d"):format(2 * k + 3))
  return system, k
end

local doc = [[
solver:modified_energy{q=, v= | p=, steps=, points=} -> {energy, H, mean, amplitude, drift, ...}
What a symplectic rule keeps in place of H: the modified energy along a run, from int p dq of the
polynomials through 2 points + 1 (default 13) neighbouring points and the discrete Lagrangian of
every step, (int p dq - Ld)/h; right to h^(2 points), so for steps that resolve the motion. energy,
H, t: vectors, the modified energy and H at the same rows; amplitude: the largest distance of the
modified energy from its mean; drift: its slope per unit of time with its standard error: round-off
for a symplectic rule. Needs a Lagrangian without time, rolling and forces; under constraints all
rules that take a mass of any kind (not rattle); on groups all but rotations(k).]]

-- the start of the system with y and z, where both and their momenta are 0
local function start_of(system, options)
  local n, p = system.Q.dimension, options.p or system:legendre(options.q, options.v)
  local x, momentum = {}, {}
  for i = 1, n do momentum[i] = p[i] end
  momentum[n + 1], momentum[n + 2] = 0, 0
  if not system.place then
    for i = 1, n do x[i] = options.q[i] end
    x[n + 1], x[n + 2] = 0, 0
    return x, momentum
  end
  return { system.place.kit.element(options.q), core.zeros(2) }, momentum
end

-- the run of the system with y and z
local function run_extended(solver, system, simple, options)
  local q, p = start_of(system, options)
  local whole = system.place and extended_on_group(system) or extended(system, simple)
  local fine, path = blame.try(function()
    return whole:solver { rule = solver.rule, h = solver.h,
      newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } }
      :run { q = q, p = p, steps = options.steps }
  end)
  if fine then return path end
  if type(path) == "string" and path:find "cannot step" then
    error(("solver:modified_energy: '%s' does not step the system with its action beside it (%s)")
      :format(tostring(solver.rule), path:match "cannot step this system: ([^;]*)"
        or "lie(s) and gauss(s) do"), 0)
  end
  error(path, 0)
end

-- a rule that does not see multiples of coordinates keeps what it keeps on R^N
local function by_coordinates(solver, options)
  local own, system, to = solver.system.place, lifts.lifted(solver)
  local q = core.vector(own.flat(own.kit.element(options.q)))
  local p = options.p or solver.system:legendre(options.q, options.v)
  return system:solver { rule = solver.rule, h = solver.h,
    newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } },
    { q = q, p = to(q, core.vector(p)), steps = options.steps, points = options.points }
end

M.modified_energy = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  local system, k = check(solver, options)
  if system.place and solver.lift == "homogeneous" then
    return M.modified_energy(by_coordinates(solver, options))
  end
  local simple = not system.place and not system.given.constraint and is_simple(system)
  local path = run_extended(solver, system, simple, options)
  local values = series(path, system, k, solver.h, simple)
  local plain = solver:run { q = options.q, v = options.v, p = options.p, steps = options.steps }
  local H, E, t, mean, worst = plain:energy(), {}, {}, 0, 0
  for i, value in ipairs(values) do
    E[i], t[i], mean = H[i + k], path.t[i + k], mean + value / #values
  end
  for _, value in ipairs(values) do worst = max(worst, abs(value - mean)) end
  local slope = core.drift(core.vector(t), core.vector(values))
  return core.result { energy = core.vector(values), H = core.vector(E), t = core.vector(t),
    mean = mean, amplitude = worst,
    drift = slope.per_time, error = slope.error }
end)

core.method("dm.solver", "modified_energy", M.modified_energy, doc)

return M
