--- NumPy files of records with named fields, each a little-endian double or an array of them.
local text_file = require "dm.base.text_file"

local M = {}

--- The head of a file of `rows` records; fields: { name, count } with count 0 for a number, else
-- the length of an array. Magic, version, length of the text, text; all a multiple of 64 bytes that
-- ends in a newline. Version 1.0, or 3.0 (UTF-8 text) when a name is not ASCII.
function M.header(fields, rows)
  local out = {}
  for i, field in ipairs(fields) do
    local shape = field[2] > 0 and (", (%d,)"):format(field[2]) or ""
    out[i] = ("('%s', '<f8'%s)"):format(field[1]:gsub("[\\']", "\\%0"), shape)
  end
  local text = ("{'descr': [%s], 'fortran_order': False, 'shape': (%d,), }")
    :format(table.concat(out, ", "), rows)
  local wide = #text > 65000 or text:find("[\128-\255]")
  local fixed = wide and 12 or 10
  local size = (fixed + #text + 1 + 63) // 64 * 64 - fixed
  text = text .. (" "):rep(size - 1 - #text) .. "\n"
  return "\147NUMPY" .. (wide and "\3\0" or "\1\0") .. (wide and "<I4" or "<I2"):pack(size) .. text
end

local BLOCK = 100 -- numbers that one call of pack takes: its results stand on the stack of Lua

local function packed(x)
  local out = {}
  for i = 1, #x, BLOCK do
    local last = math.min(#x, i + BLOCK - 1)
    local part = {}
    for j = i, last do part[#part + 1] = x[j] end
    out[#out + 1] = ("<" .. ("d"):rep(#part)):pack(table.unpack(part))
  end
  return table.concat(out)
end

--- A record: row[name] is a number or has as many as the field.
function M.record(fields, row)
  local out = {}
  for i, field in ipairs(fields) do
    local x = row[field[1]]
    out[i] = field[2] > 0 and packed(x) or ("<d"):pack(x)
  end
  return table.concat(out)
end

--- Writes a file of `rows` records as body(write) calls write(row) for each. Where fewer come, by
-- an error too, the head says how many there are.
function M.stream(file, fields, rows, where, body)
  local handle = text_file.open(file, "wb", where)
  local head, count = M.header(fields, rows), 0
  local function put(text)
    local fine, why = handle:write(text)
    if not fine then
      handle:close()
      error(("cannot write %s: %s"):format(file, why), 0)
    end
  end
  put(head)
  local fine, message = pcall(body, function(row)
    put(M.record(fields, row))
    count = count + 1
  end)
  local short = M.header(fields, count)
  if count < rows and #short == #head then
    handle:seek "set"
    put(short)
  end
  local closed, why = handle:close()
  if not fine then error(message, 0) end
  if not closed then error(("cannot write %s: %s"):format(file, why), 0) end
end

return M
