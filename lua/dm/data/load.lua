--- dm.load: the columns of a text or npy file as vectors.
local blame = require "dm.base.blame"
local core = require "dm.core"
local journal = require "dm.data.journal"
local option = require "dm.base.options"
local text_table = require "dm.data.text_table"

local M = {}

local function fail(file, ...) option.fail("dm.load: " .. file, ...) end

---- npy ----

-- text of the header; the file is left at the first byte of the data
local function npy_text(file, handle)
  local head = handle:read(8) or ""
  if head:sub(1, 6) ~= "\147NUMPY" or #head < 8 then fail(file, "is not an npy file") end
  local format = head:byte(7) == 1 and "<I2" or "<I4"
  local size = handle:read(format:packsize()) or ""
  if #size < format:packsize() then fail(file, "ends inside the header") end
  local text = handle:read((format:unpack(size))) or ""
  if text:find("'fortran_order': *True") then
    fail(file, "has Fortran order; save it in C order")
  end
  return text
end

local MOST = 2 ^ 48 -- rows that a file may say it has

local function whole(file, digits)
  local n = math.tointeger(tonumber(digits))
  if not n or n > MOST then fail(file, "has an impossible shape: %s", digits:sub(1, 40)) end
  return n
end

-- the numbers of a row are in the file
local function width_of(file, digits, handle)
  local n = whole(file, digits)
  local at = handle:seek()
  if 8 * n > handle:seek "end" then fail(file, "ends inside the first row of %d numbers", n) end
  handle:seek("set", at)
  return n
end

-- names of the columns, how many numbers each has in a row (0: one, and no array) and the number of
-- rows, from named fields or a plain array
local function npy_shape(file, text, handle)
  local rows, width = text:match("'shape': *%((%d+),? *(%d*)%)")
  local fields = text:match("'descr': *%[(.-)%], *'fortran")
  local names, counts = {}, {}
  if fields then
    local field = "%((['\"])(.-[^\\])%1, *'(.-)',? *%(?([%d, ]*)%)"
    for _, name, kind, shape in fields:gmatch(field) do
      if kind ~= "<f8" then fail(file, "field %s has type %s; only <f8 is read", name, kind) end
      if shape:find "%d+%s*,%s*%d" then fail(file, "field %s is an array of arrays", name) end
      names[#names + 1] = name:gsub("\\(.)", "%1")
      local count = shape:match "%d+"
      counts[#names] = count and width_of(file, count, handle) or 0
    end
  elseif text:find("'descr': *'<f8'") and rows then
    local columns = width ~= "" and rows ~= "0" and width_of(file, width, handle)
    for c = 1, columns or math.min(tonumber(width) or 1, 1000) do
      names[c], counts[c] = "c" .. c, 0
    end
  else
    fail(file, "holds neither <f8 numbers nor records of them")
  end
  if not rows or #names == 0 then fail(file, "has an unknown shape") end
  return names, whole(file, rows), counts
end

local BLOCK = 100 -- numbers that one call of unpack gives

-- the next `count` numbers of a file as a list; fewer where it ends
local function numbers(handle, count)
  local out = {}
  while #out < count do
    local now = math.min(BLOCK, count - #out)
    local bytes = handle:read(8 * now)
    if not bytes or #bytes < 8 * now then break end
    local part = { ("<" .. ("d"):rep(now)):unpack(bytes) }
    table.move(part, 1, now, #out + 1, out)
  end
  return out
end

local function load_npy(file, handle)
  local names, rows, counts = npy_shape(file, npy_text(file, handle), handle)
  local width, columns = 0, {}
  for c in ipairs(names) do columns[c], width = {}, width + math.max(1, counts[c]) end
  for i = 1, rows do
    local row, at = numbers(handle, width), 0
    if #row < width then fail(file, "ends at row %d of %d", i, rows) end
    for c in ipairs(names) do
      local count = counts[c]
      columns[c][i] = count == 0 and row[at + 1] or table.move(row, at + 1, at + count, 1, {})
      at = at + math.max(1, count)
    end
  end
  return names, columns, counts
end

---- both ----

-- data.columns is the list of names: a column of that name gets a line behind it, once more where
-- there is such a one, too
local function apart_from_list(names)
  local taken = {}
  for _, name in ipairs(names) do taken[name] = true end
  for c, name in ipairs(names) do
    if name == "columns" then
      repeat name = name .. "_" until not taken[name]
      names[c] = name
    end
  end
end

local doc_load = [[
dm.load(file, {separator=, decimal=, names=, skip=}) -> table
Columns of a .npy file or of a text, as path:npy and path:csv write them, or of what comes through
a pipe ("/dev/stdin"), up to its end: data.columns lists the
names, data.q1 is a dm.vector, of a field of arrays a dm.matrix with a row each. In a text commas,
semicolons, tabs or blanks stand between the fields; blank lines and comments, from a # on, are
skipped. A column of the name columns is data.columns_. Names are in the first line, or in the
last comment above the numbers; without names the columns are c1, c2, ... Words beside bare
numbers in the first line are refused: a row with a fault, or names that need quotes. A decimal
comma is seen where the fields show it ("1,5;2,5"); exponents may be of Fortran ("1.0D+00"). Given:
separator = ",", ";", "tab" or "blank", decimal = "," or ".", names = a list, skip = lines to
leave out.
Raises with the line and the column of what is not a number. Of the journal of a sweep
(dm.sweep, solver:ensemble) these are the members that ended well, by their number in column
member.]]

local GIVEN = { "separator", "decimal", "names", "skip" }

local function check_given(given)
  option.check(given, GIVEN, "dm.load")
  option.one_of(given, "decimal", "dm.load", { ",", "." })
  option.one_of(given, "separator", "dm.load", { ",", ";", "tab", "blank", "\t", " " })
  option.whole(given, "skip", "dm.load", 0, 1e9)
end

M.load = blame.caller(function(file, given)
  if type(file) ~= "string" then
    option.fail("dm.load", "a file name is needed (got %s)", option.got(file))
  end
  if given ~= nil then check_given(given) end
  local is_npy = file:lower():find("%.npy$")
  local handle, why = core.open_file(file)
  if not handle then option.fail("dm.load", "%s", why) end
  local fine, names, columns, counts
  local is_journal = handle:read(8) == journal.HEAD
  handle:seek("set")
  if is_journal then
    fine, names, columns = pcall(require "dm.data.journal_columns".columns, file)
  elseif is_npy then
    fine, names, columns, counts = pcall(load_npy, file, handle)
  else
    fine, names, columns = pcall(text_table.read, handle, "dm.load: " .. file, given)
  end
  handle:close()
  if not fine then error(names, 0) end
  local data = {}
  apart_from_list(names)
  for c, name in ipairs(names) do
    local is_array = counts and counts[c] > 0 and #columns[c] > 0
    data[name] = is_array and core.matrix(columns[c]) or core.vector(columns[c])
  end
  data.columns = names
  return data
end)

core.docs[M.load] = doc_load

return M
