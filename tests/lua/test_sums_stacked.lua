-- Several passes of a splitting step over a long ring in one generated loop: the bits of the tape, of bursts of one step, of any rule;
-- masses and numbers of springs that vary, a time-dependent term, two coordinates a body.
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos = math.sin, math.cos

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

local function run(n, L, rule, backend, every)
  local q, v = start(n)
  return dm.system { Q = dm.R(n), L = L }:solver { rule = rule, h = 0.05, backend = backend }
    :run { q = q, v = v, steps = 7, every = every }
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

for name, make in pairs(systems) do
  for _, n in ipairs { 512, 480 } do
    local L = make(n)
    for _, rule in ipairs { "verlet", "yoshida(4)", "blanes-moan(6, 11)", "symplectic-euler" } do
      local whole = run(n, L, rule, nil, 7)
      local what = ("%s, n = %d, %s: "):format(name, n, rule)
      ok(same(whole, run(n, L, rule, "tape", 7)), what .. "tape and native code, bit for bit")
      ok(same(whole, run(n, L, rule, nil, 1)), what .. "bursts of one step and of all, bit for bit")
    end
  end
end

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
