--- dm.scaling: what a step costs against the dimension of the system, and against the number of
-- members of an ensemble.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local Scaling = core.class({ __name = "dm.scaling" }, [[
dm.scaling: what a step costs as things grow, made by dm.scaling{system=, start=, ...}
fields: points (a list of {rule, size, ns, setup}), rules (names)]])

local log, max, min, huge = math.log, math.max, math.min, math.huge

local WHERE = "dm.scaling"
local fail = option.failing(WHERE)

local KNOWN = { "system", "start", "n", "members", "rules", "h", "steps", "repeats" }

local function check_sizes(options, key)
  local list = options[key]
  if type(list) ~= "table" or #list == 0 then
    fail("option '%s' must be a list of whole numbers", key)
  end
  for i = 1, #list do
    local x = list[i]
    if math.type(x) ~= "integer" or x < 1 or i > 1 and x <= list[i - 1] then
      fail("option '%s' must be growing whole numbers from 1 (got %s)", key, tostring(x))
    end
  end
  return list
end

local TAKES = "{ system =, start =, n = {...} | members = {...}, rules = {...}, h =, steps = }"

local function check(options)
  option.check(options, KNOWN, WHERE, TAKES)
  if (options.n == nil) == (options.members == nil) then
    fail("give sizes n = {...} of the system, or members = {...} of an ensemble")
  end
  if options.n and type(options.system) ~= "function" then
    fail("with n, 'system' must be a function(n) that returns a dm.system")
  end
  if options.members and getmetatable(options.system) ~= debug.getregistry()["dm.system"] then
    fail("with members, 'system' is one dm.system (got %s)", option.got(options.system))
  end
  option.need(options, "system", WHERE, "a dm.system, or with n a function of it")
  option.need(options, "start", WHERE, "a function of n or of the member's number")
  option.callable(options, "start", WHERE, "n, or of the member's number, that returns q and v")
  option.list(options, "rules", WHERE, "rules")
  option.need(options, "rules", WHERE, "a list of rules")
  option.need(options, "h", WHERE, "a step > 0")
  option.positive(options, "h", WHERE, "a step")
  local steps = option.whole(options, "steps", WHERE, 1, nil, 1000)
  option.whole(options, "repeats", WHERE, 1)
  return check_sizes(options, options.n and "n" or "members"), steps
end

-- median over batches of the best CPU time of a call, s
local function seconds(f, repeats)
  local all = {}
  for b = 1, repeats do
    local best, spent = huge, 0
    repeat
      local begin = core.cpu()
      f()
      local took = core.cpu() - begin
      best, spent = min(best, took), spent + took
    until spent > 2e-3
    all[b] = best
  end
  table.sort(all)
  return all[(#all + 1) // 2]
end

local MOST = 2 ^ 20  -- steps of a run

-- time of a step, and of set-up with one: from runs so long that their steps are most of their time
local function measured(run, steps, repeats)
  run(1)
  local first, whole = seconds(function() run(1) end, repeats), nil
  repeat
    whole = seconds(function() run(steps) end, repeats)
    local enough = whole > 4 * first or steps >= MOST
    steps = enough and steps or 8 * steps
  until enough
  return max(whole - first, 0) / max(steps - 1, 1), first
end

local function cost(run, steps, repeats)
  local pinned = core.pin()
  local fine, each, first = pcall(measured, run, steps, repeats)
  core.unpin(pinned)
  if not fine then error(each, 0) end
  return each, first
end

-- q and v
local function pair(...)
  if select("#", ...) > 2 then
    error(("start must return two values, q and v (got %d)"):format(select("#", ...)), 0)
  end
  return ...
end

-- of the system of size n
local function of_size(options, rule, n)
  local system = core.one(options.system, "system")(n)
  local q, v = pair(options.start(n))
  local solver = system:solver { rule = rule, h = options.h }
  return function(steps) solver:run { q = q, v = v, steps = steps, every = steps } end
end

-- of an ensemble, in one thread
local function of_members(options, rule, members)
  local qs, vs = {}, {}
  for i = 1, members do qs[i], vs[i] = pair(options.start(i)) end
  local solver = options.system:solver { rule = rule, h = options.h }
  return function(steps)
    solver:ensemble { members = members, q = qs, v = vs, steps = steps, threads = 1 }
  end
end

-- slope of ln y over ln x between the two largest sizes of a half of the range: what it tends to
local function exponent(points)
  local n, sx, sy, sxx, sxy = 0, 0, 0, 0, 0
  for i = #points // 2 + 1, #points do
    local x, y = log(points[i].size), log(max(points[i].ns, 1e-3))
    n, sx, sy, sxx, sxy = n + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
  end
  if n < 2 then return nil end
  return (n * sxy - sx * sy) / (n * sxx - sx * sx)
end

local doc = [[
dm.scaling{system=, start=, n= | members=, rules=, h=, steps=, repeats=} -> dm.scaling
What a step costs as things grow. n: system = function(n) returns the system of that size, start =
function(n) its q and v; ns is that of one step. members: system is a dm.system, start = function(i)
gives q and v of member i of an ensemble in one thread; ns is that of a member and step. CPU time
without set-up (which is told as `setup`), the median of `repeats` batches (3) of `steps` steps
(1000), pinned to one core; more steps where set-up would be most of it. points[i] = {rule, size,
ns, setup}; s:exponent(rule): cost like size^exponent at the upper half of the sizes; s:table(),
s:plot{file=}.]]

M.scaling = blame.caller(function(options)
  local sizes, steps = check(options)
  local out = setmetatable({ points = {}, rules = {}, failures = {},
    what = options.n and "n" or "members", load = core.load_average() }, Scaling)
  for i, rule in ipairs(options.rules) do
    out.rules[i] = (tostring(rule):gsub("^rule ", ""))
    for _, size in ipairs(sizes) do
      local fine, ns, setup = pcall(function()
        local run = (options.n and of_size or of_members)(options, rule, size)
        local each, first = cost(run, steps, options.repeats or 3)
        return 1e9 * each / (options.members and size or 1), first
      end)
      if fine then
        out.points[#out.points + 1] = { rule = out.rules[i], size = size, ns = ns, setup = setup }
      elseif blame.is_stop(ns) then
        ns = blame.stopped(ns)
        ns.scaling = out
        error(ns, 0)
      else
        out.failures[#out.failures + 1] = { rule = out.rules[i], size = size,
          why = blame.bare(ns):match "^[^\n]*" }
      end
    end
  end
  if #out.points == 0 then fail("nothing could be measured: %s", out.failures[1].why) end
  return out
end)

local function of_rule(self, rule)
  local out = {}
  for _, p in ipairs(self.points) do
    if p.rule == rule then out[#out + 1] = p end
  end
  return out
end

class.method("dm.scaling", "exponent", function(self, rule)
  local points = of_rule(self, rule)
  if #points == 0 then
    fail("no point of rule '%s'; there are %s", tostring(rule), table.concat(self.rules, ", "))
  end
  return exponent(points)
end, [[
scaling:exponent(rule) -> number or nil
The cost grows like size^exponent, by least squares over the upper half of the sizes; nil with fewer
than two of them.]])

class.method("dm.scaling", "table", function(self)
  local unit = self.what == "n" and "ns/step" or "ns/member/step"
  local lines = { ("%-28s %9s %13s %12s"):format("rule", self.what, unit, "set-up, ms") }
  for _, p in ipairs(self.points) do
    lines[#lines + 1] = ("%-28s %9d %13.4g %12.3g"):format(p.rule, p.size, p.ns, 1e3 * p.setup)
  end
  for _, rule in ipairs(self.rules) do
    local e = exponent(of_rule(self, rule))
    if e then
      lines[#lines + 1] = ("%s: like %s^%.2f at the upper half"):format(rule, self.what, e)
    end
  end
  for _, f in ipairs(self.failures) do
    lines[#lines + 1] = ("%s, %s = %d: %s"):format(f.rule, self.what, f.size, f.why)
  end
  lines[#lines + 1] = ("load %.2f at the start"):format(self.load)
  return table.concat(lines, "\n")
end, [[
scaling:table() -> string
A line for every rule and size: ns a step (of a member), the set-up in ms; then the exponents, what
failed, and the load of the machine.]])

class.method("dm.scaling", "plot", function(self, options)
  local given, series = lists.copy(options or {}), {}
  for _, rule in ipairs(self.rules) do
    local x, y, points = {}, {}, of_rule(self, rule)
    for i, p in ipairs(points) do x[i], y[i] = p.size, max(p.ns, 1e-3) end
    local e = exponent(points)
    local name = e and ("%s (exponent %.2f)"):format(rule, e) or rule
    if #x > 0 then
      series[#series + 1] = { x = x, y = y, name = name, style = "linespoints" }
    end
  end
  given.log, given.xlabel = "xy", given.xlabel or (self.what == "n" and "size n" or "members")
  given.ylabel = given.ylabel
    or self.what == "n" and "CPU time of a step" or "CPU time of a member and step"
  given.yunit = given.yunit or "ns"
  given.title = given.title or "cost of a step"
  return require "dm.show.plot".plot(series, given)
end, [[
scaling:plot{file=, ...} -> file name or nothing
Cost over size, both logarithmic, a line for every rule with its exponent. Options as in dm.plot.]])

function Scaling:__tostring() return self:table() end

core.docs[M.scaling] = doc

return M
