--- Cells whose nodes move (Leok 5.6): values (u, y), where node i is at its place in the line + y.
-- The cell is the image of the unit square, t = t0 + h tau, x bilinear; |D phi| = h x_xi.
local core = require "dm.core"
local lists = require "dm.base.lists"
local rules = require "dm.line.rule"

local M = {}

local between = rules.between

-- u (n numbers, or a number) and y of a node's list at `first`
local function split(a, first, n)
  local u = n == 1 and a[first + 1] or lists.part(a, first, n)
  return u, a[first + n + 1]
end

--- The action of a cell of n values and the displacement, as a function for core.strip.
function M.action(L, rule, n, dx)
  local points, weights = rule.points, rule.weights
  return function(lower, upper, place, clock)
    local a, ya = split(lower, 0, n)
    local b, yb = split(lower, n + 1, n)
    local c, yc = split(upper, 0, n)
    local d, yd = split(upper, n + 1, n)
    local t, h, sum = clock[1], clock[2], 0
    for j, tau in ipairs(points) do
      local x_xi = dx + between(yb - ya, yd - yc, tau)
      local ux = between(b - a, d - c, tau) / x_xi
      for i, xi in ipairs(points) do
        local u = between(between(a, b, xi), between(c, d, xi), tau)
        local y = between(between(ya, yb, xi), between(yc, yd, xi), tau)
        local ut = (between(c - a, d - b, xi) - ux * between(yc - ya, yd - yb, xi)) / h
        sum = sum + weights[i] * weights[j] * x_xi
          * L(u, ut, ux, place[1] + xi * dx + y, t + tau * h)
      end
    end
    return h * sum
  end
end

--- The integral of L over a cell at one time; `upper` is (ut, yt), along the moving nodes.
function M.start(L, rule, n, dx)
  local points, weights = rule.points, rule.weights
  return function(lower, upper, place, clock)
    local a, ya = split(lower, 0, n)
    local b, yb = split(lower, n + 1, n)
    local c, yc = split(upper, 0, n)
    local d, yd = split(upper, n + 1, n)
    local x_xi, sum = dx + yb - ya, 0
    local ux = (b - a) / x_xi
    for i, xi in ipairs(points) do
      local ut = between(c, d, xi) - ux * between(yc, yd, xi)
      sum = sum + weights[i] * L(between(a, b, xi), ut, ux,
        place[1] + xi * dx + between(ya, yb, xi), clock[1])
    end
    return x_xi * sum
  end
end

--- Vectors of n values at every node and a displacement behind each: put together, or zeros where y
-- is nil.
function M.joined(u, y, nodes, n)
  local out = core.zeros(nodes * (n + 1))
  for i = 0, nodes - 1 do
    for k = 1, n do out[i * (n + 1) + k] = u[i * n + k] end
    out[i * (n + 1) + n + 1] = y and y[i + 1] or 0
  end
  return out
end

--- And taken apart: matrices of levels -> matrix of u, matrix of y.
function M.apart(levels, nodes, n)
  local u, y = core.zeros(#levels, nodes * n), core.zeros(#levels, nodes)
  for j = 1, #levels do
    local from, us, ys = levels[j], u[j], y[j]
    for i = 0, nodes - 1 do
      for k = 1, n do us[i * n + k] = from[i * (n + 1) + k] end
      ys[i + 1] = from[i * (n + 1) + n + 1]
    end
  end
  return u, y
end

--- Nodes whose equation of motion is singular, since the slopes of u on both
-- sides of them are equal: 1 in a vector of all nodes. Ends of an open line are held, too.
function M.affine(grid, u, n)
  local marks, kinks, largest, size = core.zeros(grid.nodes), {}, 0, 0
  for i = 1, #u do size = math.max(size, math.abs(u[i])) end
  for i = 1, grid.nodes do
    local left, right = i == 1 and grid.nodes or i - 1, i == grid.nodes and 1 or i + 1
    local kink = 0
    for k = 1, n do
      local function second(w)
        return math.abs(w[(left - 1) * n + k] - 2 * w[(i - 1) * n + k] + w[(right - 1) * n + k])
      end
      kink = math.max(kink, second(u))
    end
    if not grid.periodic and (i == 1 or i == grid.nodes) then kink = 0 end
    kinks[i], largest = kink, math.max(largest, kink)
  end
  local least = math.max(1e-3 * largest, 1e-13 * size) -- of kinks that are no round-off
  for i = 1, grid.nodes do marks[i] = kinks[i] <= least and 1 or 0 end
  return marks
end

return M
