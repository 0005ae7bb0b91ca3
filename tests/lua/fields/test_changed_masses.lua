-- what L of a field reads changes after K:field: masses that no rule steps are told; modes and
-- limits ask for t where L depends on it, not where a force alone does
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = math.sin, math.cos

local plate = dm.mesh { triangle = 3 }
local function still() return 0 end
local function side(x) return x end
local start = { q = side, v = still, steps = 3 }

local m = 1
local wave = plate:field { L = function(u, v) return m * v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
local solver = wave:solver { rule = "verlet", h = 0.01 }
local limit = wave:stability_limit "verlet"
solver:run(start)
m = 4
near(wave:stability_limit "verlet", 2 * limit, 1e-12, "four times the mass, twice the limit")
ok(solver:run(start).p[4] == plate:field { L = function(u, v) return 4 * v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
  :solver { rule = "verlet", h = 0.01 }:run(start).p[4], "runs follow")
m = -1
for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "rk4", "avi", "yoshida(4)" } do
  raises("negative mass now", function()
    wave:solver { rule = rule, h = 0.01 }:run { q = side, v = still, t = 0.03 }
  end)
end
raises("negative mass now", function() solver:run(start) end)
raises("negative mass now", function() wave:modes(2) end)
raises("negative mass now", function() wave:stability_limit "verlet" end)
m = 0
raises("no mass now", function() wave:modes(2) end)
raises("no mass now", function() wave:stability_limit "verlet" end)
m = 1
near(wave:stability_limit "verlet", limit, 1e-14, "and back")

-- values that were eliminated get a mass
local extra = 0
local square = dm.mesh { grid = 2 }
local zeros = square:form(1, function() return { 0, 0 } end)
local grid = square:field { form = 1, massless = "eliminate",
  L = function(A, V) return V:dot(V) / 2 + extra * square:sum(1, function(v) return v ^ 2 end, V) - A:d():dot(A:d()) / 2 end }
grid:solver { rule = "verlet", h = 0.01 }:run { q = zeros, v = zeros, steps = 1 }
extra = 1
raises("have a mass now", function() grid:solver { rule = "verlet", h = 0.01 }:run { q = zeros, v = zeros, steps = 1 } end)
raises("have a mass now", function() grid:modes(2) end)

-- unit vectors with one mass each
local skew = 0
local map = plate:field { values = 3, on = dm.S(2), L = function(u, v)
  return v:dot(v) / 2 + skew * plate:sum(0, function(w, cell) return cell.star * w[1] ^ 2 end, v) - u:d():dot(u:d()) / 2 end }
local turning = { q = function(x, y) return { cos(x), sin(x) * cos(y), sin(x) * sin(y) } end, v = function() return { 0, 0, 0 } end, steps = 1 }
map:solver { rule = "rattle", h = 0.01 }:run(turning)
skew = 1
raises("unlike masses now", function() map:solver { rule = "rattle", h = 0.01 }:run(turning) end)

-- a force that depends on t leaves modes and limits of L alone
local pushed = plate:field { force = function(A, V, t) return cos(t) * A:map(function() return 1 end) - V end,
  L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
near(pushed:stability_limit "verlet", limit, 1e-14, "the limit of L without t")
near(pushed:modes(3).values[3], wave:modes(3).values[3], 1e-12, "and its modes")
local timed = plate:field { L = function(u, v, t) return v:dot(v) / 2 - (1 + t) * u:d():dot(u:d()) / 2 end }
local inside = plate:field { L = function(u, v, t) return v:dot(v) / 2 - plate:sum(1, function(a, cell) return cell.star * (1 + t) * a ^ 2 / 2 end, u:d()) end }
for name, field in pairs { ["a factor"] = timed, ["in a sum"] = inside } do
  raises("L depends on t", function() field:stability_limit "verlet" end)
  near(field:stability_limit("verlet", { t = 3 }), limit / 2, 1e-12, name .. " of t")
end
tap.done()
