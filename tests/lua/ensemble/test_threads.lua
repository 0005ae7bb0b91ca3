-- every rule on every kind of system: members of ensembles of several threads are runs of their own, bit for bit. Under `make tsan`,
-- where a race need not change a bit to be seen, native code too
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local vector, sin, cos, log = dm.vector, dm.sin, dm.cos, dm.log
local all = os.getenv "UNDER" == "tsan"
local G = dm.SO(3)
local plane = dm.group { dimension = 2, identity = { 0, 0 }, mul = function(a, b) return a + b end, inv = function(a) return -a end,
  exp = function(x) return x end, log = function(g) return g end }
local anomaly = dm.root { name = "anomaly", start = function(M) return M end,
  equations = function(E, M, e) return E - e * sin(E) - M end }
local shape = dm.root { name = "shape", start = { 1, 0, 0, 1 }, branch = function(y) return y[1] + y[4] end,
  equations = function(y, a)
    return { y[1] * y[1] + y[2] * y[3] - a[1], y[1] * y[2] + y[2] * y[4] - a[2],
      y[3] * y[1] + y[4] * y[3] - a[3], y[3] * y[2] + y[4] * y[4] - a[4] }
  end }
local function T(v) return v:dot(v) / 2 end
local function q2(i) return { 0.9 + 0.02 * i, 0.1 * i } end
local function v2(i) return { 0.1, 0.9 - 0.03 * i } end
local function angle(i) return 0.3 + 0.1 * i end

-- name, system, q and v of a member; p where there is no v, what varies
local systems = {
  { "Kepler", { Q = dm.R(2), L = function(q, v) return T(v) + 1 / q:norm() end }, q2, v2 },
  { "bent mass", { Q = dm.R(2), L = function(q, v) return (1 + q[1] ^ 2 / 4) * T(v) + 0.1 * q[2] * v[1] - T(q) - q[1] ^ 4 / 8 end }, q2, v2 },
  { "timed, quartic", { Q = dm.R(2), L = function(q, v, t) return T(v) + v[1] ^ 4 / 50 - T(q) * (1 + 0.1 * cos(t)) end }, q2, v2 },
  { "params", { Q = dm.R(2), params = { k = 1, m = 1 }, L = function(q, v, t, c) return c.m * T(v) - c.k * T(q) - q[1] ^ 3 / 9 end }, q2, v2,
    { vary = { k = function(i) return 1 + (i % 3) / 10 end } } },
  { "params in mass", { Q = dm.R(2), params = { k = 1, m = 1 }, L = function(q, v, t, c) return c.m * (1 + q[1] ^ 2 / 10) * T(v) - c.k * T(q) end }, q2, v2,
    { vary = { m = function(i) return 1 + (i % 3) / 10 end } } },
  { "friction", { Q = dm.R(2), L = function(q, v) return T(v) - T(q) - q[1] ^ 4 / 8 end, force = function(q, v, t) return -0.1 * v + 0.01 * q * sin(t) end }, q2, v2 },
  { "friction by a root", { Q = dm.R(2), L = function(q, v) return T(v) - T(q) end, force = function(q, v) return -0.1 * v * anomaly(q[1], 0.3) end }, q2, v2 },
  { "pendulum in space", { Q = dm.R(3), L = function(q, v) return T(v) - q[3] end, constraint = function(q) return q:dot(q) - 1 end },
    function(i) return { sin(angle(i)), 0, -cos(angle(i)) } end, function(i) return { 0, 0.4 + 0.03 * i, 0 } end },
  { "constraint by a root", { Q = dm.R(2), L = function(q, v) return T(v) - q[2] end, constraint = function(q) return q[2] - anomaly(q[1], 0.2) end },
    function(i) return { 0.1 * i, anomaly(0.1 * i, 0.2) } end, function() return { 0, 0 } end },
  { "sleigh", { Q = dm.R(3), L = function(q, v) return T(v) - 0.2 * q[1] end, rolling = function(q, v) return v[1] * sin(q[3]) - v[2] * cos(q[3]) end,
    force = function(q, v) return -0.05 * v end },
    function(i) return { 0.1 * i, 0, 0.2 } end, function(i) return { cos(0.2), sin(0.2), 0.3 + 0.02 * i } end },
  { "sphere", { Q = dm.S(2), L = function(q, v) return T(v) - q[3] - 0.3 * q[1] ^ 2 end },
    function(i) return { sin(angle(i)), 0, -cos(angle(i)) } end, function(i) return { 0, 0.4 + 0.03 * i, 0 } end },
  { "torus", { Q = dm.T(2), L = function(q, v) return v[1] ^ 2 + v[2] ^ 2 / 2 + cos(q[1] - q[2]) * v[1] * v[2] + 2 * cos(q[1]) + cos(q[2]) end }, q2, v2 },
  { "H", { Q = dm.R(2), H = function(q, p) return (1 + q[1] ^ 2 / 5) * T(p) + T(q) + q[2] ^ 3 / 9 + p[1] ^ 4 / 40 end }, q2, nil, { p = v2 } },
  { "H separable", { Q = dm.R(2), H = function(q, p) return p[1] ^ 4 / 4 + p[2] ^ 2 / 2 + T(q) + q[2] ^ 3 / 9 end }, q2, nil, { p = v2 } },
  { "body", { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end },
    function(i) return G:exp { 0.4 + 0.01 * i, 0.02 * i, -0.01 * i } end, nil, { p = function(i) return { 0.2 + 0.03 * i, 0.1, 1 } end } },
  { "driven body", { Q = G, L = function(R, w, t) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] + 0.2 * R[1][3] * sin(3 * t) end,
    force = function(_, w) return -0.05 * w end },
    function(i) return G:exp { 0.4 + 0.01 * i, 0.02 * i, -0.01 * i } end, nil, { p = function(i) return { 0.2 + 0.03 * i, 0.1, 1 } end } },
  { "joint", { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[1][3] end, constraint = function(R) return R[3][1] end },
    function(i) return G:exp { 0, 0, 0.1 * i } end, nil, { p = function(i) return { 0, 0, 0.6 + 0.1 * i } end } },
  { "SE(2)", { Q = dm.SE(2), L = function(g, x) return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2) / 2 - g[1] ^ 2 / 2 - g[2] end },
    function(i) return dm.SE(2):exp { 0.1 * i, 0.2, 0.3 } end, nil, { p = function(i) return { 0.5, 0.1 * i, 0.3 } end } },
  { "roots in L", { Q = dm.R(2), L = function(q, v) return T(v) - anomaly(q[1], 0.3) ^ 2 / 2 - q[2] ^ 2 / 2 end }, q2, v2 },
  { "four roots in L", { Q = dm.R(2), L = function(q, v)
    local s = shape { 2 + q[1] ^ 2, 0.3, 0.3, 1.5 + q[2] ^ 2 }
    return (v[1] ^ 2 * s[1] + v[2] ^ 2 * s[4]) / 2 - s[2] * q[1] * q[2] - T(q) end }, q2, v2 },
  { "vortices", { Q = dm.R(4), L = function(q, v) -- point vortices
    return (q[1] * v[2] - q[2] * v[1]) / 2 + (q[3] * v[4] - q[4] * v[3]) + log((q[1] - q[3]) ^ 2 + (q[2] - q[4]) ^ 2) / 2 end },
    function(i) return { 1, 0.1 * i, -1, 0.2 } end, nil, {} },
  { "plane of its own", { Q = plane, L = function(g, x) return T(x) - cos(g[1]) - g[2] ^ 2 / 2 end }, q2, nil, { p = v2 } },
}
local function kepler_like(x) return (x[1] ^ 2 + x[2] ^ 2 + 0.1) ^ 0.5 end
local own = {
  { "curve chosen", dm.curve { method = "rk4", substeps = function(x) return 1.6 / kepler_like(x) end } },
  { "curve chosen by a root", dm.curve { method = "heun", substeps = function(x) return 1 + anomaly(x[1], 0.4) ^ 2 end } },
  { "curve weights", dm.curve { method = "kutta3", bias = 0.5, substeps = function(x) return { 1, 2 / kepler_like(x), 1 } end } },
  { "taylor", dm.curve { method = function(x, f, h) local k = f(x) return x + h * k + h ^ 2 / 2 * f:along(x, k) end } },
  { "taylor chosen", dm.curve { method = function(x, f, h) local k = f(x) return x + h * k + h ^ 2 / 2 * f:along(x, k) end, substeps = function(x) return 1.6 / kepler_like(x) end } },
  { "own table", dm.curve { method = function(x, f, h) local k = f(x) return x + h * f(x + h / 2 * k) end, bias = 0.5 } },
  { "galerkin object", dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } } },
  { "trial functions", dm.galerkin { functions = function(t, h) return { 1, t, cos(t), sin(t) } end, quadrature = "gauss(5)" } },
  { "trial curve", dm.galerkin { parameters = 6, curve = function(t, z, h) return { z[1] + z[2] * t + z[3] * t ^ 2, z[4] + z[5] * t + z[6] * t ^ 2 + z[1] * 0 } end,
    start = function(q, v, h) return { q[1], v[1], 0, q[2], v[2], 0 } end, quadrature = "gauss(3)" } },
  { "own midpoint", dm.step { unknowns = 4, order = 2, start = function(y, h) return { y.q[1], y.q[2], y.p[1], y.p[2] } end,
    equation = function(y, x, h, m)
      local q, p = vector { (y.q[1] + x[1]) / 2, (y.q[2] + x[2]) / 2 }, vector { (y.p[1] + x[3]) / 2, (y.p[2] + x[4]) / 2 }
      local a, b = m.H_p(q, p, y.t + h / 2), m.H_q(q, p, y.t + h / 2)
      return { x[1] - y.q[1] - h * a[1], x[2] - y.q[2] - h * a[2], x[3] - y.p[1] + h * b[1], x[4] - y.p[2] + h * b[2] }
    end, next = function(y, x) return { q = { x[1], x[2] }, p = { x[3], x[4] } } end } },
  { "own with parts", dm.step { unknowns = 2, order = 1, parts = { { "F", 1 } }, begin = function(x, y) return { F = x[1] * y[1] } end,
    start = function(y, h) return { 0, 0 } end,
    equation = function(y, x, h, m) local a = m.H_p(y.q, y.p, y.t) return { x[1] - h * a[1], x[2] - h * a[2] } end,
    next = function(y, x, h, m) local b = m.H_q(y.q, y.p, y.t) return { q = y.q + x, p = y.p - h * b, F = y.F + h * y.q[1] ^ 2 } end } },
}

local names = {}
local function add(name) names[#names + 1] = { name, name } end
for _, r in ipairs(dm.rules()) do
  for k, instance in ipairs(r.instances or {}) do
    if k == 2 or #r.instances == 1 then add(tostring(instance.rule or instance.name or instance)) end
  end
end
for _, name in ipairs { "verlet", "rattle", "shake", "rkmk4", "crouch-grossman3", "rotations", "sem(2, gauss(2))", "degenerate(2)", "log-hamiltonian",
  "yoshida(4, rattle)", "gauss(3, 4)", "lie(1, gauss(1), cayley)" } do
  add(name)
end
for _, rule in ipairs(own) do names[#names + 1] = rule end

---- bits ----

local function text(x)
  if type(x) == "number" then return ("%a"):format(x) end
  if x == nil then return "nil" end
  local out = {}
  for i = 1, #x do out[i] = text(x[i]) end
  return table.concat(out, " ")
end
local function rows(path)
  local out = {}
  for i = 1, #path do out[i] = text(path.q[i]) .. " " .. text(path.p[i]) end
  return table.concat(out, "\n")
end

local MEMBERS, STEPS, H = 5, 5, 0.05
local backends = all and { "tape", "jit" } or { "tape" }

-- members that are not runs of their own, and how many there are; nil: the rule does not step the system
local function unlike(s, system, rule, backend)
  local q, v, more = s[3], s[4], s[5] or {}
  local fine, solver, e = pcall(function()
    local solver = system:solver { rule = rule, h = H, backend = backend }
    return solver, solver:ensemble { q = q, v = v, p = more.p, vary = more.vary, members = MEMBERS, steps = STEPS, threads = 3, every = 1 }
  end)
  if not fine then return nil end
  local wrong = {}
  for i = 1, MEMBERS do
    local one = solver
    if more.vary then
      local params = {}
      for name, value in pairs(s[2].params) do params[name] = more.vary[name] and more.vary[name](i) or value end
      one = dm.system({ Q = s[2].Q, L = s[2].L, params = params }):solver { rule = rule, h = H, backend = backend }
    end
    local ran, path = pcall(one.run, one, { q = q(i), v = v and v(i), p = more.p and more.p(i), steps = STEPS })
    if not ran then path = path.path end
    if ran ~= (e.status[i] == "ok") or rows(e:path(i)) ~= rows(path) then wrong[#wrong + 1] = i end
  end
  return wrong
end

-- every rule and every system, and of the pairs one in three, under sanitizers in four; SAMPLES=1: all
local stride, ensembles = all and 1 or math.min(4, 60 // tap.samples(60)), 0
for k, s in ipairs(systems) do
  local system, wrong, many = dm.system(s[2]), {}, 0
  local function try(every)
    for j, rule in ipairs(names) do
      for _, backend in ipairs((j + k) % every == 0 and backends or {}) do
        local members = unlike(s, system, rule[2], backend)
        if members then many = many + 1 end
        if members and #members > 0 then wrong[#wrong + 1] = ("%s, %s: %s"):format(rule[1], backend, table.concat(members, " ")) end
      end
    end
  end
  try(stride)
  if many == 0 then try(1) end -- few rules step it
  ensembles = ensembles + many
  ok(#wrong == 0 and many > 0, ("%s: members of three threads are runs of their own, by %d rules"):format(s[1], many), table.concat(wrong, "; "))
end
ok(ensembles > 400 / stride, "most rules step most systems", ensembles)
tap.done()
