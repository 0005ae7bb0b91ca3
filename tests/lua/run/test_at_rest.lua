-- motions that friction brings to rest away from 0, and small ones about such a place: what is left of forces there is
-- round-off of the position, which their own terms do not tell
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

local RULES = { "midpoint", "gauss(2)", "gauss(4)", "lobatto(3)" }
-- n masses between springs, the first of one mass alone at 1, with friction v/2: without a spring to a wall the mean goes on by
-- 2 of its velocity
local function masses(n)
  return dm.system { Q = dm.R(n), force = function(_, v) return -0.5 * v end, L = function(q, v)
    local sum = v:dot(v) / 2 - (n == 1 and (q[1] - 1) ^ 2 / 2 or 0)
    for i = 2, n do sum = sum - 3.5 * (q[i] - q[i - 1]) ^ 2 end
    return sum
  end }
end
for _, n in ipairs { 1, 2, 5 } do
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = 3 + 0.1 * math.sin(i), n > 1 and 0.2 or 0 end
  local mean = dm.vector(q):sum() / n
  for _, rule in ipairs(RULES) do
    local solver = masses(n):solver { rule = rule, h = 0.05 }
    local run = solver:run { q = q, v = v, steps = 6000, every = 6000 }
    near(run.q[2]:sum() / n, n == 1 and 1 or mean + 0.4, 1e-13, ("%d at rest, by %s"):format(n, rule))
    ok(run.p[2]:norm() < 1e-14, "at rest", run.p[2]:norm())
    local e = solver:ensemble { members = 4, steps = 6000, q = function(i) local x = {} for k = 1, n do x[k] = i * q[k] end return x end,
      v = function(i) local x = {} for k = 1, n do x[k] = i * v[k] end return x end }
    ok(e.q[1] == run.q[2] and e.status[4] == "ok", "and as members")
  end
end

-- fields: friction, absorbing ends, and a small oscillation about 0.8 without either
local K = dm.mesh { triangle = 4 }
local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local steps = { friction = 2000, absorbing = 1000, free = 1000 }
local kinds = { friction = { L = wave, force = function(_, V) return -0.5 * V end }, absorbing = { L = wave, absorbing = "boundary" }, free = { L = wave } }
for name, kind in pairs(kinds) do
  local field = K:field(kind)
  for _, rule in ipairs(RULES) do
    local size = name == "free" and 1e-9 or 0.1
    local run = field:solver { rule = rule, h = 0.2 }:run { q = function(x) return 0.8 + size * math.sin(3 * x) end, v = function() return 0 end, steps = steps[name], every = steps[name] }
    local still = run.p[2]:norm()
    ok(name == "free" and still > 1e-11 and still < 1e-8 or still < 1e-14, ("%s, by %s"):format(name, rule), still)
  end
end

-- coordinates of unlike units: beside one at 1e8 another of 1e-6 is no noise. A stiff spring that bends, in units of its size
local function bent(w, k, c) return k * w ^ 2 / 2 + c * w ^ 4 end
local function beside(place, size, k, c, rule, friction)
  local system = dm.system { Q = dm.R(2), force = friction or nil,
    L = function(q, v) return v:dot(v) / 2 - size ^ 2 * bent(q[2] / size, k, c) end }
  local run = system:solver { rule = rule, h = 0.3 }:run { q = { place, size }, v = { 0, 0.3 * size }, steps = 40 }
  return run.q[41][2] / size
end
local function field_beside(place, size, k, c, rule, friction)
  local field = K:field { values = 2, force = friction or nil, L = function(u, v)
    return v:dot(v) / 2 - u:d():dot(u:d()) / 2 - K:sum(0, function(x) return size ^ 2 * bent(x[2] / size, k, c) end, u) end }
  local run = field:solver { rule = rule, h = 0.3 }:run { q = function(x) return { place, size * (1 + 0.1 * x) } end,
    v = function() return { 0, 0.3 * size } end, steps = 20 }
  return run.q[21][2] / size
end
for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(3)" } do
  for name, friction in pairs { free = false, friction = function(_, v) return -0.1 * v end } do
    local what = (", %s, by %s"):format(name, rule)
    near(beside(1e8, 2 ^ -20, 1e2, 1e2, rule, friction), beside(0, 1, 1e2, 1e2, rule, friction), 1e-9, "a coordinate beside a large one" .. what)
    for _, k in ipairs { 1, 1e2 } do
      near(field_beside(1e8, 2 ^ -20, k, 0.3, rule, friction), field_beside(0, 1, k, 0.3, rule, friction), 1e-9, "a value of a field" .. what)
    end
  end
end
tap.done()
