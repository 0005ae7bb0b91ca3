-- runs on lines: rows in a file, checkpoints and what goes on from them, params, and a blow-up that is told
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin, exp, pi = math.cos, math.sin, math.exp, math.pi

local function linear(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function sine_gordon(u, ut, ux) return linear(u, ut, ux) - (1 - dm.cos(u)) end
local function hump(x) return exp(-(x - 10) ^ 2 / 4) end
local function with(a, b)
  local out = {}
  for key, value in pairs(a) do out[key] = value end
  for key, value in pairs(b) do out[key] = value end
  return out
end

---- a run that was cut has the bits of one that never stopped; so have rows in a file ----

local cases = {
  { "fixed ends", { x = { 0, 20, 40 }, fixed = "ends", L = sine_gordon }, { h = 0.25 }, { u = hump, ut = 0 } },
  { "a ring, corners", { x = { 0, 20, 41, periodic = true }, L = linear }, { h = 0.25, rule = "cell(corners)" }, { u = hump } },
  { "absorbing ends", { x = { 0, 20, 40 }, absorbing = "ends", L = sine_gordon }, { h = 0.25 }, { u = hump } },
  { "two values", { x = { 0, 20, 40 }, values = 2, L = function(u, ut, ux) return (ut:dot(ut) - ux:dot(ux)) / 2 - u:dot(u) ^ 2 / 4 end }, { h = 0.25 },
    { u = function(x) return { hump(x), sin(x) } end } },
  { "free heights", { x = { 0, 20, 40 }, L = sine_gordon }, { h = 0.125, free = "t" }, { u = hump, ut = function(x) return (x - 10) / 2 * hump(x) end } },
  { "free nodes", { x = { 0, 1, 20 }, fixed = "ends", L = linear }, { h = 0.002, free = "x" }, { u = function(x) return sin(pi * x) end } },
  { "time in L", { x = { 0, 20, 40 }, L = function(u, ut, ux, x, t) return linear(u, ut, ux) + cos(t) * sin(x) * u end }, { h = 0.25 }, { u = 0 } },
}
local name = os.tmpname()
for _, case in ipairs(cases) do
  local field = dm.field(case[2])
  local solver = field:solver(case[3])
  local whole = solver:run(with(case[4], { steps = 37 }))
  local part = solver:run(with(case[4], { steps = 15, every = 4, checkpoint = name }))
  for how, from in pairs { file = dm.field(case[2]):resume(name), run = field:resume(part), ["dm.resume"] = dm.resume(part), ["dm.resume of a file"] = dm.resume(name, field) } do
    local rest = from:run { steps = 22, every = 5 }
    ok(rest.u[#rest] == whole.u[38] and rest.p[#rest] == whole.p[38] and rest.t[#rest] == whole.t[38] and rest.energy[#rest] == whole.energy[38],
      case[1] .. ": the bits of a run that never stopped, from a " .. how)
    ok(rest.u[1] == whole.u[16] and rest.energy[1] == whole.energy[16] and rest.t[1] == whole.t[16] and #rest == 6, case[1] .. ": and its first row")
  end
  local short = solver:run(with(case[4], { steps = 37, every = 3, file = name .. ".npy" }))
  local rows = dm.load(name .. ".npy")
  local same = #rows.t == 14
  for i = 1, #rows.t do
    local k = math.min(3 * i - 2, 38)
    same = same and rows.t[i] == whole.t[k] and rows.energy[i] == whole.energy[k]
    for j = 1, #whole.u[k] do same = same and rows.u[i][j] == whole.u[k][j] and rows.p[i][j] == whole.p[k][j] end
    if whole.x then for j = 1, #whole.x[k] do same = same and rows.x[i][j] == whole.x[k][j] end end
  end
  ok(same, case[1] .. ": rows in a file are those of a run", #rows.t)
  ok(#short == 2 and short.u[2] == whole.u[38] and tostring(short):find "all rows are in", "the first and the last are kept")
  if not case[2].absorbing and case[1] ~= "time in L" then
    local a, b = short:multisymplectic(), whole:multisymplectic()
    ok(a == b, case[1] .. ": laws of a run in a file take its levels again", a - b)
  end
end
os.remove(name .. ".npy")
local field = dm.field { x = { 0, 20, 4000 }, L = sine_gordon }
local none = field:solver { h = 0.0025 }:run { u = hump, steps = 0, file = name .. ".npy" }
ok(#none == 1 and #dm.load(name .. ".npy").t == 1, "a run of no slabs has one row")
-- many pieces: 4001 numbers a row make 262 rows a piece
local long = field:solver { h = 0.0025 }:run { u = hump, steps = 270, file = name .. ".npy" }
local rows = dm.load(name .. ".npy")
ok(#rows.t == 271 and rows.u[271][2000] == field:solver { h = 0.0025 }:run { u = hump, steps = 270, every = 270 }.u[2][2000] and long.steps == 270, "in pieces")
os.remove(name .. ".npy")

---- boxes: the same ----

local function soliton(x) return 2 / dm.cosh(x) ^ 2 end
local function kdv(cells, c)
  return dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, x = { -20, 20, cells, periodic = true },
    M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
    S = function(z) return (c or 1) * z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }
end
local boxes = kdv(65)
local solver = boxes:solver { h = 0.02 }
local whole = solver:run { z = { u = soliton }, steps = 37 }
local part = solver:run { z = { u = soliton }, steps = 15, every = 4, checkpoint = name }
for how, from in pairs { file = kdv(65):resume(name), run = boxes:resume(part), ["dm.resume of a file"] = dm.resume(name, boxes), ["dm.resume"] = dm.resume(part) } do
  local rest = from:run { steps = 22, every = 5 }
  ok(rest.z[#rest] == whole.z[38] and rest.phi[#rest] == whole.phi[38] and rest.t[#rest] == whole.t[38] and rest.u[1] == whole.u[16] and #rest == 6,
    "boxes: the bits of a run that never stopped, from a " .. how)
  ok(rest:balance "multisymplectic" < 1e-10 and dm.resume(rest):run { steps = 0 }.z[1] == whole.z[38], "and its laws")
end
local short = solver:run { z = { u = soliton }, steps = 37, every = 3, file = name .. ".npy" }
local rows = dm.load(name .. ".npy")
local same = #rows.t == 14 and #short == 2 and short.z[2] == whole.z[38]
for i = 1, 14 do
  local k = math.min(3 * i - 2, 38)
  for _, key in ipairs { "phi", "u", "v", "w" } do
    for j = 1, 65 do same = same and rows[key][i][j] == whole[key][k][j] end
  end
  same = same and rows.t[i] == whole.t[k]
end
ok(same and short:balance "energy" == whole:balance "energy", "boxes: rows in a file are those of a run")
os.remove(name .. ".npy")
raises("its cells was 65 and is 67", function() dm.resume(name, kdv(67)) end)
raises("its S was", function() dm.resume(name, kdv(65, 2)) end)
raises("no checkpoint of a run on a line", function() dm.resume(name, dm.field { x = { 0, 20, 40 }, L = sine_gordon }) end)
raises("its own state", function() dm.resume(part):run { z = { u = soliton }, steps = 1 } end)
raises("not one of the boxes", function() dm.resume(part, kdv(65)) end)
raises("at least one step", function() solver:run { z = { u = soliton }, steps = 0 }:checkpoint(name) end)
raises("there are no options", function() dm.resume(part, boxes, {}) end)
raises("what the run is of", function() dm.resume(part, 3) end)

---- what is refused ----

local wave = dm.field { x = { 0, 20, 40 }, fixed = "ends", L = sine_gordon }
-- an L that differs only where u > 1, or a law that does at negative z, is another one
local function stiff(k)
  return function(u, ut, ux, _, t) return linear(u, ut, ux) - dm.where(u - 1, (k + t) * (u - 1) ^ 2, 0) end
end
local function tall(k) return dm.field { x = { 0, 20, 40 }, L = stiff(k) } end
tall(1):solver { h = 0.25 }:run { u = hump, steps = 5, checkpoint = name }
raises("its L was", function() tall(2):resume(name) end)
ok(tall(1):resume(name):run { steps = 1 }.u[2] == tall(1):solver { h = 0.25 }:run { u = hump, steps = 6 }.u[7],
  "an L that is written again is the same")
raises("L depends on t", function() tall(1):stability_limit() end)
local function low(k)
  return dm.multisymplectic { x = { -20, 20, 41, periodic = true }, names = { "u", "v", "w" },
    M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(z) return z.v ^ 2 / 2 - z.w ^ 2 / 2 + dm.where(-z.u, k * z.u ^ 4, 0) end }
end
low(1):solver { h = 0.1 }:run { z = { u = function(x) return exp(-x * x) end, v = 0 }, steps = 3, checkpoint = name }
raises("its S was", function() low(2):resume(name) end)
ok(#low(1):resume(name):run { steps = 1 } == 2, "the same S goes on")
wave:solver { h = 0.25 }:run { u = hump, steps = 5, checkpoint = name }
raises("its cells was 40 and is 41", function() dm.field { x = { 0, 20, 41 }, fixed = "ends", L = sine_gordon }:resume(name) end)
raises("its fixed was", function() dm.field { x = { 0, 20, 40 }, L = sine_gordon }:resume(name) end)
raises("its L was", function() dm.field { x = { 0, 20, 40 }, fixed = "ends", L = linear }:resume(name) end)
raises("its own state", function() wave:resume(name):run { u = hump, ut = 0, steps = 1 } end)
raises("its own state", function() wave:resume(name):run { t0 = 1, steps = 1 } end)
raises("not one of the field", function() wave:resume(field:solver { h = 0.0025 }:run { u = hump, steps = 1 }) end)
raises("at least one slab", function() wave:solver { h = 0.1 }:run { u = hump, steps = 0 }:checkpoint(name) end)
raises("cannot open", function() wave:resume(name .. ".none") end)
local text = assert(io.open(name)):read "a"
local handle = assert(io.open(name, "w"))
handle:write((text:gsub("t0 0x0p%+0", "t0 0x1p+0")))
handle:close()
raises("checksum", function() wave:resume(name) end)
raises("a run or the name of a file", function() wave:resume(3) end)
os.remove(name)
for _, key in ipairs { "events", "at", "watch", "q", "v", "control" } do
  raises("option '" .. key .. "'", function() wave:solver { h = 0.25 }:run { u = hump, steps = 5, [key] = {} } end)
end
raises("cannot", function() wave:solver { h = 0.25 }:run { u = hump, steps = 5, file = "/nowhere/at/all.npy" } end)

---- params ----

local function massive(m) return dm.field { x = { 0, 1, 16, periodic = true }, params = { m = m }, L = function(u, ut, ux, _, _, P) return linear(u, ut, ux) - P.m * u ^ 2 / 2 end } end
ok(massive(4).params.m == 4 and massive(100):stability_limit() < massive(0):stability_limit(), "params reach L")
raises("must be a table", function() dm.field { x = { 0, 1, 4 }, L = linear, params = 3 } end)

---- beyond the limit of stability ----

local circle = dm.field { x = { 0, 1, 24, periodic = true }, L = linear }
local grown = circle:solver { h = 1.05 / 24 }
local some = grown:run { u = function(x) return cos(24 * pi * x) end, steps = 60 }
ok(tostring(some):find "beyond the limit of stability, 0.0416667", "an energy that has grown is told", tostring(some))
local fine, failure = pcall(grown.run, grown, { u = function(x) return cos(6 * pi * x) end, steps = 5000 })
ok(not fine and failure.code == "blow_up" and tostring(failure):find "beyond the limit of stability" and tostring(failure):find "node %d+, x = ", "a blow-up ends a run, and says where", failure)
ok(#failure.path > 100 and failure.path.u[#failure.path]:norm() > 1e10 and failure.step == failure.path.steps, "with the path so far")
-- a motion that leaves an unstable rest of 1e-12 grows by 10^24 in its energies, and goes on
local hill = dm.field { x = { 0, 1, 12, periodic = true }, L = function(u, ut, ux) return linear(u, ut, ux) + u ^ 2 / 2 - u ^ 4 / 4 end }
local fell = hill:solver { h = 0.05 }:run { u = 1e-12, steps = 2000 }
ok(fell.u[#fell]:norm() < 6 and fell:column "u1":norm() > 1, "what leaves an unstable rest is no blow-up")
-- and rest is rest
local rest = hill:solver { h = 0.05 }:run { u = 0, steps = 200 }
near(rest.u[201]:norm(), 0, 0, "rest")
-- a plot of several values names the one that it draws, also where none was asked for by number
do
  local run = dm.field { x = { 0, 1, 8 }, values = 2, L = function(u, ut, ux) return ut:dot(ut) / 2 - ux:dot(ux) / 2 end }
    :solver { h = 0.05 }:run { u = function(x) return { 0.5, x } end, ut = function() return { 0, 0 } end, steps = 8 }
  local write, out = io.write, {}
  io.write = function(...) out[#out + 1] = table.concat({ ... }) end -- luacheck: ignore
  run:plot "u"
  run:plot "p2"
  io.write = write -- luacheck: ignore
  local text = table.concat(out)
  tap.ok(text:find "^u1, " and text:find "\np2, ", "plots of several values are named", text:sub(1, 40))
end

tap.done()
