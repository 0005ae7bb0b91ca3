--- The load of dm.adapt: integrals of f over elements, to round-off however narrow f is, with their
-- exact derivatives by the knots. f is integrated once over panels that are halved until that
-- changes nothing; an element has whole panels and parts of two.
local core = require "dm.core"
local rules = require "dm.line.rule"

local M = {}

local FIRST, MOST, DEEPEST = 64, 8192, 60 -- panels, and how often one is halved
local EXACT = 1e-14 -- of the integral of |f| over a panel
local TINY = 1e-18  -- and of that over all
local ROUNDING = 4e-16 -- of x, which a steep f feels
local points, weights = rules.gauss(10)

-- f by the weights at the points of [a, b]
local function samples(f, a, b)
  local y = {}
  for q, xi in ipairs(points) do y[q] = weights[q] * (b - a) * f(a + xi * (b - a)) end
  return y
end

-- the integral of f over [a, b], and that of f (x - a)
local function integrals(y, a, b)
  local sum, moment = 0, 0
  for q, xi in ipairs(points) do
    sum, moment = sum + y[q], moment + xi * (b - a) * y[q]
  end
  return sum, moment
end

local function panel(f, a, b)
  local y, size, least, most = samples(f, a, b), 0, math.huge, -math.huge
  local sum, moment = integrals(y, a, b)
  for q = 1, #points do
    local value = y[q] / weights[q]
    size, least, most = size + math.abs(y[q]), math.min(least, value), math.max(most, value)
  end
  local rounding = ROUNDING * math.max(math.abs(a), math.abs(b)) * (most - least) / (b - a)
  return { from = a, to = b, sum = sum, moment = moment, size = size, rounding = rounding }
end

-- Do two halves say what the whole one says? NaN goes no further.
local function agree(whole, left, right, all)
  local off = math.abs(whole.sum - left.sum - right.sum)
  local rest = right.moment + (right.from - left.from) * right.sum
  local turned = math.abs(whole.moment - left.moment - rest) / (whole.to - whole.from)
  local bound = EXACT * (left.size + right.size) + left.rounding + right.rounding + TINY * all
  return not (off + turned > bound)
end

local function size_of(panels)
  local size = 0
  for _, p in ipairs(panels) do size = size + p.size end
  return size
end

-- the panels of [from, to], and whether all are exact
local function panels_of(f, from, to, cells)
  local open, done, count = {}, {}, math.max(FIRST, 4 * cells)
  for k = 1, count do
    local a, b = from + (k - 1) * (to - from) / count, from + k * (to - from) / count
    open[k] = panel(f, a, k == count and to or b)
  end
  for _ = 1, DEEPEST do
    local rest, all = {}, size_of(open) + size_of(done)
    for _, p in ipairs(open) do
      local middle = (p.from + p.to) / 2
      local left, right = panel(f, p.from, middle), panel(f, middle, p.to)
      if agree(p, left, right, all) then
        done[#done + 1] = p
      else
        rest[#rest + 1], rest[#rest + 2] = left, right
      end
    end
    open = rest
    if #open == 0 or #done + #open > MOST then break end
  end
  local exact = #open == 0
  table.move(open, 1, #open, #done + 1, done)
  table.sort(done, function(p, q) return p.from < q.from end)
  return done, exact
end

--- The integral of |f| over [from, to]
function M.size(f, from, to, cells)
  return size_of((panels_of(f, from, to, cells)))
end

--- The load f on [from, to]: load.exact says whether its integrals are.
function M.new(f, from, to, cells)
  local panels, exact = panels_of(f, from, to, cells)
  return { panels = panels, exact = exact,
    value = core.trace(function(w) return f(w[1]) end, 1),
    slope = core.derivative(function(w) return f(w[1]) end, 1),
    part = core.trace(function(w)
      return { integrals(samples(f, w[1], w[2]), w[1], w[2]) }
    end, 2) }
end

-- number of the panel that x is in
local function panel_at(panels, x)
  local low, high = 1, #panels
  while low < high do
    local middle = (low + high + 1) // 2
    if panels[middle].from <= x then low = middle else high = middle - 1 end
  end
  return low
end

--- The integrals A, B of f (b - x)/(b - a) and of f (x - a)/(b - a) over [a, b].
function M.over(load, a, b)
  local A, B, i = 0, 0, panel_at(load.panels, a)
  repeat
    local p = load.panels[i]
    local from, to = math.max(a, p.from), math.min(b, p.to)
    if i == #load.panels then to = b end
    local sum, moment = p.sum, p.moment
    if from > p.from or to < p.to then
      local part = load.part { from, to }
      sum, moment = part[1], part[2]
    end
    A, B, i = A + (b - from) * sum - moment, B + moment + (from - a) * sum, i + 1
  until to >= b
  return A / (b - a), B / (b - a)
end

--- The load u0 A + u1 B of an element w = { X0, v0, X1, v1 }, with u = v + the line.
function M.value(load, line, w)
  local A, B = M.over(load, w[1], w[3])
  return A * (line.value + line.slope * (w[1] - line.from) + w[2])
    + B * (line.value + line.slope * (w[3] - line.from) + w[4])
end

-- 0 where u is 0: f may be infinite at an end
local function times(u, f) return u == 0 and 0 or u * f end

--- Its slope and its Hessian by w, from A_X0 = A/l - f(X0), A_X1 = B/l, and so on.
function M.derivatives(load, line, w)
  local a, b, sigma = w[1], w[3], line.slope
  local l, A, B = b - a, M.over(load, a, b)
  local u0 = line.value + sigma * (a - line.from) + w[2]
  local u1 = line.value + sigma * (b - line.from) + w[4]
  local fa, fb, da, db = load.value { a }, load.value { b }, load.slope { a }[1],
    load.slope { b }[1]
  local A_a, A_b, B_a, B_b = A / l - fa, B / l, -A / l, fb - B / l
  local aa = 2 * sigma * A_a + (u0 - u1) * (2 * A / l - fa) / l - u0 * da
  local ab = sigma * (A_b + B_a) + (u0 - u1) * (B - A) / l ^ 2
  local bb = 2 * sigma * B_b + (u0 - u1) * (fb - 2 * B / l) / l + u1 * db
  return { sigma * A + (u0 - u1) * A / l - times(u0, fa), A,
      sigma * B + (u0 - u1) * B / l + times(u1, fb), B },
    { { aa, A_a, ab, B_a }, { A_a, 0, A_b, 0 }, { ab, A_b, bb, B_b }, { B_a, 0, B_b, 0 } }
end

return M
