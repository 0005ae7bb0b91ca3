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

-- members: what is shared, and a point for every rule, the rival too, at every step
local function count_members(system, options, default_steps)
  local function name(rule) return (tostring(rule):gsub("^rule ", "")) end
  local rules = type(options.rules) == "table" and options.rules or { options.rules }
  local h = options.h or options.steps
  local count = #measures.entries(rules, options.tolerances, name)
  if options.rivals ~= false and measures.rival(system, rules, name) then count = count + 1 end
  return 1 + count * (h == nil and default_steps or type(h) == "table" and #h or 1)
end

---- member 1 ----

local function shared_of(chart)
  return { h = heads.text(chart.options.h), floor = chart.floor, text = chart.reference_text,
    load = chart.load }
end

local function read_shared(found)
  local h = {}
  for number in found.h:gmatch "%S+" do h[#h + 1] = tonumber(number) end
  found.h = h
  return #h > 0 and found
end

---- the other members ----

local function is_point(found)
  local numbers = found.why and { "h" } or { "h", "error", "ns", "steps" }
  for _, key in ipairs(numbers) do
    if type(found[key]) ~= "number" then return false end
  end
  return type(found.rule) == "string" and found
end

-- member i of a file; raises where the bytes are none of a chart
local function read_member(i, bytes, file)
  local fine, found = blame.try(function()
    return (i == 1 and read_shared or is_point)(fields.unpack(bytes))
  end)
  if fine and found then return found end
  error(("%s: %s: member %d is none of a chart: remove the file"):format(WHERE, file, i), 0)
end

---- the chart ----

--- A chart with a journal, or of ranks. how: { default_steps, new(known) -> chart, tasks;
-- measure(chart, task) -> point or { why }; enter(chart, task, that) }.
function M.chart(system, options, how)
  local members = count_members(system, options, how.default_steps)
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
      found[i] = read_member(i, one, options.journal)
    end
  end
  -- what is there, into the chart
  local function fill()
    for i, task in ipairs(need() and tasks) do
      if found[i + 1] then how.enter(chart, task, found[i + 1]) end
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
