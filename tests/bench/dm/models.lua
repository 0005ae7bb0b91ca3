-- The problems of docs/benchmarks.md as a user of dmlua writes them:
-- { key, T =, system =, q =, v =, positions = function(q) (numbers whose error counts),
--   attracting = true where a logarithmic Hamiltonian makes sense, long = true for a chain of 1024 }
local dm = require "dm"
local sqrt, sin, cos, exp, pi = math.sqrt, math.sin, math.cos, math.exp, math.pi

local models = {}
local function add(key, model)
  model.key = key
  models[#models + 1] = model
end

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
for _, e in ipairs { 0.6, 0.9 } do
  add("P1-" .. e, { attracting = true, T = 200 * pi, system = kepler, q = { 1 - e, 0 }, v = { 0, sqrt((1 + e) / (1 - e)) } })
end

local J2, speed = 0.05, sqrt(1.1 / 0.9)
local satellite = dm.system { Q = dm.R(3), L = function(q, v)
  local r2 = q:dot(q)
  local r = sqrt(r2)
  return v:dot(v) / 2 + 1 / r - J2 / (2 * r ^ 3) * (3 * q[3] ^ 2 / r2 - 1)
end }
add("P2", { attracting = true, T = 200 * pi, system = satellite, q = { 0.9, 0, 0 }, v = { 0, speed * cos(0.6), speed * sin(0.6) } })

-- masses in solar masses, AU, days
local bodies = {
  { 1.00000597682, { 0, 0, 0 }, { 0, 0, 0 } },
  { 0.000954786104043, { -3.5023653, -3.8169847, -1.5507963 }, { 0.00565429, -0.00412490, -0.00190589 } },
  { 0.000285583733151, { 9.0755314, -3.0458353, -1.6483708 }, { 0.00168318, 0.00483525, 0.00192462 } },
  { 0.0000437273164546, { 8.3101420, -16.2901086, -7.2521278 }, { 0.00354178, 0.00137102, 0.00055029 } },
  { 0.0000517759138449, { 11.4707666, -25.7294829, -10.8169456 }, { 0.00288930, 0.00114527, 0.00039677 } },
  { 1 / 1.3e8, { -15.5387357, -25.2225594, -3.1902382 }, { 0.00276725, -0.00170702, -0.00136504 } },
}
local planets = { q = {}, v = {} }
for _, body in ipairs(bodies) do
  for k = 1, 3 do
    planets.q[#planets.q + 1] = body[2][k]
    planets.v[#planets.v + 1] = body[3][k]
  end
end
local G = 2.95912208286e-4
local solar = dm.system { Q = dm.R(18), L = function(q, v)
  local L, place = 0, {}
  for i, a in ipairs(bodies) do
    local k = 3 * i - 2
    local speed = v:slice(k, k + 2)
    place[i] = q:slice(k, k + 2)
    L = L + a[1] / 2 * speed:dot(speed)
    for j = 1, i - 1 do L = L + G * a[1] * bodies[j][1] / (place[i] - place[j]):norm() end
  end
  return L
end }
add("P3", { T = 200000, system = solar, q = planets.q, v = planets.v })

-- double spherical pendulum: each rod by its horizontal part (x, y), at depth z = sqrt(1 - x^2 - y^2): the energy,
-- 7.4 above rest, leaves no rod at the level of its upper end, for which 9.8 are needed
local function depth(x, y, dx, dy)
  local z = sqrt(1 - x * x - y * y)
  return z, (x * dx + y * dy) / z
end
local pendulum = dm.system { Q = dm.R(4), L = function(q, v)
  local x1, y1, x2, y2 = v[1], v[2], v[3], v[4]
  local d1, z1 = depth(q[1], q[2], x1, y1)
  local d2, z2 = depth(q[3], q[4], x2, y2)
  local T = x1 ^ 2 + y1 ^ 2 + z1 ^ 2 + (x2 ^ 2 + y2 ^ 2 + z2 ^ 2) / 2 + x1 * x2 + y1 * y2 + z1 * z2
  return T + 9.81 * (2 * d1 + d2)
end }
add("P4", { T = 10, system = pendulum, q = { sin(0.8), 0, sin(0.4), 0 }, v = { 0, 1, 0, -0.5 },
  positions = function(q)
    local x1, y1, x2, y2 = q[1], q[2], q[3], q[4]
    local z1, z2 = -depth(x1, y1, 0, 0), -depth(x2, y2, 0, 0)
    return { x1, y1, z1, x1 + x2, y1 + y2, z1 + z2 }
  end })

-- entries of the rotation matrix; bench/dm/search.lua starts from p
local G, no_angle = dm.SO(3), dm.SO(3):identity()
local function entries(R)
  local out = {}
  for i = 1, 3 do
    for j = 1, 3 do out[#out + 1] = R[i][j] end
  end
  return out
end
-- made when asked for: builds before they could be made run the other models (bench/table/instructions.lua)
local function on_group(L)
  return { __index = function(_, name) return name == "system" and dm.system { Q = G, L = L } or nil end }
end
add("P5-body", setmetatable({ T = 100, q = no_angle, p = { 0.9, 0.3, 1.2 }, positions = entries, on_group = true },
  on_group(function(_, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end)))
add("P5-top", setmetatable({ T = 100, q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, positions = entries, on_group = true },
  on_group(function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end)))

for _, k in ipairs { "1e2", "1e4", "1e6" } do
  local stiffness = tonumber(k)
  add("P6-" .. k, { T = 16, q = { sin(1), -cos(1) }, v = { 0, 0 }, system = dm.system { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - stiffness / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2]
  end } })
end

-- velocities of the chains: s <- 1664525 s + 1013904223 (32 bits), mean removed
local function chain_start(n)
  local q, v, mean, s = {}, {}, 0, 12345
  for i = 1, n do
    s = (1664525 * s + 1013904223) & 0xffffffff
    q[i], v[i] = 0, (s >> 8) / 2 ^ 23 - 1
    mean = mean + v[i]
  end
  for i = 1, n do v[i] = v[i] - mean / n end
  return dm.vector(q), dm.vector(v) -- a table of 1024 takes 7 us longer to read, every time
end
local bonds = { toda = function(d) return exp(d) - 1 end, fpu = function(d) return d ^ 2 / 2 + d ^ 4 / 4 end }
for _, name in ipairs { "toda", "fpu" } do
  for _, n in ipairs { 3, 32, 1024 } do
    local q, v = chain_start(n)
    local W = bonds[name]
    add(("P8-%s-%d"):format(name, n), { T = n == 1024 and 16 or 100, q = q, v = v, long = n == 1024,
      system = dm.system { Q = dm.R(n), L = function(x, u)
        return dm.sum_over(u, function(a) return a ^ 2 / 2 end)
          - dm.sum_over(x, function(a, b) return W(a - b) end, { shift = 1, periodic = true })
      end } })
  end
end
return models
