--- K:animate: a page of its own, without a network, that turns a mesh and colours it by forms.
local class = require "dm.base.class"
local colours = require "dm.dec.pictures.colours"
local drawing = require "dm.dec.pictures.drawing"
local option = require "dm.base.options"
local page = require "dm.show.animate.page"
local text_file = require "dm.base.text_file"

local M = {}

local WHERE = "mesh:animate"

local STYLE = [[
canvas { width: 100%; height: 74vh; border: 1px solid #ddd; touch-action: none; }
#controls, #film:not([hidden]) { display: flex; gap: 14px; align-items: center; margin: 8px 0; }
#controls { flex-wrap: wrap; }
#row { flex: 1; }
]]

local BODY = [[
<p>@NOTE@</p>
<canvas id="picture"></canvas>
<div id="controls">
<button id="turn" type="button">pause</button>
<label>form <select id="form"></select></label>
<label><input id="edges" type="checkbox"> edges</label>
<label><input id="arrows" type="checkbox" checked> arrows</label>
</div>
<div id="film" hidden>
<button id="go" type="button">pause</button>
<input id="row" type="range" min="0" value="0"> <span id="time"></span>
</div>
]]

local function flat(lists, shift)
  local out = {}
  for _, list in ipairs(lists) do
    for _, x in ipairs(list) do out[#out + 1] = x + shift end
  end
  return out
end

-- arrows as two ends each
local function ends_of(arrows)
  local out = {}
  for _, arrow in ipairs(arrows) do
    for c = 1, 3 do out[#out + 1] = arrow[1][c] end
    for c = 1, 3 do out[#out + 1] = arrow[1][c] + arrow[2][c] end
  end
  return page.floats(out)
end

-- a form as the page has it
local function entry(name, d)
  if not d.values then
    return { name = name, on = "nothing", label = d.arrow_note or "", arrows = ends_of(d.arrows) }
  end
  local scale = colours.scale(d.values)
  return { name = name, on = d.on, label = d.name, least = scale.least, largest = scale.largest,
    stops = scale.stops, values = page.floats(d.values), arrows = ends_of(d.arrows) }
end

--- What the page has of a mesh that is drawn, and its first form, the mesh alone.
function M.data(d)
  return { dim = d.dim, solid = d.solid, points = page.floats(flat(d.points, 0)),
    faces = page.wholes(flat(d.faces, -1)), edges = page.wholes(flat(d.edges, -1)),
    forms = { entry("mesh", d) } }
end

--- The text of the page.
function M.page(title, note, data)
  local parts = { TITLE = page.escaped(title), NOTE = page.escaped(note), DATA = page.json(data),
    SCRIPT = require "dm.dec.pictures.script" }
  return page.document(STYLE, BODY, parts)
end

-- forms by name, or a list of them, behind those that are there
local function add_entries(out, K, forms)
  local names = {}
  for name in pairs(forms) do names[#names + 1] = name end
  table.sort(names, function(a, b) return tostring(a) < tostring(b) end)
  for _, name in ipairs(names) do
    local a = forms[name]
    if option.got(a) == "dm.vector_field" and rawequal(a.mesh, K) then
      out[#out + 1] = entry(tostring(name), drawing.arrows(drawing.mesh(K), a))
    elseif option.got(a) == "dm.form" and rawequal(a.mesh, K) then
      out[#out + 1] = entry(tostring(name), drawing.form(a))
    else
      option.fail(WHERE, "option 'forms': '%s' must be a form or a field of this mesh (got %s)",
        tostring(name), option.got(a))
    end
  end
end

class.method("dm.mesh", "animate", function(K, file, options)
  if type(file) ~= "string" or not file:find "%.html?$" then
    option.fail(WHERE, "a file name that ends in .html is needed (got %s)", option.got(file))
  end
  options = option.check(options or {}, { "forms", "title" }, WHERE)
  option.text(options, "title", WHERE)
  local forms = options.forms or {}
  if type(forms) ~= "table" then
    option.fail(WHERE, "option 'forms' must be a table { name = form } (got %s)", option.got(forms))
  end
  local d = drawing.mesh(K)
  local title = options.title or ("mesh of %d vertices"):format(K:count(0))
  local data = M.data(d)
  add_entries(data.forms, K, forms)
  local note = ("%d vertices, %d edges, %d faces drawn; drag to turn, wheel to come nearer")
    :format(K:count(0), #d.edges, #d.faces)
  return text_file.write(file, M.page(title, note, data), WHERE)
end, [[
K:animate(file, {forms=, title=}) -> file name
A page, name.html, in which a browser turns the mesh, without a network: colours by one of the forms
= {name = form or field of vectors}, with their scale, arrows, edges. Of meshes of dimension 3 the
boundary is drawn.]])

return M
