--- dm.wave_path: what a run of a wave recorded.
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local columns = require "dm.data.columns"
local core = require "dm.core"
local files = require "dm.wave.file"
local lacking = require "dm.base.lacking"
local notes = require "dm.wave.notes"
local option = require "dm.base.options"
local space = require "dm.wave.space"

local M = {}

local WHERE = "solver:run"

local Path = core.class({ __name = "dm.wave_path" }, [[
dm.wave_path: the rows of a run of a wave
fields: t, psi (psi[i] is a copy, a dm.complex_vector), columns (names), steps, h, rule, wave,
solver, title, notes (what to know of its accuracy), ns_per_step, file (where the rows are); #path
rows]])
lacking.refuse(Path, { fellow = "dm.path", what = "path of a wave", reasons = {
  energy = "it is a column: path:column \"energy\"",
  momentum = "it is a column, the mean: path:column \"momentum\"",
  noether = "it is a column: path:column \"noether\"",
  npy = "rows are written as they come: run { file = \"rows.npy\" }",
  vtk = "path:csv writes the columns, run { file = \"rows.npy\" } psi",
  frequency = "dm.fft of a column has its spectrum, wave:eigen the energies",
  series = "path:column has the numbers over path.t",
  velocity = "wave:current(psi) is what flows",
  worst = "path:drift(column).largest is the largest difference",
} })

local COLUMNS = { "t", "norm", "energy", "x", "momentum", "noether" }

---- rows ----

-- path.psi: row i, made when it is asked for
local Rows = { __name = "rows of a wave" }

local ROW = "a row of path.psi"

local function row(path, re, im)
  local psi = space.wrap(path.wave, re, im)
  core.locked(psi.re, ROW)
  core.locked(psi.im, ROW)
  return psi
end

function Rows.__newindex()
  option.fail("path.psi", "rows cannot be set, since they are copies: change one of your own, "
    .. "1 * row")
end

function Rows.__index(rows, i)
  local path = rawget(rows, "path")
  if math.type(i) ~= "integer" then
    option.fail("path.psi", "rows are counted from 1 to %d (got %s)", #path, option.got(i))
  end
  if i == #path + 1 then return nil end
  if i < 1 or i > #path then
    option.fail("path.psi", "rows are counted from 1 to %d (got %d)", #path, i)
  end
  if not path.file then return row(path, core.wave_values(path.rows, i)) end
  if i < #path then
    option.fail("path.psi", "row %d is in %s: the path keeps the last one, %d", i, path.file, #path)
  end
  return row(path, core.wave_values(path.block, #path.block))
end

function Rows.__len(rows) return #rawget(rows, "path") end

function Rows.__tostring(rows)
  local path = rawget(rows, "path")
  return ("psi of a path: %d complex vectors of %d"):format(#path, path.wave.N)
end

local function new(solver, rows, first)
  local wave = solver.wave
  local path = setmetatable({ rows = rows, solver = solver, wave = wave, h = solver.h,
    rule = solver.rule, first = first, columns = { table.unpack(COLUMNS) },
    title = ("%s, h = %.4g"):format(solver.rule, solver.h) }, Path)
  path.t = rows:column(1)
  path.psi = setmetatable({ path = path }, Rows)
  return path
end

function Path.__len(path) return #path.rows end

function Path.__tostring(path)
  local norm, energy = path:column "norm", path:column "energy"
  local function off(column)
    local most = 0
    for i = 1, #column do most = math.max(most, math.abs(column[i] - column[1])) end
    return most
  end
  local text = ("path of %d step%s of %s to t = %.6g: norm off by %.2g, energy off by %.2g; "
    .. "%d rows of %d points"):format(path.steps, path.steps == 1 and "" or "s", path.rule,
    path.t[#path], off(norm), off(energy), #path, path.wave.N)
  local over = path.asked and path.t[#path] - path.t0 - path.first * path.h - path.asked
  if over and over > 1e-6 * path.h then
    text = text .. (" (h = %.6g does not divide the way to %.6g)"):format(path.h,
      path.t[#path] - over)
  end
  for _, note in ipairs(path.notes) do text = text .. "\n  " .. note end
  return text
end

---- runs ----

local KNOWN = { "psi", "steps", "t", "every", "t0", "seconds", "checkpoint", "file" }

local function count_steps(options, h)
  if options.steps ~= nil and options.t ~= nil then
    option.fail(WHERE, "give one of 'steps' and 't' (a duration)")
  end
  local steps = option.whole(options, "steps", WHERE, 0)
  local t = option.positive(options, "t", WHERE, "a duration")
  if not (steps or t) then
    option.fail(WHERE, "how long? 'steps' (how many) or 't' (a duration) is missing")
  end
  if steps then return steps end
  if t / h > 2 ^ 52 then option.fail(WHERE, "%g steps are too many", t / h) end
  return math.ceil(t / h - 1e-9)
end

-- sets the state of the stepper; the time of the run's start, and the step that it stands at
local function begin(solver, options)
  local from = solver.from
  if from then
    checkpoint.check_options(options, { "psi", "t0" })
    solver.stepper:state(from.state)
    return from.t0, from.step
  end
  option.need(options, "psi", WHERE, "the wave at the start, a function of x that returns re, im")
  solver.stepper:start(space.values(solver.wave, options.psi))
  return option.number(options, "t0", WHERE, nil, 0) * 1.0, 0
end

-- why a run may have ended, in words that serve a wave
local WHY = {
  not_finite = "the wave grew without bound: is the step within wave:stability_limit(rule)?",
  singular = "no multiplier gives the wave the norm of the start: with a mean energy near 0 there "
    .. "is none (shift V by a constant), else take a smaller step",
  no_convergence = "the iteration for the part of H that modes do not have does not end: take a "
    .. "smaller step, or \"strang\"",
}

local function fail(path, code)
  local s, h = path.solver, path.h
  local late = code ~= "stopped" and code ~= "out_of_time"
  core.wave_fail(code, path.rule, path.steps + (late and 1 or 0),
    path.t0 + h * (path.first + path.steps), h, s.stepper.iterations, s.stepper.residual,
    WHY[code], path)
end

local function read_file(options)
  local file = option.text(options, "file", WHERE)
  if file and not file:find "%.npy$" then
    option.fail(WHERE, "option 'file' must end in .npy: rows are written as NumPy records (got "
      .. "'%s')", file)
  end
  return file
end

function M.run(solver, options)
  option.check(options, KNOWN, WHERE)
  local steps = count_steps(options, solver.h)
  local every = option.whole(options, "every", WHERE, 1, nil, 1)
  local seconds = option.positive(options, "seconds", WHERE, "a time of CPU")
  local saved_in, file = option.text(options, "checkpoint", WHERE), read_file(options)
  local t0, first = begin(solver, options)
  local rows, done, code, took, block
  if file then
    rows, done, code, took, block = files.run(solver.stepper, file, WHERE, COLUMNS, { t0 = t0,
      first = first, steps = steps, every = every, seconds = seconds,
      from = solver.from and t0 + first * solver.h }, solver.wave.N)
  else
    rows, done, code, took = solver.stepper:run(t0, first, steps, every, seconds)
  end
  local path = new(solver, rows, first)
  path.file, path.block = file, block
  path.t0, path.steps, path.asked = t0, done, options.t
  path.ns_per_step = done > 0 and took / done * 1e9 or 0
  path.ending = { state = solver.stepper:state(), t0 = t0, step = first + done }
  path.notes = notes.of(path)
  solver.steps, solver.ns_per_step = done, path.ns_per_step
  if saved_in then path:checkpoint(saved_in) end
  if code ~= "ok" then fail(path, code) end
  return path
end

---- columns ----

columns.give("dm.wave_path", "path", function(path, name)
  for i, column in ipairs(COLUMNS) do
    if column == name then return path.rows:column(i) end
  end
  return nil, table.concat(COLUMNS, ", ")
end, [[
path:column(name) -> dm.vector
"t", "norm" (integral of |psi|^2), "energy" (of psi* (T + V) psi + g/2 |psi|^4), "x" and "momentum"
(means), "noether": the discrete Noether quantity of the phase, of "two-step" hbar Re<psi, psi+> -
h/3 Im<psi, H psi+>, else hbar times the norm.]])

class.method("dm.wave_path", "checkpoint", function(path, file)
  return checkpoint.write(require "dm.wave.checkpoint", path, file)
end, [[
path:checkpoint(file) -> file name
Write where the run ended, a text with all bits; wave:resume(file) goes on from it.]])

class.method("dm.wave_path", "csv", function(path, file)
  return require "dm.data.export".csv(path, file)
end, [[
path:csv(file) -> file name   or   path:csv() -> string
The columns as comma-separated values, 17 significant digits; psi is left out.]])

for name, module in pairs { plot = "plot", spacetime = "plot", animate = "animate" } do
  class.later("dm.wave_path", name, "dm.wave.pictures." .. module)
end

return M
