-- A body turns freely in space: by what angle has it turned when its momentum comes back? By the time of a revolution times
-- twice the energy over |J|, less the solid angle that the momentum went around as seen from the body (Montgomery 1991). And
-- about its middle axis it does not turn for long: momenta near that axis leave it at the rate 1/sqrt 3 of their spin.
local dm = require "dm"
local sqrt, pi, abs, max, log = math.sqrt, math.pi, math.abs, math.max, math.log
local picture = (arg and arg[1] or ".") .. "/free_body.png"

local G = dm.SO(3)
local body = dm.system { name = "free body", Q = G, L = function(_, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end }

-- the period of the momentum by Jacobi's elliptic functions, K by the arithmetic-geometric mean
local J = dm.vector { 0.9, 0.3, 1.2 }
local E, size = (J[1] ^ 2 + J[2] ^ 2 / 2 + J[3] ^ 2 / 3) / 2, J:norm()
local high, low = 3 * 2 * E - size ^ 2, size ^ 2 - 2 * E        -- it goes around the first axis: |J|^2 < 2 E I2
local x, y = 1, sqrt(1 - low / high)
for _ = 1, 8 do x, y = (x + y) / 2, sqrt(x * y) end
local T = 4 * pi / (2 * x) / sqrt(high / 6)

-- one revolution in 512 steps; the solid angle is the integral of 1 - J1/|J| over the azimuth about the first axis, whose sums
-- of a periodic function converge as fast as they can
local n = 512
local path = body:solver { rule = "gauss(4)", h = T / n }:run { q = G:identity(), p = J, steps = n }
assert((path.p[n + 1] - J):norm() < 1e-11, "the momentum should come back")
local solid = 0
for i = 1, n do
  local p = path.p[i]
  local w = { p[1], p[2] / 2, p[3] / 3 }                       -- p' = p x w
  local d2, d3 = p[3] * w[1] - p[1] * w[3], p[1] * w[2] - p[2] * w[1]
  solid = solid + (1 - p[1] / size) * (p[2] * d3 - p[3] * d2) / (p[2] ^ 2 + p[3] ^ 2) * T / n
end
local turned = 2 * E * T / size - solid
local off = G:log(G:compose(path.q[n + 1], G:exp(J * (-turned / size)))):norm()
print(("in %.4f it has turned by %.6f rad about J, where the solid angle is %.6f; the run is off by %.0e"):format(T, turned, solid, off))
assert(off < 1e-9, "Montgomery's angle")

-- near the middle axis
local start = { 1e-11, 2, 1e-11 }
local flip = body:solver { rule = "gauss(3)", h = 0.05 }:run { q = G:identity(), p = start, t = 150 }
local p1 = flip:column "p1"
local function at(time) return math.floor(time / 0.05 + 1.5) end
local rate = log(p1[at(25)] / p1[at(15)]) / 10
print(("spun about the middle axis it leaves at the rate %.6f; theory 1/sqrt 3 = %.6f"):format(rate, 1 / sqrt(3)))
assert(abs(rate - 1 / sqrt(3)) < 1e-6, "the rate of leaving")

local polhodes = { equal = true, xlabel = "J1", ylabel = "J2", title = "momentum seen from the body: |J| = 1, from above" }
local worst = 0
for _, tilt in ipairs { 0.25, 0.55, 0.85, 1.05, 1.3, 1.52 } do
  for k = 0, 1 do
    local p = { math.sin(tilt) * (1 - k), math.sin(tilt) * k, math.cos(tilt) }
    local one = body:solver { rule = "gauss(3)", h = 0.1 }:run { q = G:identity(), p = p, t = 60 }
    worst = max(worst, one:drift(one:momentum(G):column(3)).largest)
    polhodes[#polhodes + 1] = { x = one:column "p1", y = one:column "p2", name = "" }
  end
end
assert(worst < 1e-13, "the momentum in space stays")
print("picture  " .. dm.figure { polhodes, { { x = flip:column "t", y = flip:column "p2", name = "J2" }, { x = flip:column "t", y = p1, name = "J1" }, xlabel = "t",
  title = "spun about its middle axis" }, title = "Free body, moments 1, 2, 3", file = picture })
