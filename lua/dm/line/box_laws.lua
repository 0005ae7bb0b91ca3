--- Local laws of runs of boxes (Bridges, Reich 2001).
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local row_times = require "dm.line.box_strip".row_times

local MOST = 3e8  -- numbers of all levels

local function all_levels(run, where)
  if run.steps < 1 then option.fail(where, "a run of at least one step is needed") end
  if run.every == 1 and not run.file then return run.z, run.t end
  if run.steps * #run.level.z > MOST then
    option.fail(where, "all %d levels of %d numbers are needed at once: ask a shorter run",
      run.steps, #run.level.z)
  end
  local again = run.strip:run { u = run.level.z, from = run.level.from, t0 = run.t0, h = run.h,
    steps = run.steps }
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
