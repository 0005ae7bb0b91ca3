-- Which functions should the curve of a step be made of (Leok 5.2)? Those that the motion is like.
-- A variational integrator takes any space of functions with any quadrature. A pendulum that swings
-- little is nearly cos t, sin t: four functions {1, t, cos t, sin t} against four powers of t.
local dm = require "dm"
local cos, sin, abs, max = math.cos, math.sin, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/own_space.png"

local pendulum = dm.system { name = "pendulum", Q = dm.R(1), coordinates = { "angle" },
  L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local spaces = {
  waves = dm.galerkin { functions = function(t) return { 1, t, cos(t), sin(t) } end, quadrature = "gauss(8)" },
  powers = dm.galerkin { functions = function(t) return { 1, t, t ^ 2, t ^ 3 } end, quadrature = "gauss(8)" },
}
local h, steps = 1, 20  -- two thirds of a second: six steps a swing
-- largest error of the angle from a release at an angle, against steps that resolve all
local function error_of(rule, angle)
  local start = { q = { angle }, v = { 0 } }
  local path = pendulum:solver { rule = rule, h = h }:run { q = start.q, v = start.v, steps = steps }
  local truth = pendulum:solver { rule = "gauss(8)", h = h / 4 }:run { q = start.q, v = start.v, steps = 4 * steps, every = 4 }
  local worst = 0
  for i = 1, #path do worst = max(worst, abs(path.q[i][1] - truth.q[i][1])) end
  return worst / angle
end

local angles, errors = {}, { waves = {}, powers = {} }
for i = 1, 24 do
  angles[i] = 0.02 * 1.22 ^ (i - 1)
  for name, rule in pairs(spaces) do errors[name][i] = error_of(rule, angles[i]) end
end
print(("released at %.2f rad: waves off by %.1e of it, powers by %.1e"):format(angles[1], errors.waves[1], errors.powers[1]))
print(("released at %.2f rad: waves off by %.1e of it, powers by %.1e"):format(angles[24], errors.waves[24], errors.powers[24]))
assert(errors.waves[1] < errors.powers[1] / 1000, "small swings are in the space")
assert(errors.waves[1] < 2e-8 and errors.powers[24] < 0.1)

-- the limit: {1, cos, sin} steps its own oscillator exactly, half a period at a time
local exact = dm.galerkin { functions = function(t) return { 1, cos(3 * t), sin(3 * t) } end, quadrature = "gauss(12)" }
local spring = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - 4.5 * q[1] ^ 2 end }
local path, off = spring:solver { rule = exact, h = math.pi / 3 }:run { q = { 1 }, v = { 0.5 }, steps = 12 }, 0
for i = 1, #path do off = max(off, abs(path.q[i][1] - cos(3 * path.t[i]) - sin(3 * path.t[i]) / 6)) end
print(("oscillator in its own space: off by %.1e"):format(off))
assert(off < 1e-12)
-- spaces that cannot work are refused with the reason
local fine, why = pcall(function()
  local poor = dm.galerkin { functions = function(t) return { 1, t, 2 * t } end, quadrature = "gauss(4)" }
  pendulum:solver { rule = poor, h = h }:run { q = { 1 }, v = { 0 }, steps = 1 }
end)
print(why)
assert(not fine and why:find "depend on each other")

print("picture  " .. dm.plot({ { x = angles, y = errors.waves, name = "{1, t, cos t, sin t}" },
    { x = angles, y = errors.powers, name = "{1, t, t^2, t^3}" } },
  { log = "xy", style = "linespoints", xlabel = "release (rad)", ylabel = "error / release",
    title = "Pendulum in steps of a sixth of a swing", file = picture }))
