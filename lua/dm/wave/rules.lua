--- What a rule is for a wave: a text to what core.wave_stepper takes, or the reason why it does not
-- serve.
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "wave:solver"
local fail = option.failing(WHERE)

-- rules of the table by the names that they have for waves
local ALIASES = { strang = "verlet", ["crank-nicolson"] = "gauss(1)" }

local MOST_STAGES = 24     -- of steps that are iterated
local MOST_SLAB = 400      -- of a slab whose degree is chosen

--- The largest modulus of the energies of modes, and whether it is exact.
function M.largest(wave)
  local energies, exact = wave:equation():energies()
  local most = 0
  for k = 1, #energies do most = math.max(most, math.abs(energies[k])) end
  return most, exact
end

-- degree of the polynomial in time that turns every mode by its angle, to round-off
local function slab_degree(wave, h)
  local theta = h * M.largest(wave) / wave.hbar
  local function off(s)
    local worst = 0
    for i = 1, 64 do worst = math.max(worst, core.gauss_phase(s, theta * i / 64)) end
    return worst
  end
  local most = wave.iterated and MOST_STAGES or MOST_SLAB
  for s = 2, most do
    if off(s) < 1e-14 * (1 + theta) then return s end
  end
  fail("a slab of h = %g needs a degree above %d for the fastest mode, which turns by %.3g: take a "
    .. "smaller h, or say which degree, \"slab(s)\"", h, most, theta)
end

local function gauss(wave, degree)
  if wave.iterated and degree > MOST_STAGES then
    fail("%s is solved by iteration, with up to %d stages (got %d)",
      wave.g ~= 0 and "the nonlinear equation" or "H of so many points", MOST_STAGES, degree)
  end
  return { kind = "stages", degree }
end

local function two_step(wave, h, options)
  if wave.g ~= 0 then
    fail "the two-step rule is one for the linear equation (g = 0): take \"strang\" or \"gauss(s)\""
  end
  if wave.iterated then fail "the two-step rule needs the modes of H: up to 1200 points" end
  local limit = math.sqrt(3) * wave.hbar / M.largest(wave)
  if h > limit * (1 + 1e-12) and not options.unstable then
    fail("h = %g is beyond the limit of the two-step rule, sqrt(3) hbar/E_max = %.10g: it would "
      .. "grow without bound; take a smaller h, or unstable = true to see it", h, limit)
  end
  return { kind = "two-step", options.norm and true or false }
end

-- by how much a step multiplies |psi| in the fastest mode
local function refuse_growth(wave, h, text)
  local theta = h * M.largest(wave) / wave.hbar
  local _, _, growth = core.wave_rule(text, theta)
  local by = growth ~= growth and "its step has no solution there"
    or ("|psi| - 1 = %.2g after a step of the fastest mode, h E/hbar = %.3g")
      :format(growth - 1, theta)
  fail("'%s' is not unitary: %s. L is linear in psi', so that only as many Gauss nodes as the "
    .. "degree keep p = -(i hbar/2) psi: take \"gauss(s)\"", text, by)
end

local function of_table(wave, h, text)
  local kind, a, b = core.wave_rule(ALIASES[text] or text, 0)
  if kind == "split" then return { kind = "split", a, b } end
  if kind == "stages" then return gauss(wave, a) end
  if kind == "loses" then refuse_growth(wave, h, text) end
  if kind == "none" then
    fail("'%s' is no rule for waves: it is neither kicks and drifts nor Gauss nodes, and would not "
      .. "keep the norm; take \"strang\", a composition such as \"yoshida(4)\", or \"gauss(s)\"",
      text)
  end
  if a then fail("rule '%s': %s", text, a) end
  local near = b or core.nearest(text, { "strang", "crank-nicolson", "two-step", "slab" })
  fail("unknown rule '%s'; %swaves are stepped by \"strang\" and every composition of dm.rules(), "
    .. "\"gauss(s)\", \"crank-nicolson\", \"two-step\", \"slab\"", text,
    near and ("did you mean '%s'? "):format(near) or "")
end

--- { kind =, arguments of core.wave_stepper ... } of the options of a solver.
function M.read(wave, options)
  local text, h = options.rule, options.h
  for _, key in ipairs { "norm", "unstable" } do
    if options[key] and text ~= "two-step" then
      fail("option '%s' goes with rule = \"two-step\"", key)
    end
  end
  if text == "two-step" then return two_step(wave, h, options) end
  local degree = text == "slab" and slab_degree(wave, h) or text:match "^slab%(%s*(%d+)%s*%)$"
  if not degree then return of_table(wave, h, text) end
  degree = lists.whole(tonumber(degree))
  if degree < 1 or degree > 10000 then fail("rule '%s': a degree from 1 on is needed", text) end
  return gauss(wave, degree)
end

return M
