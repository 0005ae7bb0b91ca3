--- Where a run ended, as a text of `key value` lines behind a head: all numbers with their bits,
-- the state one number a line, and at the end a checksum of the lines before.
local core = require "dm.core"
local option = require "dm.base.options"
local text_file = require "dm.base.text_file"

local M = {}

--- A checksum of a text, 16 digits: Fowler, Noll and Vo, 64 bits.
function M.checksum(text)
  local sum = 0xcbf29ce484222325 | 0
  for i = 1, #text do sum = (sum ~ text:byte(i)) * 0x100000001b3 end
  return ("%016x"):format(sum)
end

--- A number with all bits, a text as it is.
function M.written(x)
  if math.type(x) == "float" then return ("%a"):format(x) end
  return tostring(x)
end

--- One number of many: of their bits.
function M.fingerprint(numbers)
  local parts = {}
  for j = 1, #numbers do parts[j] = ("%a"):format(numbers[j]) end
  return M.checksum(table.concat(parts, " "))
end

--- Writes a file; fields: a list of { key, value }. An old file stays whole until the new one is.
function M.write(file, head, fields, state, where)
  if type(file) ~= "string" then
    option.fail(where, "a file name is needed (got %s)", option.got(file))
  end
  local lines = { head }
  local function add(key, value) lines[#lines + 1] = key .. " " .. M.written(value) end
  for _, field in ipairs(fields) do add(field[1], field[2]) end
  add("state", #state)
  for i = 1, #state do lines[#lines + 1] = ("%a"):format(state[i]) end
  local text = table.concat(lines, "\n") .. "\n"
  text_file.write(file, text .. "end " .. M.checksum(text) .. "\n", where, true)
  return file
end

--- The first line of a file, up to 80 bytes; nil where it cannot be read.
function M.head(file)
  local handle = core.open_file(file)
  local line = handle and handle:read(80)
  if handle then handle:close() end
  return line and line:match "^[^\n]*"
end

--- The fields of a file as texts, and its state as a vector in `state`.
function M.read(file, head, what, where)
  local function fail(...) option.fail(where, ...) end
  local handle, why = core.open_file(file)
  if not handle then fail("%s", why) end
  local text = handle:read "a" or ""
  handle:close()
  local body, sum = text:match "^(.*\n)end (%x+)\n$"
  local kind = head:gsub("%d+$", "")
  if body and text:sub(1, #head + 1) ~= head .. "\n" and text:sub(1, #kind) == kind then
    fail("%s is a checkpoint of another version of dmlua (%s, not %s): run it anew", file,
      text:match("^[^\n]*"):sub(1, 40), head)
  end
  if not body or text:sub(1, #head + 1) ~= head .. "\n" then
    fail("%s is no checkpoint of %s", file, what)
  end
  if M.checksum(body) ~= sum then
    fail("%s: its lines do not have the checksum that it ends with: it was changed", file)
  end
  local fields, state = {}, {}
  for line in body:sub(#head + 2):gmatch "[^\n]+" do
    local key, value = line:match "^(%a[%w]*) (.*)$"
    local x = not key and tonumber(line)
    if not key and not (x and x - x == 0) then
      fail("%s: '%s' in the state is no finite number", file, line:sub(1, 40))
    end
    if key then fields[key] = value else state[#state + 1] = x end
  end
  if #state ~= tonumber(fields.state) then fail("%s: numbers of the state are missing", file) end
  fields.state = core.vector(state)
  return fields
end

return M
