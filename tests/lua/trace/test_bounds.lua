-- f:bounds: interval arithmetic encloses a function, closes in on it, and says where it leaves its domain
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local exp, sin, cos, sqrt, pi, huge = math.exp, math.sin, math.cos, math.sqrt, math.pi, math.huge
local function of(f) return dm.trace(f, "number") end

-- every value at points of the box is inside, for functions of every kind
local functions = {
  function(x) return x ^ 3 - 2 * x ^ 2 + 1 / (x ^ 2 + 1) end, function(x) return sin(3 * x) * exp(-x ^ 2) end, function(x) return sqrt(x ^ 2 + 1) - cos(x) end,
  function(x) return dm.log(x ^ 2 + 0.1) * dm.atan(x) end, function(x) return dm.tanh(2 * x) + dm.abs(x - 0.3) end, function(x) return dm.cosh(x) - dm.sinh(x) end,
  function(x) return dm.min(x, 0.5) * dm.max(x, -0.25) end, function(x) return dm.atan(x + 3, x - 1) end, function(x) return (x ^ 2 + 0.5) ^ -1.5 end,
  function(x) return dm.where(x - 0.1, x, -x) end, function(x) return dm.tan(x / 4) + dm.asin(x / 4) + dm.acos(x / 5) end, function(x) return dm.sign(x) * x ^ -2 end }
math.randomseed(7)
for k, g in ipairs(functions) do
  local f, inside, width = of(g), true, 0
  for _ = 1, 200 do
    local a = 4 * math.random() - 2
    local b = a + 2 * math.random() ^ 4
    local lo, hi = f:bounds(a, b)
    for i = 0, 20 do
      local x = math.min(b, a + (b - a) * i / 20)
      local fine, y = pcall(f, x)
      inside = inside and lo <= hi and (not fine or (lo <= y and y <= hi))
    end
    local low, high = f:bounds(1.2, 1.2 + 1e-6)
    width = high - low
  end
  ok(inside, "function " .. k .. " never leaves its bounds")
  ok(width < 1e-4, "which close in on it", width)
end

-- narrow pulses, poles, domains
local pulse = of(function(t) return 2000 * exp(-((t - 5.1) / 1e-4) ^ 2) end)
local lo, hi = pulse:bounds(0, 10)
ok(lo <= 0 and hi >= 2000 and hi < 2000.001, "a narrow pulse is seen by the bounds", hi)
lo, hi = pulse:bounds(0, 5)
ok(lo <= 0 and hi < 1e-300, "where it is not they vanish", hi)
lo, hi = of(function(x) return 1 / x end):bounds(-1, 1)
ok(lo == -huge and hi == huge, "a pole is infinite")
local over = of(function(x) return (x + 4) / x end)
lo, hi = over:bounds(-1, 0)
ok(lo == -huge and hi < 0 and hi >= -3, "a pole at the end of a box goes one way", hi)
lo, hi = over:bounds(0, 1)
ok(hi == huge and lo > 0 and lo <= 5, "and the other way", lo)
lo, hi = of(function(x) return sqrt(x) end):bounds(-1, 4)
ok(lo == -huge and hi == huge, "so is what may be outside the domain")
lo, hi = of(function(x) return sin(x) end):bounds(0, pi)
ok(lo <= 0 and lo > -1e-15 and hi == 1, "extremes inside are met", hi)
lo, hi = of(function(x) return x * x end):bounds(-1, 2)
ok(lo == 0 and hi >= 4 and hi < 4 + 1e-14, "a square is not negative", lo)

-- vectors and several arguments
local f = dm.trace(function(q, v, t) return dm.vector { q[1] * v[2], q:norm() + t } end, 2, 2, "number")
local low, high = f:bounds({ { 3, 4 }, { 0, -1 }, 0 }, { { 3, 4 }, { 0, 2 }, 1 })
near(low[1], -3, 1e-14, "lists of arguments, a list of results")
near(high[1], 6, 1e-14, "with an entry for each")
ok(low[2] <= 5 and high[2] >= 6 and high[2] < 6 + 1e-14, "entry by entry")
raises("lo must be at most hi", pulse.bounds, pulse, 2, 1)
raises("lo must be at most hi", pulse.bounds, pulse, 0 / 0, 1)
raises("must be a number", pulse.bounds, pulse, {}, 1)
raises("list of 3 arguments", f.bounds, f, 1, 2)
raises("2 numbers", f.bounds, f, { { 1 }, { 0, 0 }, 0 }, { { 1, 2 }, { 0, 0 }, 0 })
-- a value that only an equation defines can be anything; what does not hang on it is bounded
local depth = dm.root { name = "depth", start = 0, equations = function(z, x) return z + 0.2 * dm.sin(z) - 0.3 * x end }
low, high = dm.trace(function(x) return depth(x[1]) end, 1):bounds({ 0 }, { 1 })
ok(low == -math.huge and high == math.huge, "a root of an equation", ("%s %s"):format(low, high))
low, high = dm.trace(function(x) return dm.vector { depth(x[1]), x[1] + 1 } end, 1):bounds({ 0 }, { 1 })
ok(low[1] == -math.huge and low[2] <= 1 and high[2] >= 2 and high[2] < 2 + 1e-14, "beside one that is none")

-- where a function passes to another formula, and where a line is clear of such places
local breaks, edges = dm.trace(function(x)
  return dm.where(x[1] - 3, dm.sqrt(x[2] + 1), dm.abs(x[1] + x[2])) + dm.max(x[1], 2 * x[2])
    + x[1] ^ 2
end, 2):breaks()
local found = breaks { 10, 4 }:totable()
table.sort(found)
ok(table.concat(found, " ") == "2.0 7.0 14.0", "operands of where, abs, max", table.concat(found, " "))
near(edges { 10, 4 }[1], 5, 0, "what a root is of must be > 0")
breaks, edges = dm.trace(function(x) return x[1] * dm.sin(x[2]) end, 2):breaks()
ok(breaks == false and edges == false, "one formula")
f = dm.trace(function(x) return dm.vector { x[1] - 3, x[1] ^ 2 + x[2] ^ 2 - 25, x[2] - x[2] + 1e-30 } end, 2)
local clear = f:clear({ 0, 0 }, { 1, 0 }, 100, 1e-3)
-- zeros at t = -5, 3, 5
local at, wide = { -100, -5, -5, 3, 3, 5, 5, 100 }, 0
for i, t in ipairs(at) do wide = math.max(wide, math.abs(clear[i] - t)) end
ok(#clear == #at and wide < 0.02, "intervals between zeros", table.concat(clear, " "))
-- bounds of sin(50 t) - sin(50 t) say nothing: that entry is left out, the other is not
local noise = dm.trace(function(x)
  return dm.vector { dm.sin(50 * x[1]) * dm.cos(x[2]) - dm.sin(50 * x[1]) * dm.cos(x[2]) ^ 3 + 1e-9, x[1] - 1 }
end, 2)
clear = noise:clear({ 0, 0 }, { 1, 0 }, 100, 1e-3)
ok(#clear == 4 and math.abs(clear[2] - 1) < 0.01 and math.abs(clear[3] - 1) < 0.01, "vague ones are left out",
  table.concat(clear, " "))
raises("a function of one vector", pulse.clear, pulse, 1, 2, 3, 4)
raises("a finite length", noise.clear, noise, { 0, 0 }, { 1, 0 }, 1 / 0, 1e-3)
raises("must be finite", noise.clear, noise, { 0, 0 }, { 0 / 0, 0 }, 1, 1e-3)
raises("at least 1e-9", noise.clear, noise, { 0, 0 }, { 1, 0 }, 1, 0)
tap.done()
