-- Do momentum and energy drift where theory has no drift? Mean slope of 10 starts and its standard error, by their spread.
--   for level in plain fma avx512; do DMLUA_PROCESSOR=$level build/dmlua tests/bench/dm/long_runs.lua; done
--   build/dmlua tests/bench/dm/long_runs.lua STEPS PATTERN: other numbers of steps, only rows "system rule" with PATTERN in them
-- 10^7 steps a start, 10^6 where one costs more than 1 us. What is more than 3 standard errors from zero is tried with 10 other
-- starts, and drifts if it is so again.
local dm = require "dm"
local sqrt, log = math.sqrt, dm.log
local STARTS, ROWS, SIGMAS, DEAR = 10, 1000, 3, 1000
local most, only = tonumber(arg[1]) or 1e7, arg[2] or ""
local level = os.getenv "DMLUA_PROCESSOR" or "the processor's own"

---- systems: the rules that step them, h, starts, J ----

local function turn(x, y, angle)
  return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)
end

-- on an ellipse, anywhere
local function ellipse(random)
  local e, a, phase, angle = 0.3 + 0.3 * random(), 0.9 + 0.3 * random(), 2 * math.pi * random(), 2 * math.pi * random()
  local E = phase -- eccentric anomaly
  local n, b = a ^ -1.5, a * sqrt(1 - e * e)
  local rate = n / (1 - e * math.cos(E))
  local x, y = turn(a * (math.cos(E) - e), b * math.sin(E), angle)
  local u, w = turn(-a * math.sin(E) * rate, b * math.cos(E) * rate, angle)
  return { x, y }, { u, w }
end

local function around(random)
  local x, y = turn(0.5 + random(), 0, 2 * math.pi * random())
  return { x, y }, { 1.5 * random() - y, 1.5 * random() + x }
end

local function on_sphere(random)
  local z = -0.9 + 0.9 * random()
  local x, y = turn(sqrt(1 - z * z), 0, 2 * math.pi * random())
  local spin, rise = 0.5 + 2 * random(), random() - 0.5
  return { x, y, z }, { -y * spin - x * z * rise, x * spin - y * z * rise, (1 - z * z) * rise }
end

local function vortices(random)
  local q = {}
  for i, x in ipairs { -1, 0, 0.5, 0.9, 0.7, -0.8 } do q[i] = x + 0.2 * random() end
  return q, { 0, 0, 0, 0, 0, 0 }
end
local G = { 1, 0.7, 1.3 }

-- slower than light
local function slowly(random)
  local x, y = turn(0.5 + random(), 0, 2 * math.pi * random())
  return { x, y }, { 0.3 * random() - 0.4 * y, 0.3 * random() + 0.4 * x }
end

local function ring(random)
  local q, v = {}, {}
  for i = 1, 8 do q[i], v[i] = random() - 0.5, random() - 0.3 end
  return q, v
end

-- two bodies beside the origin, as tests/bench/c/by_hand/drifts_verlet.c has them
local function tied_to_origin(random)
  local q, v = {}, {}
  for i, x in ipairs { -0.7, 0, 0.3, 0.2 } do q[i] = x + 0.4 * (random() - 0.5) end
  for i, x in ipairs { 0, -0.6, 0.2, 0.3 } do v[i] = x + 0.3 * (random() - 0.5) end
  return q, v
end

-- bodies of the plane about these places with about these speeds, all turned by one angle
local function near(places, apart, speeds, faster)
  return function(random)
    local q, v, angle = {}, {}, 2 * math.pi * random()
    for i = 1, #places, 2 do
      q[i], q[i + 1] = turn(places[i] + apart * (random() - 0.5), places[i + 1] + apart * (random() - 0.5), angle)
      v[i], v[i + 1] = turn(speeds[i] + faster * (random() - 0.5), speeds[i + 1] + faster * (random() - 0.5), angle)
    end
    return q, v
  end
end

-- the same in the frame in which bodies of these masses have no momentum together
local function at_rest(start, masses)
  return function(random)
    local q, v = start(random)
    for k = 0, 1 do
      local p, all = 0, 0
      for i, m in ipairs(masses) do p, all = p + m * v[2 * i - 1 + k], all + m end
      for i = 1, #masses do v[2 * i - 1 + k] = v[2 * i - 1 + k] - p / all end
    end
    return q, v
  end
end

local function nearly_round(random)
  local x, y = turn(1, 0, 6 * random())
  local speed = 0.9 + 0.2 * random()
  return { x, y, 0.2 * random() }, { -y * speed, x * speed, 0.4 * random() }
end

-- a top's axis anywhere, turning
local SO3 = dm.SO(3)
local function turning(random)
  return SO3:exp { 2 * random() - 1, 2 * random() - 1, 2 * random() - 1 }, { random(), random(), 1 + random() }
end

-- two bodies on a universal joint, R1 e1 . R2 e2 = 0, turned anywhere
local PAIR = dm.product(SO3, SO3)
local function joined_bodies(random)
  local R, spin = SO3:exp { 2 * random() - 1, 2 * random() - 1, 2 * random() - 1 }, random() - 0.5
  return { R, R }, { random() - 0.5, random(), spin, random(), random() - 0.5, spin }
end

local function angular(q, p) return q[1] * p[2] - q[2] * p[1] end
local function angular_of_two(q, p) return angular(q, p) + q[3] * p[4] - q[4] * p[3] end
local function total(_, p)
  local sum = 0
  for i = 1, #p do sum = sum + p[i] end
  return sum
end
local function vertical(R, p) return R[3][1] * p[1] + R[3][2] * p[2] + R[3][3] * p[3] end
local function of_both(g, p) return vertical(g[1], p:slice(1, 3)) + vertical(g[2], p:slice(4, 6)) end
local function impulse(q)
  local sum = 0
  for i = 1, 3 do sum = sum + G[i] * (q[2 * i - 1] ^ 2 + q[2 * i] ^ 2) / 2 end
  return sum
end

local few = { "verlet", "symplectic-euler", "yoshida(4)", "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "gauss(6)", "lobatto(3)" }
local more = { "verlet", "symplectic-euler", "yoshida(4)", "blanes-moan(6)", "midpoint", "gauss(2)", "gauss(3)", "gauss(6)",
  "lobatto(3)", "lobatto(4)", "trapezoidal", "del", "galerkin(2, gauss(3))" }
local explicit = { "verlet", "symplectic-euler", "yoshida(4)", "yoshida(6)", "suzuki(4)", "mclachlan(4)", "kahan-li(6)",
  "kahan-li(8)", "suzuki-umeno(8)", "sofroniou-spaletta(10)", "blanes-moan(4)", "blanes-moan(6)" }
local implicit = { "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "gauss(6)", "gauss(8)", "lobatto(3)", "lobatto(4)",
  "galerkin(2, gauss(3))", "galerkin(3, radau(3))", "sprk(radau-2a, 2)", "sprk(lobatto-3b-3a, 3)",
  "yoshida(4, midpoint)", "del", "curve(rk4)", "curve(euler, 0.5)" }
-- rules that have no name: curves in a space of functions
local own = { trial = dm.galerkin { functions = function(t) return { 1, t, dm.cos(t), dm.sin(t) } end, quadrature = "gauss(3)" } }

local function joined(...)
  local out = {}
  for _, list in ipairs { ... } do table.move(list, 1, #list, #out + 1, out) end
  return out
end

local systems = {
  { name = "Kepler", h = 0.05, start = ellipse, J = angular, rules = joined(explicit, implicit, { "log-hamiltonian", "trial", "sem(1, gauss(1))" }),
    system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end } },
  { name = "moving mass", h = 0.05, start = around, J = angular,
    rules = joined({ "verlet", "symplectic-euler", "yoshida(4)" }, implicit),
    system = dm.system { Q = dm.R(2), L = function(q, v) return (1 + q:dot(q) / 4) * v:dot(v) / 2 - q:dot(q) / 2 end } },
  { name = "by its H", h = 0.05, start = around, J = angular, by_p = true,
    rules = few,
    system = dm.system { Q = dm.R(2), H = function(q, p) return p:dot(p) / (2 + q:dot(q) / 2) + q:dot(q) / 2 end } },
  { name = "top", h = 0.05, start = turning, J = vertical, by_p = true,
    rules = { "lie(1)", "lie(2)", "lie(1, gauss(1), cayley)", "rotations(2)", "rotations(4)", "verlet", "gauss(2)", "lobatto(3)" },
    system = dm.system { Q = SO3, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end } },
  { name = "joint", h = 0.05, start = joined_bodies, J = of_both, rules = { "lie(1)", "lie(2)", "lie(1, gauss(1), cayley)" },
    system = dm.system { Q = PAIR, L = function(_, w)
      return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2 + 0.7 * w[4] ^ 2 + 0.9 * w[5] ^ 2 + 1.3 * w[6] ^ 2) / 2
    end, constraint = function(g)
      local sum = 0
      for i = 1, 3 do sum = sum + g[1][i][1] * g[2][i][2] end
      return sum
    end } },
  { name = "rational mass", h = 0.05, start = around, J = angular, rules = { "midpoint", "trapezoidal", "gauss(2)", "del" },
    system = dm.system { Q = dm.R(2), L = function(q, v)
      return v:dot(v) / (2 + 0.6 * q:dot(q)) + 0.3 * (q[1] * v[2] - q[2] * v[1]) - q:dot(q) / 2
    end } },
  { name = "on a sphere", h = 0.02, start = on_sphere, J = angular,
    rules = { "rattle", "shake", "yoshida(4, rattle)", "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)" },
    system = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end,
      constraint = function(q) return q:dot(q) - 1 end } },
  { name = "relativistic", h = 0.05, start = slowly, J = angular, rules = few,
    system = dm.system { Q = dm.R(2), L = function(q, v) return -sqrt(1 - v:dot(v)) - q:dot(q) / 8 end } },
  { name = "its H", h = 0.05, start = slowly, J = angular, by_p = true, rules = few,
    system = dm.system { Q = dm.R(2), H = function(q, p) return sqrt(1 + p:dot(p)) + q:dot(q) / 8 end } },
  { name = "magnetic", h = 0.05, start = slowly, J = angular, rules = few,
    system = dm.system { Q = dm.R(2), L = function(q, v)
      return v:dot(v) / 2 + (0.7 + 0.3 * q:dot(q)) * (q[1] * v[2] - q[2] * v[1]) - q:dot(q) / 2
    end } },
  { name = "ring", h = 0.05, start = ring, J = total, rules = few, system = dm.system { Q = dm.R(8), L = function(q, v)
    local sum = v:dot(v) / 2
    for i = 1, 8 do
      local d = q[i % 8 + 1] - q[i]
      sum = sum - d ^ 2 / 2 - 0.3 * d ^ 3 - 0.25 * d ^ 4
    end
    return sum
  end } },
  { name = "springs", h = 0.05, start = tied_to_origin, J = angular_of_two, rules = few, system = dm.system { Q = dm.R(4), L = function(q, v)
    local xx, xy, yy = q[1] ^ 2 + q[2] ^ 2, q[1] * q[3] + q[2] * q[4], q[3] ^ 2 + q[4] ^ 2
    return v:dot(v) / 2 - xx / 2 - 0.75 * yy / 2 - 0.25 * xy - 0.125 * yy ^ 2
  end } },
  { name = "weighted", h = 0.05, start = at_rest(near({ -0.7, 0, 0.3, 0 }, 0.4, { 0, -0.6, 0, 0.3 }, 0.3), { 0.7, 2.7 }),
    J = angular_of_two, rules = more, system = dm.system { Q = dm.R(4), L = function(q, v)
      local x, y, u, w = q:slice(1, 2), q:slice(3, 4), v:slice(1, 2), v:slice(3, 4)
      return 0.7 * u:dot(u) / 2 + 2.7 * w:dot(w) / 2 - 0.9 * ((x - y):norm() - 1.1) ^ 2
    end } },
  { name = "coupled", h = 0.05, start = near({ -0.7, 0, 0.3, 0.2 }, 0.4, { 0, -0.6, 0.2, 0.3 }, 0.3), J = angular_of_two,
    rules = more, system = dm.system { Q = dm.R(4), L = function(q, v)
      local x, y, u, w = q:slice(1, 2), q:slice(3, 4), v:slice(1, 2), v:slice(3, 4)
      return u:dot(u) / 2 + 1.7 * w:dot(w) / 2 + 0.3 * u:dot(w) - x:dot(x) / 2 - 0.7 * y:dot(y) / 2 - 0.3 * x:dot(y) - 0.1 * y:dot(y) ^ 2
    end } },
  { name = "J2", h = 0.05, start = nearly_round, J = angular, rules = more, system = dm.system { Q = dm.R(3), L = function(q, v)
    local r = q:norm()
    return v:dot(v) / 2 + 1 / r - 0.013 * (3 * q[3] ^ 2 / r ^ 5 - 1 / r ^ 3) / 2
  end } },
  { name = "exp", h = 0.05, start = near({ 0.8, 0 }, 0.5, { 0, 0.8 }, 0.5), J = angular,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "lobatto(3)" }, system = dm.system { Q = dm.R(2), L = function(q, v)
      return v:dot(v) * dm.exp(-0.3 * q:dot(q)) / 2 + 0.9 * dm.exp(-q:dot(q) / 1.7) - 0.1 * q:dot(q) ^ 2 + 0.2 * (q[1] * v[2] - q[2] * v[1])
    end } },
  { name = "vortices", h = 0.05, start = vortices, J = impulse, rules = { "degenerate(1)", "degenerate(2)" },
    system = dm.system { Q = dm.R(6), L = function(q, v)
      local sum = 0
      for i = 1, 3 do
        local x, y = q[2 * i - 1], q[2 * i]
        sum = sum + G[i] * (x * v[2 * i] - y * v[2 * i - 1]) / 2
        for j = 1, i - 1 do sum = sum + G[i] * G[j] * log((x - q[2 * j - 1]) ^ 2 + (y - q[2 * j]) ^ 2) / (8 * math.pi) end
      end
      return sum
    end } },
}

-- rules whose theory says nothing of the energy (of the time-transformed one it does, at fixed s; of sem it is that of a step)
local moment_alone = { ["log-hamiltonian"] = true, ["sem(1, gauss(1))"] = true }

---- runs ----

local function solver_of(case, rule)
  if rule ~= "del" then return case.system:solver { rule = own[rule] or rule, h = case.h } end
  local L = case.system.given.L
  return dm.solver { dm.discrete_lagrangian { Q = case.system.Q, h = case.h, Ld = function(a, b, h)
    return h * (L(a, (b - a) / h) + L(b, (b - a) / h)) / 2
  end } }
end

local function mean_and_error(list)
  local mean, square = 0, 0
  for _, x in ipairs(list) do mean = mean + x / #list end
  for _, x in ipairs(list) do square = square + (x - mean) ^ 2 end
  return mean, sqrt(square / (#list * (#list - 1)))
end

-- energies of the rows, of the system itself where the rule has an Ld of its own
local function energies(case, rule, path)
  if rule ~= "del" then return path:energy() end
  local out = {}
  for i = 1, #path do out[i] = case.system:energy(path.q[i], path.p[i], path.t[i]) end
  return dm.vector(out)
end

-- The bits of all rows as one number: levels of the processor with the same one have the same slopes.
local function fingerprint(members)
  local sum = 0
  local function add(x)
    if type(x) == "number" then
      sum = sum * 31 + string.unpack("i8", string.pack("d", x))
    else
      for i = 1, #x do add(x[i]) end
    end
  end
  for i = 1, STARTS do
    local path = members:path(i)
    for k = 1, path and #path or 0 do
      add(path.q[k])
      add(path.p[k])
    end
  end
  return ("%08x"):format(sum >> 32 ~ sum & 0xffffffff)
end

-- slopes of J and of the energy of ten starts, and the fingerprint of their rows
local function slopes(case, rule, solver, steps, seed)
  math.randomseed(seed)
  local q, v, J, E = {}, {}, {}, {}
  for i = 1, STARTS do
    q[i], v[i] = case.start(math.random)
    if rule == "del" then v[i] = case.system:momentum(q[i], v[i]):totable() end
  end
  local options = { members = STARTS, steps = steps, every = math.max(1, steps // ROWS), threads = 1, q = q }
  options[(rule == "del" or case.by_p) and "p" or "v"] = v
  local members = solver:ensemble(options)
  for i = 1, STARTS do
    local path, moments = members:path(i), {}
    if members.status[i] ~= "ok" then return nil, members.status[i] end
    for k = 1, #path do moments[k] = case.J(path.q[k], path.p[k]) end
    J[i], E[i] = path:drift(dm.vector(moments)).per_time, path:drift(energies(case, rule, path)).per_time
  end
  return J, E, fingerprint(members)
end

-- "mean +- error" of slopes, and whether they miss
local function told(list)
  local mean, err = mean_and_error(list)
  return ("%9.1e +- %7.1e"):format(mean, err), math.abs(mean) > SIGMAS * err
end

local function row(case, rule)
  local solver = solver_of(case, rule)
  local clock = os.clock()
  local _, _, bits = slopes(case, rule, solver, 5000, 0)
  local begun, path_steps = os.clock(), 20000
  math.randomseed(1)
  local q, v = case.start(math.random)
  local one = rule == "del" and { q = q, p = case.system:momentum(q, v) } or case.by_p and { q = q, p = v } or { q = q, v = v }
  one.steps, one.every = path_steps, path_steps
  solver:run(one)
  local cost = (os.clock() - begun) / path_steps * 1e9
  local steps = cost > DEAR and math.min(most, 1e6) or most
  local out
  for try = 1, 2 do
    local J, E = slopes(case, rule, solver, steps // 1 | 0, try)
    if not J then return print(("%-12s %-24s %s"):format(case.name, rule, E)) end
    local of_J, missed = told(J)
    local of_E, also = told(E)
    if moment_alone[rule] then of_E, also = "-", false end
    out = ("%-12s %-24s %5.0e  %-22s %-22s"):format(case.name, rule, steps, of_J, of_E)
    if not (missed or also) then break end
    local what = (missed and "J" or "") .. (also and "E" or "")
    if try == 2 then out = out .. " DRIFTS: " .. what else print(out .. " again: " .. what) end
  end
  print(out .. (" %s (%.0f s)"):format(bits or "", os.clock() - clock))
  io.stdout:flush()
end

print(("level %s: slopes per unit of time, mean of %d starts +- standard error"):format(level, STARTS))
print(("%-12s %-24s %-6s %-22s %-22s"):format("system", "rule", "steps", "J", "energy"))
for _, case in ipairs(systems) do
  for _, rule in ipairs(case.rules) do
    if (case.name .. " " .. rule):find(only, 1, true) then row(case, rule) end
  end
end
