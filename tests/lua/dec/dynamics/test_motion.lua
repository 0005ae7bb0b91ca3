-- pictures and files of runs on meshes: pages in motion, VTK series, NumPy records, plots
local tap = require "tap"
local dm = require "dm"
local browser = require "browser"
local ok, raises = tap.ok, tap.raises
local base = os.tmpname()
local function text(name)
  local file = io.open(name, "rb")
  local s = file and file:read "a" or ""
  if file then file:close() end
  return s
end

local ball = dm.mesh { icosphere = 1 }
local flow = ball:euler { vorticity = function(x, _, z) return z + x * z end }:solver { h = 0.1 }:run { steps = 6 }
local plate = dm.mesh { triangle = 3 }
local wave = plate:field { form = 1, fixed = "boundary", L = function(A, V) return V:dot(V) / 2 - A:d():dot(A:d()) / 2 end }
local A = plate:form(1, function(x, y) return { y * (1 - x), x * y } end)
local light = wave:solver { rule = "verlet", h = 0.01 }:run { q = A, v = 0 * A, steps = 8 }
local body = plate:field { values = 2, L = function(x, v) return v:dot(v) / 2 - x:d():dot(x:d()) / 2 end }
  :solver { rule = "verlet", h = 0.01 }:run { q = function(x, y) return { x, y } end, v = function() return { 0.1, 0 } end, steps = 4 }
local ring = dm.mesh { simplices = { { 1, 2 }, { 2, 3 }, { 1, 3 } }, points = { { 0, 0 }, { 1, 0 }, { 0, 1 } } }
local loop = ring:field { L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
  :solver { rule = "verlet", h = 0.1 }:run { q = { 1, 0, 0 }, v = { 0, 0, 0 }, steps = 3 }

-- pages need nothing from elsewhere; chromium, where it is, runs them and shows a form
for name, run in pairs { flow = flow, light = light, body = body, loop = loop } do
  local file = run:animate(base .. name .. ".html", { title = "a page of " .. name })
  local s = text(file)
  ok(s:find "<html" and s:find("a page of " .. name, 1, true) and not s:find 'src=' and not s:find "https?://", name .. ": a page without a network")
  if browser.there() then
    local dom = browser.dom(file .. "#row=3")
    ok(dom:find 'data%-form="[wq]1?"' and dom:find "t = 0%.", name .. ": the page runs", dom:match "<body[^>]*>")
  end
  os.remove(file)
end
ok(text(body:animate(base .. ".html")):find '"points":"[^"]+","seconds"' or text(base .. ".html"):find '"motion":{', "a body moves")
os.remove(base .. ".html")

-- VTK: a file for every row, the series with their times last
for name, run in pairs { flow = flow, light = light, body = body, loop = loop } do
  local list = run:vtk(base .. name)
  ok(#list == #run + 1 and list[#list]:find "%.vtk%.series$", name .. ": files of all rows")
  local series, first = text(list[#list]), text(list[1])
  ok(series:find('"time": ' .. ("%.17g"):format(run.t[#run]), 1, true) and series:find(list[2]:match "[^/]*$", 1, true), name .. ": their times and names")
  local what = { flow = "SCALARS psi", light = "VECTORS q", body = "SCALARS q2", loop = "SCALARS p" }
  ok(first:find "^# vtk DataFile" and first:find(what[name], 1, true), name .. ": " .. what[name])
  for _, file in ipairs(list) do os.remove(file) end
end

-- NumPy: rows of q are arrays
local file = light:npy(base .. ".npy")
local data = dm.load(file)
ok(table.concat(data.columns, " ") == "t q p" and data.q[5] == 1 * light.q[5] and data.p[9] == 1 * light.p[9] and data.t[9] == light.t[9], "npy of a field, to the bit")
os.remove(file)
local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }:solver { rule = "verlet", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 3 }
data = dm.load(pendulum:npy(file))
ok(data.q1[2] == pendulum.q[2][1], "and of other paths, as before")
os.remove(file)

-- pictures of rows, columns as lines
if io.popen "command -v gnuplot 2>/dev/null":read "l" then
  for name, run in pairs { w = flow, q = light } do
    local png = run:plot(name, { row = 2, file = base .. ".png" })
    ok(text(png):sub(2, 4) == "PNG", "a picture of " .. name)
    os.remove(png)
  end
  ok(text(flow:plot("energy", { file = base .. ".png" })):sub(2, 4) == "PNG", "a column over t")
  os.remove(base .. ".png")
end

-- in the terminal a picture is all there is: no nil behind it
do
  local dmlua = os.getenv "DMLUA" or arg[-1]
  local pipe = assert(io.popen(dmlua .. [[ -e '
    local K = dm.mesh { triangle = 2 }
    local u = K:field { L = function(a, v) return v:dot(v)/2 - a:d():dot(a:d())/2 end }
    local run = u:solver { rule = "verlet", h = 0.01 }:run { steps = 2, q = function(x) return x end,
      v = function() return 0 end }
    local flow = K:euler { vorticity = function(x) return x end }:solver { h = 0.1 }:run { steps = 2 }
    print(select("#", run:plot "q"), select("#", flow:plot "w"))']]))
  ok(pipe:read "a":find "\n0\t0\n$", "a picture in the terminal returns nothing")
  pipe:close()
end

raises("ends in .html", function() flow:animate "page" end)
raises("takes the name of a form, w, psi", function() flow:animate(base .. ".html", { of = "u" }) end)
raises("takes the name of a form, w, psi", function() flow:plot "vorticity" end)
raises("option 'row'", function() light:plot("q", { row = 30 }) end)
raises("unknown option 'frames'", function() flow:animate(base .. ".html", { frames = 3 }) end)
raises("beginning of file names", function() flow:vtk(3) end)
raises("no field", function() pendulum:vtk(base) end)
os.remove(base)
tap.done()
