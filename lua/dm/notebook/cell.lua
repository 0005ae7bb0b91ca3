--- A cell of a notebook as a function: an expression, a statement, or statements whose last lines
-- are an expression; ?x and x? explain, !command goes to the shell.
local M = {}

local NAME = "=cell"

local function is_incomplete(why) return why:find "<eof>$" ~= nil end

-- statements, then the last lines as an expression; errors keep their lines
local function split(text)
  local starts = {}
  for at in ("\n" .. text):gmatch "\n()[^\n]" do starts[#starts + 1] = at - 1 end
  for k = #starts, 2, -1 do
    local before, last = text:sub(1, starts[k] - 1), text:sub(starts[k])
    if load("return " .. last) and load(before) then
      return load(before .. " return " .. last, NAME)
    end
  end
end

local function explain(name)
  return function() require "dm.session.help".ask(name) end
end

local function shell(command)
  return function()
    io.stdout:flush()
    local _, how, code = os.execute(command)
    if code ~= 0 then error(("the shell says: %s %d"):format(how, code), 0) end
  end
end

--- The function of a cell; or nil, the message, and whether more text could mend it.
function M.compile(text)
  text = text:gsub("%s+$", "")
  local asked = text:match "^%s*%?%s*([^\n]*)$" or text:match "^%s*([%a_][%w_.:]*)%s*%?$"
  if asked then return explain(asked) end
  local command = text:match "^%s*!([^\n]*)$"
  if command then return shell(command) end
  local f, short = load("return " .. text, NAME), false
  if f then return f end
  local why
  f, why = load(text, NAME)
  if f then return f end
  short = is_incomplete(why)
  f = split(text)
  if f then return f end
  return nil, why, short
end

return M
