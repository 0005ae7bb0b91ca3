--- Solvers of fields on a line: the strip of a rule, starts, runs; the limit of stability.
local blame = require "dm.base.blame"
local checkpoint = require "dm.data.checkpoint"
local core = require "dm.core"
local grids = require "dm.line.grid"
local lacking = require "dm.base.lacking"
local lists = require "dm.base.lists"
local moving = require "dm.line.moving"
local option = require "dm.base.options"
local rules = require "dm.line.rule"
local runs = require "dm.line.run"
local sample = require "dm.line.sample"
local stream = require "dm.line.stream"

local M = {}

local Solver = core.class({ __name = "dm.line_solver" }, [[
dm.line_solver: a rule and a height of slabs for a field on a line, made by field:solver
fields: field, rule, h, free ("t", "x", "tx" or nil)]])
lacking.refuse(Solver, { fellow = "dm.solver", what = "solver of a field on a line", reasons = {
  ensemble = "a member is a run of its own: call solver:run for each start",
  step = "run { steps = 1 } makes one step",
  reversal = "run back from u and -p of the last row",
  symplecticity = "run:multisymplectic() is the residual of the form formula",
  tangent = "run:multisymplectic() follows first variations",
} })

---- strips ----

-- the strip of an action, with the marks of what is held; one value more than the field's is where
-- the nodes are
local function strip_of(field, action, values, held, absorbs)
  return core.strip(action, { values = values, cells = field.cells, ring = field.periodic,
    held = held, absorbs = absorbs or { 0, 0 }, place = grids.lefts(field.grid),
    moving = values > field.values and values or 0, width = field.dx })
end

--- The strip that a run steps, and the action that it is made of; held: marks of the nodes whose
-- place is held, where nodes move.
function M.strip(solver, held)
  local field, n = solver.field, solver.field.values
  local forces = { field.absorbing.left or 0, field.absorbing.right or 0 }
  if not solver.moves then
    local action = rules.action(field.L, solver.points, n, field.dx)
    return strip_of(field, action, n, field.held, forces), action
  end
  local action = moving.action(field.L, solver.points, n, field.dx)
  return strip_of(field, action, n + 1, moving.joined(field.held, held, field.nodes, n), forces),
    action
end

local ONE = rules.parse("cell(gauss(1))", "dm.field")

--- Raises what L raises at symbols.
function M.trace(field) M.strip { field = field, points = ONE } end

-- The strip of a solver whose nodes stay, made anew where L does what it did not when the last one
-- was made, since what it reads has changed.
local function current(solver)
  if not solver.strip:follows(solver.action) then
    solver.field.check()
    solver.strip, solver.action = M.strip(solver)
  end
  return solver.strip, solver.action
end

-- momenta of the first level: slopes by ut of the integral of L
local function momenta(solver, u, ut, t)
  local field, n = solver.field, solver.field.values
  local start = solver.moves and moving.start or rules.start
  local values = n + (solver.moves and 1 or 0)
  local zeros = core.zeros(field.nodes * values)
  local strip = strip_of(field, start(field.L, solver.points, n, field.dx), values, zeros)
  return strip:momenta(u, ut, t, solver.h)
end

---- solvers ----

local FREE = { t = true, x = true }

local function free_of(given, where)
  local list = type(given) == "string" and { given } or given
  local free = {}
  for i = 1, given == nil and 0 or lists.count(list) or 0 do free[list[i]] = true end
  for name in pairs(free) do
    if not FREE[name] then
      option.fail(where, "option 'free' must be \"t\", \"x\" or { \"t\", \"x\" } (got %s)",
        option.got(name))
    end
  end
  if given ~= nil and next(free) == nil then
    option.fail(where, "option 'free' must be \"t\", \"x\" or { \"t\", \"x\" } (got %s)",
      option.got(given))
  end
  return free
end

--- field:solver{...}
function M.new(field, options)
  local where = "field:solver"
  option.check(options, { "rule", "h", "free" }, where)
  local points = rules.parse(option.text(options, "rule", where, "cell(gauss(2))"), where)
  option.need(options, "h", where, "the height of a slab")
  local free = free_of(options.free, where)
  local solver = { field = field, rule = points.name, points = points,
    h = option.positive(options, "h", where, "a height"), moves = free.x, stretches = free.t,
    free = (free.t and "t" or "") .. (free.x and "x" or "") }
  if solver.free == "" then solver.free = nil end
  if solver.stretches and (field.absorbing.left or field.absorbing.right) then
    option.fail(where, "free = \"t\" keeps the energy, which absorbing ends take away")
  end
  if not solver.moves then solver.strip, solver.action = M.strip(solver) end
  return setmetatable(solver, Solver)
end

function Solver.__tostring(solver)
  return ("solver of a field on a line: %s, h = %.4g%s"):format(solver.rule, solver.h,
    solver.free and ", free " .. solver.free or "")
end

---- runs ----

local RUN = { "u", "ut", "p", "steps", "t", "t0", "every", "file", "checkpoint" }

-- what other runs take, and why this one does not
local NOT_HERE = { events = "rows of a field on a line are whole levels: look at run.u[i]",
  at = "rows are at whole slabs: 'every' says at how many", rows = "'every' says how often",
  watch = "rows have u, p and the energy", control = "a field has no control",
  project = "a field on a line has no constraints", q = "the start is called u",
  v = "the start of its rate is called ut" }

local function steps_of(solver, options, t0)
  local where = "solver:run"
  if options.t ~= nil and options.steps ~= nil then
    option.fail(where, "give one of 't' and 'steps'")
  end
  if options.t == nil then
    option.need(options, "steps", where, "a number of slabs, or t = the last time")
    return option.whole(options, "steps", where, 0, 1 << 53)
  end
  local t = option.positive(options, "t", where, "a duration")
  if solver.stretches then
    option.fail(where, "with free = \"t\" the heights are not known before: give 'steps'")
  end
  local steps = math.ceil(t / solver.h - 1e-9)
  if not (steps < 1e15) then
    option.fail(where, "%g steps of h = %g are too many", steps, solver.h)
  end
  return steps, t0 + t
end

-- u, ut and p of the start, node after node, of the values of the field alone
local function start_of(field, options)
  local where, n, grid = "solver:run", field.values, field.grid
  option.need(options, "u", where, "a function of x, or a number for every node")
  if options.ut ~= nil and options.p ~= nil then option.fail(where, "give one of 'ut' and 'p'") end
  local u = grids.values(grid, options.u, n, "u", where)
  local ut = grids.values(grid, options.ut, n, "ut", where)
  for i = 1, field.nodes * n do if field.held[i] ~= 0 then ut[i] = 0 end end
  return u, ut, options.p ~= nil and grids.values(grid, options.p, n, "p", where) or nil
end

-- the first level as the strip has it: { u =, p =, guess =, strip =, frozen = }
local function first_level(solver, options, t0)
  local field, h = solver.field, solver.h
  local u, ut, p = start_of(field, options)
  if not solver.moves then
    local strip, action = current(solver)
    return { strip = strip, action = action, u = u,
      p = p or momenta(solver, u, ut, t0), guess = u + h * ut }
  end
  if p then option.fail("solver:run", "with free = \"x\" a run starts from 'ut'") end
  field.check()
  local n = field.values
  local frozen = moving.affine(field.grid, u, n)
  local from = moving.joined(u, nil, field.nodes, n)
  local speed = moving.joined(ut, nil, field.nodes, n)
  local strip, action = M.strip(solver, frozen)
  return { strip = strip, action = action, u = from, p = momenta(solver, from, speed, t0),
    guess = from + h * speed, frozen = frozen }
end

local LOOKED_AT = 16 -- cells in which L is compared with its trace, from the first to the last

-- numbers of these cells
local function some_cells(count)
  local out = {}
  for k = 0, math.min(LOOKED_AT, count) - 1 do
    out[k + 1] = 1 + k * (count - 1) // math.max(math.min(LOOKED_AT, count) - 1, 1)
  end
  return out
end

-- the size of L in its own units: the largest of a few samples, 1 where they have none
local function size_of_L(field)
  local random, largest = core.random(3), 0
  for row = 1, 5 do
    local u, ut, ux = sample.of(random, row, field.values)
    local value = math.abs(sample.number(field.L, u, ut, ux, field.from + 0.3 * field.dx, 0))
    if value < math.huge then largest = math.max(largest, value) end
  end
  return largest > 0 and largest or 1
end

-- Raises where L, called with the numbers of the start, is not what was traced.
local function check_trace(solver, level, t0)
  local field, size = solver.field, #level.u // solver.field.nodes
  local upper, h = level.guess, solver.h
  local rounding = field.dx * h * size_of_L(field)
  local traced = level.strip:cells(level.u, upper, t0, h, "value")
  for _, c in ipairs(some_cells(field.cells)) do
    local right = c == field.nodes and 1 or c + 1
    local function corners(x)
      return lists.joined(lists.part(x, (c - 1) * size, size),
        lists.part(x, (right - 1) * size, size))
    end
    local place = core.vector { field.from + (c - 1) * field.dx }
    local plain = level.action(corners(level.u), corners(upper), place, core.vector { t0, h })
    if plain ~= plain then
      option.fail("solver:run", "L of the start is no number (NaN) in cell %d: is u inside the "
        .. "domain of L there?", c)
    end
    if math.abs(plain - traced[c][1]) > 1e-8 * (math.abs(plain) + rounding) then
      option.fail("solver:run", "L of the start in cell %d gives %.9g, but what was traced %.9g: "
        .. "a trace does not see == and truth tests (dm.where), nor globals that change", c, plain,
        traced[c][1])
    end
  end
end

-- of a solver that goes on from a run: its ending as a level
local function last_level(solver, options)
  local ending = solver.ending
  checkpoint.check_options(options, { "u", "ut", "p", "t0" })
  checkpoint.check_still(require "dm.line.checkpoint".field, solver.field, solver)
  local strip, action
  if solver.moves then
    strip, action = M.strip(solver, ending.frozen)
  else
    strip, action = current(solver)
  end
  return { strip = strip, action = action, u = ending.u, p = ending.p, from = ending.from,
    frozen = ending.frozen }
end

-- how long, from where, and into which file
local function plan_of(solver, options)
  local where, ending = "solver:run", solver.ending
  local t0 = ending and ending.t0 or option.number(options, "t0", where, nil, 0)
  local steps, until_t = steps_of(solver, options, ending and ending.from.t or t0)
  return { t0 = t0, steps = steps, until_t = until_t,
    every = option.whole(options, "every", where, 1, 1 << 53, 1),
    file = option.text(options, "file", where) }
end

local function run(solver, options)
  for key, why in pairs(type(options) == "table" and NOT_HERE or {}) do
    if options[key] ~= nil then option.fail("solver:run", "option '%s': %s", key, why) end
  end
  option.check(options, RUN, "solver:run")
  local saved_in = option.text(options, "checkpoint", "solver:run")
  local plan = plan_of(solver, options)
  local level = solver.ending and last_level(solver, options)
    or first_level(solver, options, plan.t0)
  level.law = sample.of_L(solver.field)
  if not solver.ending then check_trace(solver, level, plan.t0) end
  local started = os.clock()
  local outcome = stream.go(solver, level, plan, stream.of_field(solver))
  local made = runs.new(solver, level, plan, outcome, os.clock() - started)
  if saved_in then made:checkpoint(saved_in) end
  if outcome.code ~= "ok" then runs.fail(made, outcome) end
  return made
end

core.method("dm.line_solver", "run", blame.caller(run), [[
solver:run{u=, ut= | p=, steps= | t=, every=, t0=, file=, checkpoint=} -> dm.line_run
u, ut: functions of x, or lists of a number (with values = n: n numbers) for every node; ut is
interpolated as u is, so that p_i is the integral of L_ut phi_i; p: those themselves. t: a duration.
Rows at the start, every `every` slabs and at the end. file: a NumPy file that the rows go to as
they come (t, energy, u, p; dm.load reads it); the run keeps the first and the last one. checkpoint:
a file for where it ended, also where it was stopped (run:checkpoint). A level that is not found,
and an energy that has outgrown the start by 2^104, as beyond the limit of stability, raise a
dm.failure, whose `path` is the run so far.]])

---- the limit of stability, the impedance ----

local function check_sign(field, points, u, t, h)
  local function L(w, wt, wx, x) return field.L(w, wt, wx, x, t) end
  local strip = strip_of(field, rules.action(L, points, field.values, field.dx), field.values,
    field.held)
  local forth = strip:cells(u, u, 0, h, "hessian")
  local half = 2 * field.values
  for c = 1, #forth do
    local row = forth[c]
    for a = 0, half - 1 do
      for b = 0, half - 1 do
        local up, down = row[a * 2 * half + half + b + 1], row[(half + a) * 2 * half + b + 1]
        if math.abs(up - down) > 1e-9 * (math.abs(up) + math.abs(down)) + 1e-300 then return nil end
      end
    end
  end
  return strip
end

function M.limit(field, rule, options)
  local where = "field:stability_limit"
  options = option.check(options or {}, { "u", "t" }, where)
  local t = option.number(options, "t", where)
  if not t and not sample.is_autonomous(field) then
    option.fail(where, "L depends on t, and so does its limit: give { t = }, the time of L")
  end
  if rule ~= nil and type(rule) ~= "string" then
    option.fail(where, "takes the text of a rule (got %s)", option.got(rule))
  end
  local points = rules.parse(rule or "cell(gauss(2))", where)
  local u = grids.values(field.grid, options.u, field.values, "u", where)
  local strip = check_sign(field, points, u, t or 0, field.dx)
  if not strip then
    option.fail(where, "L is not the same for -ut (gyroscopic terms): oscillations (-1)^k v do "
      .. "not tell its limit")
  end
  local limit = strip:limit(u, field.dx)
  if limit < 0 then
    option.fail(where, "the kinetic energy at this u is of both signs, and its waves may grow in "
      .. "pairs at a height that this does not see: try runs")
  end
  if limit ~= limit then
    option.fail(where, "d2L/dut2 is degenerate at this u, or has zeros on its diagonal: there is "
      .. "no kinetic energy to tell by%s",
      #points.points == 1 and "; one point a cell does not see that of u = (-1)^i on open lines "
        .. "and on rings of an even number of cells: take cell(gauss(2)), or an odd ring" or "")
  end
  return limit
end

function M.reflection(field, options)
  local where = "field:reflection"
  options = option.check(options or {}, { "u" }, where)
  if field.values > 1 then option.fail(where, "is for fields of one value") end
  local u = option.number(options, "u", where, nil, 0)
  local out = {}
  for side, c in pairs(field.absorbing) do
    local x = side == "left" and field.from or field.to
    if c then
      local second = core.derivative(core.derivative(function(w)
        return field.L(u, w[1], w[2], x, 0)
      end, 2), 2)
      local H = second { 0, 0 }
      local Z = math.sqrt(math.max(0, -H[1][1] * H[2][2]))
      out[side] = (Z - c) / (Z + c)
    end
  end
  return core.result(out)
end

return M
