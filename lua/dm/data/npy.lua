--- NumPy files of records with named fields, each a little-endian double or an array of them.
local core = require "dm.core"
local text_file = require "dm.base.text_file"

local M = {}

local ROOM = 32 -- characters of the number of rows and what follows it

-- "17,), }" and blanks: as long for every number of rows
local function count_text(rows)
  local text = ("%d,), }"):format(rows)
  return text .. (" "):rep(ROOM - #text)
end

--- The head of a file of `rows` records; fields: { name, count } with count 0 for a number, else
-- the length of an array. Magic, version, length of the text, text; all a multiple of 64 bytes that
-- ends in a newline. Version 1.0, or 3.0 (UTF-8 text) when a name is not ASCII. Second: where in it
-- the number of rows stands, in bytes.
function M.header(fields, rows)
  local out = {}
  for i, field in ipairs(fields) do
    local shape = field[2] > 0 and (", (%d,)"):format(field[2]) or ""
    out[i] = ("('%s', '<f8'%s)"):format(field[1]:gsub("[\\']", "\\%0"), shape)
  end
  local text = ("{'descr': [%s], 'fortran_order': False, 'shape': ("):format(
    table.concat(out, ", "))
  local wide = #text > 65000 or text:find("[\128-\255]")
  local fixed = wide and 12 or 10
  local size = (fixed + #text + ROOM + 1 + 63) // 64 * 64 - fixed
  local before = "\147NUMPY" .. (wide and "\3\0" or "\1\0") .. (wide and "<I4" or "<I2"):pack(size)
    .. text
  return before .. count_text(rows) .. (" "):rep(size - 1 - #text - ROOM) .. "\n", #before
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

---- files that are written row by row ----

-- bytes and seconds between two times that the head counts the rows
local AT_ONCE, SECONDS = 1 << 20, 1

local function check(out, fine, why)
  if not fine then error(("cannot write %s: %s"):format(out.file, why), 0) end
end

local function put(out, text) check(out, out.handle:write(text)) end

-- the head counts the rows that are in the file; nil and why where it cannot
local function count_rows(out)
  out.handle:seek("set", out.behind)
  local fine, why = out.handle:write(count_text(out.rows))
  out.handle:seek("set", #out.head + out.rows * out.width)
  out.since, out.counted = 0, os.time()
  return fine, why
end

local function add(out, fields, row)
  local record = M.record(fields, row)
  put(out, record)
  out.rows, out.since = out.rows + 1, out.since + #record
  if out.since > AT_ONCE or os.time() >= out.counted + SECONDS then check(out, count_rows(out)) end
end

-- the time of row i, from 0
local function time_of(out, i)
  out.handle:seek("set", #out.head + i * out.width)
  local bytes = out.handle:read(8)
  return bytes and #bytes == 8 and ("<d"):unpack(bytes) or 0 / 0
end

-- Of a file that is there, the rows before the time `from` stay; false: it has other columns.
local function keep_rows(out, from)
  local head = out.handle:read(#out.head) or ""
  local last = out.behind + ROOM
  if head:sub(1, out.behind) ~= out.head:sub(1, out.behind)
    or head:sub(last + 1) ~= out.head:sub(last + 1) then
    return false
  end
  local least, most = 0, tonumber(head:sub(out.behind + 1, last):match "^%d+") or 0
  while least < most do -- rows before `least` are earlier, those from `most` on are not
    local middle = (least + most) // 2
    if time_of(out, middle) < from then least = middle + 1 else most = middle end
  end
  out.rows = least
  core.cut_file(out.file, #out.head + least * out.width)
  check(out, count_rows(out))
  return true
end

local function is_there(file)
  local handle = type(file) == "string" and io.open(file, "rb")
  local some = handle and handle:read(1)
  if handle then handle:close() end
  return some ~= nil and some ~= false
end

-- The file for rows, empty unless a run goes on; rows of two processes in one are those of neither.
local function locked(file, where, goes_on)
  if core.is_silent() then return text_file.open(file, "wb", where) end
  local made = text_file.open(file, "ab", where)
  local handle = text_file.open(file, "r+b", where)
  made:close()
  local fine, why = core.lock_file(handle)
  if not fine then
    handle:close()
    error(("%s: %s is %s; give another name"):format(where, file, why), 0)
  end
  if not goes_on then core.cut_file(file, 0) end
  return handle
end

local function open(file, fields, where, from)
  local goes_on = from and not core.is_silent() and is_there(file)
  local out = { handle = locked(file, where, goes_on), file = file,
    rows = 0, since = 0, width = 0, counted = os.time() }
  out.handle:setvbuf "no" -- a row is there or is not counted, also on a disk that is full
  out.head, out.behind = M.header(fields, 0)
  for _, field in ipairs(fields) do out.width = out.width + 8 * math.max(1, field[2]) end
  if not goes_on then
    put(out, out.head)
  elseif not keep_rows(out, from) then
    out.handle:close()
    error(("%s: %s has other columns than this run, which goes on: give another file"):format(
      where, file), 0)
  end
  return out
end

--- Writes a file of records as body(write) calls write(row) for each; its head counts those that
-- came, by an error too. A run that goes on (from: its time) adds to a file of the same fields, the
-- first of which is the time, and replaces its rows from that time on.
function M.stream(file, fields, where, body, from)
  local out = open(file, fields, where, from)
  local fine, message = pcall(body, function(row) add(out, fields, row) end)
  local counted, uncounted = count_rows(out)
  local closed, why = out.handle:close()
  if not fine then error(message, 0) end
  check(out, counted, uncounted)
  check(out, closed, why)
end

return M
