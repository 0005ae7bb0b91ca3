--- Rules of cells: where L is looked at inside of a cell, and its action (Leok 5.1.2): bilinear u,
-- the sum of weight * h * dx * L(u, ut, ux, x, t).
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local MOST = 16  -- points of a direction

-- P_r(x) and its derivative, by the recursion of Legendre polynomials
local function legendre(r, x)
  local before, now = 1, x
  for k = 2, r do before, now = now, ((2 * k - 1) * x * now - (k - 1) * before) / k end
  return now, r * (x * now - before) / (x * x - 1)
end

--- Points and weights of Gauss's rule on [0, 1].
function M.gauss(r)
  local points, weights = {}, {}
  for i = 1, r do
    local x = -math.cos(math.pi * (i - 0.25) / (r + 0.5))
    for _ = 1, 50 do
      local value, slope = legendre(r, x)
      local step = value / slope
      x = x - step
      if math.abs(step) < 1e-16 then break end
    end
    local _, slope = legendre(r, x)
    points[i], weights[i] = (1 + x) / 2, 1 / ((1 - x * x) * slope * slope)
  end
  if r == 1 then points[1], weights[1] = 0.5, 1 end
  return points, weights
end

--- The rule of a text, "cell(gauss(r))" or "cell(corners)": its name, points and weights.
function M.parse(text, where)
  local r = text:match "^%s*cell%s*%(%s*gauss%s*%(%s*(%d+)%s*%)%s*%)%s*$"
  r = math.tointeger(tonumber(r))
  if r and r >= 1 and r <= MOST then
    local points, weights = M.gauss(r)
    return { name = ("cell(gauss(%d))"):format(r), points = points, weights = weights }
  end
  if text:match "^%s*cell%s*%(%s*corners%s*%)%s*$" then
    return { name = "cell(corners)", points = { 0, 1 }, weights = { 0.5, 0.5 } }
  end
  option.fail(where, "option 'rule' must be \"cell(gauss(r))\" with r from 1 to %d or "
    .. "\"cell(corners)\" on a line (got %q)", MOST, text)
end

--- Left and right node of a vector of 2 n symbols: numbers where n = 1.
function M.nodes(a, n)
  if n == 1 then return a[1], a[2] end
  return lists.part(a, 0, n), lists.part(a, n, n)
end
local nodes = M.nodes

-- a at 0, b at 1
local function between(a, b, s)
  if s == 0 then return a end
  if s == 1 then return b end
  return (1 - s) * a + s * b
end
M.between = between

--- The action of a cell of width dx, as a function for core.strip.
function M.action(L, rule, n, dx)
  local points, weights = rule.points, rule.weights
  return function(lower, upper, place, clock)
    local a, b = nodes(lower, n)
    local c, d = nodes(upper, n)
    local t, h, sum = clock[1], clock[2], 0
    local left, right = (c - a) / h, (d - b) / h
    local below, above = (b - a) / dx, (d - c) / dx
    for j, tau in ipairs(points) do
      for i, xi in ipairs(points) do
        local u = between(between(a, b, xi), between(c, d, xi), tau)
        sum = sum + weights[i] * weights[j] * L(u, between(left, right, xi),
          between(below, above, tau), place[1] + xi * dx, t + tau * h)
      end
    end
    return h * dx * sum
  end
end

--- The integral of L over a cell at one time, `upper` being ut: its slopes by ut are the momenta.
function M.start(L, rule, n, dx)
  local points, weights = rule.points, rule.weights
  return function(lower, upper, place, clock)
    local a, b = nodes(lower, n)
    local c, d = nodes(upper, n)
    local sum = 0
    for i, xi in ipairs(points) do
      sum = sum + weights[i] * L(between(a, b, xi), between(c, d, xi), (b - a) / dx,
        place[1] + xi * dx, clock[1])
    end
    return dx * sum
  end
end

--- L as the rules call it: what is no number is told by the name of who asked.
function M.guarded(L, where) return option.numeric(L, where .. ": L") end

return M
