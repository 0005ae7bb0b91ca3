--- Paths to files and back: csv (17 significant digits) and npy (the bits themselves).
local blame = require "dm.base.blame"
local core = require "dm.core"
local npy = require "dm.data.npy"
local text_file = require "dm.base.text_file"

local replace = text_file.replace

local M = {}

local CHUNK = 1024  -- rows put together before a write

-- columns as plain tables, and their names
local function columns_of(path)
  local names, columns = path.columns, {}
  for i, name in ipairs(names) do
    columns[i] = require "dm.show.series".numbers(path:column(name), name)
  end
  return columns, names
end

-- iterator over strings of up to CHUNK rows each, header first
local function chunks(columns, header, format)
  local n, i = #columns[1], 0
  return function()
    if header then
      local first = header
      header = nil
      return first
    end
    if i >= n then return nil end
    local lines, row = {}, {}
    for k = i + 1, math.min(n, i + CHUNK) do
      for c = 1, #columns do row[c] = columns[c][k] end
      lines[#lines + 1] = format(row)
    end
    i = i + #lines
    return table.concat(lines)
  end
end

---- csv ----

local function csv_quote(name)
  if name:find('[",\n\r]') then return '"' .. name:gsub('"', '""') .. '"' end
  return name
end

local function csv_header(names)
  local quoted = {}
  for i, name in ipairs(names) do quoted[i] = csv_quote(name) end
  return table.concat(quoted, ",") .. "\n"
end

local function csv_row(count)
  local pattern = ("%.17g,"):rep(count - 1) .. "%.17g\n"
  return function(row) return pattern:format(table.unpack(row, 1, count)) end
end

local doc_csv = [[
path:csv(file) -> file name   or   path:csv() -> string
The rows as comma-separated values under a line of column names, 17 significant digits: reading them
back gives the same bits. Raises when the file cannot be written.]]

function M.csv(path, file)
  local columns, names = columns_of(path)
  local pieces = chunks(columns, csv_header(names), csv_row(#names))
  if file == nil then
    local all = {}
    for piece in pieces do all[#all + 1] = piece end
    return table.concat(all)
  end
  replace(file, pieces, "path:csv")
  return file
end

---- npy: records of little-endian doubles with named fields ----

local function npy_header(names, rows)
  local fields = {}
  for i, name in ipairs(names) do fields[i] = { name, 0 } end
  return npy.header(fields, rows)
end

local function npy_row(count)
  local pattern = "<" .. ("d"):rep(count)
  return function(row) return pattern:pack(table.unpack(row, 1, count)) end
end

local doc_npy = [[
path:npy(file) -> file name
The rows as a NumPy array with named fields: numpy.load(file)["q1"] is the column q1. The bits of
the numbers are kept. Raises when the file cannot be written.]]

function M.npy(path, file)
  local columns, names = columns_of(path)
  local pieces = chunks(columns, npy_header(names, #path), npy_row(#names))
  replace(file, pieces, "path:npy")
  return file
end

core.method("dm.path", "csv", blame.caller(M.csv), doc_csv)
core.method("dm.path", "npy", blame.caller(M.npy), doc_npy)

return M
