--- Running integrals of functions of one variable: Gauss points on panels, whose number is doubled
-- until nothing changes.
local M = {}

-- 12 Gauss points on [-1, 1]: roots of the Legendre polynomial by Newton's method
local POINTS = 12
local nodes, weights = {}, {}
for i = 1, POINTS do
  local x, slope = math.cos(math.pi * (i - 0.25) / (POINTS + 0.5)), nil
  for _ = 1, 8 do
    local before, now = 1, x
    for k = 1, POINTS - 1 do before, now = now, ((2 * k + 1) * x * now - k * before) / (k + 1) end
    slope = POINTS * (x * now - before) / (x * x - 1)
    x = x - now / slope
  end
  nodes[i], weights[i] = x, 2 / ((1 - x * x) * slope * slope)
end

-- inner[i][j]: the integral from -1 to node i of Lagrange polynomial j, by the same points
local inner

local function lagrange(j, x)
  local y = 1
  for k = 1, POINTS do
    if k ~= j then y = y * (x - nodes[k]) / (nodes[j] - nodes[k]) end
  end
  return y
end

local function fill_inner()
  inner = {}
  for i = 1, POINTS do
    local half, row = (nodes[i] + 1) / 2, {}
    for j = 1, POINTS do
      row[j] = 0
      for k = 1, POINTS do
        row[j] = row[j] + half * weights[k] * lagrange(j, half * (1 + nodes[k]) - 1)
      end
    end
    inner[i] = row
  end
end

--- Integral of f from a to b by one panel.
local function panel(f, a, b)
  local middle, half, sum = (a + b) / 2, (b - a) / 2, 0
  for i = 1, POINTS do sum = sum + weights[i] * f(middle + half * nodes[i]) end
  return sum * half
end

-- the panel of x among edges, by its left edge
local function find(edges, x)
  local lo, hi = 1, #edges
  while hi - lo > 1 do
    local mid = (lo + hi) // 2
    if edges[mid] <= x then lo = mid else hi = mid end
  end
  return x == edges[hi] and hi or lo
end

--- The integral of f from edges[1] on, a function of x between the first and the last edge: sums at
-- the edges, and a panel from the last edge to x.
function M.running(f, edges)
  local sums, low = { 0 }, 0
  for i = 2, #edges do  -- what rounding takes from the sum is added to the next panel
    local term = panel(f, edges[i - 1], edges[i]) + low
    local sum = sums[i - 1] + term
    low = term - (sum - sums[i - 1])
    sums[i] = sum
  end
  return function(x)
    local lo = find(edges, x)
    return x == edges[lo] and sums[lo] or sums[lo] + panel(f, edges[lo], x)
  end
end

---- the integrals of elements ----

-- of f, g, 1/g, x f and F g from a to b, F the integral of f from a
local function increments(f, g, a, b)
  local middle, half = (a + b) / 2, (b - a) / 2
  local F, G, A, moment, FG, loads, flows = 0, 0, 0, 0, 0, {}, {}
  for i = 1, POINTS do
    local x, w = middle + half * nodes[i], weights[i]
    local y, z = f(x), g(x)
    loads[i], flows[i] = y, w * z
    F, G, A, moment = F + w * y, G + w * z, A + w / z, moment + w * x * y
  end
  for i = 1, POINTS do
    local row, sum = inner[i], 0
    for j = 1, POINTS do sum = sum + row[j] * loads[j] end
    FG = FG + flows[i] * sum
  end
  return F * half, G * half, A * half, moment * half, FG * half * half
end

local KEYS = { "F", "G", "A", "M", "FG" }

--- Running integrals F of f, G of g, A of 1/g, M of x f, and FG of F g: functions of x between the
-- first and the last edge. f and g are called once at a point.
function M.together(f, g, edges)
  if not inner then fill_inner() end
  local sums, low, out = { F = { 0 }, G = { 0 }, A = { 0 }, M = { 0 }, FG = { 0 } }, {}, {}
  local function add(key, i, term)
    term = term + (low[key] or 0)
    local before = sums[key][i - 1]
    local sum = before + term
    low[key], sums[key][i] = term - (sum - before), sum
  end
  for i = 2, #edges do
    local F, G, A, moment, FG = increments(f, g, edges[i - 1], edges[i])
    add("FG", i, sums.F[i - 1] * G + FG)
    add("F", i, F)
    add("G", i, G)
    add("A", i, A)
    add("M", i, moment)
  end
  for k, key in ipairs(KEYS) do
    out[key] = function(x)
      local lo = find(edges, x)
      if x == edges[lo] then return sums[key][lo] end
      local more = { increments(f, g, edges[lo], x) }
      local term = key == "FG" and sums.F[lo] * more[2] + more[5] or more[k]
      return sums[key][lo] + term
    end
  end
  return out
end

--- The points of a panel.
function M.points(a, b)
  local out = {}
  for i = 1, POINTS do out[i] = (a + b) / 2 + (b - a) / 2 * nodes[i] end
  return out
end

--- Edges of panels no longer than `length`, at least so many between two nodes, which are among
-- them.
function M.edges(x, length, least)
  local out = { x[1] }
  for i = 2, #x do
    local count = math.max(least, math.ceil((x[i] - x[i - 1]) / length - 1e-9))
    for k = 1, count - 1 do out[#out + 1] = x[i - 1] + (x[i] - x[i - 1]) * k / count end
    out[#out + 1] = x[i]
  end
  return out
end

return M
