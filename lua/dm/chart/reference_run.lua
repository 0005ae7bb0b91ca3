--- A reference path that is itself checked: two unlike methods, refined until they agree.
local blame = require "dm.base.blame"
local core = require "dm.core"
local fail = require "dm.base.options".failing "dm.chart"
local worse = require "dm.chart.measures".worse

local M = {}

local abs, max = math.abs, math.max

-- the methods in the order of preference; each must be able to step the system
local METHODS = { { "gauss(8)", 16 }, { "sofroniou-spaletta(10)", 10 }, { "rk8", 8 },
  { "lobatto(6)", 10 }, { "gauss(6)", 12 },
  { "degenerate(4)", 8 }, { "degenerate(3)", 6 } }  -- for L linear in v
local HALVINGS = 14
-- s of CPU for one method: where it has not settled by then, what it reached is told
local BUDGET = 2

local function run(chart, rule, h)
  local o = chart.options
  local steps = math.max(#chart.times, math.ceil(o.t / h / #chart.times) * #chart.times)
  return chart.system:solver({ rule = rule, h = o.t / steps }):run { q = o.q, v = o.v, p = o.p,
    t0 = o.t0, at = chart.times, watch = chart.watch }
end

-- largest difference of two paths at the same times, relative to 1 + the largest entry
local function apart(a, b)
  local worst, size = 0, 1
  for _, name in ipairs(a.columns) do
    local x, y = a:column(name), b:column(name)
    for i = 1, #x do worst, size = worse(worst, abs(x[i] - y[i])), max(size, abs(x[i])) end
  end
  return worst / size, worst
end

local NOT_SMALLER = 0.5

-- halve h until the path stops to change; the finest, how much it still changed
local function refine(chart, rule)
  local h = math.huge
  for _, given in ipairs(chart.options.h) do h = math.min(h, given) end
  local last, best, change
  local begin, took = core.cpu(), 0
  h = h * 4
  for _ = 1, HALVINGS do
    if core.cpu() - begin + 2 * took > BUDGET then break end
    local start = core.cpu()
    local fine, path = pcall(run, chart, rule, h)
    took = core.cpu() - start
    if not fine and blame.is_stop(path) then error(path, 0) end
    if not fine and type(path) == "string" then return nil, path end
    if fine and last then
      local now = apart(path, last)
      if now ~= now then return nil, "it has no value at some of the samples" end
      if change and (now < 1e-14 or (now < 1e-10 and now > NOT_SMALLER * change)) then
        return now < change and path or best, math.min(now, change)
      end
      best, change = path, now
    end
    last = fine and path or nil
    h = h / 2
  end
  return best, change or math.huge
end

local TRUSTED = 1e-7  -- two references further apart than this are none

--- The reference of a chart: path, absolute distance to the second method, a sentence.
function M.find(chart)
  local given = chart.options.reference
  if given ~= nil then
    if type(given) ~= "table" or not (given.rule and given.h) then
      fail("option 'reference' must be { rule =, h = }; left out, one is found (got %s)",
        tostring(given))
    end
    return run(chart, given.rule, given.h), 0, ("reference: %s, h = %g, taken as given")
      :format(tostring(given.rule), given.h)
  end
  local found, why = {}, nil
  for _, method in ipairs(METHODS) do
    local path, change = refine(chart, method[1])
    why = why or not path and type(change) == "string" and change
    if path and #found < 2 then
      found[#found + 1] = { rule = method[1], path = path, change = change }
    end
    if #found == 2 then break end
  end
  if #found == 0 then
    fail("no rule could make a reference: %s", why or "does the run reach its end?")
  end
  if #found == 1 then
    return found[1].path, found[1].change,
      ("reference: %s, which changes by %.1e when its step is halved; no second method fits this "
        .. "system"):format(found[1].rule, found[1].change)
  end
  local distance, absolute = apart(found[1].path, found[2].path)
  if distance > TRUSTED then
    fail("the references %s and %s disagree by %.1e (relative): is the motion chaotic over this "
      .. "time? Take a shorter t, watch something less sensitive, or give "
      .. "reference = { rule =, h = }", found[1].rule, found[2].rule, distance)
  end
  return found[1].path, absolute, ("references %s and %s agree to %.1e")
    :format(found[1].rule, found[2].rule, absolute)
end

return M
