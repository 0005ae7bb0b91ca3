-- explicit Runge-Kutta rules with a force beside L: closed form, orders, backends, a mass that varies, what they refuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local exp, cos, sin, sqrt, abs, log = math.exp, math.cos, math.sin, math.sqrt, math.abs, math.log

-- x'' + 0.2 x' + x = 0
local damped = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end,
  force = function(_, v) return { -0.2 * v[1] } end }
local w = sqrt(1 - 0.01)
local exact = exp(-1) * (cos(10 * w) + 0.1 / w * sin(10 * w))

local function at_ten(rule, h, backend)
  local path = damped:solver { rule = rule, h = h, backend = backend }:run { q = { 1 }, v = { 0 }, t = 10, every = 1000 }
  return path.q[#path][1]
end
for _, case in ipairs { { "rk4", 4 }, { "rkf45", 5 }, { "rk8pd", 8 }, { "rk8", 8 } } do
  local rule, order = table.unpack(case)
  local coarse, fine = abs(at_ten(rule, 0.5) - exact), abs(at_ten(rule, 0.25) - exact)
  local slope = log(coarse / fine, 2)  -- an equation that is linear may be treated better than any
  ok(slope > order - 0.6 and slope < order + 1.3, rule .. " keeps its order with a force", slope)
  near(at_ten(rule, 0.05), exact, 2e-8, rule .. ": the damped oscillator in closed form")
  ok(at_ten(rule, 0.25, "tape") == at_ten(rule, 0.25, "jit"), rule .. ": the same bits on both backends")
end

-- a mass that varies, a force that sees q, v and t: against Gauss, which shares no code of the step
local arm = dm.system { Q = dm.R(2),
  L = function(q, v) return v:dot(v) / 2 + v[1] * v[2] * cos(q[1] - q[2]) / 2 + cos(q[1]) + cos(q[2]) end,
  force = function(q, v, t) return { -0.2 * v[1] + 0.1 * sin(t), -0.1 * v[2] * q[1] } end }
local function arm_end(rule, h)
  local path = arm:solver { rule = rule, h = h }:run { q = { 1, 0.4 }, v = { 0, 0.3 }, t = 10, every = 10000 }
  return path.q[#path]
end
local goal = arm_end("gauss(6)", 0.05)
for rule, bound in pairs { rk4 = 1e-9, rkf45 = 1e-9, rk8pd = 1e-13, rk8 = 1e-13 } do
  near((arm_end(rule, 0.02) - goal):norm(), 0, bound, rule .. " with a mass that varies")
end

-- changed upvalues of the force alone are picked up, although L is the same
local c = 0.2
local changing = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end,
  force = function(_, v) return { -c * v[1] } end }
local solver = changing:solver { rule = "rk8", h = 0.1 }
local first = solver:run { q = { 1 }, v = { 0 }, t = 10 }
c = 0
local second = solver:run { q = { 1 }, v = { 0 }, t = 10 }
near(first.q[#first][1], exact, 1e-11, "one force")
near(second.q[#second][1], cos(10), 1e-11, "another one, in the next run of the same solver")

raises("knows no controls", function()
  dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end, control = function(q) return { -q[1] } end,
    force = function(_, _, _, u) return { u[1] } end }:solver { rule = "rk8", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 1 }
end)
raises("knows no", function()
  dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, constraint = function(q) return q:dot(q) - 1 end }
    :solver { rule = "rk4", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1 }
end)
raises("without constraints and forces", function()
  damped:solver { rule = "gauss(2, 3)", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 1 }
end)
tap.done()
