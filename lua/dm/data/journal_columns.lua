--- Columns of the journal of a sweep, for dm.load.
local blame = require "dm.base.blame"
local fields = require "dm.data.fields"
local journal = require "dm.data.journal"
local option = require "dm.base.options"

local M = {}

local fail = option.failing "dm.load"

-- of an ensemble: steps, and q1, ..., p1, ... of members that ended well
local function ensemble_row(bytes, n, momenta, offset)
  local status, _, steps = ("<i4I4i8"):unpack(bytes)
  if status ~= 0 then return nil end
  local row = { steps }
  local at = offset + 1
  for k = 1, n do row[#row + 1] = ("<d"):unpack(bytes, at + 8 * (k - 1)) end
  for k = 1, momenta do row[#row + 1] = ("<d"):unpack(bytes, at + 8 * (n + k - 1)) end
  return row
end

local function sweep_row(bytes)
  local code, names, at = ("<s2s2"):unpack(bytes)
  if code ~= "ok" then return nil end
  local row = {}
  for k = at, #bytes, 8 do row[#row + 1] = ("<d"):unpack(bytes, k) end
  return row, names
end

-- Of kinds whose members are named values: numbers, and truths as 1 and 0; parameters by their
-- names, texts left out.
local function named_row(bytes)
  local row = {}
  for name, x in pairs(fields.unpack(bytes)) do
    name = name:gsub("^value ", "")
    if type(x) == "boolean" then x = x and 1 or 0 end
    row[name] = type(x) == "number" and x or nil
  end
  return row
end

-- columns of all names that any member has, NaN where one has not
local function named_columns(j)
  local rows, known, names, columns = {}, {}, { "member" }, { {} }
  for _, r in ipairs(j.records) do
    for i, bytes in journal.members(r, journal.bytes(j, r)) do
      rows[i] = named_row(bytes)
      for name in pairs(rows[i]) do
        if not known[name] then known[name], names[#names + 1] = true, name end
      end
    end
  end
  table.sort(names, function(a, b) return a == "member" and b ~= a or b ~= "member" and a < b end)
  local members = {}
  for i in pairs(rows) do members[#members + 1] = i end
  table.sort(members)
  for c = 1, #names do
    columns[c] = {}
    for k, i in ipairs(members) do
      local x = rows[i][names[c]]
      columns[c][k] = names[c] == "member" and i or x == nil and 0 / 0 or x
    end
  end
  return names, columns
end

---- journals ----

-- a number of columns that the head tells; a member has no more numbers than the file
local function told(j, key)
  local count = math.tointeger(tonumber(j.head[key]))
  if count and count >= 0 and count <= j.file:size() then return count end
  error(("its head has no number '%s'"):format(key), 0)
end

-- a row for each member that ended well, the one that comes first
local function rows_of(j, read)
  local rows, seen, names = {}, {}, nil
  for _, r in ipairs(j.records) do
    for i, bytes in journal.members(r, journal.bytes(j, r)) do
      local fine, row, own = blame.try(read, bytes)
      if not fine then error(("member %d has other bytes than its kind"):format(i), 0) end
      if row and not seen[i] then seen[i], rows[#rows + 1] = true, { i, row } end
      names = names or own
    end
  end
  table.sort(rows, function(a, b) return a[1] < b[1] end)
  return rows, names or ""
end

local function columns_of(names, rows)
  local columns = {}
  for c = 1, #names do columns[c] = {} end
  for k, x in ipairs(rows) do
    columns[1][k] = x[1]
    for c = 2, #names do columns[c][k] = x[2][c - 1] end
  end
  return names, columns
end

local function ensemble_columns(j)
  local names, n, momenta = { "member", "steps" }, told(j, "n"), told(j, "momenta")
  for k = 1, n do names[#names + 1] = "q" .. k end
  for k = 1, momenta do names[#names + 1] = "p" .. k end
  local offset = 16 + (j.head.h == "by member" and 24 or 0) + 8 * told(j, "varied")
  return columns_of(names, (rows_of(j, function(bytes)
    return ensemble_row(bytes, n, momenta, offset)
  end)))
end

local function sweep_columns(j)
  local rows, own = rows_of(j, sweep_row)
  local names = { "member" }
  for name in own:gmatch "[^\t]+" do names[#names + 1] = name end
  return columns_of(names, rows)
end

local KINDS = { stability = named_columns, chart = named_columns, ensemble = ensemble_columns,
  sweep = sweep_columns }

--- Names and columns of the members that ended well, "member" first.
function M.columns(file)
  local j, why = journal.read(file)
  if not j then fail("%s: %s", file, why) end
  local read = KINDS[j.head.kind]
  if not read then fail("%s is the journal of a %s, which has no columns", file, j.head.kind) end
  local fine, names, columns = blame.try(read, j)
  j.file:close()
  if not fine then fail("%s: %s", file, names) end
  return names, columns
end

return M
