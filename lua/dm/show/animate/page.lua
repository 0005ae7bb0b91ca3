--- A page of its own for moving pictures: text, style, script, and the numbers as JSON with base64
-- in it. scene = { title, note, dim, axes, trail, paths = { { name, points, rods, t, xyz } },
-- plots = { { name, lines = { { name, t, y } } } } }; t is packed as doubles, xyz (frame by frame,
-- point by point) and y as floats, all little-endian.
local M = {}

local STYLE = [[
body { font: 15px sans-serif; margin: 0.8em 1.2em; color: #222; background: #fff; }
h1 { font-size: 1.15em; margin: 0.2em 0; }
p { margin: 0.2em 0 0.6em; color: #666; }
#paths { display: flex; flex-wrap: wrap; gap: 10px; }
figure { margin: 0; }
figcaption { text-align: center; color: #444; }
.panel { flex: 1 1 320px; }
.panel canvas { width: 100%; height: 54vh; border: 1px solid #ddd; touch-action: none; }
#plots { display: flex; flex-wrap: wrap; gap: 10px; margin-top: 8px; }
.plot { flex: 1 1 320px; }
.plot canvas { width: 100%; height: 17vh; }
#controls { display: flex; gap: 12px; align-items: center; flex-wrap: wrap; margin: 8px 0; }
#scrub { flex: 1 1 240px; }
button { width: 5em; font: inherit; }
#time { font-variant-numeric: tabular-nums; min-width: 8em; }]]

local PAGE = [[
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>@TITLE@</title>
<style>
@STYLE@
</style>
</head>
<body>
<h1>@TITLE@</h1>
<p>@NOTE@</p>
<div id="paths"></div>
<div id="controls">
<button id="play" type="button">pause</button>
<input id="scrub" type="range" min="0" max="1" step="any" value="0" aria-label="time">
<span id="time"></span>
<label>speed <input id="speed" type="range" min="-5" max="4" step="0.5" value="0"></label>
<span id="rate"></span>
<label>trail <input id="trail" type="range" min="0" max="1" step="any"></label>
</div>
<div id="plots"></div>
<script type="application/json" id="data">@DATA@</script>
<script>
@SCRIPT@</script>
</body>
</html>
]]

---- base64 ----

local DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
local pair = {}  -- 12 bits -> two digits
for i = 0, 4095 do
  local a, b = i >> 6, i & 63
  pair[i] = DIGITS:sub(a + 1, a + 1) .. DIGITS:sub(b + 1, b + 1)
end

local function base64(text)
  local out, whole = {}, #text - #text % 3
  for i = 1, whole, 3 do
    local a, b, c = text:byte(i, i + 2)
    local bits = a << 16 | b << 8 | c
    out[#out + 1] = pair[bits >> 12]
    out[#out + 1] = pair[bits & 4095]
  end
  local rest = #text - whole
  if rest > 0 then
    local a, b = text:byte(whole + 1, #text)
    local bits = a << 16 | (b or 0) << 8
    out[#out + 1] = pair[bits >> 12]
    out[#out + 1] = rest == 2 and pair[bits & 4095]:sub(1, 1) .. "=" or "=="
  end
  return table.concat(out)
end

local function packed(numbers, format)
  local pieces, n, most = {}, #numbers, 200
  for i = 1, n, most do
    local last = math.min(n, i + most - 1)
    pieces[#pieces + 1] = ("<" .. format:rep(last - i + 1)):pack(table.unpack(numbers, i, last))
  end
  return base64(table.concat(pieces))
end

--- Numbers as base64 of doubles or of floats.
function M.doubles(numbers) return packed(numbers, "d") end
function M.floats(numbers) return packed(numbers, "f") end
--- Whole numbers from 0 as base64 of 32 bits each.
function M.wholes(numbers) return packed(numbers, "I4") end

---- JSON ----

local ESCAPES = { ['"'] = '\\"', ["\\"] = "\\\\" }

-- what could end the script element, too, is written by its number
local function quoted(text)
  return '"' .. text:gsub('[%c"\\<>&]', function(c)
    return ESCAPES[c] or ("\\u%04x"):format(c:byte())
  end) .. '"'
end

local function json(value)
  if type(value) == "string" then return quoted(value) end
  if math.type(value) == "integer" then return ("%d"):format(value) end
  if type(value) == "number" then return ("%.17g"):format(value) end
  local out = {}
  if value[1] ~= nil or next(value) == nil then
    for i, item in ipairs(value) do out[i] = json(item) end
    return "[" .. table.concat(out, ",") .. "]"
  end
  for key, item in pairs(value) do out[#out + 1] = quoted(key) .. ":" .. json(item) end
  table.sort(out)
  return "{" .. table.concat(out, ",") .. "}"
end

M.json = json

local ENTITIES = { ["<"] = "&lt;", [">"] = "&gt;", ["&"] = "&amp;", ['"'] = "&quot;" }
local function escaped(text) return (text:gsub('[<>&"]', ENTITIES)) end
M.escaped = escaped

--- The whole page of a scene, as text.
function M.text(scene)
  local parts = { TITLE = escaped(scene.title), NOTE = escaped(scene.note), STYLE = STYLE,
    DATA = json(scene),
    SCRIPT = require "dm.show.animate.script" }
  return (PAGE:gsub("@(%u+)@", parts))
end

return M
