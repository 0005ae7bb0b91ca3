--- The order of a rule, measured on a run: how fast the ends of runs with h, h/2, h/4 approach each
-- other.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local has_own_time = require "dm.base.own_time"
local option = require "dm.base.options"
local starts = require "dm.base.start"

local M = {}

local abs, max, log = math.abs, math.max, math.log

-- columns q and p of the end of a run of n steps over the duration
local function finish(solver, options, duration, n)
  local o = { q = options.q, v = options.v, p = options.p, t0 = options.t0 }
  if has_own_time(solver) then
    o.at = { (options.t0 or 0) + duration }
  else
    o.steps, o.every = n, n
  end
  local path = solver.system:solver { rule = solver.rule, h = duration / n,
    newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } }:run(o)
  local out, own = {}, solver.system.place
  local count = (own and own.size or solver.system.Q.dimension) + #path.p[1]
  for i = 1, count do out[i] = path:column(path.columns[1 + i])[#path] end
  return out
end

local function apart(a, b)
  local worst, size = 0, 0
  for i = 1, #a do worst, size = max(worst, abs(a[i] - b[i])), max(size, abs(b[i])) end
  return worst, size
end

local ROUND = 1e-13  -- of the size: differences below tell nothing of the order

M.measured_order = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  local what = "solver:measured_order"
  option.check(options, { "q", "v", "p", "t", "t0" }, what, "{ q =, v =, t = }")
  local duration = option.need(options, "t", what, "the duration of the runs that are compared")
  option.demand(type(duration) == "number" and duration > 0, options, "t", what, "a duration > 0")
  local n = max(1, math.ceil(duration / solver.h - 1e-9))
  local a, b, c = finish(solver, options, duration, n), finish(solver, options, duration, 2 * n),
    finish(solver, options, duration, 4 * n)
  local first, size = apart(a, b)
  local second = apart(b, c)
  if not (second > ROUND * size) then
    error(what .. ": runs with h and h/2 differ by round-off alone; take a larger step", 0)
  end
  return core.result { order = log(first / second, 2), error = second, h = duration / n }
end)

class.method("dm.solver", "measured_order", M.measured_order, [[
solver:measured_order{q=, v= | p=, t=, t0=} -> {order, error, h}
The order of the rule, measured on this run: log2 of the ratio by which the ends after the time t of
runs with steps of h, h/2 and h/4 approach each other. error: the last difference. Raises where that
is round-off.]])

return M
