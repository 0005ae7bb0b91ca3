-- free knots: figures, equipartition, slopes at knots, against an independent search; refusals
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local exp, abs = math.exp, math.abs

local function half(s) return s ^ 2 / 2 end
local r = dm.adapt { W = half, f = function(x) return -16 * exp(4 * x) end, x = { 0, 1, 6 }, ends = { 1, exp(4) } }
near(r.x[2], 0.436012123441674, 1e-10, "first free knot")
near(r.x[6], 0.936510712901791, 1e-10, "last")
local inside = 0
for i = 2, 6 do inside = math.max(inside, abs(r.force[i])) end
ok(inside < 1e-12 * r.energy * 100, "no force on inner knots", inside)
-- nodal values are exact, and u' at a knot is the mean of the slopes beside it: u = exp(4 x)
for i = 2, 6 do
  local function slope(e) return (r.u[e + 1] - r.u[e]) / (r.x[e + 1] - r.x[e]) end
  near(r.u[i] / exp(4 * r.x[i]), 1, 1e-12, ("value at knot %d"):format(i))
  near((slope(i - 1) + slope(i)) / 2 / (4 * exp(4 * r.x[i])), 1, 1e-8, ("slope at knot %d"):format(i))
end
local equal = dm.adapt { W = half, f = function(x) return -16 * exp(4 * x) end, x = { 0, 1, 1 }, ends = { 1, exp(4) } }
ok(#equal.x == 2 and equal.energy > r.energy, "one element has no knots to move")
-- one knot: the least energy of a scan, u given at the knot by its exact value
local function energy(X)
  local u = { 1, exp(4 * X), exp(4) }
  local x, sum = { 0, X, 1 }, 0
  for e = 1, 2 do
    local a, b, ua, ub = x[e], x[e + 1], u[e], u[e + 1]
    local s = (ub - ua) / (b - a)
    -- integral of 16 exp(4x) (ua + s (x - a)) = [4 exp(4x) (ua + s (x - a)) - s exp(4x)]
    sum = sum + (b - a) * s ^ 2 / 2 + 4 * exp(4 * b) * ub - s * exp(4 * b) - 4 * exp(4 * a) * ua + s * exp(4 * a)
  end
  return sum
end
local best, least = 0, math.huge
for k = 1, 99999 do local X = k / 1e5 if energy(X) < least then best, least = X, energy(X) end end
local one = dm.adapt { W = half, f = function(x) return -16 * exp(4 * x) end, x = { 0, 1, 2 }, ends = { 1, exp(4) } }
near(one.x[2], best, 1e-5, "one knot against a scan")
near(one.energy, least, 1e-7, "and its energy")
-- a load of no simple kind: f is integrated to round-off; a free end has no slope
local wave = dm.adapt { W = function(s) return half(s) + s ^ 4 end, f = function(x) return 20 * dm.sin(9 * x) end, x = { 0, 1, 40 }, ends = { 0, "free" } }
ok(wave.exact, "a wavy load is integrated to round-off")
inside = 0
for i = 2, 40 do inside = math.max(inside, abs(wave.force[i])) end
ok(inside < 1e-10, "40 knots at rest", inside)
-- without f: W - s W_s is equal on all elements; u is affine, and said
local affine = dm.adapt { W = function(s) return dm.sqrt(1 + s ^ 2) end, x = { 0, 1, 5 }, ends = { 0, 1 } }
ok(#affine.frozen == 4, "knots of an affine solution are frozen and named")
near(affine.energy, math.sqrt(2), 1e-14, "the straight line is shortest")
-- the layer -u'' = f, u = x - (e^(-(1-x)/e) - e^(-1/e))/(1 - e^(-1/e)), e = 0.05: knots gather at 1
local e = 0.05
local layer = dm.adapt { W = half, f = function(x) return exp(-(1 - x) / e) / (e ^ 2 * (1 - exp(-1 / e))) end, x = { 0, 1, 8 }, ends = { 0, 0 } }
ok(layer.x[2] > 0.8, "knots gather at a layer", layer.x[2])
near(layer.u[4], layer.x[4] - (exp(-(1 - layer.x[4]) / e) - exp(-1 / e)) / (1 - exp(-1 / e)), 1e-12, "values are those of the solution")
-- a steep line under a small bend: W'' is nearly constant, 1 + 12 s^2 at s = 53.6, so the knots are those of s^2/2
do
  local function steep(W) return dm.adapt { W = W, f = function(x) return -16 * exp(4 * x) end, x = { 0, 1, 12 }, ends = { 1, exp(4) } } end
  local quartic = steep(function(s) return half(s) + s ^ 4 end)
  local quadratic = steep(half)
  local off, force = 0, 0
  for i = 2, 12 do
    off = math.max(off, abs(quartic.x[i] - quadratic.x[i]))
    force = math.max(force, abs(quartic.force[i]))
  end
  ok(off < 1e-4, "knots along a steep line", off)
  ok(force < 1e-14 * abs(quartic.force[1]) and quartic.iterations < 60, "at rest to round-off, in few iterations", force)
end
-- u is affine beside the knot where f is 0, on equal elements alone: it moves with the others
do
  local bend = dm.adapt { W = half, f = function(x) return 10 * (x - 0.4) end, x = { 0, 1, 10 }, ends = { 0, 0 } }
  local force = 0
  for i = 2, 10 do force = math.max(force, abs(bend.force[i])) end
  ok(force < 1e-13 and #bend.frozen == 0, "a knot that was affine at first is at rest in the end", force)
end
-- a narrow load is seen before knots move: values at knots are those of -u'' = f, u(0) = 0 = u'(1)
do
  local narrow = dm.adapt { W = half, f = function(x) return exp(-(40 * (x - 0.37)) ^ 2) end, x = { 0, 1, 6 }, ends = { 0, "free" } }
  local most, steps = 0, 20000
  for i = 2, 7 do -- u(X) = integral of min(s, X) f(s), by Simpson's rule
    local X, sum = narrow.x[i], 0
    for _, part in ipairs { { 0, X }, { X, 1 } } do
      local w = (part[2] - part[1]) / steps
      for k = 0, steps do
        local y = part[1] + k * w
        sum = sum + w / 3 * (k % steps == 0 and 1 or 2 + 2 * (k % 2)) * math.min(y, X) * exp(-(40 * (y - 0.37)) ^ 2)
      end
    end
    most = math.max(most, abs(narrow.u[i] - sum))
  end
  ok(narrow.exact and most < 1e-13, "a narrow load is integrated to round-off", most)
end
-- narrow loads on few or many elements: u solves -u'' = f at the knots, and no knot gains by moving
for _, case in ipairs { { 0.7316, 0.0027, 15, 5, -0.15 }, { 0.2206, 0.044, 0.106, 8, 0.39 }, { 0.5, 1e-4, 1, 3, 0 }, { 0.853, 0.003, 9, 20, 0 } } do
  local c, width, top, n, first = table.unpack(case)
  local r = dm.adapt { W = half, f = function(x) return top * exp(-((x - c) / width) ^ 2) end, x = { 0, 1, n }, ends = { first, "free" } }
  local off, force = 0, 0
  for i = 2, n + 1 do
    local sum, steps = 0, 40000 -- u(X) = first + integral of min(s, X) f(s) by the midpoint rule, where f is not 0
    for k = 1, steps do
      local y = c + (k - 0.5 - steps / 2) / steps * 16 * width
      if y < 1 then sum = sum + 16 * width / steps * math.min(y, r.x[i]) * top * exp(-((y - c) / width) ^ 2) end
    end
    off = math.max(off, abs(r.u[i] - first - sum) / (top * width))
    force = i <= n and math.max(force, abs(r.force[i])) or force
  end
  ok(r.exact and off < 1e-6 and force < 1e-11 * (top * width) ^ 2, ("a load of width %g on %d elements"):format(width, n), force / (top * width) ^ 2)
end
-- a load that jumps, one that grows beyond all bounds at an end
local jump = dm.adapt { W = half, f = function(x) return dm.where(x - 0.37, 1, 0) end, x = { 0, 1, 5 }, ends = { 0, 0 } }
ok(jump.exact and abs(jump.force[2]) + abs(jump.force[3]) + abs(jump.force[4]) + abs(jump.force[5]) < 1e-14, "a load that jumps")
local root = dm.adapt { W = half, f = function(x) return x ^ -0.5 end, x = { 0, 1, 3 }, ends = { 0, 0 } }
near(root.u[2], 4 / 3 * (root.x[2] - root.x[2] ^ 1.5), 1e-9, "a load with a pole at an end")
-- any units of x, u and the energy: the same knots
do
  local function in_units(x, u, e)
    return dm.adapt { W = function(s) return e / x * (half(x / u * s) + (x / u * s) ^ 4 / 20) end, f = function(y) return e / (x * u) * (3 + 5 * y / x) end,
      x = { 0, x, 12 }, ends = { 0, 0.7 * u } }
  end
  local one = in_units(1, 1, 1)
  for _, units in ipairs { { 1e6, 1, 1 }, { 1, 1e-6, 1 }, { 1, 1, 1e-12 }, { 1e-9, 1e3, 1e-20 }, { 1e3, 1e-9, 1e20 } } do
    local a, most = in_units(table.unpack(units)), 0
    for i = 1, 13 do most = math.max(most, abs(a.x[i] / units[1] - one.x[i]), abs(a.u[i] / units[2] - one.u[i])) end
    ok(most < 1e-12 and abs(a.energy / units[3] - one.energy) < 1e-13, ("units %g, %g, %g"):format(table.unpack(units)), most)
  end
end
raises("it falls the more u grows", function()
  dm.adapt { W = function(s) return dm.sqrt(1 + s ^ 2) end, f = function(x) return 10 * (x - 0.4) end, x = { 0, 1, 5 }, ends = { -0.83, "free" } }
end)
raises("option 'ends'", function() dm.adapt { W = half, x = { 0, 1, 4 }, ends = { 0 } } end)
raises("has '3' beside", function() dm.adapt { W = half, x = { 0, 1, 4 }, ends = { 0, 1, 2 } } end)
raises("not finite on the first knots", function() dm.adapt { W = half, x = { 0, 1, 4 }, ends = { 1e300, -1e300 } } end)
raises("u is determined at one end at least", function() dm.adapt { W = half, x = { 0, 1, 4 }, ends = { "free", "free" } } end)
raises("option 'W' is missing", function() dm.adapt { x = { 0, 1, 4 }, ends = { 0, 1 } } end)
raises("is W convex", function() dm.adapt { W = function(s) return (s ^ 2 - 1) ^ 2 end, x = { 0, 1, 4 }, ends = { 0, 0 } } end)
raises("from 1 to", function() dm.adapt { W = half, x = { 0, 1, 0 }, ends = { 0, 1 } } end)
raises("not finite on the first knots", function() dm.adapt { W = half, f = function(x) return dm.log(x - 2) end, x = { 0, 1, 3 }, ends = { 0, 1 } } end)
raises("the knots 2 and 3 meet", function()
  dm.adapt { W = function(s) return (s ^ 2 - 1) ^ 2 end, f = function(x) return 0.1 * x end, x = { 0, 1, 4 }, ends = { 0, 0 } }
end)
tap.done()
