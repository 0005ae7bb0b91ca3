--- Runs of boxes.
local blame = require "dm.base.blame"
local checkpoint = require "dm.data.checkpoint"
local core = require "dm.core"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"
local picture = require "dm.line.picture"
local sample = require "dm.line.sample"
local start = require "dm.line.box_start"
local stream = require "dm.line.stream"
local strips = require "dm.line.box_strip"

local M = {}

local Run = core.class({ __name = "dm.box_run" }, [[
dm.box_run: the recorded levels of boxes; #run rows
fields: by the name of each component a matrix, run.u[i] (a vector of all nodes), t[i], z[i] (all
components, node after node, without what they gain), gain (by name: what a component gains round
the ring), moved (by name: how far what was given was from its row without z_t, on which it starts),
steps, h, boxes, solver]])
lacking.refuse(Run, { fellow = "dm.path", what = "run of boxes", reasons = {
  csv = "run:npy(file) writes whole levels, run:column(name) has single numbers",
  energy = "it is a column: run:column \"energy\"; run:balance \"energy\" is its local law",
  form = "run.z[i] is level i, and by the name of a component its nodes",
  frequency = "dm.fft of a column has its spectrum",
  momentum = "it is a column: run:column \"momentum\"; run:balance \"momentum\" is its local law",
  noether = "run:balance \"energy\" and \"momentum\" are the laws of shifts in t and x",
  series = "run:column has the numbers over run.t",
  worst = "run:drift(column).largest is the largest difference",
} })

M.reserved = {} -- names that components cannot have
for _, name in ipairs { "t", "z", "gain", "moved", "steps", "h", "boxes", "solver", "every", "t0",
  "level", "balance", "drift", "column", "plot", "nodes", "vtk", "npy", "animate", "strip", "rule",
  "file", "ending", "checkpoint" } do M.reserved[name] = true end

---- runs ----

-- the first row alone of a run of no steps
local function cut(outcome)
  local row = core.zeros(1, #outcome.u[1])
  for k = 1, #outcome.u[1] do row[1][k] = outcome.u[1][k] end
  outcome.u, outcome.t, outcome.done = row, core.vector { outcome.t[1] }, 0
end

local function component(boxes, z, c, slope)
  local out, d = core.zeros(#z, boxes.cells), boxes.d
  for j = 1, #z do
    local from, row = z[j], out[j]
    for i = 1, boxes.cells do
      row[i] = from[(i - 1) * d + c] + (slope and slope * (i - 1) * boxes.dx or 0)
    end
  end
  return out
end

-- where the run stands, for what goes on from it
local function ending_of(solver, level, plan, outcome)
  if outcome.done == 0 then return solver.ending end
  return { u = core.vector(outcome.u[#outcome.u]), from = outcome.ending, t0 = plan.t0,
    slope = level.slope }
end

local function new_run(solver, level, plan, outcome)
  local boxes = solver.boxes
  if plan.steps == 0 then cut(outcome) end
  local run = { solver = solver, boxes = boxes, h = solver.h, steps = outcome.done, t = outcome.t,
    z = outcome.u, level = level, strip = level.strip, every = plan.every, t0 = plan.t0,
    gain = core.result {}, moved = core.result(level.moved), rule = "box", file = plan.file,
    ending = ending_of(solver, level, plan, outcome) }
  for c, name in ipairs(boxes.names) do
    run[name] = component(boxes, outcome.u, c, level.slope[c])
    if level.slope[c] then run.gain[name] = level.slope[c] * (boxes.to - boxes.from) end
  end
  run.nodes = core.zeros(boxes.cells)
  for i = 1, boxes.cells do run.nodes[i] = boxes.from + (i - 1) * boxes.dx end
  return setmetatable(run, Run)
end

local function steps_of(solver, options)
  local where = "solver:run"
  if options.t ~= nil and options.steps ~= nil then
    option.fail(where, "give one of 't' and 'steps'")
  end
  if options.t == nil then
    option.need(options, "steps", where, "a number of boxes in time, or t = a duration")
    return option.whole(options, "steps", where, 0, 1 << 53)
  end
  return math.ceil(option.positive(options, "t", where, "a duration") / solver.h - 1e-9)
end

local SINGULAR = "a step is singular: h and dx are at a resonance of the boxes, or the equations "
  .. "do not determine a component; take another h or number of cells"

-- rows of a file: t and the components, as run:npy writes them
local function writer(boxes, level)
  local fields = { { "t", 0 } }
  for c, name in ipairs(boxes.names) do fields[c + 1] = { name, boxes.cells } end
  return { fields = fields, write = function(o, first, write)
    local columns = {}
    for c = 1, boxes.d do columns[c] = component(boxes, o.u, c, level.slope[c]) end
    for i = first, #o.t do
      local row = { t = o.t[i] }
      for c, name in ipairs(boxes.names) do row[name] = columns[c][i] end
      write(row)
    end
  end }
end

-- the level that a run begins with, and its strip
local function level_of(solver, options, plan)
  local ending = solver.ending
  strips.follow(solver)
  if ending then
    checkpoint.check_options(options, { "z", "t0" })
    checkpoint.check_still(require "dm.line.checkpoint".boxes, solver.boxes, solver)
    return { z = ending.u, u = ending.u, from = ending.from, slope = ending.slope, moved = {},
      strip = strips.new(solver, ending.slope) }
  end
  option.need(options, "z", "solver:run", "{ name = function of x, ... }")
  local level = start.level(solver.boxes, options.z, solver)
  level.strip = strips.new(solver, level.slope)
  strips.settle(solver, level, level.strip, plan.t0)
  level.u = level.z
  return level
end

--- solver:run{...}
function M.run(solver, options)
  local where, ending = "solver:run", solver.ending
  option.check(options, { "z", "steps", "t", "t0", "every", "file", "checkpoint" }, where)
  local plan = { t0 = ending and ending.t0 or option.number(options, "t0", where, nil, 0),
    steps = steps_of(solver, options), every = option.whole(options, "every", where, 1, 1 << 53, 1),
    file = option.text(options, "file", where) }
  local saved_in = option.text(options, "checkpoint", where)
  local level = level_of(solver, options, plan)
  level.law = sample.of_S(solver.boxes)
  local outcome = stream.go(solver, level, plan, writer(solver.boxes, level))
  local run = new_run(solver, level, plan, outcome)
  if saved_in then run:checkpoint(saved_in) end
  if outcome.code ~= "ok" then
    outcome.time = run.t[#run.t]
    core.strip_fail(outcome, "box", run, outcome.code == "singular" and SINGULAR or nil)
  end
  return run
end

function Run.__len(run) return #run.t end

local function moved_text(run)
  local out = {}
  for _, name in ipairs(run.boxes.names) do
    local off = run.moved[name]
    if off then
      out[#out + 1] = ("; the start of %s was moved onto its row without z_t, by %.3g at most")
        :format(name, off)
    end
  end
  return table.concat(out)
end

function Run.__tostring(run)
  local held = #run.solver.held > 0 and ("; the constant of %s is held at the first node")
    :format(table.concat(run.solver.held, ", ")) or ""
  return ("run of %d boxes a node to t = %.6g, h = %.4g: %d row%s of %s at %d nodes"):format(
    run.steps, run.t[#run.t], run.h, #run, #run == 1 and "" or "s",
    table.concat(run.boxes.names, ", "), run.boxes.cells) .. held .. moved_text(run)
    .. (run.file and "; all rows are in " .. run.file or "")
end

core.method("dm.box_run", "checkpoint", blame.caller(function(run, file)
  return checkpoint.write(require "dm.line.checkpoint".boxes, run, file)
end), [[
run:checkpoint(file) -> file name
Write where the run ended, a text with all bits; boxes:resume(file) goes on from it.]])

picture.give "dm.box_run"

return M
