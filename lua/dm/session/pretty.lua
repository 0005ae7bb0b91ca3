--- How a session shows values: tables to a depth and a length, strings in them quoted, cycles
-- named, the rest through tostring. Tables are read with rawget and next, so that printing changes
-- nothing.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"
local params = require "dm.base.params"

local M = {}

local WHERE, KNOWN = "dm.pretty", { "depth", "length", "width", "text", "colour" }

local type, next, rawget, rawlen, tostring, ipairs = type, next, rawget, rawlen, tostring, ipairs
local getmetatable, mathtype = debug.getmetatable, math.type
local rep, find, format, gsub, sub = string.rep, string.find, string.format, string.gsub, string.sub
local sort, concat, max, min = table.sort, table.concat, math.max, math.min

local LIMITS = { depth = 4, length = 30, width = 80, text = 200 }
local COLOURS = { number = "36", string = "32", boolean = "35", ["nil"] = "35", ["function"] = "34",
  table = "2", key = "0" }

local function paint(state, kind, text)
  local code = state.colour and COLOURS[kind]
  return code and "\27[" .. code .. "m" .. text .. "\27[0m" or text
end

-- characters that a terminal shows, colours left out
local function width_of(text)
  local plain = gsub(text, "\27%[[%d;]*m", "")
  return utf8.len(plain) or #plain
end

local ESCAPES = { ["\n"] = "\\n", ["\t"] = "\\t", ["\r"] = "\\r", ['"'] = '\\"', ["\\"] = "\\\\" }

local function quoted(state, text)
  local shown = sub(text, 1, state.text)
  shown = gsub(shown, '[%c"\\]', function(c) return ESCAPES[c] or format("\\%03d", c:byte()) end)
  local more = #text > state.text and format("... (%d bytes)", #text) or ""
  return paint(state, "string", '"' .. shown .. '"') .. more
end

local function function_text(f)
  local doc = core.docs[f]
  if doc then return "function " .. doc:match("^[^\n]*") end
  local info = debug.getinfo(f, "S")
  if info.what == "C" then return tostring(f) end
  return format("function at %s:%d", info.short_src, info.linedefined)
end

---- tables ----

local function is_name(key) return type(key) == "string" and find(key, "^[%a_][%w_]*$") end

local RANK = { number = 1, string = 2, boolean = 3 }

-- numbers, then strings, then the rest as next gives them
local function before(a, b)
  local ra, rb = RANK[type(a)] or 4, RANK[type(b)] or 4
  if ra ~= rb then return ra < rb end
  if ra <= 2 then return a < b end
  return ra == 3 and a ~= b and not a
end

-- at most `limit` keys outside 1..n, sorted, and how many were left out
local function other_keys(t, n, limit)
  local keys, more = {}, 0
  for key in next, t do
    local listed = mathtype(key) == "integer" and key >= 1 and key <= n
    if not listed then
      if #keys < 20 * limit then keys[#keys + 1] = key else more = more + 1 end
    end
  end
  sort(keys, before)
  for i = #keys, limit + 1, -1 do keys[i], more = nil, more + 1 end
  return keys, more
end

local show, long_text, is_long_now

local function key_text(state, key, depth)
  if is_name(key) then return paint(state, "key", key) .. " = " end
  return "[" .. show(state, key, depth + 1) .. "] = "
end

-- texts of the entries of a table
local function entries(state, t, depth)
  local list, n, limit = {}, rawlen(t), state.length
  for i = 1, min(n, limit) do list[i] = show(state, rawget(t, i), depth + 1) end
  if n > limit then list[#list + 1] = paint(state, "table", format("... %d more", n - limit)) end
  local keys, more = other_keys(t, n, limit)
  for _, key in ipairs(keys) do
    list[#list + 1] = key_text(state, key, depth) .. show(state, rawget(t, key), depth + 1)
  end
  if more > 0 then list[#list + 1] = paint(state, "table", format("... %d more", more)) end
  return list
end

-- on one line when it fits, else one entry a line; plain numbers fill lines
local function laid_out(state, list, depth)
  local total, lines, longest = 0, false, 0
  for _, text in ipairs(list) do
    local w = width_of(text)
    total, longest = total + w + 2, w > longest and w or longest
    lines = lines or find(text, "\n", 1, true)
  end
  if not lines and 2 * depth + total + 4 <= state.width then
    return "{ " .. concat(list, ", ") .. " }"
  end
  local indent = "\n" .. rep("  ", depth + 1)
  local per_line = longest < 14 and not lines
    and max((state.width - 2 * depth - 2) // (longest + 2), 1) or 1
  local parts = {}
  for i, text in ipairs(list) do
    parts[#parts + 1] = (i - 1) % per_line == 0 and indent or " "
    parts[#parts + 1] = text .. ","
  end
  return "{" .. concat(parts) .. "\n" .. rep("  ", depth) .. "}"
end

local function show_table(state, t, depth)
  local meta = getmetatable(t)
  if type(meta) == "table" and rawget(meta, "__tostring")
    and rawget(meta, "__name") ~= "dm.result" then
    return tostring(t)
  end
  if type(meta) == "table" and rawget(meta, "__name") == "dm.params" then
    t = meta.__params
    params.refresh(t)
  end
  if state.open[t] then return paint(state, "table", "<cycle>") end
  if next(t) == nil then return "{}" end
  if depth >= state.depth then return paint(state, "table", "{...}") end
  state.open[t] = true
  local text = laid_out(state, entries(state, t, depth), depth)
  state.open[t] = nil
  return text
end

function show(state, value, depth)
  local kind = type(value)
  if kind == "table" then return show_table(state, value, depth) end
  if kind == "string" then
    return depth == 0 and paint(state, kind, value) or quoted(state, value)
  end
  if kind == "function" then return paint(state, kind, function_text(value)) end
  local text = is_long_now() and long_text(state, value) or tostring(value)
  if kind == "userdata" and depth > 0 then return (gsub(text, "\n", "\n" .. rep("  ", depth))) end
  return paint(state, kind, text)
end

---- digits ----

local LONG, is_long = "%.17g", false

function is_long_now() return is_long end

-- a float with all of its digits, a float still where it is whole
local function long_number(x)
  local text = format(LONG, x)
  return find(text, "^-?%d+$") and text .. ".0" or text
end

-- entries of a vector on one line, as many as a line shows of short ones
local function long_vector(state, x)
  local list, n = {}, #x
  for i = 1, min(n, state.length) do list[i] = format(LONG, x[i]) end
  if n > state.length then list[#list + 1] = format("... (%d)", n) end
  return "[" .. concat(list, ", ") .. "]"
end

local function long_matrix(state, x)
  local rows, n = {}, #x
  for i = 1, min(n, state.length) do rows[i] = long_vector(state, x[i]) end
  if n > state.length then rows[#rows + 1] = format("... %d rows", n) end
  return "[" .. concat(rows, ",\n ") .. "]"
end

-- the text of a value in long digits, or nothing where they change nothing
function long_text(state, value)
  if mathtype(value) == "float" and value - value == 0 then return long_number(value) end
  local meta = type(value) == "userdata" and getmetatable(value)
  local class = type(meta) == "table" and meta.__name
  if class == "dm.vector" then return long_vector(state, value) end
  if class == "dm.matrix" then return long_matrix(state, value) end
end

local doc_format = [[
format("long" | "short")
Numbers, vectors and matrices in a session with 17 digits, which give the number back bit for bit,
or with 14 again.]]

M.format = blame.caller(function(what)
  option.one_of({ format = what }, "format", "format", { "long", "short" })
  if what == nil then option.fail("format", "\"long\" or \"short\" is needed") end
  is_long = what == "long"
end)

core.docs[M.format] = doc_format

local doc_pretty = [[
dm.pretty(value, {depth=, length=, width=, colour=}) -> string
The text that a session prints for a value. depth of tables in tables (4), entries of one table
(30), characters of a line (80), colours (false).]]

M.pretty = blame.caller(function(value, options)
  options = option.check(options or {}, KNOWN, WHERE)
  local state = { open = {}, colour = options.colour or false }
  for key, default in next, LIMITS do
    state[key] = option.whole(options, key, WHERE, 0, nil, default)
  end
  return show(state, value, 0)
end)

--- The texts of several values for the terminal that stdout is.
function M.texts(...)
  local here, list = core.terminal(), table.pack(...)
  local options = { width = here.width, colour = here.colour }
  for i = 1, list.n do list[i] = M.pretty(list[i], options) end
  return table.unpack(list, 1, list.n)
end

core.docs[M.pretty] = doc_pretty

return M
