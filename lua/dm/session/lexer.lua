--- Tokens of a piece of Lua, which may end anywhere: for completion, and for a trailing semicolon.
local M = {}

local find, sub, match = string.find, string.sub, string.match

-- end of the long bracket that opens at `at`; #text + 1 when it is not closed, nil when none opens
local function long_bracket(text, at)
  local level = match(text, "^%[(=*)%[", at)
  if not level then return nil end
  local _, last = find(text, "]" .. level .. "]", at, true)
  return last or #text + 1
end

-- end of the quoted string at `at`; #text + 1 when it is not closed
local function quoted(text, at)
  local quote, i = sub(text, at, at), at + 1
  while i <= #text do
    local c = sub(text, i, i)
    if c == "\\" then
      i = i + 1
    elseif c == quote then
      return i
    elseif c == "\n" then
      return i
    end
    i = i + 1
  end
  return #text + 1
end

local function comment(text, at)
  if sub(text, at, at + 1) ~= "--" then return nil end
  return long_bracket(text, at + 2) or (find(text, "\n", at, true) or #text + 2) - 1
end

local function symbol(text, at)
  local three = match(text, "^%.%.%.", at)
  return at + #(three or match(text, "^[=~<>]=", at) or match(text, "^//", at)
    or match(text, "^::", at)
    or match(text, "^%.%.", at) or match(text, "^<<", at) or match(text, "^>>", at) or " ") - 1
end

-- kind and last place of the token at `at`
local function token(text, at)
  local last = comment(text, at)
  if last then return "comment", last end
  last = long_bracket(text, at)
  if last then return "string", last end
  local c = sub(text, at, at)
  if c == '"' or c == "'" then return "string", quoted(text, at) end
  last = select(2, find(text, "^[%a_][%w_]*", at))
  if last then return "name", last end
  last = select(2, find(text, "^%.?%d[%w.]*", at))
  if last then return "number", last end
  return "symbol", symbol(text, at)
end

--- List of { kind, text, first, last } without blanks and comments; then the kind of the token that
-- the end of the text cuts ("string" or "comment"), if any.
function M.tokens(text)
  local list, at = {}, find(text, "%S")
  while at do
    local kind, last = token(text, at)
    local cut = last > #text
    if kind ~= "comment" then
      list[#list + 1] = { kind = kind, text = sub(text, at, last), first = at, last = last }
    end
    if cut then return list, kind end
    at = find(text, "%S", last + 1)
  end
  return list
end

return M
