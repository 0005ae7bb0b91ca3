-- make bench: what it costs to build the kernels of a model and to take a step, rule by rule.
local dm = require "dm"

local G = 9.81
local J2 = 0.05
local models = {
  { name = "Kepler", q = { 0.4, 0 }, v = { 0, 2 }, h = 0.01,
    system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end } },
  { name = "J2 satellite", q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, h = 0.02,
    system = dm.system { Q = dm.R(3), L = function(q, v)
      local r = q:norm()
      return v:dot(v) / 2 + 1 / r - J2 / r ^ 3 * (1.5 * q[3] ^ 2 / r ^ 2 - 0.5)
    end } },
  -- polar angles from the downward vertical, then azimuths; unit masses and rods
  { name = "double spherical pendulum", q = { 0.8, 0.4, 0.1, 0 }, v = { 0.1, 0.2, 1, 0.5 }, h = 0.01,
    system = dm.system { Q = dm.R(4), L = function(q, v)
      local function rod(theta, phi, dtheta, dphi)
        local s, c = math.sin(theta), math.cos(theta)
        return dm.vector { c * math.cos(phi) * dtheta - s * math.sin(phi) * dphi,
          c * math.sin(phi) * dtheta + s * math.cos(phi) * dphi, s * dtheta }
      end
      local a = rod(q[1], q[3], v[1], v[3])
      local b = a + rod(q[2], q[4], v[2], v[4])
      return (a:dot(a) + b:dot(b)) / 2 + G * (2 * math.cos(q[1]) + math.cos(q[2]))
    end } },
}

-- in angles: M is definite wherever q is, as bounds of its entries tell once
models[#models + 1] = { name = "double pendulum, angles", q = { 1, 0.5 }, v = { 0, 1 }, h = 0.01, rules = { "gauss(2)", "gauss(4)" },
  system = dm.system { Q = dm.T(2), L = function(q, v)
    return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * math.cos(q[1] - q[2]) + G * (2 * math.cos(q[1]) + math.cos(q[2]))
  end } }

-- springs in a line with fixed ends; at h omega = 4.7 sweeps do not contract, at 2.4 they do
for _, case in ipairs { { 15, 1.2 }, { 15, 2.35 }, { 30, 1.2 }, { 30, 2.35 }, { 60, 1.2 }, { 60, 2.35 } } do
  local BODIES, h = table.unpack(case)
  local q, v = {}, {}
  for i = 1, BODIES do q[i], v[i] = 0.1 * math.sin(i * i), 0 end
  models[#models + 1] = { name = ("chain of %d, h omega = %.1f"):format(BODIES, 2 * h), q = q, v = v, h = h, rules = { "gauss(8)" },
    system = dm.system { Q = dm.R(BODIES), L = function(x, u)
      local U = x[1] ^ 2 + x[BODIES] ^ 2
      for i = 1, BODIES - 1 do U = U + (x[i + 1] - x[i]) ^ 2 end
      return (u:dot(u) - U) / 2
    end } }
end

-- the same with quartic forces of 1e-3 of the linear ones; few unknowns: 24 and 64
for _, case in ipairs { { 30, 1e-3, "gauss(8)" }, { 6, 0, "gauss(4)" }, { 6, 1e-3, "gauss(4)" }, { 8, 1e-3, "gauss(8)" } } do
  local BODIES, quartic, rule = table.unpack(case)
  local q, v = {}, {}
  for i = 1, BODIES do q[i], v[i] = 0.1 * math.sin(i * i), 0 end
  models[#models + 1] = { name = ("chain of %d, quartic %g"):format(BODIES, quartic), q = q, v = v, h = 2.35, rules = { rule },
    system = dm.system { Q = dm.R(BODIES), L = function(x, u)
      local U = x[1] ^ 2 + x[BODIES] ^ 2
      for i = 1, BODIES - 1 do U = U + (x[i + 1] - x[i]) ^ 2 + quartic * (x[i + 1] - x[i]) ^ 4 end
      return (u:dot(u) - U) / 2
    end } }
end

-- springs in a line in a magnetic field, and with drag: linear, of the general form and with forces
for _, case in ipairs { { "magnetic field", 12, { "midpoint", "gauss(2)", "gauss(4)" } }, { "drag", 6, { "midpoint", "gauss(4)" } } } do
  local what, BODIES, rules = table.unpack(case)
  local q, v = {}, {}
  for i = 1, BODIES do q[i], v[i] = 0.1 * math.sin(i * i), 0 end
  models[#models + 1] = { name = ("chain of %d, %s"):format(BODIES, what), q = q, v = v, h = 2.35, rules = rules,
    system = dm.system { Q = dm.R(BODIES), L = function(x, u)
      local L = u:dot(u) / 2 - x[1] ^ 2 / 2 - x[BODIES] ^ 2 / 2
      for i = 1, BODIES - 1 do L = L - (x[i + 1] - x[i]) ^ 2 / 2 end
      for i = 1, what == "drag" and 0 or BODIES - 1, 2 do L = L + 0.3 * (x[i] * u[i + 1] - x[i + 1] * u[i]) end
      return L
    end, force = what == "drag" and function(_, u) return -0.01 * u end or nil } }
end

-- rods of length 1 hanging in a plane, unit masses at their ends, pushed at the lowest
for _, RODS in ipairs { 20, 80 } do
  local q, v = {}, {}
  for i = 1, RODS do q[2 * i - 1], q[2 * i], v[2 * i - 1], v[2 * i] = 0, -i, 0, 0 end
  v[2 * RODS - 1] = 1
  models[#models + 1] = { name = RODS .. " rods", q = q, v = v, h = 0.005, rules = { "rattle", "gauss(2)" },
    system = dm.system { Q = dm.R(2 * RODS),
      L = function(x, u)
        local V = 0
        for i = 1, RODS do V = V + G * x[2 * i] end
        return u:dot(u) / 2 - V
      end,
      constraint = function(x)
        local g = {}
        for i = 1, RODS do
          local a, b = i > 1 and x[2 * i - 3] or 0, i > 1 and x[2 * i - 2] or 0
          g[i] = (x[2 * i - 1] - a) ^ 2 + (x[2 * i] - b) ^ 2 - 1
        end
        return g
      end } }
end

-- best of three runs, of about a tenth of a second at most
local function measure(model, rule)
  local solver = model.system:solver { rule = rule, h = model.h }
  local best, steps = math.huge, 1000
  for _ = 1, 3 do
    local start = os.clock()
    solver:run { q = model.q, v = model.v, steps = steps, every = steps }
    local seconds = os.clock() - start
    best = math.min(best, seconds / steps)
    steps = math.min(20000, math.max(1000, math.floor(0.1 / best)))  -- later the double pendulum meets the pole of its angles
  end
  return best * 1e9, solver:report()
end

print(("%-28s %-12s %10s %10s %8s"):format("model", "rule", "ns/step", "build ms", "Newton"))
for _, model in ipairs(models) do
  for _, rule in ipairs(model.rules or { "verlet", "midpoint", "gauss(2)", "gauss(4)", "lobatto(3)", "rk4", "rk8pd" }) do
    local ns, report = measure(model, rule)
    print(("%-28s %-12s %10.1f %10.3f %8.2f"):format(model.name, rule, ns, report.compile_ms,
      report.newton_per_step or 0))
  end
end
