--- Local laws of runs of boxes (Bridges, Reich 2001), and what they keep round the ring.
local blame = require "dm.base.blame"
local columns = require "dm.data.columns"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local sample = require "dm.line.sample"
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

-- all nodes of a level, the first one once more, and the density of its boxes
local function level_of(run, z, density)
  local boxes, nodes, densities = run.boxes, {}, {}
  for i = 1, boxes.cells + 1 do nodes[i] = node(z, i, boxes.d, run.level.slope, boxes.dx) end
  for i = 1, boxes.cells do densities[i] = density(both(nodes[i], nodes[i + 1], boxes.dx)) end
  return nodes, densities
end

-- the largest (density' - density)/h + (flux right - flux left)/dx of all boxes
local function of_law(run, density, flux)
  local z, largest, dx, fluxes = all_levels(run, "run:balance"), 0, run.boxes.dx, {}
  local lower, before = level_of(run, z[1], density)
  for k = 2, #z do
    local upper, after = level_of(run, z[k], density)
    for i = 1, #upper do fluxes[i] = flux(both(lower[i], upper[i], run.h)) end
    for i = 1, #after do
      largest = math.max(largest,
        math.abs((after[i] - before[i]) / run.h + (fluxes[i + 1] - fluxes[i]) / dx))
    end
    lower, before = upper, after
  end
  return largest
end

-- Raises where S is not that of the run any more, since what it reads has changed.
local function check_S(run, where)
  if sample.of_S(run.boxes) ~= run.level.law then
    option.fail(where, "S is not that of the run any more: what it reads has changed")
  end
end

local laws = {}

function laws.energy(run)
  local b = run.boxes
  check_S(run, "run:balance")
  return of_law(run, function(m, D) return b.S(m) - pairing(b.K, m, D) / 2 end,
    function(m, D) return pairing(b.K, m, D) / 2 end)
end

function laws.momentum(run)
  local b = run.boxes
  check_S(run, "run:balance")
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
    local part = pull:dot(pull) > 0 and mean:dot(pull) / pull:dot(pull) or 0
    for k = 1, n do v[k] = v[k] - part * pull[(k - 1) % d + 1] end
  end
  return v
end

-- the sum of |a_i A_ij b_j|
local function terms_of(A, a, b)
  local sum = 0
  for i = 1, #a do
    for j = 1, #b do sum = sum + math.abs(a[i] * A[i][j] * b[j]) end
  end
  return sum
end

-- <v, M w> and <v, K w> of two variations, as density and flux, and the size of their terms
function laws.multisymplectic(run)
  local z, t = all_levels(run, "run:balance")
  local b, largest, size = run.boxes, 0, 0
  local v = run.strip:vary { u = z, t = t, v = variation(run, 1) }
  local w = run.strip:vary { u = z, t = t, v = variation(run, 2) }
  local function mean(u, k, i) return (node(u[k], i, b.d) + node(u[k], i + 1, b.d)) / 2 end
  local function over(u, k, i) return (node(u[k], i, b.d) + node(u[k + 1], i, b.d)) / 2 end
  local before = {}
  for i = 1, b.cells do before[i] = pairing(b.M, mean(v, 1, i), mean(w, 1, i)) end
  for k = 1, #z - 1 do
    local first = pairing(b.K, over(v, k, 1), over(w, k, 1))
    local left = first
    for i = 1, b.cells do
      local after = pairing(b.M, mean(v, k + 1, i), mean(w, k + 1, i))
      local right = i == b.cells and first or pairing(b.K, over(v, k, i + 1), over(w, k, i + 1))
      largest = math.max(largest, math.abs((after - before[i]) / run.h + (right - left) / b.dx))
      size = math.max(size, terms_of(b.M, mean(v, k + 1, i), mean(w, k + 1, i)) / run.h,
        terms_of(b.K, over(v, k, i), over(w, k, i)) / b.dx)
      before[i], left = after, right
    end
  end
  return largest, size
end

---- totals ----

-- <m, A D>/2; where a component gains a constant its derivative by x is taken in the place of
-- another's, -D_i A_ij m_j for m_i A_ij D_j, which is the same up to a difference of neighbours: so
-- the sum over the ring does not depend on where the ring begins, and flows nowhere
local function closed_pairing(A, m, D, gain)
  local sum = 0
  for i = 1, #m do
    for j = 1, #m do
      local a = A[i][j]
      if a ~= 0 then
        sum = sum + (gain[i] and not gain[j] and -D[i] * a * m[j] or m[i] * a * D[j]) / 2
      end
    end
  end
  return sum
end

local totals = {}

function totals.energy(b, m, D) return b.S(m) - closed_pairing(b.K, m, D, b.gain) end

function totals.momentum(b, m, D) return closed_pairing(b.M, m, D, b.gain) end

-- a density over the ring, one number a row
local function total(run, density)
  local boxes, slope, out = run.boxes, run.level.slope, {}
  local n, d, dx = boxes.cells, boxes.d, boxes.dx
  for k = 1, #run do
    local sum, left = 0, node(run.z[k], 1, d, slope, dx)
    for i = 1, n do
      local right = node(run.z[k], i + 1, d, slope, dx)
      sum = sum + dx * density(boxes, both(left, right, dx))
      left = right
    end
    out[k] = sum
  end
  return core.vector(out)
end

-- the component and the node of a name such as "u7", where there is one
local function entry_of(boxes, name)
  local found, node_number
  for c, component in ipairs(boxes.names) do
    local at = name:sub(1, #component) == component and name:sub(#component + 1)
    local i = at and at:find "^[1-9]%d*$" and math.tointeger(tonumber(at))
    if i and i <= boxes.cells then
      if found then
        option.fail("run:column", "'%s' is node %d of '%s' or node %d of '%s': run.%s[i][%d] are "
          .. "the numbers", name, node_number, found, i, boxes.names[c], found, node_number)
      end
      found, node_number = component, i
    end
  end
  return found, node_number
end

columns.give("dm.box_run", "run", function(run, name)
  if name == "energy" then check_S(run, "run:column") end
  if totals[name] then return total(run, totals[name]) end
  local component, i = entry_of(run.boxes, tostring(name))
  if not component then
    local first = run.boxes.names[1]
    return nil, ("t, energy, momentum and a component with the number of a node, as %s1 to %s%d")
      :format(first, first, run.boxes.cells)
  end
  local out, levels = {}, run[component]
  for j = 1, #run do out[j] = levels[j][i] end
  return core.vector(out)
end, [[
run:column(name) -> dm.vector
One number a row: "t"; "u7", node 7 of a component u; "energy" and "momentum", the densities of
run:balance summed over the ring: S(m z) - <m z, K D_x z>/2 and <m z, M D_x z>/2. Both stay to
round-off for quadratic S, else to order 2. In products with a component that gains a constant
round the ring its derivative stands, so that they flow nowhere.]])

core.method("dm.box_run", "balance", blame.caller(function(run, name)
  if not laws[name] then
    option.fail("run:balance", "takes \"energy\", \"momentum\" or \"multisymplectic\" (got %s)",
      option.got(name))
  end
  return laws[name](run)
end), [[
run:balance("energy" | "momentum" | "multisymplectic") -> number[, number]
The largest residual, over all boxes, of a local law D_t(density) + D_x(flux) = 0. With m the mean
over a box and D the differences: energy has the density S(m z) - <m z, K D_x z>/2 and the flux
<m z, K D_t z>/2; momentum exchanges M and K, density and flux; multisymplectic: <v, M w> and
<v, K w> of two first variations, random at the start (Bridges, Reich 2001). Round-off for quadratic
S, multisymplectic for every S; the others have order 2. The second number of "multisymplectic" is
the largest sum of its terms without signs: round-off is some 1e-16 of it, which is large where
variations grow.]])
