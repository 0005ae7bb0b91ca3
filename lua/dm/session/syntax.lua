--- Errors of syntax say how Lua writes what other languages write: from the line and the word that
-- the message names.
local M = {}

local find, match = string.find, string.match

-- { pattern of the line, pattern of the message (any where left out), how it is written }
local WAYS = {
  { "^%s*import%s+[%a_]", nil, "a module is loaded by  m = require \"m\"; dm is there" },
  { "^%s*from%s+[%w_.]+%s+import", nil, "a module is loaded by  m = require \"m\"; dm is there" },
  { "^%s*def%s+[%a_]", nil, "a function is written  function f(x) ... end" },
  { "%f[%w_]lambda[%w_,%s]*:%s", nil,
    "a function without a name is written  function(x) return x^2 end" },
  { "^%s*for%s.*%sin%s.*:%f[%s%z]", nil, "a loop is written  for i = 1, n do ... end" },
  { "^%s*e?l?s?e?if%s.*[^:]:%s*$", nil, "a condition is written  if x then ... end" },
  { "^%s*[%w_]+%s*=%s*%[", "near '%['",
    "a list is written  { 1, 2, 3 }, a vector  dm.vector { 1, 2 }" },
  { "%[[^%]]+,", "near ','", "an entry of a matrix is  A[1][2]" },
  { "%[%s*end%s*%]", "near 'end'", "the last entry is  x[#x]" },
  { "%*%*", nil, "a power is written  x^2" },
  { "!=", nil, "\"not equal\" is written  ~=" },
  { "&&", nil, "\"and\" is written  and" },
  { "||", nil, "\"or\" is written  or" },
  { "![^=]", "near '!'", "\"not\" is written  not x" },
  { "[%w_%]]%s*%+%+", nil, "x++ is written  x = x + 1" },
  { "[%w_%]]%s*[+*/-]=", nil, "x += y is written  x = x + y" },
  { "^[^'\"]*#%s", nil, "a comment begins with  --" },
  { "^%s*print%s+[^%s({%['\"]", nil, "printing is written  print(x)" },
}

-- the line of that number without strings and comments
local function line_of(text, number)
  for line in (text .. "\n"):gmatch "([^\n]*)\n" do
    number = number - 1
    if number == 0 then return (line:gsub("%b\"\"", '""'):gsub("%b''", "''"):gsub("%-%-.*", "")) end
  end
end

local function way_of(line, what)
  for _, way in ipairs(WAYS) do
    if find(line, way[1]) and (not way[2] or find(what, way[2])) then return way[3] end
  end
end

-- what is not written as elsewhere, but forgotten
local function forgotten(line, message)
  if find(message, "'}' expected near", 1, true) then return "is a comma missing before it?" end
  local body = match(line, ".*%f[%w_]function%s*[%w_.:]*%b()(.*)") -- of the last function
  if body and find(message, "near '[-+*/^]'") and not find(body, "%f[%w_]return%f[^%w_]") then
    return "does the function lack a return?"
  end
end

--- The message of a chunk that does not compile, with what to write instead where that is known.
-- text: the chunk; nil: that of the file.
function M.explain(message, text, file)
  local number, what = match(message, "^[^\n]-:(%d+): ([^\n]*)$")
  local source = not text and number and file and io.open(file)
  if source then
    text = source:read "a"
    source:close()
  end
  local line = number and text and line_of(text, tonumber(number))
  if not line then return message end
  local before = line_of(text, number - 1) or ""  -- a line may end in the middle of its mistake
  local way = way_of(line, what) or forgotten(line, what) or way_of(before, what)
  return way and message .. ": " .. way or message
end

return M
