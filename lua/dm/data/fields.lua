--- Named numbers, texts and truths as bytes, in the alphabet's order, so that equal tables have
-- equal bytes: name (u16 and text), a letter (d: f64, i: i64, s: u16 and text, t, f), the value.
local blame = require "dm.base.blame"

local M = {}

local LETTERS = { integer = "i", float = "d", string = "s" }

--- The bytes of a table; keys in `left_out` are not told.
function M.pack(t, left_out)
  local names, out = {}, {}
  for name in pairs(t) do
    if not (left_out and left_out[name]) then names[#names + 1] = name end
  end
  table.sort(names)
  for i, name in ipairs(names) do
    local x = t[name]
    local letter = type(x) == "boolean" and (x and "t" or "f") or LETTERS[math.type(x) or type(x)]
    local value = letter == "i" and ("<i8"):pack(x) or letter == "d" and ("<d"):pack(x)
      or letter == "s" and ("<s2"):pack(x) or ""
    out[i] = ("<s2"):pack(name) .. letter .. value
  end
  return table.concat(out)
end

local readers = { i = "<i8", d = "<d", s = "<s2" }

local function read(bytes, out)
  local at = 1
  while at <= #bytes do
    local name, letter, value
    name, at = ("<s2"):unpack(bytes, at)
    letter, at = bytes:sub(at, at), at + 1
    if readers[letter] then
      value, at = readers[letter]:unpack(bytes, at)
    else
      value = letter == "t"
    end
    out[name] = value
  end
  return out
end

--- The table of these bytes, added to `into` or a new one.
function M.unpack(bytes, into)
  local fine, out = blame.try(read, bytes, into or {})
  return fine and out or error("bytes that are no named values", 0)
end

return M
