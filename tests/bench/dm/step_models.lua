-- The models of bench/dm/steps.lua whose implicit steps C by hand takes too (bench/c/newton_models.c, tied.c, rattle.c):
-- { key, h =, q =, v =, system =, rule = where it is not midpoint }
local dm = require "dm"
local sin, cos, sqrt = math.sin, math.cos, math.sqrt

local models = {}
local function add(key, model)
  model.key = key
  model.system = dm.system { Q = dm.R(#model.q), L = model.L, constraint = model.constraint }
  models[#models + 1] = model
end

local J2 = 0.05
add("J2 satellite", { h = 0.05, q = { 1.1, 0, 0.1 }, v = { 0, 0.95, 0.2 }, L = function(q, v)
  local r = q:norm()
  return v:dot(v) / 2 + 1 / r - J2 / (2 * r ^ 3) * (3 * q[3] ^ 2 / r ^ 2 - 1)
end })

local function velocity(a, b, da, db)
  return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
end
add("double spherical pendulum", { h = 0.01, q = { 1, 0, 0.7, 0.4 }, v = { 0, 1.5, 0, 2 }, L = function(q, v)
  local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
  local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
  local T = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
  return T + 9.81 * (2 * cos(q[1]) + cos(q[3]))
end })

add("three bodies", { h = 0.01, q = { 0.97000436, -0.24308753, 0, -0.97000436, 0.24308753, 0, 0, 0, 0 },
  v = { 0.466203685, 0.43236573, 0, 0.466203685, 0.43236573, 0, -0.93240737, -0.86473146, 0 }, L = function(q, v)
    local L = v:dot(v) / 2
    for i = 4, 7, 3 do
      for j = 1, i - 1, 3 do
        L = L + 1 / sqrt((q[i] - q[j]) ^ 2 + (q[i + 1] - q[j + 1]) ^ 2 + (q[i + 2] - q[j + 2]) ^ 2)
      end
    end
    return L
  end })

add("spherical pendulum in space", { h = 0.02, q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 },
  L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end })

-- two rods, unit masses at their ends
local function weights(q, v) return v:dot(v) / 2 - 9.81 * (q[3] + q[6]) end
local function rods(q)
  local x, y = dm.vector { q[1], q[2], q[3] }, dm.vector { q[4] - q[1], q[5] - q[2], q[6] - q[3] }
  return { x:dot(x) - 1, y:dot(y) - 1 }
end
add("double spherical pendulum in space",
  { h = 0.01, q = { 0.6, 0, -0.8, 0.6, 0.6, -1.6 }, v = { 0, 1, 0, 1, 1, 0 }, L = weights, constraint = rods })
add("double spherical pendulum in R^6", { rule = "rattle", h = 0.01, q = { 0.6, 0, -0.8, 0.6, 0.6, -1.6 },
  v = { 0, 1, 0, 0.5, 1, 0 }, L = weights, constraint = function(q)
    local x, y, z = q[4] - q[1], q[5] - q[2], q[6] - q[3]
    return { (q[1] ^ 2 + q[2] ^ 2 + q[3] ^ 2 - 1) / 2, (x ^ 2 + y ^ 2 + z ^ 2 - 1) / 2 }
  end })
return models
