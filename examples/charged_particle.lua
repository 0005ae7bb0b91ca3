-- Is the magnetic force a shadow of inertia? Kaluza and Klein: a free particle on a plane with one more, circular dimension, whose angle
-- is dragged along by A(x): L = |x'|^2/2 + (theta' + A . x')^2/2. The momentum of the angle is the charge e; what is left of the motion after
-- reduction is a particle in the field B = curl A, and A is the connection. The midpoint rule turns the velocity in a constant field by 2 atan(e B h/2) a step.
local dm = require "dm"
local atan, cos, sin, abs, pi = math.atan, math.cos, math.sin, math.abs, math.pi
local picture = (arg and arg[1] or ".") .. "/charged_particle.png"

local function particle(A)
  return dm.system { name = "particle", Q = dm.R(3), coordinates = { "theta", "x", "y" }, L = function(q, v)
    local a = A(q[2], q[3])
    return (v[2] ^ 2 + v[3] ^ 2 + (v[1] + a[1] * v[2] + a[2] * v[3]) ^ 2) / 2
  end }
end
local round, straight = particle(function(x, y) return { -y, x } end), particle(function(x) return { 0, 2 * x } end)  -- B = 2, two gauges
local e, h, start = 1.5, 0.1, { q = { 0, 0 }, v = { 1, 0 }, steps = 400 }

local shape = round:routh { cyclic = { "theta" }, mu = e }
print(shape, "magnetic form", shape:curvature { 0.3, 0.4 })
assert(abs(shape:curvature({ 0.3, 0.4 })[1][2] - 2 * e) < 1e-15)
local path = shape:solver { rule = "midpoint", h = h }:run(start)
local v, worst = path:velocity(), 0
for i = 1, #path do
  local angle = -2 * (i - 1) * atan(e * 2 * h / 2)
  worst = math.max(worst, abs(v[i][1] - cos(angle)), abs(v[i][2] - sin(angle)))
end
print(("velocity turns by the Cayley angle to %.0e over 400 steps"):format(worst))
assert(worst < 1e-11)

-- another gauge is another angle theta + f(x): the same points, another connection, and the same phase once around
local other = straight:routh { cyclic = { "theta" }, mu = e }
local apart = dm.compare(path, other:solver { rule = "midpoint", h = h }:run(start), { columns = { "x", "y" } })
print("two gauges", apart)
assert(apart.worst < 1e-12)
local function circle(s) return { cos(2 * pi * s), sin(2 * pi * s) } end
local flux = shape:holonomy(circle)[1]
print(("holonomy of the unit circle %.12f, minus the flux through it %.12f, other gauge %.12f"):format(flux, -2 * pi, other:holonomy(circle)[1]))
assert(abs(flux + 2 * pi) < 1e-13 and abs(other:holonomy(circle)[1] - flux) < 1e-13)

-- a field that is stronger further up: circles drift to the side, and the fifth coordinate runs on
local uneven = particle(function(_, y) return { -2 * y - y * y / 2, 0 } end):routh { cyclic = { "theta" }, mu = e }
local drift = uneven:solver { rule = "gauss(2)", h = h }:run { q = { 0.8, 0 }, v = { 1, 0 }, steps = 300 }
local whole, phases = drift:reconstruct(), drift:phases()
assert(drift:drift "energy".largest < 1e-5)
local geometric = {}
for i = 1, #drift do geometric[i] = phases.geometric[i][1] end
print("picture  " .. dm.figure { file = picture, width = 1000, height = 420,
  { { x = path:column "x", y = path:column "y", name = "constant field" }, { x = drift:column "x", y = drift:column "y", name = "stronger further up" },
    equal = true, xlabel = "x", ylabel = "y", title = "what is left: a charge in a magnetic field" },
  { whole:series("t", "theta", "angle"), { x = whole:column "t", y = geometric, name = "its geometric part" }, xlabel = "t", title = "the dimension that was reduced" } })
