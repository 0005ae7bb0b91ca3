-- Can steps be chosen such that the energy itself is kept (Leok 5.5)? On an ellipse, as long as e^2 < 5/8.
-- A symplectic-energy-momentum step has one unknown more, its length, and the discrete energy as the
-- equation for it. Short steps have energies on one side of H only: where that side is the wrong one
-- there is no step, which the rule says.
local dm = require "dm"
local sqrt, abs = math.sqrt, math.abs
local picture = (arg and arg[1] or ".") .. "/energy_steps.png"

local kepler = dm.system { name = "Kepler", Q = dm.R(2), coordinates = { "x", "y" },
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function pericentre(e) return { q = { 1 - e, 0 }, v = { 0, sqrt((1 + e) / (1 - e)) } } end
local function run(rule, h, e, steps)
  local start = pericentre(e)
  return kepler:solver { rule = rule, h = h }:run { q = start.q, v = start.v, steps = steps }
end

-- ten revolutions with e = 0.5: sem keeps E_d and the angular momentum, midpoint only the latter
local sem = run("sem(1, gauss(1))", 0.05, 0.5, 480)
print(sem)
assert(sem.sem.fallbacks == 0 and sem:drift "E_d".largest < 1e-13)
assert(sem:drift(sem:momentum(dm.SO(2))).largest < 1e-13)
-- steps follow the distance: five times longer at the apocentre
print(("h from %.3f to %.3f"):format(sem.sem.least, sem.sem.largest))
assert(sem.sem.largest > 4 * sem.sem.least)
-- what is kept is E_d; the energy H swings by O(h^2) beside it, less than that of equal steps
local midpoint = run("midpoint", sem.t[#sem] / 480, 0.5, 480)
local function swing(path) return path:drift "energy".largest end
print(("energy off by %.1e with equal steps, %.1e with chosen ones"):format(swing(midpoint), swing(sem)))
assert(swing(sem) < swing(midpoint) / 2)

-- the border e^2 = 5/8: below it every step of an orbit has a root, above it steps are flagged
local orbits = {}
for _, e in ipairs { 0.3, 0.6, 0.75, 0.8, 0.85 } do
  local path = run("sem(1, gauss(1))", 0.02 * (1 - e) ^ 1.5 / 0.25 ^ 1.5, e, 60)
  print(("e = %.2f: %2d of 60 steps without a root"):format(e, path.sem.fallbacks))
  assert((path.sem.fallbacks > 0) == (e ^ 2 > 5 / 8))
  orbits[#orbits + 1] = { x = path.t, y = path:column "h", name = ("e = %.2f"):format(e) }
end
-- asked beforehand: C has the sign of E_d - H, and an energy on the other side no step
local solver = kepler:solver { rule = "sem(1, gauss(1))", h = 0.05 }
local answer = solver:solvability { q = { 0.5, 0 }, v = { 0, sqrt(3) }, energy = -0.49 }
print("E = -0.49: " .. answer.why)
assert(not answer.solvable and abs(answer.C + 5) < 1e-6)

print("picture  " .. dm.plot(orbits, { log = "y", style = "linespoints", xlabel = "t", ylabel = "h",
  title = "Steps that keep the energy of an ellipse", file = picture }))
