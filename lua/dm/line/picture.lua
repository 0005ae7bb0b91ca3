--- Runs on lines drawn: space and time as a raster, rows as profiles, a page in motion.
local blame = require "dm.base.blame"
local core = require "dm.core"
local files = require "dm.line.files"
local gnuplot = require "dm.show.gnuplot"
local look = require "dm.show.look"
local option = require "dm.base.options"
local page = require "dm.show.animate.page"
local plot = require "dm.show.plot"
local raster_of = require "dm.show.raster"
local shades = require "dm.show.shades"
local text_file = require "dm.base.text_file"

local M = {}

local MOST = 400  -- columns or rows of a raster in a file

---- what is drawn ----

-- { levels, first, step }: entry first + (i - 1) step of levels[j] is the value of node i at row j
local function quantity(run, name, where)
  local stem, number = tostring(name):match "^(%a[%a_]*)(%d*)$"
  if run.boxes then
    if not run.boxes.number[name] then
      option.fail(where, "takes the name of a component, %s (got %s)",
        table.concat(run.boxes.names, ", "), option.got(name))
    end
    return { levels = run[name], first = 1, step = 1, name = name }
  end
  local n = run.field.values
  local v = number == "" and 1 or math.tointeger(tonumber(number))
  if (stem ~= "u" and stem ~= "p") or v < 1 or v > n then
    option.fail(where, "takes \"u\" or \"p\"%s (got %s); numbers of rows: dm.plot(run.t, "
      .. "run:column \"energy\")", n > 1 and (", \"u1\" to \"p%d\""):format(n) or "",
      option.got(name))
  end
  return { levels = run[stem], first = v, step = n, name = n > 1 and stem .. v or stem }
end

local function value(q, j, i) return q.levels[j][q.first + (i - 1) * q.step] end

-- place of node i at row j
local function place(run, j, i) return run.x and run.x[j][i] or run.nodes[i] end

-- numbers from 1 to count, at most `most` of them, evenly
local function thinned(count, most)
  local out = {}
  if count <= most then
    for i = 1, count do out[i] = i end
    return out
  end
  for k = 0, most - 1 do out[k + 1] = 1 + math.floor(k * (count - 1) / (most - 1) + 0.5) end
  return out
end

local function range(q, run, rows)
  local lo, hi = math.huge, -math.huge
  for _, j in ipairs(rows) do
    for i = 1, #run.nodes do
      local x = value(q, j, i)
      lo, hi = math.min(lo, x), math.max(hi, x)
    end
  end
  return lo, hi
end

local function title_of(run, name)
  return ("%s, %s, h = %.4g"):format(name, run.rule, run.h)
end

---- profiles ----

-- the rows that are asked for, or five over the run
local function rows_of(run, given, where)
  if given == nil then return thinned(#run, math.min(#run, 5)) end
  local rows = type(given) == "number" and { given } or given
  for _, j in ipairs(rows) do
    if math.type(j) ~= "integer" or j < 1 or j > #run then
      option.fail(where, "option 'rows' must list rows from 1 to %d (got %s)", #run, option.got(j))
    end
  end
  return rows
end

local function profile(run, q, options, where)
  local series = {}
  for k, j in ipairs(rows_of(run, options.rows, where)) do
    local x, y = {}, {}
    for i = 1, #run.nodes do x[i], y[i] = place(run, j, i), value(q, j, i) end
    series[k] = { x = x, y = y, name = ("t = %.4g"):format(run.t[j]) }
  end
  local own = { file = options.file, title = options.title or title_of(run, q.name), xlabel = "x",
    ylabel = q.name, ascii = options.ascii }
  for _, key in ipairs(look.KNOWN) do own[key] = options[key] end
  return plot.plot(series, own)
end

---- rasters ----

local function terminal_raster(run, q, options)
  local width, height = shades.size(options)
  local rows, columns = thinned(#run, height or 24), thinned(#run.nodes, width)
  local lo, hi = range(q, run, rows)
  local shade, legend = shades.scale(lo, hi, 1)
  local lines = { options.title or title_of(run, q.name) }
  for k = #rows, 1, -1 do
    local out, j = {}, rows[k]
    for c, i in ipairs(columns) do out[c] = shade(value(q, j, i)) end
    lines[#lines + 1] = shades.line(run.t[j], table.concat(out))
  end
  lines[#lines + 1] = shades.ends(run.nodes[1], run.nodes[#run.nodes], #columns)
  lines[#lines + 1] = "t up, x across; " .. legend
  io.write(table.concat(lines, "\n"), "\n")
end

local function raster_script(run, q, options)
  local rows, columns = thinned(#run, MOST), thinned(#run.nodes, MOST)
  local lo, hi = range(q, run, rows)
  local left, right = math.huge, -math.huge
  for _, j in ipairs(rows) do
    left, right = math.min(left, place(run, j, 1)), math.max(right, place(run, j, #run.nodes))
  end
  local axes = { x = { left, right, "x" }, y = { run.t[1], run.t[#run], "t" },
    cb = { lo, hi, q.name } }
  return function(part)
    local lines = { gnuplot.head(part, options, 800, 600)
      .. raster_of.axes(options, 800, 600, axes) .. "\nset title "
      .. gnuplot.caption(options.title or title_of(run, q.name)),
      "set palette defined (0 '#440154', 1 '#3b518b', 2 '#21908d', 3 '#5cc863', 4 '#fde725')",
      "set pm3d map corners2color mean", "set autoscale fix", "$rows << EOD" }
    for _, j in ipairs(rows) do
      for _, i in ipairs(columns) do
        lines[#lines + 1] = ("%.9g %.9g %.9g"):format(place(run, j, i), run.t[j], value(q, j, i))
      end
      lines[#lines + 1] = ""
    end
    lines[#lines + 1] = "EOD\nsplot $rows using 1:2:3 with pm3d\nunset output"
    return table.concat(lines, "\n") .. "\n"
  end
end

local function raster(run, q, options)
  if not options.file then return terminal_raster(run, q, options) end
  gnuplot.draw(options.file, raster_script(run, q, options))
  return options.file
end

local OPTIONS = { "file", "style", "rows", "title", "ascii", table.unpack(look.KNOWN) }

local function draw(run, name, options)
  local where = "run:plot"
  options = option.check(options or {}, OPTIONS, where)
  local style = option.one_of(options, "style", where, { "raster", "profile" },
    (options.rows or #run < 2) and "profile" or "raster")
  option.text(options, "file", where)
  option.text(options, "title", where)
  look.check(options)
  local q = quantity(run, name or (run.boxes and run.boxes.names[1] or "u"), where)
  if style == "profile" then return profile(run, q, options, where) end
  if #run < 2 then option.fail(where, "a raster needs two rows at least") end
  return raster(run, q, options)
end

---- a page in motion ----

local STYLE = [[
canvas { width: 100%; height: 70vh; border: 1px solid #ddd; }
#controls { display: flex; gap: 14px; align-items: center; margin: 8px 0; }
#row { flex: 1; }
]]

local BODY = [[
<canvas id="picture"></canvas>
<div id="controls"><button id="go" type="button">pause</button>
<input id="row" type="range" min="0" value="0"><span id="time"></span></div>
]]

local SCRIPT = [[
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
function floats(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}
const x = floats(data.x), u = floats(data.u), t = floats(data.t), n = data.nodes;
const canvas = document.getElementById("picture"), slider = document.getElementById("row");
const go = document.getElementById("go"), time = document.getElementById("time");
slider.max = t.length - 1;
let row = 0, runs = true, last = 0;
// round numbers between lo and hi, with their texts
function ticks(lo, hi) {
  const raw = (hi - lo) / 6, p = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].find(m => m * p >= raw) * p, out = [];
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step; k++)
    out.push([k * step, digits > 5 || step > 1e5 ? (k * step).toExponential(1)
      : (k * step).toFixed(digits)]);
  return out;
}
function draw() {
  const w = canvas.width = canvas.clientWidth, h = canvas.height = canvas.clientHeight;
  const pen = canvas.getContext("2d"), left = 64, low = h - 38;
  const px = v => left + (v - data.from) / (data.to - data.from) * (w - left - 16);
  const py = v => low - (v - data.least) / (data.largest - data.least) * (low - 14);
  pen.font = "13px sans-serif"; pen.fillStyle = "#666"; pen.strokeStyle = "#ddd";
  pen.textAlign = "right";
  for (const [v, text] of ticks(data.least, data.largest)) {
    pen.beginPath(); pen.moveTo(left, py(v)); pen.lineTo(w - 16, py(v)); pen.stroke();
    pen.fillText(text, left - 8, py(v) + 4);
  }
  for (const [s, text] of ticks(data.from, data.to)) {
    pen.beginPath(); pen.moveTo(px(s), 14); pen.lineTo(px(s), low); pen.stroke();
    pen.textAlign = px(s) > w - 40 ? "right" : "center";
    pen.fillText(text, px(s), h - 18);
  }
  pen.textAlign = "center"; pen.fillText("x", (left + w - 16) / 2, h - 3);
  pen.strokeStyle = "#21618c"; pen.lineWidth = 2; pen.beginPath();
  for (let i = 0; i < n; i++) {
    const at = row * n + i, a = px(data.moves ? x[at] : x[i]), b = py(u[at]);
    if (i) pen.lineTo(a, b); else pen.moveTo(a, b);
  }
  pen.stroke();
  time.textContent = "t = " + t[row].toPrecision(4);
  slider.value = row;
}
function frame(now) {
  if (runs && now - last > 1000 * data.seconds / t.length) {
    last = now; row = (row + 1) % t.length; draw();
  }
  requestAnimationFrame(frame);
}
go.onclick = () => { runs = !runs; go.textContent = runs ? "pause" : "play"; };
slider.oninput = () => { runs = false; go.textContent = "play"; row = +slider.value; draw(); };
window.onresize = draw;
draw();
requestAnimationFrame(frame);
]]

local function page_data(run, q, options)
  local rows, x, u, t = thinned(#run, 2000), {}, {}, {}
  for k, j in ipairs(rows) do
    t[k] = run.t[j]
    for i = 1, #run.nodes do
      u[#u + 1] = value(q, j, i)
      if run.x then x[#x + 1] = place(run, j, i) end
    end
  end
  local lo, hi = range(q, run, rows)
  local size = math.max(math.abs(lo), math.abs(hi))
  if not (hi - lo > 1e-12 * size) then lo, hi = lo - 1, hi + 1 end
  local margin = 0.05 * (hi - lo)
  return { nodes = #run.nodes, moves = run.x and 1 or 0, x = page.floats(run.x and x or run.nodes),
    u = page.floats(u), t = page.floats(t), from = run.nodes[1], to = run.nodes[#run.nodes],
    least = lo - margin, largest = hi + margin, seconds = options.seconds or 10 }
end

local function animate(run, file, options)
  local where = "run:animate"
  if type(file) ~= "string" or not file:find "%.html?$" then
    option.fail(where, "a file name that ends in .html is needed (got %s)", option.got(file))
  end
  options = option.check(options or {}, { "of", "title", "seconds" }, where)
  option.text(options, "title", where)
  option.positive(options, "seconds", where)
  local q = quantity(run, options.of or (run.boxes and run.boxes.names[1] or "u"), where)
  local parts = { TITLE = page.escaped(options.title or title_of(run, q.name)),
    DATA = page.json(page_data(run, q, options)), SCRIPT = SCRIPT }
  return text_file.write(file, page.document(STYLE, BODY, parts), where)
end

--- Gives a class of runs these methods.
function M.give(class)
  files.give(class)
  core.method(class, "plot", blame.caller(draw), [[
run:plot(name, {style=, rows=, file=, title=, size=, ...}) -> file name or nothing
name: "u" or "p" ("u2" of several values), of boxes a component. style = "raster" (default): its
values over x, across, and t, upwards; "profile", or rows = {1, 50, ...}: over x, a line for each of
these rows. In the terminal, or with file = to a .png, .svg or .pdf through gnuplot. Sizes and
letters as of dm.plot.]])

  core.method(class, "animate", blame.caller(animate), [[
run:animate(file, {of=, title=, seconds=}) -> file name
A page, name.html, in which a browser moves the line through its rows, without a network. of: "u",
"p2", a component of boxes; seconds: how long all rows take.]])
end

return M
