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

-- names of the columns and the number of rows, from named fields or a plain array
local function npy_shape(file, text)
  local rows, width = text:match("'shape': *%((%d+),? *(%d*)%)")
  local fields = text:match("'descr': *%[(.-)%], *'fortran")
  local names = {}
  if fields then
    for _, name, kind in fields:gmatch("%((['\"])(.-[^\\])%1, *'(.-)'%)") do
      if kind ~= "<f8" then fail(file, "field %s has type %s; only <f8 is read", name, kind) end
      names[#names + 1] = name:gsub("\\(.)", "%1")
    end
  elseif text:find("'descr': *'<f8'") and rows then
    for c = 1, tonumber(width) or 1 do names[c] = "c" .. c end
  else
    fail(file, "holds neither <f8 numbers nor records of them")
  end
  if not rows or #names == 0 then fail(file, "has an unknown shape") end
  return names, tonumber(rows)
end

local function load_npy(file, handle)
  local names, rows = npy_shape(file, npy_text(file, handle))
  local pattern, columns = "<" .. ("d"):rep(#names), {}
  for c in ipairs(names) do columns[c] = {} end
  for i = 1, rows do
    local record = handle:read(8 * #names)
    if not record or #record < 8 * #names then fail(file, "ends at row %d of %d", i, rows) end
    local row = { pattern:unpack(record) }
    for c in ipairs(names) do columns[c][i] = row[c] end
  end
  return names, columns
end

---- both ----

local doc_load = [[
dm.load(file) -> table
Columns of a .npy file or of a text, as path:npy and path:csv write them: data.columns lists the
names, data.q1 is a dm.vector. In a text commas, semicolons, tabs or blanks stand between the
fields; blank lines and those that begin with # are skipped. Names are in the first line, or in the
last comment above the numbers; without names the columns are c1, c2, ... Raises with the line and
the column of what is not a number. Of the journal of a sweep (dm.sweep, solver:ensemble) these are
the members that ended well, by their number in column member.]]

M.load = blame.caller(function(file)
  if type(file) ~= "string" then
    option.fail("dm.load", "a file name is needed (got %s)", option.got(file))
  end
  local is_npy = file:lower():find("%.npy$")
  local handle, why = io.open(file, "rb")
  if not handle then option.fail("dm.load", "cannot open %s", why) end
  local fine, names, columns
  local is_journal = handle:read(8) == journal.HEAD
  handle:seek("set")
  if is_journal then
    fine, names, columns = pcall(require "dm.data.journal_columns".columns, file)
  elseif is_npy then
    fine, names, columns = pcall(load_npy, file, handle)
  else
    fine, names, columns = pcall(text_table.read, handle, "dm.load: " .. file)
  end
  handle:close()
  if not fine then error(names, 0) end
  local data = {}
  for c, name in ipairs(names) do data[name] = core.vector(columns[c]) end
  data.columns = names
  return data
end)

core.docs[M.load] = doc_load

return M
