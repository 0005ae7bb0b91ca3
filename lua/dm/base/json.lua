--- JSON: values to text and back (RFC 8259). Lists are tables with an entry 1 or none at all.
local M = {}

local ESCAPES = { ['"'] = '\\"', ["\\"] = "\\\\" }

-- what could end a script element is written by its number, and so is what is no UTF-8
local function quoted(text)
  if not utf8.len(text) then text = text:gsub("[\128-\255]", "?") end
  return '"' .. text:gsub('[%c"\\<>&]', function(c)
    return ESCAPES[c] or ("\\u%04x"):format(c:byte())
  end) .. '"'
end

--- A number, string, boolean or table of them as text; names of a table in the alphabet's order. A
-- number that is not finite is null.
function M.encode(value)
  if type(value) == "string" then return quoted(value) end
  if type(value) == "boolean" then return tostring(value) end
  if math.type(value) == "integer" then return ("%d"):format(value) end
  if type(value) == "number" then
    return value - value == 0 and ("%.17g"):format(value) or "null"
  end
  local out = {}
  if value[1] ~= nil or next(value) == nil then
    for i, item in ipairs(value) do out[i] = M.encode(item) end
    return "[" .. table.concat(out, ",") .. "]"
  end
  for key, item in pairs(value) do out[#out + 1] = quoted(key) .. ":" .. M.encode(item) end
  table.sort(out)
  return "{" .. table.concat(out, ",") .. "}"
end

---- text to values ----

local NAMED = { b = "\b", f = "\f", n = "\n", r = "\r", t = "\t", ['"'] = '"', ["\\"] = "\\",
  ["/"] = "/" }
local MOST_DEEP = 100

local value_at

local function wrong(at, what) error(("JSON: %s at byte %d"):format(what, at), 0) end

-- a number of four digits; two of them make a character beyond 65535
local function by_number(text, at)
  local code = tonumber(text:match("^%x%x%x%x", at) or wrong(at, "four hexadecimal digits"), 16)
  local low = code >= 0xD800 and code < 0xDC00 and text:match("^\\u(%x%x%x%x)", at + 4)
  low = low and tonumber(low, 16)
  if low and low >= 0xDC00 and low < 0xE000 then
    return utf8.char(0x10000 + (code - 0xD800) * 0x400 + low - 0xDC00), at + 10
  end
  return utf8.char(code), at + 4
end

local function string_at(text, at)
  local out = {}
  while true do
    local plain, stop = text:match('^([^"\\]*)()', at)
    out[#out + 1] = plain
    local c = text:sub(stop, stop)
    if c == '"' then return table.concat(out), stop + 1 end
    if c == "" then wrong(at, "a string without end") end
    local name = text:sub(stop + 1, stop + 1)
    if name == "u" then
      out[#out + 1], at = by_number(text, stop + 2)
    else
      out[#out + 1] = NAMED[name] or wrong(stop, "an unknown escape")
      at = stop + 2
    end
  end
end

local function blanks(text, at) return text:match("^[ \t\r\n]*()", at) end

-- after an item: the next one's place, or nothing and the place behind the end
local function separator(text, at, close)
  at = blanks(text, at)
  local c = text:sub(at, at)
  if c == "," then return blanks(text, at + 1) end
  if c == close then return nil, at + 1 end
  wrong(at, "',' or '" .. close .. "' is missing")
end

local function list_at(text, at, depth)
  local out, behind = {}, nil
  at = blanks(text, at)
  if text:sub(at, at) == "]" then return out, at + 1 end
  while at do
    out[#out + 1], at = value_at(text, at, depth)
    at, behind = separator(text, at, "]")
  end
  return out, behind
end

local function object_at(text, at, depth)
  local out, behind = {}, nil
  at = blanks(text, at)
  if text:sub(at, at) == "}" then return out, at + 1 end
  while at do
    if text:sub(at, at) ~= '"' then wrong(at, "a name is missing") end
    local key
    key, at = string_at(text, at + 1)
    at = text:match("^[ \t\r\n]*:[ \t\r\n]*()", at) or wrong(at, "':' is missing")
    out[key], at = value_at(text, at, depth)
    at, behind = separator(text, at, "}")
  end
  return out, behind
end

local WORDS = { ["true"] = true, ["false"] = false }

-- null is nil: an entry that is not there
function value_at(text, at, depth)
  if depth > MOST_DEEP then wrong(at, "too deep a nesting") end
  local c = text:sub(at, at)
  if c == '"' then return string_at(text, at + 1) end
  if c == "[" then return list_at(text, at + 1, depth + 1) end
  if c == "{" then return object_at(text, at + 1, depth + 1) end
  local word, behind = text:match("^(%a+)()", at)
  if word == "null" then return nil, behind end
  if WORDS[word] ~= nil then return WORDS[word], behind end
  local number
  number, behind = text:match("^(%-?%d[%d.eE+-]*)()", at)
  if not tonumber(number) then wrong(at, "no value") end
  return tonumber(number), behind
end

--- The value of a text, or an error with the byte that is wrong.
function M.decode(text)
  local value, at = value_at(text, blanks(text, 1), 0)
  at = blanks(text, at)
  if at <= #text then wrong(at, "something behind the value") end
  return value
end

return M
