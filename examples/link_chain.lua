-- How does a chain of ten rigid links swing, without angles? Each link is a body on SO(3) x R^3, its ends are held to those of its
-- neighbours: 30 conditions on 60 velocities, held to rounding. It swings at the first zero of Bessel's J0 (Bernoulli 1733), a little
-- off as links are no string. lie(1) with constraints is RATTLE on the group, and its equations are solved as a band.
local dm = require "dm"
local sqrt, pi, abs = math.sqrt, math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/link_chain.png"

local N, G = 10, dm.SO(3)
local length, g, factors = 1 / N, 1, {}                         -- mass 1 / N each: a chain of length and mass 1
local I = { length ^ 2 / 12, length ^ 2 / 12, length ^ 2 / 200 }
for k = 1, N do factors[2 * k - 1], factors[2 * k] = G, dm.R(3) end
local half = dm.vector { 0, 0, length / 2 }                     -- from the middle of a link to its upper end

local chain = dm.system { name = "chain of links", Q = dm.product(table.unpack(factors)),
  L = function(q, v)
    local sum = 0
    for i = 1, 6 * N do sum = sum + (I[(i - 1) % 6 + 1] or 1) * v[i] ^ 2 / 2 end
    for k = 1, N do sum = sum - g * q[2 * k][3] end
    return sum / N
  end,
  constraint = function(q)
    local out, above = {}, dm.vector { 0, 0, 0 }
    for k = 1, N do
      local x, arm = q[2 * k], q[2 * k - 1] * half
      for i = 1, 3 do out[#out + 1] = (x + arm - above)[i] end
      above = x - arm
    end
    return out
  end }

-- hung straight and turned by an angle about y, let go at rest
local function swing(angle, h, t)
  local R, q = G:exp { 0, angle, 0 }, {}
  for k = 1, N do q[2 * k - 1], q[2 * k] = R, R * half * (1 - 2 * k) end
  local path = chain:solver { rule = "lie(1)", h = h }:run { q = q, v = dm.zeros(6 * N), t = t,
    events = { middle = function(x) return x[2 * N][1] end } }
  assert(path:worst "constraint" < 1e-13, "links stay together")
  return path
end

local path = swing(1e-3, 0.02, 60)
local events = path.events
local period = 2 * (events[#events].t - events[1].t) / (#events - 1)
local string = 2 * pi / (2.404825557695773 / 2 * sqrt(g))
print(("it swings in %.4f on the average; a string in %.4f"):format(period, string))
assert(abs(period / string - 1) < 0.01, "the first zero of Bessel's function")
path = swing(0.9, 0.01, 30)
local E = path:drift "energy"
print(("swung wide: energy within %.1e of %.3f, joints within %.0e"):format(E.largest, path:energy()[1], path:worst "constraint"))
assert(E.largest < 0.01 * abs(path:energy()[1]), "energy within one percent")

local shapes = { equal = true, xlabel = "x", ylabel = "z", title = "every half unit of time" }
for i = 1, 501, 50 do
  local x, z, q = { 0 }, { 0 }, path.q[i]
  for k = 1, N do x[k + 1], z[k + 1] = (q[2 * k] - q[2 * k - 1] * half)[1], (q[2 * k] - q[2 * k - 1] * half)[3] end
  shapes[#shapes + 1] = { x = x, y = z, name = "" }
end
print("picture  " .. dm.figure { shapes, { { x = path:column "t", y = path:energy() }, xlabel = "t", title = "energy" }, title = "Chain of ten links",
  file = picture })
