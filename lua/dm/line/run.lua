--- dm.line_run: the levels of a run, and what is asked of them.
local blame = require "dm.base.blame"
local checkpoint = require "dm.data.checkpoint"
local columns = require "dm.data.columns"
local core = require "dm.core"
local lacking = require "dm.base.lacking"
local moving = require "dm.line.moving"
local picture = require "dm.line.picture"

local M = {}

local Run = core.class({ __name = "dm.line_run" }, [[
dm.line_run: the recorded levels of a field on a line; #run rows
fields: u[i], p[i] (vectors, node after node), t[i], energy[i] (-dS/dh of the slab that ends at the
row, first: of the first slab), x[i] (places of the nodes, where they move), nodes (where they are
at the start), frozen (numbers of the nodes that stay, where others move), steps, h, rule, field,
solver, ns_per_step]])
lacking.refuse(Run, { fellow = "dm.path", what = "run of a field on a line", reasons = {
  csv = "run:npy(file) writes whole levels, run:column(name) has single numbers",
  form = "run.u[i] is level i, node after node",
  frequency = "dm.fft of a column, as run:column \"u7\", has its spectrum",
  mass = "run.p[i] are the momenta of level i",
  momentum = "run:conservation(generator) is the residual of its law, run.p[i]:sum() the momentum "
    .. "of shifts of u",
  noether = "run:conservation(generator) is the residual of its law",
  series = "run:column has the numbers over run.t",
  velocity = "(run.u[i + 1] - run.u[i]) / run.h is that of a slab",
  worst = "run:drift(column).largest is the largest difference",
} })

-- where the nodes are: at the start, and at all rows
local function places(run, y)
  local field = run.field
  local from = {}
  for i = 1, field.nodes do from[i] = require "dm.line.grid".x(field.grid, i) end
  run.nodes = core.vector(from)
  if not y then return end
  for j = 1, #y do
    local row = y[j]
    for i = 1, field.nodes do row[i] = row[i] + from[i] end
  end
  run.x = y
end

-- numbers of the nodes that stay although others move
local function frozen_of(field, marks)
  local out = {}
  for i = 1, field.nodes do
    local is_end = not field.periodic and (i == 1 or i == field.nodes)
    if marks[i] ~= 0 and not is_end then out[#out + 1] = i end
  end
  return core.result(out)
end

-- the first row alone of a run of no steps
local function cut(outcome)
  for _, name in ipairs { "u", "p" } do
    local row = core.zeros(1, #outcome[name][1])
    for k = 1, #outcome[name][1] do row[1][k] = outcome[name][1][k] end
    outcome[name] = row
  end
  outcome.t, outcome.energy = core.vector { outcome.t[1] }, core.vector { outcome.energy[1] }
  outcome.done = 0
end

-- where the run stands, for what goes on from it
local function ending_of(level, plan, outcome)
  local last = #outcome.t
  return { u = core.vector(outcome.u[last]), p = core.vector(outcome.p[last]),
    from = outcome.ending, t0 = plan.t0, frozen = level.frozen }
end

--- The run of a solver that began with `level` and ended as `outcome` tells.
function M.new(solver, level, plan, outcome, seconds)
  local field = solver.field
  if plan.steps == 0 then cut(outcome) end
  local run = { field = field, solver = solver, rule = solver.rule, h = solver.h,
    steps = outcome.done, every = plan.every, t0 = plan.t0, until_t = plan.until_t, t = outcome.t,
    energy = outcome.energy, u = outcome.u, p = outcome.p, level = level, levels = outcome.u,
    file = plan.file, ending = outcome.done > 0 and ending_of(level, plan, outcome)
      or solver.ending,
    ns_per_step = outcome.done > 0 and seconds * 1e9 / outcome.done or 0 }
  local y
  if solver.moves then
    run.u, y = moving.apart(outcome.u, field.nodes, field.values)
    run.p, run.px = moving.apart(outcome.p, field.nodes, field.values)
    run.frozen = frozen_of(field, level.frozen)
  end
  places(run, y)
  return setmetatable(run, Run)
end

---- failures ----

-- moving nodes: those that have passed each other, or are about to
local function tangles(run, outcome)
  if outcome.tangled > 0 then
    return ("the nodes of cell %d have passed each other (|D phi| <= 0): moving nodes tangle "
      .. "there; take a smaller h, or fixed nodes"):format(outcome.tangled)
  end
  local x, narrow, least = run.x[#run], 1, math.huge
  for c = 1, #x - 1 do
    if x[c + 1] - x[c] < least then narrow, least = c, x[c + 1] - x[c] end
  end
  return ("moving nodes tangle: cell %d has %.3g of its width left, and the next level has no "
    .. "solution with all cells in order; take a smaller h, or fixed nodes")
    :format(narrow, least / run.field.dx)
end

-- the limit of stability about the start, or about u = 0, where h is beyond it
local function beyond(run)
  local field, solver = run.field, run.solver
  if solver.moves then return nil end
  for _, about in ipairs { { "the start", run.u[1] }, { "u = 0", 0 } } do
    local fine, limit = blame.try(field.stability_limit, field, solver.rule, { u = about[2],
      t = run.t[#run.t] })
    if fine and limit < solver.h * (1 - 1e-9) then return limit, about[1] end
  end
end

-- where u of the last row is largest
local function largest_text(run)
  local u, n, at, most = run.u[#run], run.field.values, 1, 0
  for i = 1, #u do
    if math.abs(u[i]) > most then at, most = i, math.abs(u[i]) end
  end
  local node = (at - 1) // n + 1
  return ("; |u| is largest, %.3g, at node %d, x = %.6g"):format(most, node, run.nodes[node])
end

-- what a failed level may come from, or nil: the general advice then
local function reason(run, outcome)
  if outcome.code == "stopped" then return nil end
  local solver, field = run.solver, run.field
  if solver.moves then return tangles(run, outcome) end
  if solver.stretches and outcome.code == "no_convergence" then
    return "no height gives this slab the energy of the first one: start where the field is less "
      .. "smooth in time, or leave free = \"t\" out"
  end
  if outcome.code == "singular" and #solver.points.points == 1
    and not (field.periodic and field.cells % 2 == 1) then
    return "the matrix of a level is singular: one point a cell does not see u = (-1)^i; take "
      .. "cell(gauss(2)), or a ring of an odd number of cells"
  end
  if outcome.code == "singular" then
    return "the matrix of a level is singular: is L quadratic in ut to lowest order (d2L/dut2 is "
      .. "not 0), or do moving nodes stand where u is affine?"
  end
  local where = outcome.code == "blow_up" and largest_text(run) or ""
  local limit, about = beyond(run)
  if limit then
    return ("h = %.6g is beyond the limit of stability, %.6g about %s (field:stability_limit)%s")
      :format(solver.h, limit, about, where)
  end
  return outcome.code == "blow_up" and "a smaller h or fewer cells may be stable" .. where or nil
end

--- Raises the dm.failure of a run; its path is the run.
function M.fail(run, outcome)
  outcome.time = run.t[#run.t]
  core.strip_fail(outcome, run.rule, run, reason(run, outcome))
end

---- text ----

local function grouped(n)
  local text = ("%d"):format(n):reverse():gsub("(%d%d%d)", "%1,"):reverse()
  return (text:gsub("^,", ""))
end

function Run.__len(run) return #run.t end

-- an energy that has gone from its start by more than a tenth: is the step too long?
local function warning(run, off)
  if not (off > math.abs(run.energy[1]) / 10) or run.steps == 0 then return "" end
  local limit, about = beyond(run)
  return limit and ("; h = %.6g is beyond the limit of stability, %.6g about %s"):format(run.h,
    limit, about) or ""
end

function Run.__tostring(run)
  local E, off = run.energy, 0
  for i = 1, #E do off = math.max(off, math.abs(E[i] - E[1])) end
  local last = run.t[#run.t]
  local short = run.until_t and last - run.until_t > 1e-6 * run.h
  return ("run of %s slab%s of %s to t = %.6g%s (%.3g ns a cell): energy off by %.2g; %d row%s of "
    .. "%d nodes%s"):format(grouped(run.steps), run.steps == 1 and "" or "s", run.rule, last,
    short and (" (h = %.6g does not divide the way to %.6g)"):format(run.h, run.until_t) or "",
    run.ns_per_step / run.field.cells, off, #run, #run == 1 and "" or "s", run.field.nodes,
    run.frozen and #run.frozen > 0 and (", %d of them frozen where u is affine"):format(#run.frozen)
    or "") .. (run.file and "; all rows are in " .. run.file or "") .. warning(run, off)
end

---- columns ----

core.method("dm.line_run", "checkpoint", blame.caller(function(run, file)
  return checkpoint.write(require "dm.line.checkpoint".field, run, file)
end), [[
run:checkpoint(file) -> file name
Write where the run ended, a text with all bits; field:resume(file) goes on from it.]])

columns.give("dm.line_run", "run", function(run, name)
  if name == "energy" then return run.energy end
  local which, i = tostring(name):match "^([up])(%d+)$"
  i = math.tointeger(tonumber(i))
  if not i or i < 1 or i > #run.u[1] then
    return nil, ("t, energy, u1 to u%d and p1 to p%d"):format(#run.u[1], #run.u[1])
  end
  local out, levels = {}, run[which]
  for j = 1, #run do out[j] = levels[j][i] end
  return core.vector(out)
end, [[
run:column(name) -> dm.vector
One number a row: "t", "energy", "u7" or "p7" (entry 7 of u or p).]])

picture.give "dm.line_run"

return M
