--- dm.flow: what a run of a flow recorded, and how it is recorded.
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local columns = require "dm.data.columns"
local core = require "dm.core"
local form = require "dm.dec.form"
local handles = require "dm.dec.flow.handles"
local holes = require "dm.dec.flow.holes"
local lacking = require "dm.base.lacking"
local npy = require "dm.data.npy"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local sample = require "dm.dec.equations.sample"

local M = {}

local WHERE = "solver:run of a flow"
local fail = option.failing(WHERE)

local Flow = core.class({ __name = "dm.flow" }, [[
dm.flow: what a run of K:euler recorded
fields: mesh, t (a dm.vector), w[i] (vorticity of row i, a dm.vector), around[i] (b_k of row i,
round the handles), columns (names), steps, h, rule, euler, solver, circulations (round the holes),
sweeps (rates that a step needed, in the mean), file; #run rows]])

lacking.refuse(Flow, { fellow = "dm.path", what = "flow", reasons = {
  csv = "run:npy(file) writes rows and columns, run:column(name) has single ones",
  energy = "it is a column: run:column \"energy\"",
  momentum = "a flow on a surface keeps run:column \"circulation\"",
  noether = "run:column \"energy\", \"enstrophy\" and \"circulation\" are what it keeps",
  series = "run:column has the numbers over run.t",
  velocity = "run:beta(i), turned by 90 degrees, is that of row i",
  worst = "run:drift(column).largest is the largest difference",
} })

local COLUMNS = { "energy", "enstrophy", "circulation" }

function Flow.__len(run) return #run.w end

function Flow.__tostring(run)
  local note = run.euler.report.note
  return ("flow of %d steps of %s to t = %.6g; %d rows%s%s"):format(run.steps, run.rule,
    run.t[#run.t] or run.t0, #run.w, run.file and ", all of them in " .. run.file or "",
    note and "; " .. note or "")
end

---- how long ----

local function steps_of(options, h)
  local t, steps = option.number(options, "t", WHERE, "a duration"),
    option.whole(options, "steps", WHERE, 0)
  if (t == nil) == (steps == nil) then fail("give either 't' or 'steps'") end
  if steps then return steps end
  if t < 0 then fail("option 't' must be a duration of 0 at least (got %.6g)", t) end
  local count = math.ceil(t / h * (1 - 1e-12) - 1e-9)
  if count > 1e15 then fail("%.3g steps are too many", count) end
  return math.max(0, math.tointeger(count))
end

---- rows ----

-- the row of the engine's state now
local function row_of(engine, t)
  local psi, energy, enstrophy, circulation = engine:measure()
  return { t = t, w = engine:vorticity(), around = engine:around(), psi = psi, energy = energy,
    enstrophy = enstrophy, circulation = circulation }
end

local function add(run, row)
  local at = #run.w + 1
  if run.file and at == 3 then at = 2 end -- in a file: the first and the last
  run.times[at], run.w[at], run.psi[at], run.around[at] = row.t, row.w, row.psi, row.around
  for _, name in ipairs(COLUMNS) do run.values[name][at] = row[name] end
end

-- times and columns as vectors
local function finish(run)
  run.t = core.vector(run.times)
  for _, name in ipairs(COLUMNS) do run.values[name] = core.vector(run.values[name]) end
  run.times = nil
  return run
end

local function begin(s, options)
  local K, ending = s.euler.mesh, s.ending
  local run = setmetatable({ mesh = K, w = {}, psi = {}, around = {}, times = {}, values = {},
    solver = s, euler = s.euler, h = s.h, rule = s.rule, steps = 0,
    columns = { "t", table.unpack(COLUMNS) },
    t0 = ending and ending.t0 or option.number(options, "t0", WHERE, nil, 0),
    first = ending and ending.step or 0, file = option.text(options, "file", WHERE) }, Flow)
  for _, name in ipairs(COLUMNS) do run.values[name] = {} end
  return run
end

-- at the start: the vorticity, low parts where the run goes on, round the holes and the handles
local function start_of(s, options)
  if s.ending then return s.ending.w, s.ending.low, s.ending.circulations, s.ending.around end
  local K, w, system = s.euler.mesh, s.euler.vorticity.values, s.euler.system
  if options.vorticity == nil and options.circulations == nil and options.harmonic == nil then
    return w, nil, s.euler.circulations, s.euler.around
  end
  if options.vorticity ~= nil then
    w = sample.values(options.vorticity, K, operator.primal(0), K:count(0),
      function() return K:points() end, WHERE, "vorticity")
  end
  return w, nil, holes.circulations(options, K, system.holes, w, WHERE),
    handles.around(options, K, system, WHERE)
end

-- the time of the run's last step
local function now(run) return run.t0 + (run.first + run.steps) * run.h end

local function fields_of(run)
  local fields, count = { { "t", 0 }, { "w", run.mesh:count(0) } }, run.euler.system.handles.count
  for _, name in ipairs(COLUMNS) do fields[#fields + 1] = { name, 0 } end
  if count > 0 then fields[#fields + 1] = { "around", count } end
  return fields
end

-- steps and rows until all are done; false where one fails
local function go(run, engine, steps, every, write)
  local sweeps = 0
  while true do
    local row = row_of(engine, now(run))
    add(run, row)
    if write then write(row) end
    if run.steps == steps then break end
    local wanted = math.min(every, steps - run.steps)
    local done, rates = engine:advance(run.h, wanted)
    run.steps, sweeps = run.steps + done, sweeps + rates
    run.sweeps = run.steps > 0 and sweeps / run.steps or nil
    if done < wanted then return false end
  end
  return true
end

-- the rows, in memory or in a file
local function record(run, engine, steps, every)
  if not run.file then return go(run, engine, steps, every) end
  local whole
  npy.stream(run.file, fields_of(run), WHERE, function(write)
    whole = go(run, engine, steps, every, write)
  end, run.first > 0 and now(run) or nil)
  return whole
end

function M.run(s, options)
  option.check(options, { "t", "steps", "every", "t0", "vorticity", "circulations", "harmonic",
    "file", "checkpoint" }, WHERE)
  if s.ending then
    checkpoint.check_options(options, { "t0", "vorticity", "circulations", "harmonic" })
  end
  local run, system = begin(s, options), s.euler.system
  local steps = steps_of(options, s.h)
  local every = option.whole(options, "every", WHERE, 1, nil, 1)
  local saved_in = option.text(options, "checkpoint", WHERE)
  local w, low, circulations, around = start_of(s, options)
  local engine = core.euler(run.mesh, system.solver and system.solver.factor, system.solved,
    system.component, system.sign, w, low, system.holes.functions, system.holes.inverse,
    circulations, system.handles.on_triangles, around)
  run.circulations = circulations
  local whole = record(run, engine, steps, every)
  finish(run)
  run.ending = { w = engine:vorticity(), low = engine:low(), circulations = circulations,
    around = engine:around(), t0 = run.t0, step = run.first + run.steps }
  if saved_in then run:checkpoint(saved_in) end
  if not whole then engine:fail(run.steps, now(run), run.h, run.rule, run) end
  return run
end

---- what is read off ----

local function row_number(run, i, where)
  if math.type(i) ~= "integer" or i < 1 or i > #run.w then
    option.fail(where, "rows are numbered from 1 to %d (got %s)", #run.w, option.got(i))
  end
  return i
end

class.method("dm.flow", "form", function(run, i)
  return form.new(run.mesh, 0, "primal", run.w[row_number(run, i, "flow:form")])
end, "run:form(i) -> dm.form\nThe vorticity of row i, a 0-form.")

class.method("dm.flow", "stream", function(run, i)
  return form.new(run.mesh, 0, "primal", run.psi[row_number(run, i, "flow:stream")])
end, [[
run:stream(i) -> dm.form
The stream function of row i, div grad psi = w: 0 on the longest loop of the boundary, a constant on
the others, or 0 at one vertex.]])

class.method("dm.flow", "beta", function(run, i)
  row_number(run, i, "flow:beta")
  return handles.beta(run.mesh, run.euler.system.handles, run.psi[i], run.around[i])
end, [[
run:beta(i) -> dm.form
The closed 1-form of row i that, turned by 90 degrees, is the velocity u = *beta: d psi and what
flows round the handles. Its integral along a path is what crosses it from its right to its left.]])

columns.give("dm.flow", "run", function(run, name)
  return run.values[name], table.concat(run.columns, ", ")
end, [[
run:column(name) -> dm.vector
"t", "energy", "enstrophy" or "circulation" of every row.]])

class.method("dm.flow", "checkpoint", function(run, file)
  return checkpoint.write(require "dm.dec.flow.checkpoint", run, file)
end, [[
run:checkpoint(file) -> file name
Write where the run ended, a text with all bits; euler:resume(file) goes on from it.]])

class.method("dm.flow", "npy", function(run, file)
  npy.stream(file, fields_of(run), "flow:npy", function(write)
    for i = 1, #run do
      local row = { t = run.t[i], w = run.w[i], around = run.around[i] }
      for _, name in ipairs(COLUMNS) do row[name] = run.values[name][i] end
      write(row)
    end
  end)
  return file
end, [[
run:npy(file) -> file name
The rows as a NumPy array with fields t, w (of one number a vertex), energy, enstrophy, circulation
and, on surfaces with handles, around; dm.load reads it.]])

-- in a room above this one
for _, name in ipairs { "animate", "plot", "vtk" } do
  class.later("dm.flow", name, "dm.dec.pictures.motion")
end

return M
