--- Cells of a stability map as members of a sweep: kept in a journal, split into parts, shared out
-- to ranks. A member tells of its cell what the passes have found, beside its rule, step and
-- parameters.
local blame = require "dm.base.blame"
local carrier = require "dm.sweep.carrier"
local cells = require "dm.stability.cells"
local core = require "dm.core"
local fields = require "dm.data.fields"
local heads = require "dm.sweep.head"
local journal = require "dm.data.journal"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.stability"
local UNIT = 64 -- cells of the shortest range

local fail = option.failing(WHERE)

---- what decides the result ----

-- graphs of the system at both ends of the map
local function systems_text(map, all)
  local out = {}
  for _, cell in ipairs { all[1], all[#all] } do
    local fine, text = blame.try(function() return core.fingerprint(map.system_of(cell)) end)
    out[#out + 1] = fine and text or "none"
  end
  return table.concat(out, " ")
end

local PLAIN = { "steps", "t", "t0", "drift", "accuracy", "observe", "watch", "inside", "project",
  "newton", "sums", "q", "v", "p" }

local function head_of(map, all)
  local head = heads.of("stability", #all)
  local function say(key, value) head[#head + 1] = { key, value } end
  say("system", systems_text(map, all))
  say("rules", table.concat(map.rules, ", "))
  for _, name in ipairs { "h", table.unpack(map.names) } do
    say("axis " .. name, heads.text(table.move(map[name], 1, #map[name], 1, {})))
  end
  for _, key in ipairs(PLAIN) do
    if map.options[key] ~= nil then say(key, heads.text(map.options[key])) end
  end
  say("chaos", tostring(map.chaos))
  return head
end

---- bytes of cells ----

-- what a cell is is known by its number; what it is compared with is found again
local LEFT_OUT = { number = true, values = true, x = true, row = true, flow = true,
  looked = true }

-- That L has no value at a start is told in other words where all cells beside it have one.
local NO_VALUE = "^L is "

-- a cell without a start has nothing else
local function no_start(cell)
  local why = cell.reason
  return { h = cell.h, code = "no_start", steps = 0,
    reason = why and not why:find(NO_VALUE) and why or nil }
end

local function bytes_of(map, cell)
  local out, found = {}, cell.class == cells.NUMBER["no start"] and no_start(cell) or cell
  for name, x in pairs(found) do
    if not LEFT_OUT[name] then out[name] = x end
  end
  out.class, out.rule = cells.CLASSES[cell.class].name, map.rules[cell.rule]
  for name, x in pairs(cell.values) do out["value " .. name] = x * 1.0 end
  return fields.pack(out)
end

local TEXTS = { code = true, reason = true, cause = true, unresolved = true }
local TRUTHS = { is_right = true, is_close = true, loose = true, sized = true }

-- are these values of a cell, which is at its rule, step and parameters? An observable is a column.
local function is_of_cell(map, cell, found)
  if found.rule ~= map.rules[cell.row.number] or found.h ~= cell.h then return false end
  for _, name in ipairs(map.names) do
    if found[name] ~= nil and found[name] ~= cell[name] then return false end
  end
  for name, x in pairs(found) do
    local kind = TEXTS[name] and "string" or TRUTHS[name] and "boolean" or "number"
    if name ~= "rule" and name ~= "class" and type(x) ~= kind then return false end
  end
  local columns = map.beside and #map.beside.observed.columns or 0
  local k = found.observable
  return math.type(found.steps) == "integer" and found.steps >= 0 and type(found.code) == "string"
    and (k == nil or math.type(k) == "integer" and k >= 1 and k <= columns and type(found.off)
      == "number" and type(found.range) == "number")
end

local function read_cell(map, cell, bytes, file)
  local fine, found = blame.try(fields.unpack, bytes)
  local class = fine and cells.NUMBER[found.class]
  if not class or not is_of_cell(map, cell, found) then
    fail("%s: cell %d is none of this map: remove the file", file, cell.number)
  end
  for name, x in pairs(found) do
    if not name:find "^value " then cell[name] = x end
  end
  for name in pairs(cell) do
    if found[name] == nil and not LEFT_OUT[name] then cell[name] = nil end
  end
  cell.class, cell.rule = class, cell.row.number
end

---- running ----

-- a cell that is finished is run again
local function check_cell(map, plan, cell, i, was, file)
  local twin = {}
  for name, value in pairs(cell) do twin[name] = value end
  local stopped = cells.run_planned(map, { twin }, plan)
  if stopped then error(stopped, 0) end
  if bytes_of(map, twin) ~= was then
    fail("%s has another cell %d: its start, its system or its rule gave something else then. "
      .. "Remove the file, or give another name", file, i)
  end
end

-- one of every rule: the file cannot see what functions of starts give, nor those of rules
local function check_cells(map, plan, all, c)
  local seen, left = {}, #map.rules
  for _, x in ipairs(c.records) do
    if left == 0 then return end
    for i, was in journal.members(x.r, journal.bytes(x.j, x.r)) do
      local number = all[i].row.number
      if not seen[number] then
        check_cell(map, plan, all[i], i, was, x.j.name)
        seen[number], left = true, left - 1
      end
    end
  end
end

-- cells without a start are no error of one part alone; without any other there is nothing to show
local function check_started(all)
  for _, cell in ipairs(all) do
    if cell.code ~= "no_start" then return end
  end
  fail("no cell has a start: %s", all[1].reason or "L has no value there")
end

--- Run the cells of a map that are not in its journal yet, or are of this part or rank; all of them
-- are filled in. Returns what a stop on request was, or nothing.
function M.run(map, all)
  local plan = cells.plan(map, all, map.chaos)
  local file = option.text(map.options, "journal", WHERE)
  local c = carrier.open(WHERE, file, head_of(map, all), #all)
  local function run(first, count)
    local some, out = table.move(all, first, first + count - 1, 1, {}), {}
    local stopped = cells.run_planned(map, some, plan)
    if stopped then error(stopped, 0) end
    for i, cell in ipairs(some) do out[i] = ("<s4"):pack(bytes_of(map, cell)) end
    return table.concat(out)
  end
  local function put(first, count, bytes)
    for i, one in journal.members({ first = first, count = count }, bytes) do
      read_cell(map, all[i], one, file)
    end
  end
  map.started = true
  return carrier.guarded(c, function()
    local fine, why = pcall(function()
      check_cells(map, plan, all, c)
      carrier.run(c, UNIT, run, put)
    end)
    if not fine and type(why) == "table" and why.code == "stopped" then return why end
    if not fine then error(why, 0) end
    carrier.leave_if_part(c)
    check_started(all)
    map.journal = carrier.result(c)
  end)
end

return M
