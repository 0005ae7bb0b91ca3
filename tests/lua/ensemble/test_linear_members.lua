-- members of a quadratic L that is not separable: lanes keep the factors of a step's matrix, one for every h; bits are those of runs alone, whatever ran before
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin = math.sin

local N, STEPS, MEMBERS = 12, 60, 11
local system = dm.system { Q = dm.R(N), L = function(x, u)
  local L = u:dot(u) / 2 - x[1] ^ 2 / 2 - x[N] ^ 2 / 2
  for i = 1, N - 1 do L = L - (x[i + 1] - x[i]) ^ 2 / 2 end
  for i = 1, N - 1, 2 do L = L + 0.3 * (x[i] * u[i + 1] - x[i + 1] * u[i]) end
  return L
end }
local function start(k)
  local q, v = {}, {}
  for i = 1, N do q[i], v[i] = sin(i * k), 0.3 * sin(i + k * k) end
  return q, v
end
local function same(a, b)
  for i = 1, N do if a[i] ~= b[i] then return false end end
  return true
end
-- members with steps of their own, beside runs of their own by solvers of their own
local function members_are_runs(rule, h)
  local e = system:solver({ rule = rule, h = h(1) }):ensemble { members = MEMBERS, h = h, q = function(k) return (start(k)) end, v = function(k) return select(2, start(k)) end, steps = STEPS }
  local all = true
  for k = 1, MEMBERS do
    local q, v = start(k)
    local path = system:solver({ rule = rule, h = h(k) }):run { q = q, v = v, steps = STEPS, every = STEPS }
    all = all and same(path.q[2], e.q[k]) and same(path.p[2], e.p[k])
  end
  return all
end
-- methods of as many stages and points one after the other: factors are not those of the other
for _, rule in ipairs { "lobatto(3)", "galerkin(2, radau(3))", "galerkin(2, lobatto(3))", "galerkin(2, gauss(3))", "lobatto(3)", "midpoint", "gauss(2)", "galerkin(1, lobatto(2))" } do
  ok(members_are_runs(rule, function() return 0.8 end), rule .. ": members have the bits of runs alone")
  ok(members_are_runs(rule, function(k) return k % 2 == 0 and 0.8 or 0.1 * k end), rule .. ": and with steps of their own")
  ok(members_are_runs(rule, function(k) return 0.8 + 1e-3 * k end), rule .. ": also where factors of the next would do")
end
tap.done()
