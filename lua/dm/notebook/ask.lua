--- What a program asks about a text: what could complete it, what a name is, whether it is whole.
local cell = require "dm.notebook.cell"
local complete = require "dm.session.complete"

local M = {}

-- byte where the word begins that completion replaces
local function word_start(text)
  local quote = text:match "^.*()[\"'][^\"']*$"
  local words = complete.candidates(text)
  local is_string = quote and select(2, text:gsub("[\"']", "")) % 2 == 1
  if is_string then return quote + 1, words end
  return #text - #text:match "[%w_]*$" + 1, words
end

--- { words =, first = } for the text before the cursor; words is true for names of files. `first`
-- counts bytes from 0.
function M.complete(text)
  local first, words = word_start(text)
  local list = type(words) == "table" and words or {}
  return { words = list, first = first - 1, files = words == true }
end

-- what f prints, as one text
local function printed(f, ...)
  local lines, before = {}, print
  print = function(...)  -- luacheck: ignore
    local parts = table.pack(...)
    for i = 1, parts.n do parts[i] = tostring(parts[i]) end
    lines[#lines + 1] = table.concat(parts, "\t")
  end
  local fine, why = pcall(f, ...)
  print = before  -- luacheck: ignore
  return fine and table.concat(lines, "\n") or why
end

-- the name at the cursor; behind an open parenthesis that of the function
local function name_at(text, at)
  local before, after = text:sub(1, at), text:sub(at + 1)
  local name = before:match "[%w_.:]*$" .. after:match "^[%w_]*"
  if name == "" then name = before:match "([%a_][%w_.:]*)%s*[({][^(){}]*$" or "" end
  return (name:gsub("^[.:]+", ""):gsub("[.:]+$", ""))
end

--- { found =, text = }: help on the name at byte `at` of the text.
function M.inspect(text, at)
  local name = name_at(text, at)
  local object = name ~= "" and (complete.look_up(name) or complete.look_up("dm." .. name))
  if not object or object.value == nil and not object.class then return { found = false } end
  return { found = true, text = printed(require "dm.session.help".ask, name) }
end

--- "complete", "incomplete" or "invalid".
function M.is_complete(text)
  local f, _, short = cell.compile(text)
  return { status = f and "complete" or short and "incomplete" or "invalid" }
end

return M
