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

--- Integral of f from a to b by one panel.
local function panel(f, a, b)
  local middle, half, sum = (a + b) / 2, (b - a) / 2, 0
  for i = 1, POINTS do sum = sum + weights[i] * f(middle + half * nodes[i]) end
  return sum * half
end
M.panel = panel

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
  local function at(x)
    local lo, hi = 1, #edges
    while hi - lo > 1 do
      local mid = (lo + hi) // 2
      if edges[mid] <= x then lo = mid else hi = mid end
    end
    if x == edges[lo] then return sums[lo] end
    if x == edges[hi] then return sums[hi] end
    return sums[lo] + panel(f, edges[lo], x)
  end
  return at, sums
end

--- Edges of panels no longer than `length`, the nodes among them.
function M.edges(x, length)
  local out = { x[1] }
  for i = 2, #x do
    local count = math.max(1, math.ceil((x[i] - x[i - 1]) / length - 1e-9))
    for k = 1, count - 1 do out[#out + 1] = x[i - 1] + (x[i] - x[i - 1]) * k / count end
    out[#out + 1] = x[i]
  end
  return out
end

return M
