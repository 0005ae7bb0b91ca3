-- dmlua tests/bench/setup.lua: CPU time from dm.system{} through the first step of a run, for the models of the examples and
-- n bodies, with constraints and reduced; of each the first time, then the median of nine systems made anew, and of a run that finds its kernels
local dm = require "dm"
local sin, cos = math.sin, math.cos
local masses = { 1, 1e-3, 3e-4, 4e-5, 5e-5, 1e-8 }
local function spread(n, f) local t = {} for i = 1, n do t[i] = f(i) end return t end
local models = {
  { "Kepler", 2, { 0.4, 0 }, { 0, 2 }, function(q, v) return v:dot(v) / 2 + 1 / q:norm() end },
  { "J2 satellite", 3, { 1.1, 0, 0.1 }, { 0, 0.95, 0.2 }, function(q, v)
    local r = q:norm()
    return v:dot(v) / 2 + 1 / r - 0.05 / r ^ 3 * (1.5 * q[3] ^ 2 / r ^ 2 - 0.5)
  end },
  { "stiff spring", 2, { sin(1), -cos(1) }, { 0, 0 }, function(q, v) return v:dot(v) / 2 - 1e4 / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end },
  { "double spherical pendulum", 4, { 1, 0, 0.7, 0.4 }, { 0, 1.5, 0, 2 }, function(q, v)
    local function velocity(a, b, da, db)
      return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
    end
    local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
    local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
    local T = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
    return T + 9.81 * (2 * cos(q[1]) + cos(q[3]))
  end },
  { "outer solar system", 18, spread(18, function(i) return i * 1.3 + (i % 5) ^ 2 end), spread(18, function(i) return 0.01 * i end), function(q, v)
    local L = 0
    for i, m in ipairs(masses) do
      local at, u = q:slice(3 * i - 2, 3 * i), v:slice(3 * i - 2, 3 * i)
      L = L + m * u:dot(u) / 2
      for j = 1, i - 1 do L = L + m * masses[j] / (at - q:slice(3 * j - 2, 3 * j)):norm() end
    end
    return L
  end },
}
-- moving masses: one that bounds tell to be definite wherever q is, one that is squares and products beside them
models[#models + 1] = { "double pendulum, angles", 2, { 1, 0.5 }, { 0, 1 }, function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 9.81 * (2 * cos(q[1]) + cos(q[2]))
end, "gauss(4)" }
models[#models + 1] = { "double sph. pendulum, chart", 4, { sin(0.8), 0, sin(0.4), 0 }, { 0, 1, 0, -0.5 }, function(q, v)
  local function depth(x, y, dx, dy)
    local z = (1 - x * x - y * y) ^ 0.5
    return z, (x * dx + y * dy) / z
  end
  local d1, z1 = depth(q[1], q[2], v[1], v[2])
  local d2, z2 = depth(q[3], q[4], v[3], v[4])
  local T = v[1] ^ 2 + v[2] ^ 2 + z1 ^ 2 + (v[3] ^ 2 + v[4] ^ 2 + z2 ^ 2) / 2 + v[1] * v[3] + v[2] * v[4] + z1 * z2
  return T + 9.81 * (2 * d1 + d2)
end, "gauss(4)" }
for _, bodies in ipairs { 20, 59 } do
  local n = 3 * bodies
  models[#models + 1] = { bodies .. " bodies", n, spread(n, function(i) return 10 * sin(i * i) end), spread(n, function(i) return 0.01 * cos(i) end), function(q, v)
    local L = v:dot(v) / 2
    for i = 1, bodies do
      local at = q:slice(3 * i - 2, 3 * i)
      for j = 1, i - 1 do L = L + 1 / (at - q:slice(3 * j - 2, 3 * j)):norm() end
    end
    return L
  end, "verlet" }
end
models[#models + 1] = { "double pendulum, rods", 4, { 1, 0, 1, -1 }, { 0, 0, 0, 0 }, function(q, v) return v:dot(v) / 2 - 9.81 * (q[2] + q[4]) end, "rattle",
  { constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 } end } }
models[#models + 1] = { "Chaplygin sleigh", 3, { 0, 0, 0 }, { 0, 0, 1 }, function(q, v)
  local x, y = v[1] - 0.5 * v[3] * sin(q[3]), v[2] + 0.5 * v[3] * cos(q[3])
  return (x * x + y * y) / 2 + 0.375 * v[3] ^ 2
end, "gauss(2)", { rolling = function(q, v) return cos(q[3]) * v[2] - sin(q[3]) * v[1] end } }
-- in (theta, r, z) and as what is left of it, q and v of the shape
models[#models + 1] = { "J2 satellite, reduced", 3, { 1, 0 }, { 0, 0.28 }, function(q, v)
  local r = (q[2] ^ 2 + q[3] ^ 2) ^ 0.5
  return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / r - 0.05 / r ^ 3 * (1.5 * q[3] ^ 2 / r ^ 2 - 0.5)
end, "gauss(2)", { mu = 0.96 } }
local function median(n, f)
  local all = {}
  for i = 1, n do
    local t = os.clock()
    f()
    all[i] = (os.clock() - t) * 1e3
  end
  table.sort(all)
  return all[(n + 1) // 2]
end
print(("%-28s %-10s %10s %10s %10s %10s"):format("ms of CPU time", "rule", "first", "median", "again", "operations"))
for _, model in ipairs(models) do
  local name, n, q, v, L, only, more = table.unpack(model, 1, 7)
  more = more or {}
  for _, rule in ipairs(only and { only } or { "verlet", "midpoint", "gauss(2)" }) do
    local system, solver
    local function run()
      solver = system:solver { rule = rule, h = 1e-3 }
      solver:run { q = q, v = v, steps = 1 }
    end
    local function anew()
      system = dm.system { Q = dm.R(n), L = L, constraint = more.constraint, rolling = more.rolling }
      if more.mu then system = system:routh { cyclic = { 1 }, mu = more.mu } end
      run()
    end
    local first, made, again = median(1, anew), median(9, anew), median(99, run)
    print(("%-28s %-10s %10.3f %10.3f %10.3f %10d"):format(name, rule, first, made, again, solver:report().operations))
  end
end
