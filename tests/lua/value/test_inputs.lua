-- parameters as inputs of kernels: members with parameters of their own have the bits of runs of such systems
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local most = dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 end }):solver({ rule = "verlet", h = 0.1 })
  :ensemble({ members = 1, q = { { 1 } }, v = { { 0 } }, steps = 1 }).lanes

local function start(i, n, speed)
  local q, v = { 0.5 + 0.01 * i }, { speed and speed(i) or 0.1 }
  for k = 2, n do q[k], v[k] = 0.1, 0.9 end
  return q, v
end

-- ensemble and runs of the systems that its members stand for: how many differ, and the ensemble
local function differ(case, rule, sums)
  local n, members, differences = case.n or 1, case.members or 23, 0
  local options = { rule = rule, h = 0.01, sums = sums, backend = case.backend }
  local system = dm.system { Q = dm.R(n), params = case.params, L = case.L }
  local e = system:solver(options):ensemble { members = members, steps = 60, t0 = 0.3, h = case.h, vary = case.vary, threads = case.threads,
    watch = case.watch, q = function(i) return (start(i, n, case.speed)) end, v = function(i) return select(2, start(i, n, case.speed)) end }
  for i = 1, members do
    local own = {}
    for name, value in pairs(case.params) do own[name] = case.vary[name] and case.vary[name](i) or value end
    options.h = case.h and case.h(i) or 0.01
    local q, v = start(i, n, case.speed)
    local single = dm.system({ Q = dm.R(n), params = own, L = case.L }):solver(options)
    local fine, path = pcall(single.run, single, { q = q, v = v, steps = 60, every = not case.watch and 60 or nil, t0 = 0.3, watch = case.watch })
    local same = fine == (e.status[i] == "ok")
    if same and not fine then
      same = path.step - 1 == e.steps[i]
    elseif same and case.watch then
      for _, name in ipairs(case.watch) do same = same and path:column(name) == e:path(i):column(name) end
    elseif same then
      same = path.q[#path] == e.q[i] and path.p[#path] == e.p[i]
    end
    if not same then differences = differences + 1 end
  end
  return differences, e
end

local function k(i) return i % 5 * 0.25 end
local function pendulum(q, v, _, c) return v[1] ^ 2 / 2 + c.k * math.cos(q[1]) end
local function pulled(q, v, t, c) return v:dot(v) / 2 + c.k / q:norm() + c.g * t * q[1] end
local cases = {
  { "pendulum", L = pendulum, params = { k = 1 }, vary = { k = k } },
  { "like terms that numbers would join", L = function(q, v, _, c) return v[1] ^ 2 / 2 - c.k / 3 * q[1] ^ 3 - c.k * c.g * q[1] ^ 3 end,
    params = { k = 1, g = 0.7 }, vary = { k = k } },
  { "satellite", n = 2, params = { mu = 1, J = 0.01 }, vary = { J = function(i) return 1e-3 * i end, mu = function(i) return 1 + 0.01 * i end },
    L = function(q, v, _, c)
      local r = q:norm()
      return v:dot(v) / 2 + c.mu / r + c.J * c.mu / r ^ 3 * (1 - 3 * q[2] ^ 2 / r ^ 2)
    end },
  { "time", n = 2, L = pulled, params = { k = 1, g = 0.3 }, vary = { g = k } },
  { "many coordinates", n = 9, L = function(q, v, _, c) return v:dot(v) / 2 - c.k * q:dot(q) ^ 2 end, params = { k = 1 }, vary = { k = k } },
  { "other entries of params", n = 2, L = function(q, v, _, c) return v:dot(v) / 2 - c.T[1] * q:dot(q) - c.b * q[1] end,
    params = { T = { 2 }, b = 2, name = "x" }, vary = { b = k } },
  { "a mass that stays", L = function(q, v, _, c) return c.m * v[1] ^ 2 / 2 - c.k * c.m * q[1] ^ 2 / 2 end, params = { k = 1, m = 3 }, vary = { k = k } },
  { "steps of their own", L = pendulum, params = { k = 1 }, vary = { k = k }, h = function(i) return 0.01 * (1 + i // 9) end },
  { "what is watched", L = pendulum, params = { k = 1 }, vary = { k = k }, watch = { "q1", "energy" }, threads = 2 },
  { "threads", L = pendulum, params = { k = 1 }, vary = { k = k }, members = 101, threads = 3 },
  { "members that fail", L = function(q, v, _, c) return v[1] ^ 2 / 2 + c.k * math.sqrt(1 - q[1] ^ 2) end, params = { k = 1 },
    vary = { k = function(i) return 0.1 * i end }, speed = function(i) return i % 6 == 0 and 3 or 0.1 end, fails = true },
  -- those that cannot be inputs: a system for every value
  { "equality", L = function(q, v, _, c) return c.k == 0 and v[1] ^ 2 / 2 - q[1] ^ 4 or v[1] ^ 2 / 2 - c.k * q[1] ^ 2 end, params = { k = 1 }, vary = { k = k } },
  { "order", L = function(q, v, _, c) return c.k > 0.4 and v[1] ^ 2 / 2 - q[1] ^ 4 or v[1] ^ 2 / 2 - c.k * q[1] ^ 2 end, params = { k = 1 }, vary = { k = k } },
  { "the end of a loop", params = { n = 1 }, vary = { n = function(i) return 1 + i % 3 end }, L = function(q, v, _, c)
    local V = 0
    for i = 1, c.n do V = V + q[1] ^ (2 * i) / i end
    return v[1] ^ 2 / 2 - V
  end },
  { "a mass", L = function(q, v, _, c) return c.m * v[1] ^ 2 / 2 - c.k * q[1] ^ 2 / 2 end, params = { k = 1, m = 1 },
    vary = { k = k, m = function(i) return 1 + i // 10 end } },
  { "a magnetic field", n = 2, L = function(q, v, _, c) return v:dot(v) / 2 + c.k * (q[1] * v[2] - q[2] * v[1]) end, params = { k = 1 }, vary = { k = k }, rule = "midpoint" },
  { "the tape", L = pendulum, params = { k = 1 }, vary = { k = k }, backend = "tape" },
}
for _, case in ipairs(cases) do
  local rules = case.rule and { case.rule } or { "verlet", "blanes-moan(6, 11)", "symplectic-euler" }
  for i, rule in ipairs(rules) do
    local count, e = differ(case, rule)
    ok(count == 0, ("%s, %s: members are runs of their systems, bit for bit"):format(case[1], rule), count)
    ok((#e:failures() > 0) == (case.fails or false), case[1] .. ": who fails alone fails here", #e:failures())
    if i == 1 and not case.rule then ok(e.lanes == (case.backend and 1 or most), case[1] .. ": side by side", e.lanes) end
  end
  if not case.rule then ok(differ(case, "verlet", "plain") == 0, case[1] .. ": with plain sums too") end
end

-- one trace for all values
local calls = 0
local counted = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, c)
  if type(q[1]) ~= "number" then calls = calls + 1 end
  return v[1] ^ 2 / 2 - c.k * q[1] ^ 2
end }
counted:solver({ rule = "verlet", h = 0.01 }):ensemble { members = 300, q = function() return { 1 } end, v = function() return { 0 } end, steps = 1,
  threads = 1, vary = { k = function(i) return i end } }
ok(calls < 10, "300 values are traced a few times", calls)
-- a checkpoint of a system with parameters
local whole = counted:solver { rule = "verlet", h = 0.01 }
local half = whole:run { q = { 1 }, v = { 0 }, steps = 40 }
ok(dm.resume(half):run({ steps = 60 }).q[61] == whole:run({ q = { 1 }, v = { 0 }, steps = 100 }).q[101], "a run goes on bit for bit")
tap.done()
