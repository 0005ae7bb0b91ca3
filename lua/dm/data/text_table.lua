--- Columns of numbers from a text: fields between commas, semicolons, tabs or blanks; names in the
-- first line or in a comment above the numbers, or none.
local option = require "dm.base.options"

local M = {}

---- fields of a line ----

local BLANKS = "%s+"

-- what stands between the fields of a line, as a pattern; where it is one field, the end
local function separator_of(line)
  local plain = line:gsub('%b""', "")
  for _, sign in ipairs { "\t", ";", "," } do
    if plain:find(sign, 1, true) then return sign end
  end
  return plain:find(BLANKS) and BLANKS or "$"
end

-- the text from position `at`, which begins with a quote, and the position behind it
local function quoted_field(line, at)
  local text = ""
  repeat
    local part, after = line:match('^"([^"]*)"()', at)
    if not part then return nil end
    text, at = text .. part, after
    local doubled = line:sub(at, at) == '"'
    if doubled then text = text .. '"' end
  until not doubled
  return text, at
end

-- fields of a line; nil where a quote is not closed
local function fields_of(line, separator)
  line = line:match "^%s*(.-)%s*$"
  local fields, at = {}, 1
  repeat
    local text, after = nil, at
    if line:sub(at, at) == '"' then
      text, after = quoted_field(line, at)
      if not text then return nil end
    end
    local first, last = line:find(separator, after)
    fields[#fields + 1] = text or line:sub(at, (first or #line + 1) - 1):match "^%s*(.-)%s*$"
    at = first and last >= first and last + 1  -- at the end of the line nothing is matched
  until not at
  return fields
end

local WORDS = { nan = 0 / 0, ["-nan"] = 0 / 0, inf = math.huge, ["-inf"] = -math.huge }

local function number_of(field)
  local x = tonumber(field) or WORDS[field:lower()]
  if x == 0 and field:find "^-" then return -0.0 end
  return x and x + 0.0
end

-- numbers, some of which may be missing: no names of columns
local function are_numbers(fields)
  local count = 0
  for _, field in ipairs(fields) do
    if number_of(field) then count = count + 1 elseif field ~= "" then return false end
  end
  return count > 0
end

---- lines ----

-- a function that gives number and text of the next line that says something, and a table whose
-- `comment` is the last comment above the first such line
local function lines_of(handle, fail)
  local number, seen = 0, {}
  local function next_line()
    for line in handle:lines "l" do
      number = number + 1
      if number == 1 then line = line:gsub("^\239\187\191", "") end  -- the mark of UTF-8
      if line:find "\0" then
        fail("line %d: zeros between the letters: save it as UTF-8", number)
      end
      local comment = line:match "^%s*#(.*)$"
      if not comment and line:find "%S" then
        seen.first = true
        return number, line
      end
      if comment and not seen.first then seen.comment = comment end
    end
  end
  return next_line, seen
end

-- names in a comment, if there are as many words as numbers
local function names_in(comment, count, separator)
  for _, sign in ipairs { separator == BLANKS and "[%s,;]+" or separator, "[%s,;]+" } do
    local names = comment and fields_of(comment, sign)
    if names and #names == count and not are_numbers(names) then return names end
  end
end

local function numbered(count)
  local names = {}
  for c = 1, count do names[c] = "c" .. c end
  return names
end

local function check_names(names, fail)
  local seen = {}
  for _, name in ipairs(names) do
    if seen[name] then fail("two columns are called '%s'", name) end
    seen[name] = true
  end
end

--- Names and columns (lists of numbers) of an open file; `where` names it in messages.
function M.read(handle, where)
  local fail = option.failing(where)
  local next_line, seen = lines_of(handle, fail)
  local number, line = next_line()
  if not number then fail "is empty; a line of column names is needed" end
  local second_number, second = next_line()
  local function fields_at(at, text, separator)
    return fields_of(text, separator) or fail("line %d: a quote is not closed", at)
  end
  local separator = separator_of(line)
  local names, columns, rows = fields_at(number, line, separator), {}, 0
  if second and not are_numbers(names) then  -- names may have blanks or commas in them
    separator = separator_of(second)
    local others = fields_at(number, line, separator)
    if #names ~= #fields_at(second_number, second, separator) then names = others end
  end
  local function add(at, fields)
    if #fields ~= #names then
      fail("line %d has %d fields, the first line has %d", at, #fields, #names)
    end
    rows = rows + 1
    for c, field in ipairs(fields) do
      columns[c][rows] = number_of(field)
        or fail("line %d, column %s: not a number: %q", at, names[c], field)
    end
  end
  for c in ipairs(names) do columns[c] = {} end
  if are_numbers(names) then
    local first = names
    names = names_in(seen.comment, #first, separator) or numbered(#first)
    add(number, first)
  end
  check_names(names, fail)
  number, line = second_number, second
  while number do
    add(number, fields_at(number, line, separator))
    number, line = next_line()
  end
  return names, columns
end

return M
