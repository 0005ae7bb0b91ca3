-- system:independent: constraints that follow from the others are left out, those that do so in one position only are not
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin = math.cos, math.sin

local function free(_, v) return v:dot(v) / 2 end
local function point(q, i) return q:slice(2 * i - 1, 2 * i) end
local function square_of(a) return a:dot(a) end

-- doubled: the pendulum once
local function pendulum(constraint)
  return dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, constraint = constraint }
end
local once, numbers = pendulum(function(q) return { q:dot(q) - 1, 2 * q:dot(q) - 2 } end):independent { q = { 1, 0 } }
ok(#numbers == 1 and numbers[1] == 2 and once:structure().constraints == 1, "a doubled constraint is left out")
local path = once:solver({ rule = "gauss(3)", h = 0.05 }):run { q = { 1, 0 }, v = { 0, 0.7 }, t = 10 }
near(path.q[#path][1], cos(0.7 * path.t[#path]), 1e-10, "and the rest moves as it should")
local same = pendulum(function(q) return q:dot(q) - 1 end)
once, numbers = same:independent { q = { 1, 0 } }
ok(once == same and #numbers == 0, "nothing is left out where nothing depends")

-- a square with both diagonals is rigid with one of its six distances less; it turns
local square = dm.system { Q = dm.R(8), L = free, constraint = function(q)
  local out = {}
  for i = 1, 4 do
    for k = i + 1, 4 do out[#out + 1] = square_of(point(q, i) - point(q, k)) - (k - i == 2 and 4 or 2) end
  end
  return out
end }
local q, v = {}, {}
for i = 0, 3 do
  q[2 * i + 1], q[2 * i + 2] = cos(i * math.pi / 2), sin(i * math.pi / 2)
  v[2 * i + 1], v[2 * i + 2] = -0.4 * q[2 * i + 2], 0.4 * q[2 * i + 1]
end
raises("system:independent{ q = } does so", function()
  square:solver({ rule = "rattle", h = 0.05 }):run { q = q, v = v, steps = 1 }
end)
once, numbers = square:independent { q = q }
ok(#numbers == 1 and numbers[1] == 6, "the sixth distance of a square", numbers[1])
path = once:solver({ rule = "lobatto(4)", h = 0.05 }):run { q = q, v = v, t = 10 }
local worst = 0
for i = 1, #path do
  worst = math.max(worst, (path.q[i]:slice(7, 8) - dm.vector { sin(0.4 * path.t[i]), -cos(0.4 * path.t[i]) }):norm())
end
near(worst, 0, 1e-10, "turns as a rigid body")

-- a parallelogram with a third bar passes its flat position, where one more row depends
local function flat(x)
  local a, b, c = point(x, 1), point(x, 2), point(x, 3)
  return { square_of(a) - 1, square_of(b - dm.vector { 2, 0 }) - 1, square_of(a - b) - 4, c[1] - (a[1] + b[1]) / 2,
    c[2] - (a[2] + b[2]) / 2, square_of(c - dm.vector { 1, 0 }) - 1 }
end
local bars = dm.system { Q = dm.R(6), L = free, constraint = flat }
local function at(s) return { cos(s), sin(s), 2 + cos(s), sin(s), 1 + cos(s), sin(s) } end
once, numbers = bars:independent { q = at(1) }
ok(#numbers == 1 and numbers[1] == 6, "the third bar of a parallelogram", numbers[1])
for _, rule in ipairs { "lobatto(3)", "gauss(3)" } do
  path = once:solver({ rule = rule, h = 0.05 }):run { q = at(1), v = dm.vector { -sin(1), cos(1), -sin(1), cos(1), -sin(1), cos(1) }, t = 20 }
  near(path.q[#path][4], sin(1 + path.t[#path]), 1e-5, rule .. " goes through flat positions")
end

-- in time
once, numbers = pendulum(function(x, t) return { x[1] - dm.sin(t), 2 * x[1] - 2 * dm.sin(t) } end):independent { q = { 0, 0 } }
ok(numbers[1] == 2, "that depends on time")
raises("contradict each other", function() pendulum(function(x) return { x:dot(x) - 1, x:dot(x) - 2 } end):independent { q = { 1, 0 } } end)
raises("at this q only", function() pendulum(function(x, t) return { x[1] - dm.sin(t), x[1] - t } end):independent { q = { 0, 0 } } end)

-- a straight bar of three points: without the third distance it would bend
local bar = dm.system { Q = dm.R(6), L = free, constraint = function(x)
  return { square_of(point(x, 1) - point(x, 2)) - 1, square_of(point(x, 2) - point(x, 3)) - 1, square_of(point(x, 1) - point(x, 3)) - 4 }
end }
raises("constraint 3 depends on those before it at this q only", function() bar:independent { q = { 0, 0, 1, 0, 2, 0 } } end)

-- on another branch what was left out does not hold: runs say so
local cross = pendulum(function(x) return { x[1] * x[2], 2 * x[2] } end)
once, numbers = cross:independent { q = { -1, 0 } }
ok(numbers[1] == 2, "y = 0 where x y = 0 and x is not 0")
raises("constraint 2, which was left out as dependent", function()
  once:solver({ rule = "rattle", h = 0.05 }):run { q = { 0, 1 }, v = { 0, 0.1 }, steps = 3 }
end)

raises("has no constraint", function() dm.system { Q = dm.R(2), L = free }:independent { q = { 1, 0 } } end)
raises("'q'", function() cross:independent {} end)
raises("2 numbers", function() cross:independent { q = { 1 } } end)
raises("did you mean", function() cross:independent { q = { 1, 0 }, tt = 1 } end)
tap.done()
