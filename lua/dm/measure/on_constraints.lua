--- Is a state in coordinates on the constraints of its system? What is linearised there is the
-- motion on them.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local abs, max, sqrt = math.abs, math.max, math.sqrt

local ON = 1e-8  -- how far off a state may be, in parts of its size

-- raises where one of the values is off by more than its slope makes of a change of so much
local function check_values(values, slopes, size, name, what)
  for c, value in ipairs(values) do
    local square = 0
    for _, s in ipairs(slopes[c]) do square = square + s * s end
    if not (abs(value) <= ON * max(1, size) * sqrt(square)) then
      error(("%s: the state is off the constraints: %s %d is %.3g there"):format(what, name, c,
        value), 0)
    end
  end
end

-- columns first + 1 .. first + n of the rows of J
local function columns(J, count, first, n)
  local out = {}
  for c = 1, count do out[c] = lists.part(J[c], first, n) end
  return out
end

local function check_holonomic(g, q, v, t, what)
  local n = #q
  local J = core.derivative(function(x, s) return core.vector(lists.entries(g(x, s))) end, n,
    "number")(q, t)
  local values, speeds = lists.entries(g(q, t)), {}
  local G = columns(J, #values, 0, n)
  for c, row in ipairs(G) do
    speeds[c] = J[c][n + 1]
    for k = 1, n do speeds[c] = speeds[c] + row[k] * v[k] end
  end
  check_values(values, G, q:norm(), "constraint", what)
  check_values(speeds, G, v:norm(), "the rate of constraint", what)
end

local function check_rolling(phi, q, v, t, what)
  local n = #q
  local J = core.derivative(function(x, y, s) return core.vector(lists.entries(phi(x, y, s))) end,
    n, n, "number")(q, v, t)
  local values = lists.entries(phi(q, v, t))
  check_values(values, columns(J, #values, n, n), v:norm(), "rolling condition", what)
end

--- Raises where (q, v) at the time t is off the constraints; what: who asks.
function M.check(system, q, v, t, what)
  local given = system.given
  local g, phi = bound(given.constraint, given.params), bound(given.rolling, given.params)
  if g then check_holonomic(g, q, v, t, what) end
  if phi then check_rolling(phi, q, v, t, what) end
end

return M
