-- Coordinates in units far apart: a length of 1e11 beside an angle costs the angle no digits. What has settled is judged by every
-- coordinate's own size, so that a model in other units has the same solution, to the rounding of numbers in these units.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local cos, sin, abs, max = math.cos, math.sin, math.abs, math.max
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local UNITS = { 1e11, 0x1p37, 1e-11, 1e-4 }
local level = os.getenv "DMLUA_UNITS" -- the same tests in a process of their own

-- the worst difference between f(1) and f(s) over all units s, and where a run failed
local function worst(f)
  local known, most = f(1), 0
  for _, s in ipairs(UNITS) do
    local fine, z = pcall(f, s)
    if not fine then return math.huge, z end
    for i = 1, #known do most = max(most, abs(z[i] - known[i])) end
  end
  return most
end

-- coordinates `long` of the model are s times those at s = 1
local function ending(made, case, rule, backend)
  return function(s)
    local q, v = { table.unpack(case.q) }, { table.unpack(case.v) }
    for _, i in ipairs(case.long) do q[i], v[i] = q[i] * s, case.H and v[i] / s or v[i] * s end
    local path = dm.system(made(s)):solver { rule = rule, h = case.h or 0.05, backend = backend }
      :run { q = q, [case.H and "p" or "v"] = v, steps = case.steps or 150 }
    local z = path.q[#path.q]:totable()
    for _, i in ipairs(case.long) do z[i] = z[i] / s end
    return z
  end
end

local stages = { "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "gauss(6)", "gauss(9)", "lobatto(3)", "lobatto(4)",
  "galerkin(2, gauss(3))", "galerkin(3, lobatto(4))", "sprk(radau-2a, 2)", "curve(rk4)", "curve(euler, 0.5)", "yoshida(4, midpoint)" }
local cases = {
  -- masses that belong to the unit, and equal ones: then energies are far apart, too
  { name = "apart", rules = stages, q = { 0.7, 1.1 }, v = { 0.2, 0.3 }, long = { 1 }, made = function(s)
    return { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / s ^ 2 / 2 + v[2] ^ 2 / 2 + cos(q[2]) end } end },
  { name = "equal masses", rules = stages, q = { 0.7, 1.1 }, v = { 0.2, 0.3 }, long = { 1 }, made = function()
    return { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 + v[2] ^ 2 / 2 + cos(q[2]) end } end },
  { name = "mass that moves", rules = stages, q = { 0.7, 1.1 }, v = { 0.2, 0.3 }, long = { 1 }, made = function(s)
    return { Q = dm.R(2), L = function(q, v)
      local x, u = q[1] / s, v[1] / s
      return u ^ 2 / 2 + (1 + x ^ 2) * v[2] ^ 2 / 2 - (x - 1) ^ 2 / 2 + cos(q[2])
    end } end },
  -- the constraint is on the long ones, on the others, on both
  { name = "a large circle", long = { 1, 2 }, q = { 0.6, -0.8, 1.1 }, v = { 0.4, 0.3, 0.2 }, h = 0.02, made = function(s)
    return { Q = dm.R(3), L = function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 / s ^ 2 - q[2] / s + v[3] ^ 2 / 2 + cos(q[3]) end,
      constraint = function(q) return { (q[1] / s) ^ 2 + (q[2] / s) ^ 2 - 1 } end } end },
  { name = "a circle beside a length", long = { 3 }, q = { 0.6, -0.8, 0.7 }, v = { 0.4, 0.3, 0.2 }, h = 0.02, made = function(s)
    return { Q = dm.R(3), L = function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 - q[2] + (v[3] ^ 2 - q[3] ^ 2) / 2 / s ^ 2 end,
      constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - 1 } end } end },
  { name = "a pendulum on a slider", long = { 1 }, q = { 0.3, 0.9, -0.8 }, v = { 0.1, 0.1, 0 }, h = 0.02, made = function(s)
    return { Q = dm.R(3), L = function(q, v) return (v[1] / s) ^ 2 - (q[1] / s) ^ 2 / 2 + (v[2] ^ 2 + v[3] ^ 2) / 2 - q[3] end,
      constraint = function(q) return { (q[2] - q[1] / s) ^ 2 + q[3] ^ 2 - 1 } end } end },
  { name = "a skate", long = { 1, 2 }, q = { 0.1, 0.2, 0.3 }, v = { cos(0.3), sin(0.3), 0.5 }, h = 0.02,
    rules = { "midpoint", "gauss(2)", "lobatto(3)", "lobatto(4)", "curve(rk4)" }, made = function(s)
    return { Q = dm.R(3), L = function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 / s ^ 2 + v[3] ^ 2 / 2 - 0.3 * q[1] / s + cos(2 * q[3]) end,
      rolling = function(q, v) return { v[1] / s * sin(q[3]) - v[2] / s * cos(q[3]) } end } end },
  { name = "an H", H = true, long = { 1 }, q = { 0.7, 1.1 }, v = { 0.2, 0.3 },
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(9)", "lobatto(3)", "symplectic-euler", "verlet" }, made = function(s)
    return { Q = dm.R(2), H = function(q, p)
      return p[1] ^ 2 * s ^ 2 / 2 + q[1] ^ 2 / s ^ 2 / 2 + p[2] ^ 2 / 2 * (1 + 0.1 * cos(q[2])) - cos(q[2])
    end } end },
  { name = "linear in v", long = { 1, 2 }, q = { 0.7, 0.1, 0.4, 0.3 }, v = { 0, 0, 0, 0 }, h = 0.02, steps = 100,
    rules = { "degenerate(1)", "degenerate(2)" }, made = function(s)
    return { Q = dm.R(4), L = function(q, v)
      local x, y = q[1] / s, q[2] / s
      return (x * v[2] - y * v[1]) / 2 / s + (q[3] * v[4] - q[4] * v[3]) / 2 - (x ^ 2 + y ^ 2) / 2 - x ^ 4 / 10 - cos(q[3]) - cosh(q[4])
    end } end },
}
local tied = { "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "lobatto(3)", "lobatto(4)", "rattle", "shake", "curve(rk4)",
  "curve(euler, 0.5)" }

for _, case in ipairs(cases) do
  for _, rule in ipairs(case.rules or tied) do
    local off, why = worst(ending(case.made, case, rule))
    ok(off < 3e-14, ("%s, %s: no digits lost"):format(case.name, rule), why or off)
  end
end
for _, rule in ipairs { "midpoint", "gauss(3)", "lobatto(3)" } do
  local case = cases[3]
  ok(worst(ending(case.made, case, rule, "tape")) < 3e-14, rule .. " on the tape, too")
end

---- discrete Lagrangians, steps and maps of a script, roots

local function pair(s)
  local D = dm.discrete_lagrangian { Q = dm.R(3), h = 0.05, Ld = function(a, b, h)
    local w, m = (b - a) / h, (a + b) / 2
    return h * ((w[1] ^ 2 + w[2] ^ 2) / 2 / s ^ 2 - m[2] / s + w[3] ^ 2 / 2 + cos(m[3]))
  end, constraint = function(q) return (q[1] ^ 2 + q[2] ^ 2) / s ^ 2 - 1 end }
  local z = D:solver {}:run { q = { 0.6 * s, -0.8 * s, 1.1 }, p = { 0.4 / s, 0.3 / s, 0.3 }, steps = 400 }.q[401]
  return { z[1] / s, z[2] / s, z[3] }
end
ok(worst(pair) < 3e-14, "del with a constraint", worst(pair))

local function root(s)
  local y = dm.root { equations = function(y, x)
    return { y[1] / s + sin(y[1] / s) / 10 - x[1], y[2] + sin(y[2]) / 5 - x[2] - y[1] / s / 10 }
  end, start = function(x) return { 0 * x[1], 0 * x[2] } end }
  local z = y(dm.vector { 0.7, 0.3 })
  return { z[1] / s, z[2] }
end
ok(worst(root) < 1e-15, "dm.root", worst(root))

---- ensembles in lanes: the same, with the bits of runs alone

local function lanes(rule)
  return function(s)
    local solver = dm.system(cases[3].made(s)):solver { rule = rule, h = 0.05 }
    local function q(i) return { (0.5 + 0.03 * i) * s, 1 + 0.01 * i } end
    local members = solver:ensemble { members = 13, threads = 1, steps = 300, q = q, v = function() return { 0.2 * s, 0.3 } end }
    local alone, out = solver:run { q = q(5), v = { 0.2 * s, 0.3 }, steps = 300 }.q[301], {}
    assert(alone[1] == members.q[5][1] and alone[2] == members.q[5][2], "a member has other bits than a run alone")
    for i = 1, 13 do out[2 * i - 1], out[2 * i] = members.q[i][1] / s, members.q[i][2] end
    return out
  end
end
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "gauss(6)", "lobatto(3)", "galerkin(2, gauss(3))" } do
  local off, why = worst(lanes(rule))
  ok(off < 3e-14, ("%s in lanes: no digits lost, the bits of runs alone"):format(rule), why or off)
end

---- coordinates that pass through 0, or stay there but for noise, keep no step waiting

local function iterations(start)
  local solver = dm.system { Q = dm.R(3), L = function(q, v)
    return (1 + q:dot(q) / 4) * v:dot(v) / 2 - q:dot(q) / 2 - ((q[1] - q[3]) + (q[3] - q[1])) ^ 2
  end }:solver { rule = "midpoint", h = 0.05 }
  solver:run { q = start.q, v = start.v, steps = 5000, every = 5000 }
  return solver:report().newton_per_step
end
local turning = iterations { q = { 0.4, 0.3, 0.2 }, v = { 0, 1, 0.3 } }
ok(turning < 2.3, "oscillating coordinates: two iterations a step", turning)
local noise = iterations { q = { 0.4, 0.3, 1e-17 }, v = { 0, 1, 0 } }
ok(noise < 2.3, "as with one of 1e-17", noise)

---- every kind of processor

if not level then
  for _, processor in ipairs { "plain", "fma", "avx512" } do
    local fine = os.execute(("DMLUA_UNITS=1 DMLUA_PROCESSOR=%s %s %s >/dev/null"):format(processor, arg[-1], arg[0]))
    ok(fine, "the same at level " .. processor)
  end
end
tap.done()
