-- theory of maps of fields along the orbit: what changes in time, what changes with the state, how far it was looked at
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sqrt, exp = math.sqrt, math.exp

local function waves(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local plate = dm.mesh { triangle = 3 }
local wave = plate:field { form = 0, L = waves }
local square = (2 / wave:stability_limit "verlet") ^ 2

-- a spring that is stiff for a short while: square + max k
local function k(t, e) return 400 * e(-((t - 1.3) / 0.2) ^ 2) end
local driven = plate:field { form = 0, L = function(u, v, t) return waves(u, v) - k(t, dm.exp) * u:dot(u) / 2 end }
local function map_of(field, h, T, q, v)
  return dm.stability { field, rule = "verlet", h = { h, 4 * h }, t = T, q = function() return q end, v = function() return v end, accuracy = false }
end
local map = map_of(driven, 0.005, 4, 0, 1)
local limit, why = map:theory(1)
near(limit, 2 / sqrt(square + 400), 1e-3 * limit, "the stiffest time of a field is found")
ok(why:find "largest along the orbit" and not why:find "seen up to", "along all of it", why)
near(2 / driven:stability_limit("verlet", { t = 0.9 }), sqrt(square + k(0.9, exp)), 1e-9 * sqrt(square), "about a time")

-- u'' = -u^3 at every vertex, from 0 with v: u^4 = 2 v^2 where it turns, square + 3 u^2 there. Eight even places over 16 half periods meet 0 alone.
local u = (2 * 30 ^ 2) ^ (1 / 4)
local half = sqrt(2) * 2.622057554292119 / u -- half a period, by the lemniscate constant
local quartic = plate:field { form = 0, L = function(w, v) return waves(w, v) - plate:sum(0, function(a, cell) return cell.star * a ^ 4 / 4 end, w) end }
local run = quartic:solver { rule = "verlet", h = 1e-3 }:run { q = function() return 0 end, v = function() return 30 end, t = half }
near(run.q[#run][1], 0, 0.1, "half a period")
map = map_of(quartic, half / 200, 16 * half, 0, 30)
limit = map:theory(1)
local exact = 2 / sqrt(square + 3 * u ^ 2)
ok(limit >= exact * (1 - 1e-3) and limit <= 1.03 * exact, "the stiffest state of a field is found between even times", limit / exact)

-- more steps than are looked at: that is said
map = map_of(quartic, half / 200, 24 * half, 0, 30)
local _, told = map:theory(1)
ok(told:find "seen up to t0 %+ ", "up to where it was looked at", told)
tap.done()
