-- A particle in a harmonic well that may only move so that x' + y z' = 0 (McLachlan & Perlmutter 2006, 5.2): which
-- rules keep its energy? Nonholonomic integrators look good on it since it is reversible. Shifting the momentum by
-- grad cos z (a total derivative in L) changes no motion but hides the reversal (Modin & Verdier 2020): every rule drifts.
local dm = require "dm"
local sin, sqrt, abs, max, pi = math.sin, math.sqrt, math.abs, math.max, math.pi
local picture = (arg and arg[1] or ".") .. "/contact_oscillator.png"

local function oscillator(shift)
  return dm.system { name = "contact oscillator", Q = dm.R(3), coordinates = { "x", "y", "z" },
    L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 + shift * sin(q[3]) * v[3] end,
    rolling = function(q, v) return v[1] + q[2] * v[3] end }
end
local start = { q = { sqrt(1.5), 1, -sqrt(0.5) }, v = { 0, 0, 0 } } -- energy 3/2, of which y has 1/2
local h, steps = 2 * sin(pi / 40), 10000

local function run(system, rule, part)
  local path = system:solver { rule = rule, h = h / part }:run { q = start.q, v = start.v, steps = steps * part }
  assert(path:worst "rolling" < 1e-14, "off the constraint")
  local E, worst = path:energy(), 0
  for i = 1, #E do worst = max(worst, abs(E[i] - 1.5)) end
  return path:drift("energy"), worst, path, E
end

local reversible, shifted = oscillator(0), oscillator(1)
local rules = { "midpoint", "trapezoidal", "suzuki(4, midpoint)", "lobatto(3)", "gauss(2)", "lobatto(4)", "gauss(3)", "gauss(4)" }
local rate, curves = {}, { log = "y", xlabel = "t", ylabel = "|E - E0|", title = "not reversible: largest error so far" }
print "drift of the energy a unit of time     reversible      not reversible   at h/2      worst error"
for _, rule in ipairs(rules) do
  local still, band = run(reversible, rule, 1)
  local drift, worst, path, E = run(shifted, rule, 1)
  local finer = run(shifted, rule, 2)
  print(("%-34s %14.0e %17.1e %11.1e %12.1e"):format(rule, still.per_time, drift.per_time, finer.per_time, worst))
  assert(abs(still.per_time) * h * steps < band / 50, rule .. " should not drift where motion can be reversed")
  rate[rule] = drift.per_time / finer.per_time
  if rule ~= "trapezoidal" and not rule:find "lobatto" then
    local t, top, most = {}, {}, 1e-16
    for i = 1, #E do
      most = max(most, abs(E[i] - 1.5))
      if i % 50 == 0 then t[#t + 1], top[#top + 1] = path.t[i], most end
    end
    curves[#curves + 1] = { x = t, y = top, name = rule }
  end
end
for rule, power in pairs { ["gauss(2)"] = 6, ["lobatto(3)"] = 6, ["gauss(3)"] = 8, ["lobatto(4)"] = 8, ["suzuki(4, midpoint)"] = 4 } do
  assert(abs(math.log(rate[rule], 2) - power) < 0.5, rule .. ": the drift should fall like h^" .. power)
end
print "the drift of Gauss and Lobatto rules of order p falls like h^(p + 2): the highest order does best"

local path = select(3, run(reversible, "gauss(3)", 1))
local x, z = {}, {}
for i = 1, 600 do x[i], z[i] = path.q[i][1], path.q[i][3] end
print("picture  " .. dm.figure { title = "Contact oscillator", file = picture,
  { x, z, equal = true, xlabel = "x", ylabel = "z", title = "path, 94 units of time" }, curves })
