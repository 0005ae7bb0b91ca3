-- How far does a spinning top nod? Its axis goes up and down between two roots of a cubic, in half the period of an elliptic
-- function (Lagrange 1788), and with the right push it does not nod at all: it goes around at a root of I Omega^2 cos theta
-- - p3 Omega + mgl = 0. Gauss methods step it by way of its unit quaternion, and keep energy and both momenta.
local dm = require "dm"
local sqrt, cos, sin, pi, abs = math.sqrt, math.cos, math.sin, math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/heavy_top.png"

local G, I, I3 = dm.SO(3), 1, 0.4
local top = dm.system { name = "heavy top", Q = G, L = function(R, w) return (I * (w[1] ^ 2 + w[2] ^ 2) + I3 * w[3] ^ 2) / 2 - R[3][3] end }
local solver = top:solver { rule = "gauss(6)", h = 0.05 }

-- u = cos theta: u'^2 = f(u); its smaller roots are the turning points
local tilt, spin, push = 0.5, 1.6, { 0, 0.1, 0.4 }
local function nutation(p)
  local u0 = cos(tilt)
  local b, E = spin * u0 + p * sin(tilt), p ^ 2 / (2 * I) + u0
  local function f(u) return 2 * (E - u) * (1 - u * u) / I - (b - spin * u) ^ 2 / I ^ 2 end
  local function root(low, high)
    for _ = 1, 200 do
      local middle = (low + high) / 2
      if (f(middle) > 0) == (f(high) > 0) then high = middle else low = middle end
    end
    return (low + high) / 2
  end
  local inner = -1                                             -- between the smaller roots f is positive
  while f(inner) <= 0 do inner = inner + 1e-3 end
  local u1, u2, u3 = root(-1, inner), root(inner, 1), root(1, 10)
  local x, y = 1, sqrt((u3 - u2) / (u3 - u1))
  for _ = 1, 8 do x, y = (x + y) / 2, sqrt(x * y) end
  return u1, u2, 2 / sqrt(2 / I * (u3 - u1)) * pi / (2 * x)     -- half a period
end

local tracks, tilts = { equal = true, xlabel = "x", ylabel = "y", title = "end of the axis, from above" }, { xlabel = "t", ylabel = "theta" }
for k, p in ipairs(push) do
  local u1, u2, half = nutation(p)
  local path = solver:run { q = G:exp { tilt, 0, 0 }, p = { 0, p, spin }, t = 20,
    events = { nod = function(R, w) return R[3][1] * w[2] - R[3][2] * w[1] end } }
  local times, ends = {}, {}
  for _, event in ipairs(path.events) do
    if event.t > 0.01 then times[#times + 1], ends[#ends + 1] = event.t, event.q[3][3] end
  end
  local worst = 0
  for i, u in ipairs(ends) do worst = math.max(worst, math.min(abs(u - u1), abs(u - u2)), i > 1 and abs(times[i] - times[i - 1] - half) or 0) end
  print(("push %.1f: between %.4f and %.4f rad, every %.6f; the run is off by %.0e"):format(p, math.acos(u2), math.acos(u1), half, worst))
  assert(#times > 3 and worst < 1e-8, "turning points and their times")
  assert(path:drift "energy".largest < 1e-12 and path:drift(path:momentum(dm.SO(2))).largest < 1e-12, "energy and vertical momentum")
  local theta, R33 = {}, path:column "R33"
  for i = 1, #R33 do theta[i] = math.acos(R33[i]) end
  tracks[k] = { x = path:column "R13", y = path:column "R23", name = ("push %g"):format(p) }
  tilts[k] = { x = path:column "t", y = theta, name = ("push %g"):format(p) }
end

-- steady: the slow root; angular velocity Omega about the vertical, the rest about the axis
local Omega = (2 - sqrt(4 - 4 * I * cos(tilt))) / (2 * I * cos(tilt))
local steady = solver:run { q = G:exp { tilt, 0, 0 }, p = { 0, I * Omega * sin(tilt), 2 }, t = 40 }
local last = steady.q[#steady]
print(("steady precession: %.8f rad per unit of time; after 40 off by %.0e"):format(Omega, abs(last[3][3] - cos(tilt))))
assert(abs(last[3][3] - cos(tilt)) < 1e-10 and abs(last[1][3] - sin(tilt) * sin(40 * Omega)) < 1e-9, "a steady precession")
print("picture  " .. dm.figure { tracks, tilts, title = "Heavy top", file = picture })
