-- linear theory along orbits, however long they are, and resonances at the frequencies that motions of large amplitude have: closed forms
local dm = require "dm"
local tap = require "tap"
local ok, near = tap.ok, tap.near
local pi, sin, sqrt = math.pi, math.sin, math.sqrt

local function map_of(system, q, v, more)
  local options = { system = system, q = q, v = v, rule = "verlet", h = { 0.01, 4, 3, "log" }, refine = false, accuracy = false, chaos = false }
  for key, value in pairs(more) do options[key] = value end
  return dm.stability(options)
end

-- Kepler: omega^2 = 1/r^3 across the radius, largest at the pericentre r = 1 - e, whatever the number of turns
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
for _, e in ipairs { 0.6, 0.97 } do
  for _, turns in ipairs { 1, 19.6, 100 } do
    local map = map_of(kepler, { 1 + e, 0 }, { 0, sqrt((1 - e) / (1 + e)) }, { t = 2 * pi * turns })
    local exact = 2 * (1 - e) ^ 1.5
    near(map:theory(1), exact, 1e-3 * exact, ("theory on an ellipse, e = %g, %g turns"):format(e, turns))
  end
end

-- the pendulum turns with pi/(2 K(sin A/2)), by the arithmetic-geometric mean; Verlet turns by 2 pi/n where h omega = 2 sin(pi/n)
local function frequency(A)
  local a, b = 1, math.cos(A / 2)
  for _ = 1, 40 do a, b = (a + b) / 2, sqrt(a * b) end
  return a
end
local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.cos(q[1]) end }
for _, A in ipairs { 0.1, 1, 2, 3 } do
  local map, omega = map_of(pendulum, { A }, { 0 }, { t = 60 }), frequency(A)
  local list = map:resonances(1)
  ok(#list >= 3, "resonances", A, #list)
  for _, r in ipairs(list) do
    near(r.omega, omega, 1e-3, ("the frequency of the amplitude %g"):format(A))
    near(r.h, 2 * sin(pi / r.n) / omega, 1e-3 * r.h, ("a step turns by 2 pi/%d, amplitude %g"):format(r.n, A))
  end
  near(map:theory(1), 2, 2e-3, "the limit is that of the bottom, which every swing passes")
end

-- a pendulum on a stiff spring: the spring swings with sqrt(k), which the turning of its direction hides from no state; the swing with its own
local k = 1e4
local spring = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] - k / 2 * (q:norm() - 1) ^ 2 end }
local swings = map_of(spring, { sin(2), -math.cos(2) }, { 0, 0 }, { t = 60, h = { 0.001, 2, 3, "log" } })
local fast, slow = {}, {}
for _, r in ipairs(swings:resonances(1)) do
  local list = r.omega > 10 and fast or slow
  list[#list + 1] = r
end
ok(#fast == 4 and #slow >= 1, "resonances of the spring, and of the swing", #fast, #slow)
for _, r in ipairs(fast) do near(r.omega, sqrt(k), 0.01 * sqrt(k), "the spring") end
for _, r in ipairs(slow) do near(r.omega, frequency(2), 5e-3, "the swing") end

-- an oscillator whose frequency a heavy rotor changes, from 60 to 10 in a seventh of a turn: its mean over the time, wherever the orbit begins
local function beats(angle) return 10 + 50 * dm.exp(-20 * (1 - dm.cos(angle))) end
local rotor = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + 1e8 * v[2] ^ 2 - beats(q[2]) ^ 2 * q[1] ^ 2) / 2 end }
local mean = 0
for i = 1, 1000 do mean = mean + beats(2 * pi * i / 1000) / 1000 end
for _, angle in ipairs { 0, 2 } do
  for _, x in ipairs { 0, 1 } do
    local r = map_of(rotor, { x, angle }, { 0, 0.3 }, { t = 4 * pi / 0.3 }):resonances(1)[1]
    near(r.omega, mean, 0.03 * mean, ("the mean of a frequency that changes, from the angle %g, amplitude %g"):format(angle, x))
  end
end

-- a free rotor beside: nothing turns, and nothing oscillates
local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
local none, why = map_of(free, { 0 }, { 1 }, { t = 10 }):theory(1)
ok(none == nil and why:find "nothing oscillates", "nothing oscillates", why)
-- a start at a late time ends where it should
local late = map_of(pendulum, { 1 }, { 0 }, { t = 60, t0 = 1e9 })
near(late:resonances(1)[1].omega, frequency(1), 1e-3, "at a late time")

-- an orbit that is too long is looked at for so many steps and not for up to twice as many: the last piece has the steps that are left
do
  local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  local states, done = require "dm.stability.orbit".states(oscillator, { q = { 1 }, v = { 0 }, t = 0 }, 1e6, 1)
  tap.ok(#states > 0.9 * 2 ^ 15 and #states < 1.1 * 2 ^ 15 and done < 1e6, "steps of an orbit that is cut", #states, done)
  tap.near(states[#states].q[1], math.cos(done), 1e-2, "which are those of the orbit")
end

-- what is the same at the start and long after it need not be so between: a spring that is stiff once, and late; a stiff bump that is met far from the start
do
  local function limit_of(L, q)
    local map = dm.stability { dm.system { Q = dm.R(1), L = L }, rule = "verlet", h = { 0.05, 3, 3, "log" }, t = 60, q = { q }, v = { q == 0 and 1 or 0 }, accuracy = false, refine = false }
    return map:theory(1)
  end
  local late = limit_of(function(q, v, t) return v[1] ^ 2 / 2 - (1 + 99 * dm.exp(-((t - 30) / 2) ^ 2)) * q[1] ^ 2 / 2 end, 1)
  tap.near(late, 0.2, 1e-4, "a late pulse of the spring: 2 / sqrt(1 + 99)")
  local still = limit_of(function(q, v) return v[1] ^ 2 / 2 - 9 * q[1] ^ 2 / 2 end, 0)
  tap.near(still, 2 / 3, 1e-9, "an L of second degree")
  -- V = q^2/2 + 200 (q - 40)^2 for q > 40: free of it up to t = 40, about
  local wall = limit_of(function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2e8 - dm.where(q[1] - 40, 200 * (q[1] - 40) ^ 2, 0) end, 0)
  tap.near(wall, 0.1, 1e-4, "a wall that is met late: 2 / sqrt(400)")
end

-- coupled quartic oscillators, whose coordinates turn with all oscillations: no more frequencies than these, and the fastest of 2,000 states
do
  local function count_of(map)
    local count, different = 0, {}
    for _, r in ipairs(map:resonances(1)) do different[("%.9g"):format(r.omega)] = true end
    for _ in pairs(different) do count = count + 1 end
    return count
  end
  local m, K = { 0.9, 1.7, 2.6 }, { { 3.1, 0.3, -0.2 }, { 0.3, 4.2, 0.35 }, { -0.2, 0.35, 4.9 } }
  local three = dm.system { Q = dm.R(3), L = function(q, v)
    local L = 0
    for i = 1, 3 do
      L = L + m[i] * v[i] ^ 2 / 2 - 0.45 * q[i] ^ 4
      for j = 1, 3 do L = L - K[i][j] * q[i] * q[j] / 2 end
    end
    return L
  end }
  for _, start in ipairs { { { 0.5, -0.4, 0.3 }, { 0.2, 0.4, -0.5 } }, { { -0.3, 0.5, 0.45 }, { 0.4, -0.1, 0.3 } }, { { 0.1, 0.45, -0.5 }, { -0.5, 0.2, 0.1 } } } do
    local map, most = map_of(three, start[1], start[2], { t = 20, rule = "kahan-li(8)" }), 0
    local path = three:solver({ rule = "rk8", h = 1e-3 }):run { q = start[1], v = start[2], t = 20 }
    for i = 1, #path, 10 do
      local H = dm.zeros(3, 3):totable()
      for a = 1, 3 do
        for b = 1, 3 do H[a][b] = (K[a][b] + (a == b and 5.4 * path.q[i][a] ^ 2 or 0)) / sqrt(m[a] * m[b]) end
      end
      local squares = dm.matrix(H):eigenvalues()
      for a = 1, 3 do most = math.max(most, sqrt(squares[a])) end
    end
    local exact = dm.stability_limit "kahan-li(8)" / most
    near(map:theory(1), exact, 5e-4 * exact, "the fastest state, between those of controlled steps")
    ok(count_of(map) <= 3, "three oscillators have three frequencies", count_of(map))
  end
  local four = dm.system { Q = dm.R(4), L = function(q, v)
    local L = q[1] * q[2] / 5 + q[2] * q[3] / 4 - q[3] * q[4] / 5 - q[1] * q[4] / 3
    for i = 1, 4 do L = L + v[i] ^ 2 / 2 * i ^ 0.5 - (1 + i / 2) * q[i] ^ 2 / 2 - 0.2 * q[i] ^ 4 end
    return L
  end }
  for _, q in ipairs { { 0.5, -0.4, 0.3, 0.1 }, { -0.3, 0.5, 0.45, -0.2 }, { 0.4, 0.4, -0.5, 0.3 }, { 0.3, -0.3, 0.3, 0.5 } } do
    local count = count_of(map_of(four, q, { 0.2, 0.4, -0.5, 0.3 }, { t = 20, rule = "gauss(2)" }))
    ok(count >= 3 and count <= 4, "and four have four", count)
  end
end

-- quartic oscillators beside each other, coupled by nothing: one frequency each, that of its amplitude, though the mean over the orbit of another one is nearer
do
  local function exact(k, A) -- x'' = -k x - 1.8 x^3
    local square = k + 1.8 * A ^ 2
    local a, b = 1, sqrt(1 - 0.9 * A ^ 2 / square)
    for _ = 1, 40 do a, b = (a + b) / 2, sqrt(a * b) end
    return sqrt(square) * a
  end
  local seed = 5
  local function random()
    seed = seed * 16807 % 2147483647
    return seed / 2147483647
  end
  for trial = 1, 12 do
    local n, k, A, own = 2 + trial % 4, {}, {}, {}
    for i = 1, n do k[i], A[i] = i * 0.5 + 0.4 * random(), 0.1 + 0.9 * random() end
    for i = 1, n do own[i] = exact(k[i], A[i]) end
    table.sort(own)
    local beside = dm.system { Q = dm.R(n), L = function(q, v)
      local L = 0
      for i = 1, n do L = L + v[i] ^ 2 / 2 - k[i] * q[i] ^ 2 / 2 - 0.45 * q[i] ^ 4 end
      return L
    end }
    local told, seen = {}, {}
    for _, r in ipairs(map_of(beside, A, dm.zeros(n), { t = 100, rule = "gauss(2)" }):resonances(1)) do
      if not seen[r.omega] then seen[r.omega], told[#told + 1] = true, r.omega end
    end
    table.sort(told)
    ok(#told == n, "as many frequencies as oscillators", trial, #told, n)
    for i = 1, n do near(told[i] or 0, own[i], 0.012 * own[i], ("frequency %d of %d"):format(i, n)) end
  end
end

-- weakly coupled ones, of which one hardly moves: what it has of the other is no third frequency
for _, c in ipairs { { 1.4526, 1.161, 4.0685, 2.553, -0.0182, -0.41107, -0.00093, -0.40419, -0.06888 },
  { 1.318, 0.6914, 1.3274, 3.8322, 0.00116, -0.02699, -0.3848, 0.00362, 0.58596 }, { 0.8816, 0.818, 2.3822, 3.6234, -0.00102, -0.06019, -0.20361, 0.02512, 0.32929 } } do
  local two = dm.system { Q = dm.R(2), L = function(q, v)
    return (c[1] * v[1] ^ 2 + c[2] * v[2] ^ 2 - c[3] * q[1] ^ 2 - c[4] * q[2] ^ 2) / 2 - c[5] * q[1] * q[2] - 0.45 * (q[1] ^ 4 + q[2] ^ 4)
  end }
  local seen, count = {}, 0
  for _, r in ipairs(map_of(two, { c[6], c[7] }, { c[8], c[9] }, { t = 200, rule = "gauss(2)" }):resonances(1)) do
    if not seen[r.omega] then seen[r.omega], count = true, count + 1 end
  end
  ok(count == 2, "two oscillators have two frequencies", count)
end
tap.done()
