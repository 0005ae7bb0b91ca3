--- A page of its own for moving pictures: text, style, script, and the numbers as JSON with base64
-- in it. scene = { title, note, dim, axes, trail, paths = { { name, points, rods, t, xyz } },
-- plots = { { name, lines = { { name, t, y } } } } }; t is packed as doubles, xyz (frame by frame,
-- point by point) and y as floats, all little-endian.
local base64 = require "dm.base.base64"
local json = require "dm.base.json"

local M = { json = json.encode }

M.STYLE = [[
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
#time { font-variant-numeric: tabular-nums; min-width: 8em; }]]

--- What the script draws on and listens to.
M.VIEWER = [[
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
]]

-- what every page has: the numbers as JSON, then the script that reads them
local HEAD = [[
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>@TITLE@</title>
<style>
body { font: 15px sans-serif; margin: 0.8em 1.2em; color: #222; background: #fff; }
h1 { font-size: 1.15em; margin: 0.2em 0; }
p { margin: 0.2em 0 0.6em; color: #666; }
button { width: 5em; font: inherit; }
]]
local MIDDLE = [[
</style>
</head>
<body>
<h1>@TITLE@</h1>
]]
local TAIL = [[
<script type="application/json" id="data">@DATA@</script>
<script>
@SCRIPT@</script>
</body>
</html>
]]

--- A page of its own: rules of style and the elements below the title, in which every @NAME@ is
-- parts.NAME; TITLE, DATA and SCRIPT are needed.
function M.document(style, body, parts)
  return ((HEAD .. style .. MIDDLE .. body .. TAIL):gsub("@(%u+)@", parts))
end

---- numbers ----

local function packed(numbers, format)
  local pieces, n, most = {}, #numbers, 200
  for i = 1, n, most do
    local last = math.min(n, i + most - 1)
    pieces[#pieces + 1] = ("<" .. format:rep(last - i + 1)):pack(table.unpack(numbers, i, last))
  end
  return base64.encode(table.concat(pieces))
end

--- Numbers as base64 of doubles or of floats.
function M.doubles(numbers) return packed(numbers, "d") end
function M.floats(numbers) return packed(numbers, "f") end
--- Whole numbers from 0 as base64 of 32 bits each.
function M.wholes(numbers) return packed(numbers, "I4") end

local ENTITIES = { ["<"] = "&lt;", [">"] = "&gt;", ["&"] = "&amp;", ['"'] = "&quot;" }
local function escaped(text) return (text:gsub('[<>&"]', ENTITIES)) end
M.escaped = escaped

--- The whole page of a scene, as text.
function M.text(scene)
  local parts = { TITLE = escaped(scene.title), NOTE = escaped(scene.note), STYLE = M.STYLE,
    VIEWER = M.VIEWER,
    DATA = json.encode(scene),
    SCRIPT = require "dm.show.animate.script"
      .. 'open(JSON.parse(element("data").textContent));\n' }
  return M.document("@STYLE@\n", "<p>@NOTE@</p>\n@VIEWER@", parts)
end

return M
