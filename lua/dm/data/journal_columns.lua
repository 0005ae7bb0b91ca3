--- Columns of the journal of a sweep, for dm.load.
local fields = require "dm.data.fields"
local journal = require "dm.data.journal"
local option = require "dm.base.options"

local M = {}

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

--- Names and columns of the members that ended well, "member" first.
function M.columns(file)
  local j, why = journal.read(file)
  if not j then option.fail("dm.load", "%s: %s", file, why) end
  if j.head.kind == "stability" or j.head.kind == "chart" then
    local names, columns = named_columns(j)
    j.file:close()
    return names, columns
  end
  local names, columns, seen = { "member" }, { {} }, {}
  local n, momenta, offset = tonumber(j.head.n), tonumber(j.head.momenta), nil
  if j.head.kind == "ensemble" then
    names[2] = "steps"
    for k = 1, n do names[#names + 1] = "q" .. k end
    for k = 1, momenta do names[#names + 1] = "p" .. k end
    offset = 16 + (j.head.h == "by member" and 24 or 0) + 8 * tonumber(j.head.varied)
  elseif j.head.kind ~= "sweep" then
    option.fail("dm.load", "%s is the journal of a %s, which has no columns", file, j.head.kind)
  end
  local rows = {}
  for _, r in ipairs(j.records) do
    for i, bytes in journal.members(r, journal.bytes(j, r)) do
      local row, own
      if j.head.kind == "sweep" then row, own = sweep_row(bytes)
      else row = ensemble_row(bytes, n, momenta, offset) end
      if own and #names == 1 then
        for name in own:gmatch "[^\t]+" do names[#names + 1] = name end
      end
      if row and not seen[i] then seen[i], rows[#rows + 1] = true, { i, row } end
    end
  end
  j.file:close()
  table.sort(rows, function(a, b) return a[1] < b[1] end)
  for c = 1, #names do columns[c] = {} end
  for k, x in ipairs(rows) do
    columns[1][k] = x[1]
    for c = 2, #names do columns[c][k] = x[2][c - 1] end
  end
  return names, columns
end

return M
