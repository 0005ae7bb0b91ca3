-- A sleigh on one skate, its centre of mass ahead of it, is spun on the spot: where does it end up?
-- The skate cannot slip sideways (Bloch 2003, 1.7). Spin turns into a glide, c = a V / k^2, k^2 = a^2 + I / m:
-- speed V tanh(c t), heading (k / a) gd(c t): it always ends up turned by pi k / (2 a), whatever the spin.
local dm = require "dm"
local sin, cos, exp, atan, abs, max, pi = math.sin, math.cos, math.exp, math.atan, math.abs, math.max, math.pi
local picture = (arg and arg[1] or ".") .. "/chaplygin_sleigh.png"

local m, I, a = 1, 0.75, 0.5  -- kg, kg m^2, m from the skate to the centre of mass
local k = (a ^ 2 + I / m) ^ 0.5
local sleigh = dm.system { name = "Chaplygin sleigh", Q = dm.R(3), coordinates = { "x", "y", "heading" },
  units = { t = "s", x = "m", y = "m", heading = "rad", energy = "J" },
  L = function(q, v)
    local x, y = v[1] - a * v[3] * sin(q[3]), v[2] + a * v[3] * cos(q[3])  -- centre of mass
    return m * (x * x + y * y) / 2 + I * v[3] ^ 2 / 2
  end,
  rolling = function(q, v) return cos(q[3]) * v[2] - sin(q[3]) * v[1] end }

local function tanh(x) return 1 - 2 / (exp(2 * x) + 1) end
local function run(rule, h, spin, t)
  return sleigh:solver { rule = rule, h = h }:run { q = { 0, 0, 0 }, v = { 0, 0, spin }, t = t }
end

print "rule          h      heading off by   speed off by   energy"
for _, row in ipairs { { "midpoint", 0.05, 2e-4 }, { "gauss(2)", 0.1, 1e-7 }, { "lobatto(4)", 0.2, 1e-8 }, { "gauss(4)", 0.2, 1e-12 } } do
  local rule, h, bound = table.unpack(row)
  local path = run(rule, h, 1, 20)
  local c, turned, glide = a * k / k ^ 2, 0, 0  -- spin 1: V = k
  for i = 1, #path do
    local t, q, p = path.t[i], path.q[i], path.p[i]
    local v = (p[1] * cos(q[3]) + p[2] * sin(q[3])) / m
    turned = max(turned, abs(q[3] - k / a * 2 * atan(tanh(c * t / 2))))
    glide = max(glide, abs(v - k * tanh(c * t)))
  end
  local E = path:energy()
  print(("%-10s %5.2f %16.1e %14.1e %9.0e"):format(rule, h, turned, glide, abs(E[#E] - E[1])))
  assert(turned < bound and glide < bound, "the sleigh should glide as it must")
  assert(path:worst "rolling" < 1e-14, "the skate slips")
end

local tracks, headings = { equal = true, xrange = { -5, 1 }, xlabel = "x", ylabel = "y", xunit = "m", yunit = "m", title = "the skate: one track for all spins" },
  { xlabel = "t", ylabel = "heading", xunit = "s", yunit = "rad", title = "the same turn, sooner or later" }
for i, spin in ipairs { 0.5, 1, 2 } do
  local path = run("gauss(3)", 0.05, spin, 24)
  local last = path.q[#path][3]
  print(("spin %.1f rad/s: turned by %.4f rad, in the end by pi k / (2 a) = %.4f"):format(spin, last, pi * k / (2 * a)))
  assert(spin < 1 or abs(last - pi * k / (2 * a)) < 1e-4, "the turn does not depend on the spin")
  local x, y, t, heading, name = {}, {}, {}, {}, ("spin %.1f rad/s"):format(spin)
  for j = 1, #path do x[j], y[j], t[j], heading[j] = path.q[j][1], path.q[j][2], path.t[j], path.q[j][3] end
  tracks[i], headings[i] = { x = x, y = y, name = name }, { x = t, y = heading, name = name }
end
print("picture  " .. dm.figure { tracks, headings, file = picture, title = "Chaplygin sleigh" })
