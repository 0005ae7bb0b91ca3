-- dm.lab: every position of the sliders is a run of its own; what fails says so; a browser moves them
local tap = require "tap"
local dm = require "dm"
local browser = require "browser"
local json = require "dm.base.json"
local ok, raises = tap.ok, tap.raises

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))
local file = folder .. "/lab.html"
local function text_of(name)
  local f <close> = assert(io.open(name))
  return f:read "a"
end
local function data_of(name) return json.decode(text_of(name):match '<script type="application/json" id="data">(.-)</script>') end

local DIGITS = {}
for i = 1, 64 do DIGITS[("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"):byte(i)] = i - 1 end
local function unpacked(text, format)
  local bytes, bits, held = {}, 0, 0
  for c in text:gmatch "[^=]" do
    bits, held = bits << 6 | DIGITS[c:byte()], held + 6
    if held >= 8 then
      held = held - 8
      bytes[#bytes + 1] = string.char(bits >> held & 255)
    end
  end
  local out, at, s = {}, 1, table.concat(bytes)
  while at <= #s do out[#out + 1], at = string.unpack("<" .. format, s, at) end
  return out
end

local function swing(h, k, rule)
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - k * q:dot(q) / 2 end }
  return s:solver { rule = rule, h = h }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 20 }
end
local RULES = { "verlet", "gauss(2)" }
local given = { sliders = { rule = RULES, h = { 0.01, 1, 3, "log" }, k = { 1, 2, 2 } }, run = swing, file = file, title = "a <b> & \"c\"" }
ok(dm.lab(given) == file, "a file comes back")
local data = data_of(file)
ok(#data.positions == 12 and table.concat(data.sliders[1].labels, " ") == "0.01 0.1 1" and data.sliders[3].name == "rule",
  "sliders in the order of run's arguments")
local far = 0
for i, h in ipairs { 0.01, 0.1, 1 } do
  for j, k in ipairs { 1, 2 } do
    for l, rule in ipairs(RULES) do
      local path, here = swing(h, k, rule), data.positions[((i - 1) * 2 + j - 1) * 2 + l].scene.paths[1]
      local xyz, t = unpacked(here.xyz, "f"), unpacked(here.t, "d")
      for row = 1, #path do
        far = math.max(far, math.abs(xyz[2 * row] - path.q[row][2]), math.abs(t[row] - path.t[row]))
      end
    end
  end
end
ok(far < 1e-6, "the numbers of every position are those of solver:run", far)
local page = text_of(file)
ok(select(2, page:gsub('<input type="range" name="[hkr]%a*"', "")) == 3, "an input for each slider, with its name")
ok(not page:find "https?:" and not page:find "fetch%(" and not page:find "import%(", "it asks for nothing")
ok(page:find("a &lt;b&gt; &amp; &quot;c&quot;", 1, true), "text is text")

---- what fails ----

local some = { sliders = { h = { 0.1, 3, 4 } }, file = file, run = function(h)
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) ^ 2 end }
  if h > 2 then error("too far </script><script>") end
  return s:solver { rule = "verlet", h = h }:run { q = { 1, 1 }, v = { 0, 0 }, steps = 30 }
end }
dm.lab(some)
data = data_of(file)
ok(data.positions[1].scene and data.positions[2].wrong:find "NaN or infinite" and data.positions[4].wrong:find "too far", "positions that fail have their message",
  tostring(data.positions[2].wrong))
local before = text_of(file)
local function lab(changes)
  return function()
    local options = { sliders = { h = { 0.1, 1, 2 } }, run = function(h) return swing(h, 1, "verlet") end, file = file }
    for key, value in pairs(changes) do options[key] = value end
    if changes.no then options[changes.no], options.no = nil, nil end
    dm.lab(options)
  end
end
raises("positions", lab { sliders = { h = { 0.1, 1, 9000 } }, run = function(h) return swing(h, 1, "verlet") end })
raises("positions", lab { sliders = { h = { 0.1, 1, 10000 }, k = { 1, 2, 10000 } }, run = function(h, k) return swing(h, k, "verlet") end })
raises("every position", lab { run = function(h) error("no " .. h) end })
raises("must return a path", lab { run = function(h) return h end })
raises("no slider", lab { run = function(h, other) return swing(h, other, "verlet") end })
raises("no argument", lab { sliders = { h = { 0.1, 1, 2 }, k = { 1, 2, 2 } } })
raises("names of the sliders", lab { run = function(...) return ... end })
raises("at least one", lab { sliders = {}, run = function() end })
for _, slider in ipairs { 3, { 1 }, { 1, 2 }, { 2, 1, 3 }, { 1, 2, 1 }, { 1, 2, 2.5 }, { 0, 1, 3, "log" }, { 1, 2, 3, "lin" }, { 0 / 0, 1, 3 }, { 0, 1 / 0, 3 }, { "a", 2 } } do
  raises("slider", lab { sliders = { h = slider } })
end
raises(".html", lab { file = "x.txt" })
raises("file", lab { no = "file" })
raises("unknown", lab { slider = {} })
raises("run", lab { run = 3 })
raises("sliders", lab { no = "sliders" })
ok(text_of(file) == before, "a lab that cannot be made leaves the file as it was")

---- in a browser ----

if browser.there() and os.getenv "UNDER" == "" then
  dm.lab(given)
  local f <close> = assert(io.open(file, "a"))
  f:write [[<script>window.onerror = e => { document.title = "error " + e; };
const input = document.querySelector('input[name="h"]'); const from = scene;
input.value = 2; input.dispatchEvent(new Event("input"));
document.title = "moved " + document.body.getAttribute("data-position") + " " + (scene !== from) + " " + scene.paths[0].t.length + " "
  + document.querySelectorAll("canvas").length;</script>]]
  f:close()
  local dom = browser.dom(file, "--virtual-time-budget=2000")
  local title = dom:match "<title>(.-)</title>"
  ok(title == "moved 8 true 21 3", "a slider moves the picture", title)
else
  print "# skipped: a browser (chromium)"
end
os.execute(("rm -rf '%s'"):format(folder))

tap.done()
