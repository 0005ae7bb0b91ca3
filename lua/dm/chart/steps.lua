--- The steps of a chart: as they are given, or from the coarsest that still shows the motion, by
-- halves.
local blame = require "dm.base.blame"
local core = require "dm.core"
local has_own_time = require "dm.base.own_time"
local lists = require "dm.base.lists"
local M = {}

local fail = require "dm.base.options".failing "dm.chart"

---- given ----

--- A list; one number or name is as good as a list of it.
function M.list(options, key, what)
  local list = lists.plain(options[key])
  if type(list) == "number" or type(list) == "string" then list = { list } end
  if type(list) ~= "table" or #list == 0 then
    fail("option '%s' must be a list of %s", key, what)
  end
  return list
end

-- is a rule among them whose steps are not steps of time?
local function any_has_own_time(rules)
  for _, rule in ipairs(type(rules) == "table" and rules or { rules }) do
    if has_own_time(rule) then return true end
  end
  return false
end

--- The sizes of all steps; whole numbers that are too large for a size count the steps of the run.
function M.sizes(options)
  local key = options.h == nil and "steps" or "h"
  local out, longest, counts = {}, 0, key == "steps"
  for i, h in ipairs(M.list(options, key, "steps")) do
    if type(h) ~= "number" or not (h > 0 and h < math.huge) then
      fail("option '%s' must hold steps > 0 (got %s)", key, tostring(h))
    end
    out[i], longest = h, math.max(longest, h)
    counts = counts and h > options.t and math.tointeger(h) ~= nil
  end
  for i, n in ipairs(counts and out or {}) do out[i] = options.t / n end
  if longest > options.t and not counts and not any_has_own_time(options.rules) then
    fail("option '%s' holds %g, but the run has the duration t = %g: give sizes of steps%s", key,
      longest, options.t, key == "steps" and ", or whole numbers of steps, all larger than t" or "")
  end
  return out
end

---- found ----

-- relative change of the end when a step is halved; how many steps are found (M.COUNT)
local SHOWN = 0.03
M.COUNT = 7
-- steps of a pilot run; how often in a row the change must be small
local FEWEST, MOST, PATIENCE = 8, 2 ^ 22, 3

local PILOTS = { "gauss(2)", "degenerate(2)", "lie(2)" }  -- between them they step every system

local function last(system, options, rule, n)
  local path = system:solver({ rule = rule, h = options.t / n }):run {
    q = options.q, v = options.v, p = options.p, t0 = options.t0, steps = n, every = n }
  local out, own = {}, system.place
  for i = 1, own and own.size or system.Q.dimension do
    out[i] = path:column(path.columns[1 + i])[#path]
  end
  return core.vector(out)
end

-- the largest h at which a pilot sees the motion, and its next halves too (a coarse end may be near
-- by chance); nil: at none, and a refusal
local function coarsest(system, options, rule)
  local before, good, first, n, wrong = nil, 0, nil, FEWEST, nil
  while n <= MOST do
    local fine, q = blame.try(last, system, options, rule, n)
    wrong = wrong or not fine and type(q) == "string" and q or nil
    local near = fine and before and (q - before):norm() <= SHOWN * (q:norm() + 1e-300)
    good = near and good + 1 or 0
    if good == 1 then first = n / 2 end
    if good == PATIENCE then return options.t / first end
    before, n = fine and q or nil, 2 * n
  end
  return nil, wrong
end

--- A list of steps for the run of a chart; raises where a pilot run does not settle.
function M.find(system, options)
  local refused = nil  -- by the first pilot: a start that no rule takes
  for _, rule in ipairs(PILOTS) do
    local h, wrong = coarsest(system, options, rule)
    refused = refused or rule == PILOTS[1] and wrong
    if h then
      local out = {}
      for i = 1, M.COUNT do out[i] = h / 2 ^ (i - 1) end
      return out
    end
  end
  if refused and not refused:find("degenerate", 1, true) then error(refused, 0) end
  fail("no steps were given, and pilot runs with gauss(2) did not settle over t = %g: give steps, "
    .. "h = { 0.1, 0.05, 0.025 }, or a shorter t", options.t)
end

return M
