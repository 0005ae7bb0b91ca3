--- Columns of numbers from a text: fields between commas, semicolons, tabs or blanks; numbers with
-- a decimal point or comma; names in the first line or in a comment above the numbers, or none.
local core = require "dm.core"
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

local huge = math.huge
local NAN = math.abs(0 / 0)  -- without a sign, which would be printed
local WORDS = { nan = NAN, ["-nan"] = NAN, inf = huge, ["-inf"] = -huge }

-- a number of Fortran ("1.0D+00", and "1.0-103", which leaves the letter out) as C writes it
local function plain(field)
  return (field:gsub("^([-+]?%d*%.?%d*)[dD]([-+]?%d+)$", "%1e%2")
    :gsub("^([-+]?%d*%.%d+)([-+]%d%d%d)$", "%1e%2"))
end

local function number_of(field, comma)
  if comma then field = field:gsub(",", ".", 1) end
  local x = tonumber(field) or tonumber(plain(field)) or WORDS[field:lower()]
  if x == 0 and field:find "^-" then return -0.0 end
  return x and x + 0.0
end

-- UTF-8 of what looks like a blank or a minus, and is none to a program; a lone byte of Latin-1
local ALIKE = { { "\194[\133\160]", " " }, { "\226\128[\128-\139\168\169\175]", " " },
  { "\226\129\159", " " }, { "\227\128\128", " " }, { "\226\136\146", "-" },
  { "\226\128[\144-\147]", "-" }, { "\160", " " } }

-- what a message says of a field that would be numbers if these were blanks and minus; else nothing
local function looks_like_numbers(field)
  local seen = field
  for _, row in ipairs(ALIKE) do seen = seen:gsub(row[1], row[2]) end
  if seen == field then return end
  for word in seen:gmatch "%S+" do
    if not number_of(word, true) then return end
  end
  return (" (a sign in it looks like a blank or a minus and is another one: write it as %q)")
    :format(seen)
end

-- a field in a message
local function shown(field) return #field > 60 and field:sub(1, 60) .. "..." or field end

-- numbers, some of which may be missing: no names of columns
local function are_numbers(fields, comma)
  local count = 0
  for _, field in ipairs(fields) do
    if number_of(field, comma) then count = count + 1 elseif field ~= "" then return false end
  end
  return count > 0
end

-- A first line with words and numbers is a row with a fault, or names of which some are numbers: to
-- take it as either would be a guess. Numbers in quotes are names.
local function check_first(fields, line, comma, at, fail)
  local word, number
  for _, field in ipairs(fields) do
    local bare, odd = not line:find('"' .. field .. '"', 1, true), looks_like_numbers(field)
    if odd and bare then fail("line %d: not a number: %q%s", at, shown(field), odd) end
    if not number_of(field, comma) then word = word or field
    elseif bare then number = number or field end
  end
  if word and number then
    fail("line %d: %q is no number, and %s no name: mend the row, or, where the line holds names, "
      .. "put them in quotes or leave it out by skip = %d, names = { ... }", at, shown(word),
      shown(number), at)
  end
end

---- lines ----

-- a line without the comment behind its numbers
local function uncommented(line)
  if not line:find "^%s*[-+]?%.?%d[%w.+-]*[%s,;]" then return line end
  return (line:gsub("[%s,;]#.*$", ""))
end

-- Raises at a carriage return inside of a line, and its kin: they are no blanks between fields.
local function check_control(line, number, fail)
  local at = line:find "[\1-\8\11-\31\127]"
  if not at or not line:find("%S", at) then return end
  local sign = line:byte(at)
  fail("line %d: %s inside of it: lines end in a newline, and blanks or tabs stand between fields",
    number, sign == 13 and "a carriage return" or "control character " .. sign)
end

-- a function that gives number and text of the next line that says something, the first `skip`
-- lines left out, and a table whose `comment` is the last comment above the first such line
local function lines_of(handle, skip, fail)
  local number, seen = 0, {}
  for _ = 1, skip do
    if handle:read "l" then number = number + 1 end
  end
  local function next_line()
    for line in handle:lines "l" do
      number = number + 1
      if number == 1 then line = line:gsub("^\239\187\191", "") end  -- the mark of UTF-8
      if line:find "\0" then
        fail("line %d: zeros between the letters: save it as UTF-8", number)
      end
      line = line:gsub("^\f+", "")  -- a page begins
      check_control(line, number, fail)
      local comment = line:match "^%s*#(.*)$"
      if not comment and line:find "%S" then
        seen.first = true
        return number, uncommented(line)
      end
      if comment and not seen.first then seen.comment = comment end
    end
  end
  return next_line, seen
end

-- names in a comment, if there are as many words as numbers
local function names_in(comment, count, separator, comma)
  for _, sign in ipairs { separator == BLANKS and "[%s,;]+" or separator, "[%s,;]+" } do
    local names = comment and fields_of(comment, sign)
    if names and #names == count and not are_numbers(names, comma) then return names end
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

local SIGNS = { tab = "\t", blank = BLANKS, [" "] = BLANKS, ["\t"] = "\t", [";"] = ";",
  [","] = "," }

-- Is the comma of this line a decimal one? Where another sign stands between the fields, and every
-- field with a comma is a number with it; of blanks only where no comma ends a field.
local function has_decimal_comma(line, separator)
  if not line or separator == "," or not line:find(",", 1, true) then return false end
  local found = false
  for _, field in ipairs(fields_of(line, separator) or {}) do
    if field:find "^[-+]?%d*,%d+[eEdD]?[-+]?%d*$" then
      found = true
    elseif field:find(",", 1, true) then
      return false
    end
  end
  return found
end

-- what stands between the fields, and whether numbers have a comma, from a line of numbers
local function look_at(line, given, fail)
  local separator = given.separator and (SIGNS[given.separator]
    or fail("separator must be \",\", \";\", \"tab\" or \"blank\" (got %s)",
      option.got(given.separator)))
  separator = separator or separator_of(line)
  if not given.separator and separator == "," and given.decimal == "," then separator = BLANKS end
  if not given.separator and separator == "," and has_decimal_comma(line, BLANKS)
    and line:find "%d%s+[-+]?%d" then
    separator = BLANKS -- "0 1,5": blanks between numbers with a comma
  end
  local comma = given.decimal == "," or given.decimal == nil and has_decimal_comma(line, separator)
  return separator, comma
end

-- Reads the lines of a text: names, columns as they grow.
local function reader(handle, given, fail)
  local next_line, seen = lines_of(handle, given.skip or 0, fail)
  local number, line = next_line()
  if not number then fail "is empty; a line of numbers is needed" end
  local second_number, second = next_line()
  local separator, comma = look_at(line, given, fail)
  if second then comma = comma or select(2, look_at(second, given, fail)) end
  return { next_line = next_line, seen = seen, number = number, line = line, second = second,
    second_number = second_number, separator = separator, comma = comma }
end

local function fields_at(r, at, text, fail)
  return fields_of(text, r.separator) or fail("line %d: a quote is not closed", at)
end

-- fields of the first line; names may have blanks or commas in them, the numbers below tell what
-- stands between
local function first_fields(r, given, fail)
  local fields = fields_at(r, r.number, r.line, fail)
  if not r.second or are_numbers(fields, r.comma) then return fields end
  local kept = r.separator
  r.separator, r.comma = look_at(r.second, given, fail)
  local others = fields_at(r, r.number, r.line, fail)
  if #fields == #fields_at(r, r.second_number, r.second, fail) and kept == r.separator then
    return fields
  end
  if #others ~= #fields_at(r, r.second_number, r.second, fail) then
    r.separator = kept
    local same = #fields == #fields_at(r, r.second_number, r.second, fail)
    if same then return fields end
    r.separator = (look_at(r.second, given, fail))
  end
  return others
end

-- the names that were given for so many columns
local function given_names(names, count, fail)
  names = core.unlocked(names)
  if type(names) ~= "table" then fail "names must be a list of texts" end
  for c = 1, math.max(count, #names) do
    if type(names[c]) ~= "string" then
      fail("names must be %d texts, one for each column (got %d)", count, #names)
    end
  end
  return table.move(names, 1, count, 1, {})
end

local function fail_ragged(at, fields, names, fail)
  local short = #fields < #names
  fail("line %d, column %s: %s: the line has %d field%s, the first one %d", at,
    short and names[#fields + 1] or #names + 1, short and "nothing is there" or "one too many",
    #fields, #fields == 1 and "" or "s", #names)
end

local function fail_field(at, name, field, fail)
  if field == "" then
    fail("line %d, column %s: not a number: nothing is there; where one is missing write nan", at,
      shown(name))
  end
  fail("line %d, column %s: not a number: %q%s", at, shown(name), shown(field),
    looks_like_numbers(field) or "")
end

--- Names and columns (lists of numbers) of an open file; `where` names it in messages. given: {
-- separator, decimal, names, skip (lines) }, what is left out is seen from the text.
function M.read(handle, where, given)
  local fail = option.failing(where)
  given = given or {}
  local r = reader(handle, given, fail)
  local names, columns, rows = first_fields(r, given, fail), {}, 0
  local function add(at, fields)
    if #fields ~= #names then fail_ragged(at, fields, names, fail) end
    rows = rows + 1
    for c, field in ipairs(fields) do
      local x = number_of(field, r.comma)
      if not x then fail_field(at, names[c], field, fail) end
      if (x == huge or x == -huge) and not field:lower():find("inf", 1, true) then
        fail("line %d, column %s: %s is beyond the largest number, 1.8e308 (infinity is written "
          .. "inf)", at, names[c], field)
      end
      columns[c][rows] = x
    end
  end
  for c in ipairs(names) do columns[c] = {} end
  local first = names
  if given.names then names = given_names(given.names, #first, fail) end
  if are_numbers(first, r.comma) then
    names = given.names and names or names_in(r.seen.comment, #first, r.separator, r.comma)
      or numbered(#first)
    add(r.number, first)
  else
    check_first(first, r.line, r.comma, r.number, fail)
  end
  check_names(names, fail)
  local number, line = r.second_number, r.second
  while number do
    add(number, fields_at(r, number, line, fail))
    number, line = r.next_line()
  end
  return names, columns
end

return M
