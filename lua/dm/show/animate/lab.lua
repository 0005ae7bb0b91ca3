--- dm.lab: a page with sliders, every position of which was run when the page was made. It asks for
-- nothing: no server, no port, no network; the price is a grid of positions.
local blame = require "dm.base.blame"
local core = require "dm.core"
local inline = require "dm.show.inline"
local json = require "dm.base.json"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local page = require "dm.show.animate.page"

local M = {}

local WHERE = "dm.lab"
local fail = option.failing(WHERE)

local OF_PICTURE = { "points", "dim", "draw", "rods", "bodies", "trail", "plots", "title", "names",
  "frames", "t" }
local KNOWN = { "sliders", "run", "file", table.unpack(OF_PICTURE) }

local FRAMES = 240            -- of a position, unless asked for
local PIXELS = 80             -- of its plots over time
local MOST_BYTES = 4 << 20    -- of the page
local MOST_POSITIONS = 10000

local STYLE = [[
@STYLE@
#sliders label { display: flex; gap: 10px; align-items: center; margin: 3px 0; }
#sliders span { min-width: 7em; font-variant-numeric: tabular-nums; }
#sliders input { flex: 1 1 240px; max-width: 40em; }
#wrong { color: #a00; white-space: pre-wrap; }
]]

local BODY = [[
<div id="sliders">
@SLIDERS@</div>
<p id="note"></p>
<p id="wrong"></p>
<div id="shown">
@VIEWER@</div>
]]

-- the sliders count positions; a position that failed shows its message
local SCRIPT = [==[
const lab = JSON.parse(element("data").textContent);
const inputs = lab.sliders.map(s => document.querySelector(`input[name="${s.name}"]`));

// the last slider runs fastest
const position = () =>
  lab.sliders.reduce((k, s, i) => k * s.labels.length + Number(inputs[i].value), 0);

function present(begin) {
  lab.sliders.forEach((s, i) => {
    element("value_" + s.name).textContent = s.name + " = " + s.labels[Number(inputs[i].value)];
  });
  const here = lab.positions[position()];
  element("wrong").textContent = here.wrong || "";
  element("note").textContent = here.note || "";
  element("shown").style.display = here.scene ? "" : "none";
  if (here.scene) begin(structuredClone(here.scene));
  document.body.setAttribute("data-position", position());
}

let opened = false;
function begin(scene) {
  if (opened) show(scene); else open(scene);
  opened = true;
}
inputs.forEach(input => input.addEventListener("input", () => present(begin)));
present(begin);
]==]

---- sliders ----

local function range_of(name, given)
  local from, to, n, scale = table.unpack(given)
  local fine = type(from) == "number" and type(to) == "number" and from < to
    and from - from == 0 and to - to == 0
  n = lists.whole(n)
  if not fine or not n or n < 2 or n > MOST_POSITIONS then
    fail("slider '%s' is { from, to, count } or { from, to, count, \"log\" }, from < to, count "
      .. "from 2, or a list of texts", name)
  end
  if scale ~= nil and scale ~= "log" then
    fail("slider '%s': the scale is \"log\" or left out", name)
  end
  if scale and from <= 0 then fail("slider '%s' is logarithmic: from must be positive", name) end
  local values = {}
  for i = 1, n do
    local s = (i - 1) / (n - 1)
    values[i] = scale and from * (to / from) ^ s or from + (to - from) * s
  end
  values[n] = to * 1.0
  return values
end

local function values_of(name, given)
  if type(given) ~= "table" then fail("slider '%s' must be a table", name) end
  if type(given[1]) ~= "string" then return range_of(name, given) end
  for i, text in ipairs(given) do
    if type(text) ~= "string" then fail("slider '%s': entry %d must be a text", name, i) end
  end
  return given
end

-- { name, values } in the order of the arguments of run
local function sliders_of(sliders, run)
  local list, seen = {}, {}
  if debug.getinfo(run, "u").isvararg or debug.getinfo(run, "S").what == "C" then
    fail "run's arguments must have the names of the sliders, as in run = function(h, e)"
  end
  for i = 1, debug.getinfo(run, "u").nparams do
    local name = debug.getlocal(run, i)
    if sliders[name] == nil then fail("run's argument '%s' has no slider", name) end
    list[i], seen[name] = { name = name, values = values_of(name, sliders[name]) }, true
  end
  for name in pairs(sliders) do
    if not seen[name] then fail("slider '%s' is no argument of run", tostring(name)) end
  end
  if #list == 0 then fail "at least one slider is needed" end
  return list
end

local function count_of(sliders)
  local n = 1
  for _, slider in ipairs(sliders) do n = n * #slider.values end
  return n
end

-- values of the position k, from 0: the last slider runs fastest
local function arguments(sliders, k)
  local out = {}
  for i = #sliders, 1, -1 do
    local values = sliders[i].values
    out[i] = values[k % #values + 1]
    k = k // #values
  end
  return out
end

---- positions ----

local function is_path(x)
  return type(x) == "userdata" or type(x) == "table" and x.columns ~= nil
end

-- { scene, note } of what run returned; or { wrong }, the message
local function shown(result, options)
  local paths = is_path(result) and { result } or result
  if type(paths) ~= "table" or #paths == 0 then
    return { wrong = "run must return a path, or a list of paths" }
  end
  local fine, scene = blame.try(require "dm.show.animate".scene, paths, options, PIXELS)
  if not fine then return { wrong = tostring(scene) } end
  local note = scene.note
  scene.note, scene.title = nil, nil
  return { scene = scene, note = note }
end

local function position(run, sliders, k, options)
  local fine, result = blame.try(run, table.unpack(arguments(sliders, k)))
  if fine then return shown(result, options) end
  local message = type(result) == "table" and result.message or result
  return { wrong = tostring(message):match "^[^\n]*" }
end

local function too_large(count, bytes)
  fail("%d positions of %.1f kB would be a page of %.1f MB, at most 4 MB: take fewer positions of "
    .. "a slider, or lower frames (%d a position by default)", count, bytes / 1024,
    count * bytes / 2 ^ 20, FRAMES)
end

-- the positions as JSON, and how many of them failed
local function run_all(run, sliders, options)
  local count, texts, bytes, failures, first = count_of(sliders), {}, 0, 0, nil
  if count > MOST_POSITIONS then
    fail("%d positions: at most %d; take fewer positions of a slider", count, MOST_POSITIONS)
  end
  for k = 0, count - 1 do
    local here = position(run, sliders, k, options)
    if here.wrong then failures, first = failures + 1, first or here.wrong end
    texts[k + 1] = json.encode(here)
    bytes = bytes + #texts[k + 1]
    if count * bytes / (k + 1) > 2 * MOST_BYTES or bytes > MOST_BYTES then
      too_large(count, bytes / (k + 1))
    end
  end
  if failures == count then fail("run fails at every position: %s", first) end
  return texts
end

---- the page ----

local function label_of(value)
  return type(value) == "string" and value or ("%.6g"):format(value)
end

local function input_of(slider)
  local most = #slider.values - 1
  return ('<label><span id="value_%s"></span><input type="range" name="%s" min="0" max="%d" '
    .. 'step="1" value="%d"></label>\n'):format(slider.name, slider.name, most, most // 2)
end

local function text_of(title, sliders, positions)
  local inputs, data = {}, {}
  for i, slider in ipairs(sliders) do
    local labels = {}
    for k, value in ipairs(slider.values) do labels[k] = label_of(value) end
    inputs[i], data[i] = input_of(slider), { name = slider.name, labels = labels }
  end
  local parts = { TITLE = page.escaped(title), STYLE = page.STYLE, VIEWER = page.VIEWER,
    SLIDERS = table.concat(inputs), SCRIPT = require "dm.show.animate.script" .. SCRIPT,
    DATA = ('{"sliders":%s,"positions":[%s]}'):format(json.encode(data),
      table.concat(positions, ",")) }
  return page.document(STYLE, BODY, parts)
end

local function check_file(file)
  if file == nil and inline.show then return end
  if type(file) ~= "string" or not file:find "%.html?$" then
    fail("option 'file' must be a name that ends in .html (got %s)", tostring(file))
  end
end

local doc = "dm.lab{sliders=, run=, file=, points=, dim=, draw=, rods=, bodies=, trail=, plots=, "
  .. "names=, title=, frames=, t=} -> file name\n" .. [[
A page with sliders, for a lecture: every position was run when the page was made, so that it needs
no server and no network. sliders = { h = { 0.01, 0.5, 12, "log" }, rule = { "verlet", "rk4" } }:
{ from, to, count [, "log"] }, or a list of texts; run = function(h, rule) returns the path of a
position, or a list of paths that move side by side; its arguments have the names of the sliders.
The other options are those of path:animate, frames by default 240. Where run fails the page shows
its message. In a notebook the page stands there without a file. Raises when the page would have
more than 4 MB, with what to lower.]]

M.lab = blame.caller(function(given)
  option.check(given, KNOWN, WHERE)
  option.need(given, "sliders", WHERE, "{ name = { from, to, count [, \"log\"] }, ... }")
  if type(given.sliders) ~= "table" then fail "option 'sliders' must be a table" end
  if type(given.run) ~= "function" then
    fail("option 'run' must be a function of the sliders that returns a path (got %s)",
      type(given.run))
  end
  local sliders, options = sliders_of(given.sliders, given.run), {}
  for _, key in ipairs(OF_PICTURE) do options[key] = given[key] end
  options.frames = options.frames or FRAMES
  check_file(given.file)
  local text = text_of(given.title or "dm.lab", sliders, run_all(given.run, sliders, options))
  if given.file == nil then return inline.show("text/html", text) end
  return require "dm.base.text_file".write(given.file, text, WHERE)
end)

core.docs[M.lab] = doc

return M
