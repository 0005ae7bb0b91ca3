--- wave:solver and its runs.
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local core = require "dm.core"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"
local path_ = require "dm.wave.path"
local rules = require "dm.wave.rules"
local space = require "dm.wave.space"

local WHERE = "wave:solver"

local Solver = core.class({ __name = "dm.wave_solver" }, [[
dm.wave_solver: a rule that steps a wave
fields: wave, rule, h]])
lacking.refuse(Solver, { fellow = "dm.solver", what = "solver of a wave", reasons = {
  ensemble = "a member is a run of its own: call solver:run for each psi, what the steps are "
    .. "made of is kept",
  step = "run { steps = 1 } makes one step",
  solvability = "no rule for waves chooses its steps by an energy",
  measured_order = "run with h and with h/2, and compare psi",
  reversal = "the rules for waves are symmetric: run back from the complex conjugate of psi",
  multipliers = "the multiplier of \"two-step\" is solver { norm = true }, and is not kept",
} })

function Solver.__tostring(s) return ("solver of a wave: %s, h = %g"):format(s.rule, s.h) end

---- plans of FFTW ----

-- where FFTW's choices are kept, unless told otherwise
local function usual_wisdom()
  local home = os.getenv "XDG_CACHE_HOME" or os.getenv "HOME" and os.getenv "HOME" .. "/.cache"
  return home and home .. "/dmlua-fftw.wisdom"
end

-- the file, or nil where plans are chosen by rule
local function read_plan(options, wave)
  local plan = option.one_of(options, "plan", WHERE, { "estimate", "measure" }, "estimate")
  local wisdom = option.text(options, "wisdom", WHERE)
  if plan == "estimate" then
    if wisdom then option.fail(WHERE, "option 'wisdom' goes with plan = \"measure\"") end
    return nil
  end
  if wave.kind == "walls" then
    option.fail(WHERE, "plan = \"measure\" is for rings: walls need no transforms")
  end
  wisdom = wisdom or usual_wisdom()
  if not wisdom then
    option.fail(WHERE, "plan = \"measure\" needs wisdom = \"file\", in which FFTW's choice is "
      .. "kept, so that the next run has the same bits")
  end
  return wisdom
end

---- the solver ----

local KNOWN = { "rule", "h", "norm", "unstable", "plan", "wisdom" }

local function make_stepper(solver, make_equation)
  local wave, rule = solver.wave, solver.choice
  local equation = solver.wisdom and make_equation(wave, true, solver.wisdom) or wave:equation()
  solver.equation = equation
  return core.wave_stepper(equation, rule.kind, solver.h, table.unpack(rule))
end

local DOC_SOLVER = [[
wave:solver{rule=, h=, norm=, unstable=, plan=, wisdom=} -> dm.wave_solver
What steps a wave. rule: "strang" (half a kick by V + g |psi|^2, a drift, half a kick) and every
composition and splitting of dm.rules(), "yoshida(4)"; "gauss(s)", "crank-nicolson" = "gauss(1)", by
the modes of H up to 1200 points and by iteration for what these do not have (g, s <= 24); "slab",
Gauss with a degree in time that resolves every mode, or "slab(s)"; "two-step", Leok's linear
functions in time, with norm = true the multiplier that keeps the norm, with unstable = true beyond
its limit. plan = "measure": FFTW chooses by timing, kept in the file wisdom = (unless given, in
the user's cache), so that the next run has the same bits. Raises, with the reason, on rules that
are not unitary.]]

-- called with the functions of dm.wave
return function(waves)
  class.method("dm.schroedinger", "solver", function(wave, options)
    option.check(options, KNOWN, WHERE)
    option.need(options, "rule", WHERE, "\"strang\", \"yoshida(4)\", \"gauss(s)\", \"two-step\"")
    if type(options.rule) ~= "string" then
      option.fail(WHERE, "option 'rule' must be the name of a rule (got %s)",
        option.got(options.rule))
    end
    option.need(options, "h", WHERE, "the step")
    local h = option.positive(options, "h", WHERE, "a step") * 1.0
    local self = { wave = wave, rule = options.rule, h = h, wisdom = read_plan(options, wave),
      norm = options.norm and true or nil }
    self.choice = rules.read(wave, { rule = options.rule, h = h, norm = options.norm,
      unstable = options.unstable })
    self.stepper = make_stepper(self, waves.make_equation)
    return setmetatable(self, Solver)
  end, DOC_SOLVER)
  class.method("dm.schroedinger", "resume", function(wave, from)
    return checkpoint.resume(require "dm.wave.checkpoint", wave, from)
  end, [[
wave:resume(file | path) -> dm.wave_solver
The solver of a run, which goes on from where that ended, bit for bit: run it without psi. From a
path or from the file that path:checkpoint wrote. Raises where the wave is another one.]])
end, class.method("dm.wave_solver", "report", function(solver)
  local r = { rule = solver.rule, h = solver.h, fft = solver.equation.fft,
    steps = solver.steps or 0, ns_per_step = solver.ns_per_step,
    iterations = solver.stepper.iterations, residual = solver.stepper.residual }
  if solver.choice.kind == "two-step" then r.parasitic = solver.stepper.parasitic end
  if solver.choice.kind == "stages" then r.degree = solver.choice[1] end
  return core.result(r)
end, [[
solver:report() -> {rule, h, fft, steps, ns_per_step, iterations, residual, degree, parasitic}
Who makes the transforms ("FFTW", "GSL", "none" between walls); of the last run steps and time;
iterations so far and the residual of the last, where a step is solved for; degree in time of Gauss
and slabs; parasitic: the share of the parasitic mode in the start of "two-step".]]),
class.method("dm.wave_solver", "run", function(solver, options)
  return path_.run(solver, options, space)
end, [[
solver:run{psi=, steps= | t=, every=, t0=, seconds=, checkpoint=, file=} -> dm.wave_path
Steps from psi, a function of x that returns re and im (left out: 0), a complex vector or
{ re =, im = }; t: a duration, up to the step that reaches it. A row for `every` steps and the last.
seconds: of CPU, at most; checkpoint: a file, written at the end and where the run stops. file =
"rows.npy": rows go there as they come, NumPy records of the columns, re and im; the path keeps the
columns, and psi of the last row. What ends a run early, Ctrl-C too, is a dm.failure with the path
so far. The rows: path.psi[i], and columns t, norm, energy, x, momentum, noether.]])
