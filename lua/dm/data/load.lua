--- dm.load: the columns of a text or npy file as vectors.
local blame = require "dm.base.blame"
local core = require "dm.core"
local journal = require "dm.data.journal"
local npy_read = require "dm.data.npy_read"
local option = require "dm.base.options"
local text_table = require "dm.data.text_table"

local M = {}

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
Columns of a .npy file or of a text, as path:npy and path:csv write them, or of what comes through a
pipe ("/dev/stdin"), up to its end: data.columns lists the names, data.q1 is a dm.vector, of a field
of arrays a dm.matrix with a row each. Of a .npy file the numbers have 4 or 8 bytes, whole ones and
truth values 1 to 8, in any order, as rows; what stands behind the array is not read. An array has
columns c1, c2, ... In a text commas, semicolons, tabs or blanks stand between the fields; blank
lines and comments, from a # on, are skipped. A column of the name columns is data.columns_. Names
are in the first line, or in the last comment above the numbers; without names the columns are c1,
c2, ... Words beside bare numbers in the first line are refused: a row with a fault, or names that
need quotes. A decimal comma is seen where the fields show it ("1,5;2,5"); exponents may be of
Fortran ("1.0D+00").
Given:
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
  local handle, why = core.open_file(file)
  if not handle then option.fail("dm.load", "%s", why) end
  local fine, names, columns, counts
  local head = handle:read(8) or ""
  handle:seek("set")
  if head == journal.HEAD then
    fine, names, columns = pcall(require "dm.data.journal_columns".columns, file)
  elseif head:sub(1, 6) == npy_read.MAGIC or file:lower():find "%.npy$" then
    fine, names, columns, counts = pcall(npy_read.read, file, handle)
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
