-- dm.sum_over: sums over bodies, neighbours and pairs; the same L written out as a loop in Lua is the independent road
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local exp, sin = math.exp, math.sin

local function toda(d) return exp(d) - 1 end
local function kinetic(u) return u ^ 2 / 2 end

-- ring of n equal bodies with the force law W, as a sum and written out
local function ring(n, W)
  return dm.system { Q = dm.R(n), L = function(q, v)
    return dm.sum_over(v, kinetic) - dm.sum_over(q, function(a, b) return W(a - b) end, { shift = 1, periodic = true })
  end }
end
local function ring_written_out(n, W)
  return dm.system { Q = dm.R(n), L = function(q, v)
    local L = 0
    for i = 1, n do L = L + v[i] ^ 2 / 2 - W(q[i] - q[i % n + 1]) end
    return L
  end }
end
local function start(n)
  local q, v, mean = dm.vector(n), dm.vector(n), 0
  for i = 1, n do q[i], v[i] = 0.3 * sin(1.7 * i), sin(2.1 * i) end
  for i = 1, n do mean = mean + v[i] / n end
  for i = 1, n do v[i] = v[i] - mean end
  return q, v
end

-- numbers: a plain loop
local x, w = dm.vector { 1, 2, 3, 4 }, { 10, 20, 30, 40 }
near(dm.sum_over(x, function(a) return a ^ 2 end), 30, 0, "sum of squares")
near(dm.sum_over(x, w, function(a, m) return a * m end), 300, 0, "a vector and a table side by side")
near(dm.sum_over(x, function(a, b) return a * b end, { shift = 1 }), 2 + 6 + 12, 0, "neighbours of an open chain")
near(dm.sum_over(x, function(a, b) return a * b end, { shift = 1, periodic = true }), 24, 0, "neighbours of a ring")
near(dm.sum_over(x, function(a, b) return a * b end, { shift = 2 }), 3 + 8, 0, "second neighbours")
near(dm.sum_over(x, function(a, b) return a * b end, { pairs = true }), 35, 0, "pairs: ((sum x)^2 - sum x^2)/2")
near(dm.sum_over(x, w, function(a, m, b, k) return (a - b) * (m - k) end, { pairs = true }), 200, 0, "pairs with a second vector: one body's entries, then the other's")
near(dm.sum_over(x, w, function(r, m) return r:dot(r) * #m end, { block = 2 }), 60, 0, "blocks of two entries are vectors")
near(dm.sum_over(x, 0.5, function(a, k) return k * a end), 5, 0, "a number is the same in every round")
local f = dm.trace(function(q) return dm.sum_over(q, function(a) return a ^ 3 end) end, 40)
near(f(dm.vector(40) + 2), 320, 1e-12, "in a function that is no Lagrangian the sum is written out")
near(f:gradient(dm.vector(40) + 2)[7], 12, 1e-13, "and its derivative is exact")

-- loops against the same L written out: value, energy, momentum, path
for _, n in ipairs { 3, 129, 200 } do
  local a, b, q, v = ring(n, toda), ring_written_out(n, toda), start(n)
  near(a:lagrangian(q, v), b:lagrangian(q, v), 1e-14 * n, n .. " bodies: the value of L")
  near(a:energy(q, v), b:energy(q, v), 1e-14 * n, n .. " bodies: the energy")
  near((a:momentum(q, v) - b:momentum(q, v)):norm(), 0, 1e-15, n .. " bodies: the momentum")
  near((a:velocity(q, v) - v):norm(), 0, 1e-15, n .. " bodies: velocity from momentum")
  local options = { q = q, v = v, steps = 200 }
  local A = a:solver { rule = "blanes-moan(6)", h = 0.05 }:run(options)
  local B = b:solver { rule = "blanes-moan(6)", h = 0.05 }:run(options)
  near((A.q[#A] - B.q[#B]):norm(), 0, 1e-12, n .. " bodies: where the path ends")
  ok(A:drift("energy").largest < 1e-6 * n, n .. " bodies: energy keeps within the error of the rule", A:drift("energy").largest)
  near(A:drift(A:momentum(dm.R(1))).largest, 0, 1e-12, n .. " bodies: total momentum is kept")
end

-- every backend, the same bits
local function last(n, backend)
  local q, v = start(n)
  local path = ring(n, toda):solver { rule = "verlet", h = 0.05, backend = backend }:run { q = q, v = v, steps = 50, every = 50 }
  return path.q[#path]
end
for _, n in ipairs { 200, 1001 } do
  local tape, own, same = last(n, "tape"), last(n), true
  for i = 1, n do same = same and tape[i] == own[i] end
  ok(same, n .. " bodies: tape and default backend give the same bits")
end

-- three particles of the Toda lattice against a tight Gauss run
do
  local a, q, v = ring(3, toda), start(3)
  local A = a:solver { rule = "kahan-li(8)", h = 0.01 }:run { q = q, v = v, steps = 1000, every = 1000 }
  local B = a:solver { rule = "gauss(8)", h = 0.1 }:run { q = q, v = v, steps = 100, every = 100 }
  near((A.q[#A] - B.q[#B]):norm(), 0, 1e-12, "Toda with three particles: explicit order 8 meets gauss(8)")
end

-- unequal masses, bodies in the plane, gravity between all pairs, an outer field that depends on time
do
  local n, m = 20, {}
  for i = 1, n do m[i] = 1 + i / 10 end
  local function attraction(a, ma, b, mb)
    local d = a - b
    return ma * mb / (0.1 + d:dot(d)) ^ 0.5
  end
  local sums = dm.system { Q = dm.R(2 * n), L = function(q, v, t)
    return dm.sum_over(v, m, function(u, mi) return mi * u:dot(u) / 2 end, { block = 2 })
      + dm.sum_over(q, m, attraction, { block = 2, pairs = true })
      - math.cos(t) * dm.sum_over(q, t, function(r, s) return r[1] ^ 2 * s + r[2] end, { block = 2 })
  end }
  local plain = dm.system { Q = dm.R(2 * n), L = function(q, v, t)
    local L = 0
    for i = 1, n do
      local a = dm.vector { q[2 * i - 1], q[2 * i] }
      L = L + m[i] * (v[2 * i - 1] ^ 2 + v[2 * i] ^ 2) / 2 - math.cos(t) * (a[1] ^ 2 * t + a[2])
      for j = i + 1, n do L = L + attraction(a, m[i], dm.vector { q[2 * j - 1], q[2 * j] }, m[j]) end
    end
    return L
  end }
  local s, q, v = sums:structure(), start(2 * n)
  q = 5 * q
  ok(s.separable and s.constant_mass and s.diagonal_mass and not s.autonomous, "structure of the plane system")
  near(sums:energy(q, v, 0.3), plain:energy(q, v, 0.3), 1e-12, "plane: energy at t = 0.3")
  near((sums:momentum(q, v) - plain:momentum(q, v)):norm(), 0, 1e-14, "plane: momenta m v")
  local options = { q = q, v = v, steps = 100 }
  local A, B = sums:solver { rule = "verlet", h = 0.01 }:run(options), plain:solver { rule = "verlet", h = 0.01 }:run(options)
  near((A.q[#A] - B.q[#B]):norm(), 0, 1e-11, "plane: the same path")
  near((A:velocity()[100] - B:velocity()[100]):norm(), 0, 1e-11, "plane: the same velocities")
  local C = sums:solver { rule = "gauss(2)", h = 0.01 }:run { q = q, v = v, steps = 3 }
  local D = plain:solver { rule = "gauss(2)", h = 0.01 }:run { q = q, v = v, steps = 3 }
  near((C.q[#C] - D.q[#D]):norm(), 0, 1e-12, "plane: an implicit rule writes the sums out")
end

-- L that is not linear in its sums: (sum q^2)^2, and a kinetic energy that is not diagonal
do
  local n = 150
  local function quartic(v, q) return dm.sum_over(v, kinetic) - dm.sum_over(q, function(a) return a ^ 2 end) ^ 2 / n end
  local a = dm.system { Q = dm.R(n), L = function(q, v) return quartic(v, q) + q[1] * q[2] - v[3] ^ 2 / 8 end }
  local b = dm.system { Q = dm.R(n), L = function(q, v)
    return v:dot(v) / 2 - q:dot(q) ^ 2 / n + q[1] * q[2] - v[3] ^ 2 / 8 end }
  local q, v = start(n)
  local A = a:solver { rule = "verlet", h = 0.01 }:run { q = q, v = v, steps = 50 }
  local B = b:solver { rule = "verlet", h = 0.01 }:run { q = q, v = v, steps = 50 }
  near((A.q[#A] - B.q[#B]):norm(), 0, 1e-12, "the square of a sum, beside terms of single coordinates")
  near(a:energy(q, v), b:energy(q, v), 1e-12, "its energy")
  local c = dm.system { Q = dm.R(n), L = function(q, v)
    return dm.sum_over(v, function(a1, b1) return a1 ^ 2 + a1 * b1 / 2 end, { shift = 1, periodic = true }) - q:dot(q) end }
  ok(not c:structure().diagonal_mass, "coupled velocities are no diagonal mass")
  near(c:momentum(q, v)[2], 2 * v[2] + (v[1] + v[3]) / 2, 1e-14, "and their momenta are right")
end

-- splitting steps go along arrays in lanes: chains of all lengths and ends against the same L written out, and the same bits
-- from tape and native code, in bursts of any length
do
  local function path(n, L, rule, backend, every)
    local q, v = start(n)
    return dm.system { Q = dm.R(n), L = L }:solver { rule = rule, h = 0.05, backend = backend }:run { q = q, v = v, steps = 12, every = every }
  end
  local function same(a, b)
    for _, key in ipairs { "q", "p" } do
      local x, y = a[key][#a], b[key][#b]
      for i = 1, #x do if x[i] ~= y[i] then return false end end
    end
    return true
  end
  local function bond(a, b) return (a - b) ^ 2 / 2 + (a - b) ^ 4 / 4 end
  local function compare(what, n, rule, L, plain)
    local a = path(n, L, rule)
    ok(same(a, path(n, L, rule, "tape")), what .. ": tape and native code, bit for bit")
    ok(same(a, path(n, L, rule, nil, 12)), what .. ": bursts of one step and of all, bit for bit")
    near((a.q[#a] - path(n, plain, rule).q[#a]):norm(), 0, 1e-12, what .. ": as written out")
  end
  for _, n in ipairs { 41, 136, 263 } do
    for _, periodic in ipairs { true, false } do
      local last, rule = periodic and n or n - 1, periodic and "blanes-moan(4)" or "verlet"
      local name = n .. (periodic and " in a ring" or " in a row")
      local m = {}
      for i = 1, n do m[i] = 1 + i % 3 end
      compare(name .. ", bonds and a field", n, rule, function(q, v)
        return dm.sum_over(v, kinetic) - dm.sum_over(q, bond, { shift = 1, periodic = periodic }) - dm.sum_over(q, function(a) return 1 - math.cos(a) end)
      end, function(q, v)
        local L = 0
        for i = 1, n do L = L + v[i] ^ 2 / 2 - (1 - math.cos(q[i])) end
        for i = 1, last do L = L - bond(q[i], q[i % n + 1]) end
        return L
      end)
      compare(name .. ", exponential bonds", n, "symplectic-euler", function(q, v)
        return dm.sum_over(v, kinetic) - dm.sum_over(q, function(a, b) return toda(a - b) end, { shift = 1, periodic = periodic })
      end, function(q, v)
        local L = 0
        for i = 1, n do L = L + v[i] ^ 2 / 2 end
        for i = 1, last do L = L - toda(q[i] - q[i % n + 1]) end
        return L
      end)
      compare(name .. ", masses, far neighbours, time", n, rule, function(q, v, t)
        return dm.sum_over(v, m, function(u, mi) return mi * u ^ 2 / 2 end)
          - dm.sum_over(q, m, t, function(a, x, b, y, s) return x * y * (1 + s) * (a - b) ^ 2 / 20 + a * b ^ 2 / 50 end, { shift = 5, periodic = periodic })
      end, function(q, v, t)
        local L = 0
        for i = 1, n do L = L + m[i] * v[i] ^ 2 / 2 end
        for i = 1, periodic and n or n - 5 do
          local j = (i + 4) % n + 1
          L = L - m[i] * m[j] * (1 + t) * (q[i] - q[j]) ^ 2 / 20 - q[i] * q[j] ^ 2 / 50
        end
        return L
      end)
    end
  end
  -- a square lattice: neighbours along the rows of all, and from row to row
  local side = 12
  local n = side * side
  compare("12 x 12", n, "blanes-moan(4)", function(q, v)
    return dm.sum_over(v, kinetic) - dm.sum_over(q, bond, { shift = 1 }) - dm.sum_over(q, bond, { shift = side, periodic = true })
  end, function(q, v)
    local L = 0
    for i = 1, n do L = L + v[i] ^ 2 / 2 - bond(q[i], q[(i + side - 1) % n + 1]) end
    for i = 1, n - 1 do L = L - bond(q[i], q[i + 1]) end
    return L
  end)
  -- two coordinates a body
  compare("bodies in the plane", 120, "blanes-moan(4)", function(q, v)
    return dm.sum_over(v, kinetic) - dm.sum_over(q, function(a, b)
      local d = a - b
      return (d:dot(d) - 1) ^ 2 / 4
    end, { shift = 1, block = 2, periodic = true })
  end, function(q, v)
    local L = v:dot(v) / 2
    for i = 1, 60 do
      local j = i % 60 + 1
      L = L - ((q[2 * i - 1] - q[2 * j - 1]) ^ 2 + (q[2 * i] - q[2 * j]) ^ 2 - 1) ^ 2 / 4
    end
    return L
  end)
end

-- a model is kept from run to run, but not when a number inside of the function of a sum has changed
do
  local k, n = 1, 200
  local function L(q, v) return dm.sum_over(v, kinetic) - dm.sum_over(q, function(a, b) return k * (a - b) ^ 2 end, { shift = 1 }) end
  local kept, q, v = dm.system { Q = dm.R(n), L = L }, start(n)
  local function last(s)
    local path = s:solver { rule = "verlet", h = 0.1 }:run { q = q, v = v, steps = 9 }
    return path.q[#path]
  end
  local one = last(kept)
  k = 2
  local two = last(kept)
  ok((one - two):norm() > 0.01, "a changed upvalue changes the path")
  near((two - last(dm.system { Q = dm.R(n), L = L })):norm(), 0, 0, "to that of a new system")
end

-- cost: operations per particle do not grow from 10^3 to 10^5
local function operations(n)
  local q, v = start(n)
  local s = ring(n, function(d) return d ^ 2 / 2 + d ^ 4 / 4 end):solver { rule = "verlet", h = 0.01 }
  local path = s:run { q = q, v = v, steps = 2, every = 2 }
  ok(path.q[2][1] == path.q[2][1], n .. " bodies: two steps")
  collectgarbage()
  local before = collectgarbage "count"
  local other = s:run { q = q, v = v, steps = 2, every = 2 }
  ok(#other == 2 and (collectgarbage "count" - before) * 1024 / n < 4000, n .. " bodies: at most 4000 bytes a body",
    (collectgarbage "count" - before) * 1024 / n)
  return s:report().operations / n
end
near(operations(100000) / operations(1000), 1, 0.01, "operations per body are those of a short chain")

-- misuse
local many = dm.R(500)
local function L_of(f) return function() return dm.system { Q = many, L = f }:energy(start(500)) end end
raises("needs vectors and then a function", dm.sum_over)
raises("needs vectors and then a function", dm.sum_over, x)
raises("one argument before the function must be a vector", dm.sum_over, 3, kinetic)
raises("argument 1 must be a vector", dm.sum_over, "q", kinetic)
raises("argument 2 has 3 entries, but there are 4 bodies", dm.sum_over, x, { 1, 2, 3 }, function(a, b) return a * b end)
raises("takes 2 arguments, but gets 1", dm.sum_over, x, function(a, b) return a * b end)
raises("takes 1 argument, but gets 2", dm.sum_over, x, kinetic, { shift = 1 })
raises("must return a number, got table", dm.sum_over, x, function(a) return { a } end)
raises("must return a number, got nil", dm.sum_over, x, function(a) a = a end)
raises("from 1 to 3 for 4 bodies", dm.sum_over, x, function(a, b) return a * b end, { shift = 4 })
raises("'shift'", dm.sum_over, x, function(a, b) return a * b end, { shift = -1 })
raises("give 'shift'", dm.sum_over, x, kinetic, { periodic = true })
raises("'pairs' stands alone", dm.sum_over, x, function(a, b) return a * b end, { pairs = true, shift = 1 })
raises("must be true or false", dm.sum_over, x, function(a, b) return a * b end, { pairs = 1 })
raises("no number of bodies with 3 each", dm.sum_over, x, kinetic, { block = 3 })
raises("did you mean 'shift'", dm.sum_over, x, kinetic, { shfit = 1 })
raises("symbols of two traces meet", L_of(function(q, v) return dm.sum_over(v, function(u) return u ^ 2 * q[1] end) end))
raises("symbol of another trace", L_of(function(q, v) return dm.sum_over(v, function(u) return q[1] end) end))
raises("symbols of two traces meet", L_of(function(q, v)
  return dm.sum_over(v, function(u) return u * dm.sum_over(q, function(a) return a end) end) end))
raises("met a symbol", L_of(function(q, v) return dm.sum_over(q, v, function(a, u) return a == 0 and 0 or (a == a + 0 and u ^ 2 or u) end) end))
near(dm.sum_over(x, function(a) return a * dm.sum_over(x, function(b) return b end) end), 100, 0, "a sum inside a sum, on numbers")
local implicit = ring(500, toda):solver { rule = "gauss(2)", h = 0.1 }
raises("the function of dm.sum_over is not what its trace says", function()
  local q, v = start(200)
  dm.system { Q = dm.R(200), L = function(x, u)
    return dm.sum_over(u, kinetic) - dm.sum_over(x, function(a) return type(a) == "number" and 2 * a or a end)
  end }:solver { rule = "verlet", h = 0.1 }:run { q = q, v = v, steps = 1 }
end)
raises("explicit rules do without", function() local q, v = start(500) implicit:run { q = q, v = v, steps = 1 } end)
raises("explicit rules do without", L_of(function(q, v) return dm.sum_over(q, v, function(a, u) return u ^ 2 * (1 + a ^ 2) end) end))
raises("written out up to", function() ring(500, toda):graph() end)
local still = ring(200, toda):solver { rule = "gauss(1)", h = 0.1 }
local q, v = start(200)
ok(#still:run { q = q, v = v, steps = 1 } == 2, "200 bodies: an implicit rule still runs")
-- a run of another system inside of L: its sums are its own, when L is traced and when it is compared with its trace
do
  local inner = ring(40, function(d) return 3 * d end):solver { rule = "verlet", h = 0.02 }
  local written_out = ring(40, function(d) return d ^ 2 end):solver { rule = "midpoint", h = 0.02 }
  local small = dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 / 2 - x[1] ^ 2 end }:solver { rule = "verlet", h = 0.02 }
  local x, u = start(40)
  local function run(place, solver, q0, v0)
    local function meanwhile(here)
      if here == place then solver:run { q = q0, v = v0, steps = 2 } end
    end
    return dm.system { Q = dm.R(40), L = function(q, v)
      meanwhile(1)
      local T = dm.sum_over(v, kinetic)
      meanwhile(2)
      return T - dm.sum_over(q, function(a, b) return toda(a - b) end, { shift = 1, periodic = true })
    end }:solver({ rule = "verlet", h = 0.02 }):run { q = x, v = u, steps = 5 }
  end
  local alone = run(0)
  for place = 1, 2 do
    for name, with in pairs { ["with sums"] = { inner, x, u }, ["written out"] = { written_out, x, u }, small = { small, { 0.1 }, { 0.3 } } } do
      local path = run(place, table.unpack(with))
      ok(path.q[6] == alone.q[6] and path.p[6] == alone.p[6], ("a run inside of L, %s, at %d"):format(name, place))
    end
  end
end
tap.done()
