--- The journal of a chart. Member 1 is what all points share: the steps, how far the references are
-- apart; each other member is a point, or why there is none.
local blame = require "dm.base.blame"
local carrier = require "dm.sweep.carrier"
local core = require "dm.core"
local fields = require "dm.data.fields"
local heads = require "dm.sweep.head"
local journal = require "dm.data.journal"
local measures = require "dm.chart.measures"

local M = {}

local WHERE = "dm.chart"

---- what decides the result ----

-- of a function its instructions, which names of variables and comments do not change
local function code_of(f)
  local fine, code = blame.try(string.dump, f, true)
  return fine and ("function %08x"):format(core.crc32(code)) or "function"
end

-- times of two machines do not compare
local function machine()
  local file <close> = io.open "/proc/cpuinfo"
  for line in file and file:lines() or function() end do
    local name = line:match "^model name%s*:%s*(.*)"
    if name then return name end
  end
  return "unknown"
end

-- A rule as it prints; of one that is an object also what it does in its first steps, since
-- functions of a user may be in it.
local function rule_text(rule, system, options)
  local text = tostring(rule)
  if type(rule) ~= "userdata" then return text end
  for _, part in ipairs { 1 / 64, 1 / 4096 } do
    local fine, path = blame.try(function()
      return system:solver { rule = rule, h = part * options.t }:run { q = options.q,
        v = options.v, p = options.p, t0 = options.t0, steps = 3 }
    end)
    if fine then
      local out = {}
      for _, name in ipairs(path.columns) do
        local column = path:column(name)
        for i = 1, #column do out[#out + 1] = ("%a"):format(column[i]) end
      end
      return ("%s %08x"):format(text, core.crc32(table.concat(out, " ")))
    end
  end
  return text
end

local PLAIN = { "q", "v", "p", "t", "t0", "h", "steps", "error", "samples", "repeats", "reference",
  "tolerances", "rivals" }

local function head_of(system, options, members)
  local head = heads.of("chart", members)
  local function say(key, value) head[#head + 1] = { key, value } end
  local rules = {}
  for i, rule in ipairs(type(options.rules) == "table" and options.rules or { options.rules }) do
    rules[i] = rule_text(rule, system, options)
  end
  say("machine", machine())
  say("system", core.fingerprint(system))
  say("rules", table.concat(rules, ", "))
  for _, key in ipairs(PLAIN) do
    if options[key] ~= nil then say(key, heads.text(options[key], code_of)) end
  end
  return head
end

-- members: what is shared, and a point for every rule, the rival too, at every step; and the steps
local function count_members(system, options, default_steps)
  local function name(rule) return (tostring(rule):gsub("^rule ", "")) end
  local rules = type(options.rules) == "table" and options.rules or { options.rules }
  local h = options.h or options.steps
  local count = #measures.entries(rules, options.tolerances, name)
  if options.rivals ~= false and measures.rival(system, rules, name) then count = count + 1 end
  local steps = h == nil and default_steps or type(h) == "table" and #h or 1
  return 1 + count * steps, steps
end

---- member 1 ----

local function shared_of(chart)
  return { h = heads.text(chart.options.h), floor = chart.floor, text = chart.reference_text,
    load = chart.load }
end

-- what a value of a member must be: a finite number >= 0, a whole one, a text, a truth
local function amount(x) return type(x) == "number" and x >= 0 and x < math.huge end
local function whole(x) return math.type(x) == "integer" and x >= 0 end
local function text(x) return type(x) == "string" end
local function truth(x) return type(x) == "boolean" end
local function maybe(is) return function(x) return x == nil or is(x) end end

-- has a table these values?
local function has(found, values)
  for key, is in pairs(values) do
    if not is(found[key]) then return false end
  end
  return true
end

local SHARED = { h = text, floor = amount, text = text, load = amount }

-- member 1 with its steps as a list, so many; or nothing
local function read_shared(found, steps)
  if not has(found, SHARED) then return false end
  local h = {}
  for word in found.h:gmatch "%S+" do h[#h + 1] = tonumber(word) or 0 / 0 end
  for _, x in ipairs(h) do
    if not (amount(x) and x > 0) then return false end
  end
  found.h = h
  return #h == steps and found
end

---- the other members ----

local POINT = { rule = text, h = amount, error = amount, ns = amount, steps = whole,
  setup = maybe(amount), evaluations = maybe(whole), newton = maybe(whole), below = maybe(truth),
  far = maybe(truth) }
local NO_POINT = { rule = text, h = amount, why = text }

local function fail_member(i, file)
  error(("%s: %s: member %d is none of this chart: remove the file"):format(WHERE, file, i), 0)
end

-- member i of a file; raises where the bytes are none of a chart
local function read_member(i, bytes, file, steps)
  local fine, found = blame.try(function()
    local that = fields.unpack(bytes)
    if i == 1 then return read_shared(that, steps) end
    return has(that, that.why ~= nil and NO_POINT or POINT) and that
  end)
  return fine and found or fail_member(i, file)
end

---- the chart ----

--- A chart with a journal, or of ranks. how: { default_steps, new(known) -> chart, tasks;
-- measure(chart, task) -> point or { why }; enter(chart, task, that) }.
function M.chart(system, options, how)
  local members, steps = count_members(system, options, how.default_steps)
  local c = carrier.open(WHERE, options.journal, head_of(system, options, members), members, true)
  local found, chart, tasks = {}, nil, nil
  local function need()
    if not chart then chart, tasks = how.new(found[1]) end
    return chart
  end
  local function run(first, count)
    local pieces = {}
    for i = first, first + count - 1 do
      local what = i == 1 and shared_of(need()) or how.measure(need(), tasks[i - 1])
      pieces[#pieces + 1] = ("<s4"):pack(fields.pack(what))
    end
    return table.concat(pieces)
  end
  local function put(first, count, bytes)
    for i, one in journal.members({ first = first, count = count }, bytes) do
      found[i] = read_member(i, one, options.journal, steps)
    end
  end
  -- what is there, into the chart
  local function fill()
    for i, task in ipairs(need() and tasks) do
      local that = found[i + 1]
      if that and that.rule ~= task.entry.name then fail_member(i + 1, options.journal) end
      if that then how.enter(chart, task, that) end
    end
    chart.journal = carrier.result(c)
  end
  return carrier.guarded(c, function()
    local fine, why = pcall(carrier.run, c, 1, run, put)
    if not fine then
      if chart and type(why) == "table" then fill() end -- goes with the failure
      error(why, 0)
    end
    carrier.leave_if_part(c)
    fill()
    return chart
  end)
end

return M
