--- path:animate of waves: a page of its own, without a network, on which the density moves,
-- coloured by the phase.
local class = require "dm.base.class"
local option = require "dm.base.options"
local page = require "dm.show.animate.page"
local text_file = require "dm.base.text_file"

local M = {}

local WHERE = "path:animate"
local FRAMES, POINTS = 400, 600 -- of a page, at most

local STYLE = [[
canvas { width: 100%; height: 66vh; border: 1px solid #ddd; }
#controls { display: flex; gap: 14px; align-items: center; margin: 8px 0; }
#scrub { flex: 1 1 240px; }
]]

local BODY = [[
<p>@NOTE@</p>
<canvas id="picture"></canvas>
<div id="controls">
<button id="play" type="button">pause</button>
<input id="scrub" type="range" min="0" max="1" step="1" value="0" aria-label="time">
<span id="time"></span>
</div>
]]

-- every so many of `count` that there are no more than `most`, as numbers
local function every(count, most)
  local out = {}
  for i = 1, count, math.max(1, math.ceil(count / most)) do out[#out + 1] = i end
  return out
end

-- V at the points that are shown, from 0 to 1; flat where it is constant
local function potential(wave, points)
  local least, most = math.huge, -math.huge
  for j = 1, #wave.V do
    least, most = math.min(least, wave.V[j]), math.max(most, wave.V[j])
  end
  local out, shift = {}, wave.boundary == "walls" and 1 or 0
  for k, j in ipairs(points) do
    local at = math.max(1, math.min(#wave.V, j - shift))
    out[k] = most > least and (wave.V[at] - least) / (most - least) or 0
  end
  return out
end

local function data_of(path)
  local wave = path.wave
  local points, rows = every(wave.N, POINTS), every(#path, FRAMES)
  local x, t, re, im, most = {}, {}, {}, {}, 0
  for k, j in ipairs(points) do x[k] = wave.x[j] end
  for k, i in ipairs(rows) do
    local v = path.psi[i]
    t[k] = path.t[i]
    for _, j in ipairs(points) do
      re[#re + 1], im[#im + 1] = v.re[j], v.im[j]
      most = math.max(most, v.re[j] ^ 2 + v.im[j] ^ 2)
    end
  end
  return { x = page.floats(x), t = page.floats(t), re = page.floats(re), im = page.floats(im),
    V = page.floats(potential(wave, points)), most = most }, #rows
end

class.method("dm.wave_path", "animate", function(path, file, options)
  if type(file) ~= "string" or not file:find "%.html?$" then
    option.fail(WHERE, "a file name that ends in .html is needed (got %s)", option.got(file))
  end
  options = option.check(options or {}, { "title" }, WHERE)
  local title = option.text(options, "title", WHERE) or path.title
  local data, frames = data_of(path)
  local note = ("|psi|^2 coloured by the phase, V in grey; t = %.6g to %.6g, %d of %d rows. "
    .. "Space: pause; arrow keys: step."):format(path.t[1], path.t[#path], frames, #path)
  local parts = { TITLE = page.escaped(title), NOTE = page.escaped(note), DATA = page.json(data),
    SCRIPT = require "dm.wave.pictures.script" }
  return text_file.write(file, page.document(STYLE, BODY, parts), WHERE)
end, [[
path:animate(file, {title=}) -> file name
A page, name.html, on which a browser shows |psi|^2 in time, coloured by the phase, with V behind
it, without a network: at most 400 of the rows.]])

return M
