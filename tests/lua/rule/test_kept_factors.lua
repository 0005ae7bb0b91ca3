-- random nearly linear models by stage methods whose steps sweeps cannot take: kept factors lead to the roots of the general form (L and the rate of a function of q), which makes its matrix in each step; runs in two parts and members have the same bits; a matrix that changes is not kept
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local STEPS = 24

local state = 16
local function uniform(a, b)
  state = (state * 16807) % 2147483647
  return a + (b - a) * state / 2147483647
end
local function pick(list) return list[1 + math.floor(uniform(0, #list))] end
local function square(n)
  local A = {}
  for i = 1, n do
    A[i] = {}
    for j = 1, n do A[i][j] = uniform(-1, 1) end
  end
  return A
end
local function row(A, x)
  local s = 0
  for j = 1, #A do s = s + A[j] * x[j] end
  return s
end

-- beside K, which is linear: what bends with the size eps
local bends = {
  function(s) return s ^ 4 end,
  function(s) return dm.cos(s) end,
  function(s) return dm.sqrt(1 + s ^ 2) end,
  function(s, t) return s ^ 2 * dm.sin(1.3 * t) end,
}
local function model(n, full, bend, eps, rate)
  local K, A = square(n), square(n)
  local function L(q, v, t)
    local sum = 0
    for i = 1, n do
      local s = row(K[i], q)
      sum = sum - s ^ 2 / 2 - 0.3 * q[i] ^ 2 - eps * bend(s, t)
      sum = sum + (full and row(A[i], v) ^ 2 + v[i] ^ 2 or (1 + i % 3) * v[i] ^ 2) / 2
    end
    return sum
  end
  local Q = dm.R(n)
  local plain = bend == bends[4] and L or function(q, v) return L(q, v, 0) end
  return dm.system { Q = Q, L = plain },
    dm.system { Q = Q, L = bend == bends[4] and function(q, v, t) return L(q, v, t) + rate(q, v) end or function(q, v) return L(q, v, 0) + rate(q, v) end }
end
local function farthest(a, b)
  local d, size = 0, 0
  for i = 1, #a do d, size = math.max(d, math.abs(a[i] - b[i])), math.max(size, math.abs(b[i])) end
  return d / size
end

local made, steps, worst, parts, together = 0, 0, 0, true, true
for _ = 1, 40 do
  local n = math.floor(uniform(2, 9))
  local bend, eps = pick(bends), 10 ^ uniform(-6, -1.5)
  local rule, h = pick { "gauss(2)", "gauss(3)", "gauss(4)", "gauss(8)", "galerkin(2, gauss(4))", "midpoint" }, uniform(1.2, 2.4)
  local system, general = model(n, uniform(0, 1) < 0.4, bend, eps, function(q, v) return q[1] * v[2] + q[2] * v[1] end)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = uniform(-1, 1), uniform(-1, 1) end
  local options, start = { rule = rule, h = h }, { q = q, v = v, steps = STEPS }
  local solver = system:solver(options)
  local path = solver:run(start)
  made, steps = made + solver:report().matrices, steps + STEPS
  worst = math.max(worst, farthest(path.q[#path], general:solver(options):run(start).q[STEPS + 1]))
  local file = os.tmpname()
  system:solver(options):run({ q = q, v = v, steps = 11 }):checkpoint(file)
  local rest = dm.resume(file, system):run { steps = STEPS - 11 }
  os.remove(file)
  parts = parts and farthest(rest.q[#rest], path.q[#path]) == 0
  local e = system:solver(options):ensemble { members = 5, q = function(k) return k == 4 and q or dm.vector(q) * (1 + k) end, v = function() return v end, steps = STEPS }
  together = together and farthest(e.q[4], path.q[#path]) == 0
end
ok(worst < 1e-11, "40 random models: where steps with new matrices lead", worst)
ok(made < 0.25 * steps, "by few matrices", made .. " in " .. steps .. " steps")
ok(parts, "two parts of a run, bit for bit")
ok(together, "and members of an ensemble")

-- L_qq grows threefold: old factors would need many iterations, or lead nowhere
local function growing(rate)
  return dm.system { Q = dm.R(6), L = function(q, v, t)
    local U = q[1] ^ 2 + q[6] ^ 2
    for i = 1, 5 do U = U + (q[i + 1] - q[i]) ^ 2 end
    return (v:dot(v) - (1 + 0.01 * t) * U) / 2 + rate * (q[1] * v[2] + q[2] * v[1])
  end }
end
local q = {}
for i = 1, 6 do q[i] = 0.3 * math.sin(i * i) end
local options, start = { rule = "gauss(4)", h = 2.35 }, { q = q, v = dm.zeros(6), steps = 100 }
local solver = growing(0):solver(options)
local path, report = solver:run(start), solver:report()
ok(report.matrices > 3 and report.newton < 10 * 100, "a matrix that changes is made again", report.matrices .. " matrices, " .. report.newton .. " iterations")
local other = growing(1):solver(options):run(start)
ok(farthest(path.q[101], other.q[101]) < 1e-11, "and steps lead where those with new ones do", farthest(path.q[101], other.q[101]))
tap.done()
