--- demo(), dmlua --demo: guided demonstrations. Each shows what one would type, runs it, says what
-- came out, and runs again with another number. One file in lua/dm/demos each, in the order of
-- lua/dm/demos/init.lua:
--   { title, about, numbers = { { name, value, least, most, what } },
--     steps = { { text, code }, ... }, claim = function(e) }
-- The code of all steps shares one set of globals, e, in which the numbers are; claim returns
-- whether what the demonstration is about was seen, and a sentence with the figures.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local fail = require "dm.base.options".failing "demo"
local lists = require "dm.base.lists"

---- what there is ----

local ROOMS = { fields = "line." }  -- demonstrations in rooms of their own

local function names() return require "dm.demos" end

--- The names of the demonstrations, in the order in which they are best seen.
function M.names()
  local out = {}
  for i, name in ipairs(names()) do out[i] = name end
  return out
end

--- One of them, by its name.
function M.find(name)
  for _, known in ipairs(names()) do
    if known == name then return require("dm.demos." .. (ROOMS[name] or "") .. name) end
  end
  fail("there is no demonstration '%s'; there are %s", tostring(name), table.concat(names(), ", "))
end

---- on the screen ----

local function screen()
  local out, input = core.terminal(), core.terminal "stdin"
  return { width = math.min(out.width or 80, 100), colour = out.colour, asks = out.tty
    and input.tty }
end

local function paint(view, code, text)
  return view.colour and ("\27[%sm%s\27[0m"):format(code, text) or text
end

local function say(view, text)
  local line
  for word in text:gmatch "%S+" do
    if line and #line + 1 + #word > view.width - 2 then
      print(line)
      line = nil
    end
    line = line and line .. " " .. word or word
  end
  if line then print(line) end
end

local function trimmed(code) return (code:gsub("^%s*\n", ""):gsub("%s+$", "")) end

local function show_code(view, code)
  for line in (code .. "\n"):gmatch "(.-)\n" do
    print(paint(view, "32", "> ") .. paint(view, "36", line))
  end
end

---- asking ----

-- a line from whoever sits there; nil at the end of the input
local function ask(text)
  io.write(text)
  io.flush()
  return io.read "l"
end

local function goes_on(view)
  if not view.asks then return true end
  local answer = ask(paint(view, "2", "[Return: go on, q: stop] "))
  return answer and not answer:match "^%s*[qQ]"
end

local function number_named(demo, name)
  for _, number in ipairs(demo.numbers) do
    if name == nil or number.name == name then return number end
  end
  local known = {}
  for i, number in ipairs(demo.numbers) do known[i] = number.name end
  fail("this demonstration has no number '%s' to change; it has %s", tostring(name),
    table.concat(known, ", "))
end

local function check_number(number, value)
  if type(value) ~= "number" or not (value >= number.least and value <= number.most) then
    fail("%s (%s) must be a number from %g to %g (got %s)", number.name, number.what, number.least,
      number.most, tostring(value))
  end
  if math.type(number.value) == "integer" then
    local whole = lists.whole(value)
    if not whole then
      fail("%s (%s) must be a whole number (got %g)", number.name, number.what, value)
    end
    return whole
  end
  return value * 1.0
end

-- "0.1" or "h = 0.1" -> "h", 0.1
local function read_answer(demo, text)
  local name, value = text:match "^%s*([%a_][%w_]*)%s*=%s*(%S+)%s*$"
  value = value or text:match "^%s*(%S+)%s*$"
  local number = number_named(demo, name)
  return number.name, check_number(number, tonumber(value) or value)
end

-- the numbers of the next run, or nil when it is enough
local function next_numbers(demo, view, numbers)
  while view.asks do
    local parts = {}
    for i, number in ipairs(demo.numbers) do
      parts[i] = ("%s = %.6g (%s, %g to %g)"):format(number.name, numbers[number.name], number.what,
        number.least, number.most)
    end
    say(view, "Change a number and run again: " .. table.concat(parts, "; ") .. ".")
    local answer = ask(paint(view, "1", ("%s = , Return: done > "):format(demo.numbers[1].name)))
    if not answer or answer:match "^%s*[qQ]?%s*$" then return nil end
    local fine, name, value = blame.try(read_answer, demo, answer)
    if fine then
      numbers[name] = value
      return numbers
    end
    say(view, name)
  end
end

---- running ----

local function fresh(numbers)
  local e = setmetatable({ dm = require "dm" }, { __index = _G })
  for name, value in pairs(numbers) do e[name] = value end
  return e
end

-- run the steps; the globals they made, or nil when the person had enough
local function play(name, demo, view, numbers, pauses)
  local e = fresh(numbers)
  for i, step in ipairs(demo.steps) do
    local text, code = table.unpack(step)
    if pauses then
      print()
      say(view, text)
    end
    local chunk = assert(load(trimmed(code), "=demo " .. name, "t", e))
    show_code(view, trimmed(code))
    chunk()
    io.flush()
    if pauses and i < #demo.steps and not goes_on(view) then return nil end
  end
  return e
end

-- a run with changed numbers may fail, which is a result
local function again(name, demo, view, numbers)
  local fine, e = blame.try(play, name, demo, view, numbers, false)
  if fine then return say(view, select(2, demo.claim(e))) end
  say(view, "It did not get through: " .. tostring(e):match "^[^\n]*")
end

local function start_numbers(demo, given)
  local numbers = {}
  for _, number in ipairs(demo.numbers) do numbers[number.name] = number.value end
  for key, value in pairs(given) do
    if type(key) ~= "string" then
      fail("numbers are given by name: demo(\"%s\", { %s = %g })", "...", demo.numbers[1].name,
        demo.numbers[1].value)
    end
    numbers[key] = check_number(number_named(demo, key), value)
  end
  return numbers
end

--- Run one: numbers = { name = value } changes some. Returns whether what it is about was seen, and
-- the sentence that says so.
function M.run(name, given)
  local demo, view = M.find(name), screen()
  local numbers = start_numbers(demo, given or {})
  print(paint(view, "1", demo.title))
  say(view, demo.about)
  local e = play(name, demo, view, numbers, true)
  if not e then return end
  local seen, sentence = demo.claim(e)
  print()
  say(view, sentence)
  numbers = next_numbers(demo, view, numbers)
  while numbers do
    again(name, demo, view, numbers)
    numbers = next_numbers(demo, view, numbers)
  end
  return seen, sentence
end

local function list()
  print "Demonstrations; dmlua --demo NAME, or demo \"NAME\" in a session:"
  for _, name in ipairs(names()) do print(("  %-12s %s"):format(name, M.find(name).title)) end
end

local doc_demo = [[
demo()   or   demo(name [, {number = value}])
Guided demonstrations: without a name the list of them; with one it shows what one would type, runs
it and explains what came out. On a terminal it waits after every step (q stops), and asks for
another number to run again with; elsewhere it runs straight through.
demo("noether", { squash = 0.1 }) begins with another number. From a shell: dmlua --demo noether
squash=0.1]]

M.demo = blame.caller(function(name, given)
  if name == nil then return list() end
  if given ~= nil and type(given) ~= "table" then
    fail("numbers are given as a table, { name = value } (got %s)", type(given))
  end
  if not screen().asks then
    M.run(name, given)
    return
  end
  local fine, why = core.until_stop(M.run, name, given)
  if fine then return end
  if not blame.is_stop(why) then error(why, 0) end
  print "\ndemo: stopped"  -- by whom the demonstration is for: nothing to trace
end)

local function command(name, ...)
  if name == nil then return list() end
  local given = {}
  for _, word in ipairs { ... } do
    local key, value = word:match "^([%a_][%w_]*)=(.*)$"
    if not key then
      fail("after the name come numbers, as %s=0.1 (got '%s')", M.find(name).numbers[1].name, word)
    end
    given[key] = tonumber(value) or value
  end
  local seen, sentence = M.run(name, given)
  if seen == false and next(given) == nil then
    error("demo " .. name .. ": this should have been seen: " .. sentence:gsub("%s+", " "), 0)
  end
end

--- The words after dmlua --demo: nothing, or a name and number=value ...; raises where what it is
-- about was not seen with its own numbers. A message of ours is an object, so that no traceback is
-- printed with it.
function M.command(...)
  local fine, message = core.until_stop(command, ...)
  if fine then return end
  if blame.is_stop(message) then message = "demo: stopped" end
  if type(message) ~= "string" or not message:find "^demo" then error(message, 0) end
  error(setmetatable({}, { __tostring = function() return message end }), 0)
end

core.docs[M.demo] = doc_demo

return M
