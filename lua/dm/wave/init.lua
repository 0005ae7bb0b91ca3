--- Waves: dm.schroedinger, the equation i hbar psi_t = -hbar^2/2m psi_xx + (V + g |psi|^2) psi by
-- spectral methods (Leok 5.8). docs/theory/waves.md has the equations, src/wave the steps.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"
local rules = require "dm.wave.rules"
local space = require "dm.wave.space"

local M = {}

local WHERE = "dm.schroedinger"

local Wave = core.class({ __name = "dm.schroedinger" }, [[
dm.schroedinger: a Schroedinger equation on a ring or between walls
fields: x (points), weight (of integrals), V (at `nodes`), nodes, N, from, to, hbar, m, g, space,
boundary]])
lacking.refuse(Wave, { fellow = "dm.system", what = "Schroedinger equation", reasons = {
  energy = "wave:observe(psi).energy is that of a state",
  momentum = "wave:observe(psi).momentum is the mean of a state",
  modes = "wave:eigen(k) has the energies and states of H",
  relative_equilibria = "wave:eigen(k) has the stationary states of H",
  linearize = "with g = 0 it is linear: wave:eigen(k)",
  stability = "wave:stability_limit(rule) is the largest step",
  start = "run { psi = } takes a function of x or a complex vector",
} })

local KNOWN = { "x", "V", "hbar", "m", "g", "space", "boundary" }

local MOST_DENSE = 1200  -- unknowns of dense modes

---- making one ----

-- is V, in doubles, one constant?
local function is_constant(V)
  for j = 2, #V do
    if V[j] ~= V[1] then return false end
  end
  return true
end

local DOC = "dm.schroedinger{x = {from, to, N}, V=, hbar=, m=, g=, space=, boundary=} "
  .. "-> dm.schroedinger\n" .. [[
The equation i hbar psi_t = -hbar^2/2m psi_xx + (V + g |psi|^2) psi in one dimension. On a ring
(boundary = "periodic", unless given) of the even number N of points from + (j - 1) (to - from)/N;
boundary = "walls": psi = 0 at both ends, N Chebyshev points with the ends among them. V: a function
of x, a number (0) or a list of N values; hbar = m = 1 and g = 0 unless given. space =
"collocation", or "galerkin" on a ring: Leok's trigonometric polynomials with exact integrals of the
interpolated V, g = 0. Raises on odd rings, where V is not finite, and on V of x and t.]]

M.schroedinger = blame.caller(function(options)
  option.check(options, KNOWN, WHERE)
  local boundary = option.one_of(options, "boundary", WHERE, { "periodic", "walls" }, "periodic")
  local of = option.one_of(options, "space", WHERE, { "collocation", "galerkin" }, "collocation")
  local walls, galerkin = boundary == "walls", of ~= "collocation"
  if walls and galerkin then option.fail(WHERE, "space = \"galerkin\" is one of a ring") end
  local self = { boundary = boundary, space = of, kind = walls and "walls" or of,
    hbar = option.positive(options, "hbar", WHERE, nil, 1) * 1.0,
    m = option.positive(options, "m", WHERE, nil, 1) * 1.0,
    g = option.number(options, "g", WHERE, nil, 0) * 1.0 }
  if galerkin and self.g ~= 0 then
    option.fail(WHERE, "space = \"galerkin\" is Leok's, of the linear equation: g = 0 (got %g)",
      self.g)
  end
  self.from, self.to, self.N = space.interval(options, walls, galerkin)
  self.unknowns = walls and self.N - 2 or self.N
  self.x, self.weight = space.points(self)
  self.nodes = core.wave_nodes(self.kind, self.from, self.to, self.unknowns)
  self.V = space.potential(options, self)
  self.iterated = self.g ~= 0 or self.unknowns > MOST_DENSE and not is_constant(self.V)
  return setmetatable(self, Wave)
end)

core.docs[M.schroedinger] = DOC

function Wave.__tostring(wave)
  local where = wave.boundary == "walls" and "between walls" or "on a ring"
  return ("Schroedinger equation %s from %g to %g: %d points, %s%s"):format(where, wave.from,
    wave.to, wave.N, wave.kind == "walls" and "Chebyshev" or wave.space,
    wave.g ~= 0 and (", g = %g"):format(wave.g) or "")
end

-- the equation in C, with plans of its own where they are measured
local function make_equation(wave, measure, wisdom)
  return core.wave(wave.kind, wave.from, wave.to, wave.hbar, wave.m, wave.g, wave.V, measure,
    wisdom)
end

M.make_equation = make_equation

class.method("dm.schroedinger", "equation", function(wave)
  if not rawget(wave, "made") then wave.made = make_equation(wave) end
  return wave.made
end, [[
wave:equation() -> dm.wave_equation
What stands behind it in C, made when it is first asked for.]])

---- spectra ----

local DOC_EIGEN = [[
wave:eigen(k) -> {values, psi}
The k least energies of the linear equation, ascending, and their states, real dm.complex_vectors of
norm 1: by dense rotations up to 1200 points, beyond it, up to 4096, by Lanczos iterations, which
need dm/sparse.so (libsuitesparse-dev, libarpack2-dev). k: 6 unless given. Raises where g is not 0:
energies then depend on how much there is of the state.]]

class.method("dm.schroedinger", "eigen", function(wave, k)
  option.whole({ k = k }, "k", "wave:eigen", 1, wave.unknowns)
  if k == nil then k = math.min(6, wave.unknowns) end
  if wave.g ~= 0 then
    option.fail("wave:eigen", "with g = %g a stationary state has an energy for every norm; those "
      .. "of the linear part are of dm.schroedinger { ..., g = 0 }", wave.g)
  end
  local is_sparse, eq = wave.unknowns > MOST_DENSE, wave:equation()
  if is_sparse and k >= wave.unknowns // 2 then
    option.fail("wave:eigen", "of more than %d points fewer states than half of these are found, "
      .. "here at most %d (got %d)", MOST_DENSE, wave.unknowns // 2 - 1, k)
  end
  local values, states = eq[is_sparse and "lanczos" or "eigen"](eq, k)
  local psi = {}
  for i, re in ipairs(states) do psi[i] = space.wrap(wave, re, core.zeros(#re)) end
  return core.result { values = values, psi = psi }
end, DOC_EIGEN)

class.method("dm.schroedinger", "stability_limit", function(wave, rule)
  local known = { rule = rule }
  option.need(known, "rule", "wave:stability_limit", "the name of a rule, such as \"two-step\"")
  option.text(known, "rule", "wave:stability_limit")
  local most, exact = rules.largest(wave)
  local read = rules.read(wave, { rule = rule, h = 1e-9, unstable = rule == "two-step" })
  if rule == "two-step" then return math.sqrt(3) * wave.hbar / most, exact end
  if read.kind ~= "split" or wave.g == 0 then return math.huge, true end
  local k = math.pi * wave.N / (wave.to - wave.from)
  return math.pi * 2 * wave.m / (wave.hbar * k ^ 2), wave.kind ~= "walls"
end, [[
wave:stability_limit(rule) -> h, exact
The largest step that does not let modes grow: sqrt(3) hbar/E_max for "two-step"; for kicks and
drifts with g that of resonances, pi hbar/T_max (Weideman & Herbst 1986); infinite for all that is
unitary. exact = false: an estimate.]])

---- of states ----

local function given_state(wave, psi, where)
  if psi == nil then
    option.fail(where, "a state is needed: a complex vector or a function of x")
  end
  return space.values(wave, psi)
end

class.method("dm.schroedinger", "current", function(wave, psi)
  local re, im = given_state(wave, psi, "wave:current")
  local slope_re, slope_im = wave:equation():slope(re, im)
  local j, density = core.zeros(#re), core.zeros(#re)
  for i = 1, #re do
    j[i] = wave.hbar / wave.m * (re[i] * slope_im[i] - im[i] * slope_re[i])
    density[i] = re[i] ^ 2 + im[i] ^ 2
  end
  return space.wrap(wave, j, j).re, space.wrap(wave, density, density).re
end, [[
wave:current(psi) -> j, density
hbar/m Im(psi* psi_x) and |psi|^2 at the points, dm.vectors: density_t + j_x = 0. The current of the
phase (Leok 5.8, signs corrected) is -hbar times both. psi: a complex vector or a function of x.]])

class.method("dm.schroedinger", "observe", function(wave, psi)
  local re, im = given_state(wave, psi, "wave:observe")
  local norm, energy, x, momentum = wave:equation():observe(re, im)
  return core.result { norm = norm, energy = energy, x = x, momentum = momentum }
end, [[
wave:observe(psi) -> {norm, energy, x, momentum}
Of a state: the integral of |psi|^2; that of psi* (T + V) psi + g/2 |psi|^4; means of x and p.]])

require "dm.wave.solver"(M)

return M
