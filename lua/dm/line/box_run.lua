--- Runs of boxes, and their local laws.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local picture = require "dm.line.picture"
local start = require "dm.line.box_start"

local M = {}

local Run = core.class({ __name = "dm.box_run" }, [[
dm.box_run: the recorded levels of boxes; #run rows
fields: by the name of each component a matrix, run.u[i] (a vector of all nodes), t[i], z[i] (all
components, node after node, without what they gain), gain (by name: what a component gains round
the ring), steps, h, boxes, solver]])

M.reserved = { t = true, z = true, gain = true, steps = true, h = true, boxes = true, solver = true,
  every = true, t0 = true, level = true, balance = true, drift = true, column = true, plot = true,
  nodes = true, vtk = true, npy = true, animate = true, strip = true, rule = true }

---- the equations of a box ----

-- sum of matrix[i][j] v[j], without zeros
local function row_times(matrix, i, v)
  local sum = 0
  for j = 1, #v do
    local x = matrix[i][j]
    if x ~= 0 then sum = sum + x * v[j] end
  end
  return sum
end

-- M D_t m_x z + K D_x m_t z - grad S(m z), as a function for core.strip
local function equations(boxes, slope)
  local d, dx = boxes.d, boxes.dx
  return function(lower, upper, _, clock)
    local a, b = lists.part(lower, 0, d), lists.part(lower, d, d)
    local c, e = lists.part(upper, 0, d), lists.part(upper, d, d)
    local zt = (c + e - a - b) / (2 * clock[2])
    local zx = (b + e - a - c) / (2 * dx)
    local out, gradient = {}, boxes.gradient((a + b + c + e) / 4)
    for i = 1, d do
      local lifted = row_times(boxes.M, i, zt) + row_times(boxes.K, i, zx) - gradient[i]
      for k, s in pairs(slope) do lifted = lifted + boxes.K[i][k] * s end
      out[i] = lifted
    end
    return out
  end
end

-- the strip of a run, whose gained components have these slopes
local function strip_of(solver, slope)
  local boxes = solver.boxes
  local held = core.zeros(boxes.cells * boxes.d)
  for _, gauge in ipairs(solver.gauges) do held[gauge.held] = 1 end
  return core.strip(equations(boxes, slope), { values = boxes.d, cells = boxes.cells, ring = true,
    boxes = true, held = held, absorbs = { 0, 0 },
    place = core.zeros(boxes.cells) })
end

---- runs ----

-- loose components begin at their mean over the first slab
local function settle(solver, level, strip, t0)
  if #level.loose == 0 then return end
  local out = strip:run { u = level.z, t0 = t0, h = solver.h, steps = 1 }
  if out.code ~= "ok" then return end
  local d = solver.boxes.d
  for _, c in ipairs(level.loose) do
    for i = 0, solver.boxes.cells - 1 do level.z[i * d + c] = out.u[2][i * d + c] / 2 end
  end
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

local function new_run(solver, level, plan, outcome)
  local boxes = solver.boxes
  local run = { solver = solver, boxes = boxes, h = solver.h, steps = outcome.done, t = outcome.t,
    z = outcome.u, level = level, strip = level.strip, every = plan.every, t0 = plan.t0,
    gain = core.result {},
    rule = "box" }
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

--- solver:run{...}
function M.run(solver, options)
  option.check(options, { "z", "steps", "t", "t0", "every" }, "solver:run")
  option.need(options, "z", "solver:run", "{ name = function of x, ... }")
  local plan = { t0 = option.number(options, "t0", "solver:run", nil, 0),
    steps = steps_of(solver, options),
    every = option.whole(options, "every", "solver:run", 1, 1 << 53, 1) }
  local level = start.level(solver.boxes, options.z, solver)
  level.strip = strip_of(solver, level.slope)
  settle(solver, level, level.strip, plan.t0)
  local outcome = level.strip:run { u = level.z, t0 = plan.t0, h = solver.h, steps = plan.steps,
    every = plan.every }
  local run = new_run(solver, level, plan, outcome)
  if outcome.code ~= "ok" then
    outcome.time = run.t[#run.t]
    core.strip_fail(outcome, "box", run, outcome.code == "singular" and SINGULAR or nil)
  end
  return run
end

function Run.__len(run) return #run.t end

function Run.__tostring(run)
  local held = #run.solver.held > 0 and ("; the constant of %s is held at the first node")
    :format(table.concat(run.solver.held, ", ")) or ""
  return ("run of %d boxes a node to t = %.6g, h = %.4g: %d rows of %s at %d nodes%s"):format(
    run.steps, run.t[#run.t], run.h, #run, table.concat(run.boxes.names, ", "), run.boxes.cells,
    held)
end

---- local laws ----

local function all_levels(run, where)
  if run.steps < 1 then option.fail(where, "a run of at least one step is needed") end
  if run.every == 1 then return run.z, run.t end
  local again = run.strip:run { u = run.level.z, t0 = run.t0, h = run.h, steps = run.steps }
  return again.u, again.t
end

-- value of a form <a, A b>
local function pairing(A, a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i] * row_times(A, i, b) end
  return sum
end

-- z of a node, with what it has gained; node cells + 1 is the first one, a ring later
local function node(z, i, d, slope, dx)
  local out = lists.part(z, (i - 1) * d % #z, d)
  for c, s in pairs(slope or {}) do out[c] = out[c] + s * (i - 1) * dx end
  return out
end

-- mean and difference quotient of two nodes
local function both(a, b, step) return (a + b) / 2, (b - a) / step end

-- the largest (density' - density)/h + (flux right - flux left)/dx of two levels
local function residual_of(run, z0, z1, density, flux)
  local boxes, slope = run.boxes, run.level.slope
  local n, d, dx, largest = boxes.cells, boxes.d, boxes.dx, 0
  local lower, upper, fluxes = {}, {}, {}
  for i = 1, n + 1 do
    lower[i], upper[i] = node(z0, i, d, slope, dx), node(z1, i, d, slope, dx)
    fluxes[i] = flux(both(lower[i], upper[i], run.h))
  end
  for i = 1, n do
    local before = density(both(lower[i], lower[i + 1], dx))
    local after = density(both(upper[i], upper[i + 1], dx))
    largest = math.max(largest,
      math.abs((after - before) / run.h + (fluxes[i + 1] - fluxes[i]) / dx))
  end
  return largest
end

local function of_law(run, density, flux)
  local z, largest = all_levels(run, "run:balance"), 0
  for k = 1, #z - 1 do
    largest = math.max(largest, residual_of(run, z[k], z[k + 1], density, flux))
  end
  return largest
end

local laws = {}

function laws.energy(run)
  local b = run.boxes
  return of_law(run, function(m, D) return b.S(m) - pairing(b.K, m, D) / 2 end,
    function(m, D) return pairing(b.K, m, D) / 2 end)
end

function laws.momentum(run)
  local b = run.boxes
  return of_law(run, function(m, D) return pairing(b.M, m, D) / 2 end,
    function(m, D) return b.S(m) - pairing(b.M, m, D) / 2 end)
end

-- a random variation of the start that has levels above it
local function variation(run, row)
  local random, n = core.random(1), #run.level.z
  local v, d = core.zeros(n), run.boxes.d
  for k = 1, n do v[k] = 2 * random:uniform(row, k) - 1 end
  for _, gauge in ipairs(run.solver.gauges) do
    local mean, pull = core.zeros(d), gauge.pull
    for i = 1, run.boxes.cells do mean = mean + node(v, i, d) / run.boxes.cells end
    local part = mean:dot(pull) / pull:dot(pull)
    for k = 1, n do v[k] = v[k] - part * pull[(k - 1) % d + 1] end
  end
  return v
end

-- <v, M w> and <v, K w> of two variations, as density and flux
function laws.multisymplectic(run)
  local z, t = all_levels(run, "run:balance")
  local b, largest = run.boxes, 0
  local v = run.strip:vary { u = z, t = t, v = variation(run, 1) }
  local w = run.strip:vary { u = z, t = t, v = variation(run, 2) }
  local function mean(u, k, i, j) return (node(u[k], i, b.d) + node(u[k], j, b.d)) / 2 end
  local function over(u, k, i) return (node(u[k], i, b.d) + node(u[k + 1], i, b.d)) / 2 end
  for k = 1, #z - 1 do
    for i = 1, b.cells do
      local j = i == b.cells and 1 or i + 1
      local time = pairing(b.M, mean(v, k + 1, i, j), mean(w, k + 1, i, j))
        - pairing(b.M, mean(v, k, i, j), mean(w, k, i, j))
      local space = pairing(b.K, over(v, k, j), over(w, k, j))
        - pairing(b.K, over(v, k, i), over(w, k, i))
      largest = math.max(largest, math.abs(time / run.h + space / b.dx))
    end
  end
  return largest
end

core.method("dm.box_run", "balance", blame.caller(function(run, name)
  if not laws[name] then
    option.fail("run:balance", "takes \"energy\", \"momentum\" or \"multisymplectic\" (got %s)",
      option.got(name))
  end
  return laws[name](run)
end), [[
run:balance("energy" | "momentum" | "multisymplectic") -> number
The largest residual, over all boxes, of a local law D_t(density) + D_x(flux) = 0. With m the mean
over a box and D the differences: energy has the density S(m z) - <m z, K D_x z>/2 and the flux
<m z, K D_t z>/2; momentum exchanges M and K, density and flux; multisymplectic: <v, M w> and
<v, K w> of two first variations, random at the start (Bridges, Reich 2001). Round-off for quadratic
S, multisymplectic for every S; the others have order 2.]])

picture.give "dm.box_run"

return M
