-- what fields on a line refuse, and how; what a failed run leaves; files and pictures
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function linear(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function field(options)
  local all = { x = { 0, 1, 10 }, L = linear }
  for key, value in pairs(options or {}) do all[key] = value end
  return dm.field(all)
end
local solver = field():solver { h = 0.05 }
local function run(options) return solver:run(options) end

raises("option 'x' is missing", function() dm.field { L = linear } end)
raises("option 'L' is missing", function() dm.field { x = { 0, 1, 2 } } end)
raises("with from < to", function() field { x = { 1, 0, 3 } } end)
raises("did you mean 'periodic'", function() field { x = { 0, 1, 3, periodical = true } } end)
raises("whole number from 1", function() field { x = { 0, 1, 2.5 } } end)
raises("whole number from 3", function() field { x = { 0, 1, 2, periodic = true } } end)
raises("a ring has no ends", function() field { x = { 0, 1, 5, periodic = true }, fixed = "ends" } end)
raises("a ring has no ends", function() field { x = { 0, 1, 5, periodic = true }, absorbing = 1 } end)
raises("option 'fixed' must be", function() field { fixed = "middle" } end)
raises("both fixed and absorbing", function() field { fixed = "left", absorbing = "ends" } end)
raises("takes c > 0", function() field { absorbing = -1 } end)
raises("option 'values'", function() field { values = 0 } end)
raises("option 'rule' must be \"cell(gauss(r))\"", function() field():solver { rule = "verlet", h = 0.1 } end)
raises("r from 1 to 16", function() field():solver { rule = "cell(gauss(17))", h = 0.1 } end)
raises("option 'h' is missing", function() field():solver {} end)
raises("a height > 0", function() field():solver { h = 0 } end)
raises("option 'free' must be", function() field():solver { h = 0.1, free = "u" } end)
raises("which absorbing ends take away", function() field { absorbing = 1 }:solver { h = 0.1, free = "t" } end)
raises("L must return a number", function() field { L = function() return nil end }:solver { h = 0.1 } end)
raises("L must return a number", function() field { L = function() return {} end }:solver { h = 0.1 } end)
raises("where", function() field { L = function(u, ut) if u > 0 then return ut ^ 2 end return 0 end }:solver { h = 0.1 } end)
raises("option 'u' is missing", function() run { steps = 1 } end)
raises("u must give a number at x = 0", function() run { u = function() return "a" end, steps = 1 } end)
raises("must be finite", function() run { u = function() return 1 / 0 end, steps = 1 } end)
raises("a list for 11 nodes", function() run { u = { 1, 2, 3 }, steps = 1 } end)
raises("give one of 'ut' and 'p'", function() run { u = 0, ut = 0, p = 0, steps = 1 } end)
raises("give one of 't' and 'steps'", function() run { u = 0, t = 1, steps = 1 } end)
raises("a number of slabs, or t", function() run { u = 0 } end)
raises("a trace does not see ==", function()
  field { L = function(u, ut) if u == 1 then return ut ^ 2 + 3 end return ut ^ 2 / 2 end }:solver { h = 0.1 }:run { u = 1, steps = 1 } end)
raises("are not known before", function() field():solver { h = 0.1, free = "t" }:run { u = 0, t = 1 } end)
raises("starts from 'ut'", function() field():solver { h = 0.1, free = "x" }:run { u = 0, p = 0, steps = 1 } end)
raises("is not the same for -ut", function()
  field { values = 2, L = function(u, ut) return ut:dot(ut) / 2 + u[1] * ut[2] end }:stability_limit() end)
raises("degenerate at this u", function() field { L = function(u, ut, ux) return ut ^ 4 + u ^ 2 - ux ^ 2 end }:stability_limit() end)
raises("is for fields of one value", function() field { values = 2, L = function(_, ut) return ut:dot(ut) end, absorbing = 1 }:reflection() end)
local path = run { u = 0, ut = 1, steps = 3 }
raises("no column 'q1'", function() path:drift "q1" end)
raises("the generator of a symmetry", function() path:conservation "u" end)
raises("the generator must give a number", function() path:conservation(function() return { 1, 2 } end) end)
raises("at least 3 rows", function() run { u = 0, steps = 1 }:drift "energy" end)
raises("at least one slab", function() run { u = 0, steps = 0 }:multisymplectic() end)

---- failed runs keep their path ----

local blown, why = pcall(function()
  field { L = function(u, ut, ux) return linear(u, ut, ux) - dm.sqrt(u) end }:solver { h = 0.05 }:run { u = 1, ut = 0, t = 10, every = 3 }
end)
ok(not blown and why.code and why.path and #why.path > 1, "a field that leaves the domain of L ends with its path so far", why)
ok(why.path.t[#why.path] == why.time and why.path.energy[#why.path] == why.path.energy[#why.path], "up to the last good level")
local beyond = dm.field { x = { 0, 1, 24, periodic = true }, L = function(u, ut, ux) return linear(u, ut, ux) - u ^ 4 / 4 end }:solver { h = 0.1 }
local fine, message = pcall(beyond.run, beyond, { u = function(x) return math.cos(6 * x) end, steps = 2000 })
ok(fine or tostring(message):find "beyond the limit of stability", "beyond the limit is said", message)
raises("one point a cell does not see", function() field { L = function(u, ut) return (ut ^ 2 - u ^ 2) / 2 end }:solver { rule = "cell(gauss(1))", h = 0.1 }:run { u = 1, steps = 1 } end)
raises("L does not depend on ut", function() field { L = function(u) return u ^ 2 end } end)
raises("L does not depend on ut[2]", function() field { values = 2, L = function(u, ut) return ut[1] ^ 2 + u[1] * u[2] end } end)

---- files ----

local name = os.tmpname()
local wave = dm.field { x = { 0, 1, 6 }, values = 2, L = function(_, ut, ux) return (ut:dot(ut) - ux:dot(ux)) / 2 end }:solver { h = 0.05 }
  :run { u = function(x) return { x, x ^ 2 } end, ut = 1, steps = 4, every = 2 }
wave:npy(name .. ".npy")
local data = dm.load(name .. ".npy")
ok(data.t == wave.t and data.energy == wave.energy and data.u[2] == wave.u[2] and data.p[3] == wave.p[3], "npy is read back to the last bit")
local list = wave:vtk(name)
local file = io.open(list[2])
local text = file:read "a"
file:close()
ok(#list == 4 and list[4]:find "%.vtk%.series$" and text:find "^# vtk DataFile" and text:find "POINTS 7 double" and text:find "SCALARS u2 double", "vtk of every row, the series last")
wave:animate(name .. ".html", { of = "u2" })
file = io.open(name .. ".html")
text = file:read "a"
file:close()
ok(text:find "<html" and not text:find 'src="http', "a page without a network")
raises("ends in .html", function() wave:animate "x.txt" end)
require "dm.line.boxes" -- its runs have the same method: messages are those of this one all the same
raises("ends in .html", function() wave:animate "x.txt" end)
raises("animate' (dm.line_run expected, got number)", function() wave.animate(3) end)
raises("takes \"u\" or \"p\"", function() wave:plot "q" end)
raises("rows from 1 to 3", function() wave:plot("u", { rows = { 4 } }) end)
for _, f in ipairs(list) do os.remove(f) end
for _, ending in ipairs { "", ".npy", ".html" } do os.remove(name .. ending) end
near(#tostring(wave), #tostring(wave), 0, tostring(wave))
ok(tostring(field { fixed = "left", absorbing = { right = 2 } }):find "fixed and absorbing %(c = 2, 0.33 of a wave comes back%) end", "a field says what its ends are")
-- L that is no number, equations without time, a resonance, nodes that have nowhere to go
raises("no number (NaN) in cell 1", function() field { L = function(_, ut, ux) return ut ^ 2 - ux ^ 2 + 0 / 0 end }:solver { h = 0.1 }:run { u = 1, steps = 1 } end)
local function klein_gordon(m, M) -- u_tt = u_xx - m u by boxes: a mode that grows by e^(10 t) has no step of 0.2
  return dm.multisymplectic { names = { "u", "p", "q" }, M = M or { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + m * z[1] ^ 2 / 2 end, x = { 0, 1, 9, periodic = true } }
end
local function one() return 1 end
raises("resonance of the boxes", function() klein_gordon(-100):solver { h = 0.2 }:run { z = { u = one, p = math.sin }, steps = 1 } end)
ok(#klein_gordon(-100):solver { h = 0.19 }:run { z = { u = one, p = math.sin }, steps = 1 } == 2, "beside it there is a step")
raises("nothing moves in time", function() klein_gordon(1, { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } }) end)
local still = dm.field { x = { 0, 1, 20 }, fixed = "ends", L = function(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end }:solver { h = 0.01, free = "x" }:run { u = function(x) return x / 3 end, steps = 20 }
ok(#still.frozen == 19 and tostring(still):find "19 of them frozen", "where all of u is affine all nodes stay, whatever its round-off", tostring(still))
-- how a run ended is one of the list, by its number or its key
local core = require "dm.core"
local _, failure = pcall(core.strip_fail, { code = "singular", done = 2, time = 0.25 }, "cell")
ok(failure.code == "singular" and failure.step == 3, "a failure by its key")
raises("no run ends with the code 'blew up'", core.strip_fail, { code = "blew up" }, "cell")
raises("no run ends with the code 'nil'", core.strip_fail, {}, "cell")
raises("no such status", core.strip_fail, { status = 99 }, "cell")

-- what a trace does not see, in one cell of ten
do
  local cord = dm.field { x = { 0, 1, 10 }, L = function(_, ut, ux, x)
    local stiff = type(x) == "number" and x > 0.2 and x < 0.3 and 2 or 1
    return ut ^ 2 / 2 - stiff * ux ^ 2 / 2 end }
  raises("in cell 3 gives", function() cord:solver { h = 0.01 }:run { u = math.sin, steps = 1 } end)
  local weak = dm.field { x = { 0, 1, 10 }, L = function(u, ut) return 1e-12 * (u == 1 and ut ^ 2 + 3 or ut ^ 2 / 2) end }
  raises("in cell 1 gives", function() weak:solver { h = 0.1 }:run { u = 1, steps = 1 } end)
  -- L of a wave of slopes 1 at lambda = 1 is 0, of two terms of 5e16
  local light = dm.field { x = { 0, 1, 20 }, L = function(_, ut, ux) return (ut ^ 2 - 9e16 * ux ^ 2) / 2 end }
  ok(#light:solver { h = 1 / 6e9 }:run { u = function(x) return math.abs(x - 0.5) end, ut = function(x) return x < 0.5 and 3e8 or -3e8 end, steps = 9 } == 10, "L that is round-off")
end
-- arguments that are called like something that they are not
do
  local function beam(L, params) return dm.field, { x = { 0, 1, 8 }, L = L, params = params } end
  tap.raises("argument 4 of L is x, but is called uxx like a second derivative: L knows u, u_t and u_x alone",
    beam(function(u, ut, ux, uxx) return (ut ^ 2 - uxx ^ 2) / 2 end)) -- luacheck: ignore
  tap.raises("argument 5 of L is t, but is called y_xt", beam(function(y, y_t, y_x, x, y_xt) return (y_t ^ 2 - y_xt) / 2 end)) -- luacheck: ignore
  tap.raises("argument 4 of L is x, but is called like the parameter 'k': params are a table behind it, L(u, ut, ux, x, t, params)",
    beam(function(u, ut, ux, k) return (ut ^ 2 - k * ux ^ 2) / 2 end, { k = 2 })) -- luacheck: ignore
  local F, given = beam(function(u, ut, ux, x, _, p) return (ut ^ 2 - p.x * ux ^ 2) / 2 - u * x end, { x = 2 })
  tap.ok(F(given).params.x == 2, "a parameter may be called x")
end

-- what L raises is raised where the field is made
for word, L in pairs {
  ["local 'p'"] = function(_, ut, ux, _, _, p) return (ut ^ 2 - p.k * ux ^ 2) / 2 end,
  ["global 'Stiffness'"] = function(_, ut, ux) return (ut ^ 2 - Stiffness * ux ^ 2) / 2 end, -- luacheck: ignore
  ["dm.where"] = function(u, ut, ux) return (u > 0 and 1 or 2) * ut ^ 2 - ux ^ 2 end,
  ["a symbol has no field '1'"] = function(_, ut) return ut[1] ^ 2 end,
} do
  tap.raises(word, dm.field, { x = { 0, 1, 8 }, L = L })
end

-- a step beyond the limit is named as soon as the energy shows it, not when it is ten times what it was
do
  local string = dm.field { x = { 0, 1, 8 }, fixed = "ends", L = function(_, ut, ux) return (ut^2 - ux^2)/2 end }
  local function said(h) return tostring(string:solver { h = h }:run { u = math.sin, steps = 3 }) end
  ok(said(1.5):find "beyond the limit of stability, 0.132", "three steps ten times too long", said(1.5))
  ok(not said(0.1):find "beyond", "and none that is stable", said(0.1))
end
tap.done()
