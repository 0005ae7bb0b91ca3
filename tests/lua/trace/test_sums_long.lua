-- Splitting steps over long chains as generated loops: the bits of the tape, of bursts of one step, of any rule; masses and numbers
-- of springs that vary, a time-dependent term, two coordinates a body; sums with compensation and without.
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos, exp = math.sin, math.cos, math.exp

local function start(n)
  local q, v = dm.vector(n), dm.vector(n)
  for i = 1, n do q[i], v[i] = 0.2 * cos(2.7 * i), sin(1.3 * i) end
  return q, v
end

local function numbers(n, f)
  local out = {}
  for i = 1, n do out[i] = f(i) end
  return out
end

local function spring(a, b)
  local d = a - b
  return d ^ 2 / 2 + d ^ 4 / 4
end

local ring = { shift = 1, periodic = true }
local systems = {
  ["equal bodies"] = function()
    return function(q, v) return dm.sum_over(v, function(u) return u ^ 2 / 2 end) - dm.sum_over(q, spring, ring) end
  end,
  ["masses that vary"] = function(n)
    local m = numbers(n, function(i) return 1 + 0.5 * sin(i) end)
    return function(q, v) return dm.sum_over(v, m, function(u, k) return k * u ^ 2 / 2 end) - dm.sum_over(q, spring, ring) end
  end,
  ["springs that vary, and an own force on each"] = function(n)
    local k = numbers(n, function(i) return 1 + 0.3 * cos(0.7 * i) end)
    return function(q, v)
      return dm.sum_over(v, function(u) return u ^ 2 / 2 end) - dm.sum_over(q, function(a) return a ^ 4 / 4 end)
        - dm.sum_over(q, k, function(a, s, b, _) return s * spring(a, b) end, ring)
    end
  end,
  ["a spring that gets stiffer"] = function()
    return function(q, v, t)
      return dm.sum_over(v, function(u) return u ^ 2 / 2 end)
        - dm.sum_over(q, t, function(a, b, s) return (1 + s) * spring(a, b) end, ring)
    end
  end,
  ["two coordinates a body"] = function()
    return function(q, v)
      return dm.sum_over(v, function(u) return u:dot(u) / 2 end, { block = 2 })
        - dm.sum_over(q, function(a, b)
          local d = a - b
          return d:dot(d) / 2 + d:dot(d) ^ 2 / 4
        end, { block = 2, shift = 1, periodic = true })
    end
  end,
}

-- not closed, with a function, to the neighbour after the next
local others = {
  ["an open chain"] = function()
    return function(q, v) return dm.sum_over(v, function(u) return u ^ 2 / 2 end) - dm.sum_over(q, spring, { shift = 1 }) end
  end,
  ["exponentials"] = function()
    return function(q, v)
      return dm.sum_over(v, function(u) return u ^ 2 / 2 end) - dm.sum_over(q, function(a, b) return exp(a - b) end, ring)
    end
  end,
  ["the neighbour after the next"] = function()
    return function(q, v)
      return dm.sum_over(v, function(u) return 0.6 * u ^ 2 end) - dm.sum_over(q, spring, { shift = 2, periodic = true })
    end
  end,
}

local function run(system, how, backend, every)
  local q, v = start(system.Q.dimension)
  return system:solver { rule = how.rule, sums = how.sums, h = 0.05, backend = backend }
    :run { q = q, v = v, steps = how.steps or 7, every = every }
end

local function same(a, b)
  local x, y = a.q[#a], b.q[#b]
  for i = 1, #x do
    if x[i] ~= y[i] then return false end
  end
  x, y = a.p[#a], b.p[#b]
  for i = 1, #x do
    if x[i] ~= y[i] then return false end
  end
  return true
end

local function compare(name, n, system, how)
  local whole = run(system, how, nil, how.steps or 7)
  local what = ("%s, n = %d, %s, %s sums: "):format(name, n, how.rule, how.sums or "compensated")
  ok(same(whole, run(system, how, "tape", how.steps or 7)), what .. "tape and native code, bit for bit")
  ok(same(whole, run(system, how, nil, 1)), what .. "bursts of one step and of all, bit for bit")
  return whole
end

-- two ways to sum: apart by round-off of some steps, and not the same
local function compare_sums(name, n, system, rule)
  local a = compare(name, n, system, { rule = rule })
  local b = compare(name, n, system, { rule = rule, sums = "plain" })
  local apart = (a.q[#a] - b.q[#b]):norm() / math.sqrt(n)
  ok(apart < 2e-15 and apart > 0, ("%s, n = %d, %s: plain sums round oftener"):format(name, n, rule), apart)
end

for name, make in pairs(systems) do
  for _, bodies in ipairs { 512, 480, 509, 1001 } do
    local n = name:find "two" and 2 * bodies or bodies
    local system = dm.system { Q = dm.R(n), L = make(n) }
    for _, rule in ipairs { "verlet", "yoshida(4)", "blanes-moan(6, 11)", "symplectic-euler" } do
      compare_sums(name, n, system, rule)
    end
  end
end
for name, make in pairs(others) do
  for _, n in ipairs { 512, 509, 37, 7 } do
    local system = dm.system { Q = dm.R(n), L = make(n) }
    for _, rule in ipairs { "verlet", "blanes-moan(6, 14)" } do compare_sums(name, n, system, rule) end
  end
end

-- pulled out so far that the bond from the last body to the first, which is not there, would be infinite
for _, backend in ipairs { "jit", "tape" } do
  local n, q = 509, {}
  for i = 1, n do q[i] = 3 * i end
  local path = dm.system { Q = dm.R(n), L = function(x, v)
    return dm.sum_over(v, function(u) return u ^ 2 / 2 end) - dm.sum_over(x, function(a, b) return exp(a - b) end, { shift = 1 })
  end }:solver { rule = "verlet", h = 0.1, backend = backend }:run { q = q, v = dm.vector(n), steps = 1 }
  -- half a kick of exp(-3) drives the ends apart, all others are pushed from both sides alike
  local push = 0.1 ^ 2 / 2 * exp(-3)
  near(path.q[#path][1], 3 - push, 1e-15, "the first body of a chain that is not closed: " .. backend)
  near(path.q[#path][n], 3 * n + push, 1e-12, "the last: " .. backend)
  near(path.q[#path][200], 600, 0, "one between: " .. backend)
end

-- longer than a cache: steps differ there by what loads and stores bring, not by how many there are
local long = { ["equal bodies"] = systems, ["springs that vary, and an own force on each"] = systems, ["exponentials"] = others,
  ["an open chain"] = others }
for name, from in pairs(long) do
  local rules = tap.watched and { verlet = "plain" }
    or { verlet = "plain", ["blanes-moan(6, 11)"] = "compensated", ["symplectic-euler"] = "plain" }
  local n = 8 * 4100 + 3
  local system = dm.system { Q = dm.R(n), L = from[name](n) }
  for rule, sums in pairs(rules) do compare(name, n, system, { rule = rule, sums = sums, steps = 2 }) end
end
compare("two coordinates a body", 16 * 4100,
  dm.system { Q = dm.R(16 * 4100), L = systems["two coordinates a body"]() },
  { rule = "yoshida(4)", sums = "plain", steps = 2 })

-- an independent road: the same ring written out by hand, by another backend and another rule of high order
do
  local n = 512
  local q, v = start(n)
  local a = dm.system { Q = dm.R(n), L = systems["equal bodies"]() }
  local path = a:solver { rule = "blanes-moan(6, 11)", h = 0.02 }:run { q = q, v = v, steps = 50, every = 50 }
  local rival = a:solver { rule = "rk8pd", h = 0.02 }:run { q = q, v = v, steps = 50, every = 50 }
  near((path.q[#path] - rival.q[#rival]):norm() / math.sqrt(n), 0, 1e-9, "the ring goes where rk8pd takes it")
end
tap.done()
