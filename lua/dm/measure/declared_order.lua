--- Is the order that a dm.step declares the one that it has? Measured once for a rule and a system,
-- from the start of the first run: two steps of h, four of h/2 ... until the ratio of differences
-- says so, is round-off, or has settled at less.
local blame = require "dm.base.blame"

local M = {}

local abs, max, log = math.abs, math.max, math.log

local HALVINGS = 8
local ENOUGH = 0.4     -- an order is had where the measured one is not less by more
local SETTLED = 0.1    -- two measured orders that differ by less are the limit
local ROUND = 1e-11    -- of the size: differences below tell nothing

-- systems that a rule was measured on
local measured = setmetatable({}, { __mode = "k" })

local function is_known(rule, system)
  local of_rule = measured[rule] or setmetatable({}, { __mode = "k" })
  measured[rule] = of_rule
  local known = of_rule[system]
  of_rule[system] = true
  return known
end

--- A rule whose order is known by other means on this system is not measured.
function M.trust(rule, system) is_known(rule, system) end

-- q and p behind `steps` steps of h
local function finish(solver, options, h, steps)
  local system = solver.system
  local path = system:solver { rule = solver.rule, h = h }
    :run { q = options.q, v = options.v, p = options.p, a = options.a, t0 = options.t0,
      project = options.project, steps = steps, every = steps }
  local own, out = system.place, {}
  local n = own and own.size + own.dimension or 2 * system.Q.dimension
  for i = 1, n do
    local column = path:column(path.columns[1 + i])
    out[i] = column[#column]
  end
  return out
end

-- the largest difference, and whether it is round-off
local function apart(a, b)
  local worst, size = 0, 1
  for i = 1, #a do worst, size = max(worst, abs(a[i] - b[i])), max(size, abs(b[i])) end
  return worst, worst <= ROUND * size
end

-- the order where it has settled below the declared one, or nothing
local function less_than(order, solver, options)
  local last, gap, before
  for k = 0, HALVINGS do
    local here = finish(solver, options, solver.h * 0.5 ^ k, 2 << k)
    if last then
      local now, round = apart(here, last)
      if round then return end
      local p = gap and log(gap / now, 2)
      if p and p >= order - ENOUGH then return end
      if p and before and k >= 4 and abs(p - before) < SETTLED then return p end
      gap, before = now, p
    end
    last = here
  end
end

--- Raise where the order is less than declared; a start from which the step does not get on is left
-- to the run itself.
function M.check(solver, options)
  if is_known(solver.rule, solver.system) then return end
  local fine, p = blame.try(less_than, solver.order, solver, options)
  if not fine or not p then return end
  error(("dm.step: %s declares order %d, and from this start it has order %.2f: is a formula "
    .. "wrong, or the order?"):format(tostring(solver.rule), solver.order, p), 0)
end

return M
