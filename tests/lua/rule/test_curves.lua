-- dm.curve: one-step methods made variational; their order, what they keep where the bare method does not, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, sin, log, max, pi = math.abs, math.cos, math.sin, math.log, math.max, math.pi

local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
-- a mass that varies, and time
local cart = dm.system { Q = dm.R(2), L = function(q, v, t)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[2]) + cos(q[2]) * (1 + 0.2 * sin(t)) - q[1] ^ 2 / 2
end }

local function final(system, rule, start, t, n)
  local path = system:solver { rule = rule, h = t / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[#path], path
end
local function order(system, rule, start, t, n, goal)
  return log((final(system, rule, start, t, n) - goal):norm() / (final(system, rule, start, t, 2 * n) - goal):norm(), 2)
end

-- steps at which the leading term shows; dopri5's of order 5 nearly vanishes, so that 6 shows for long
local low, middle, fast = { q = { 1.2 }, v = { 0.5 } }, { q = { 1.2 }, v = { 1.5 } }, { q = { 0.5 }, v = { 1.8 } }
local inside = { q = { 0.1, 0 }, v = { 0, 0.5 } }
local rows = {
  { "straight", 2, pendulum, middle, 400 }, { "euler", 1, pendulum, low, 800 }, { "midpoint", 2, pendulum, low, 400 },
  { "heun", 2, pendulum, low, 400 }, { "kutta3", 3, pendulum, fast, 400 }, { "rk4", 4, pendulum, middle, 800 },
  { "butcher6", 6, pendulum, middle, 560 }, { "fehlberg7", 7, pendulum, fast, 100 }, { "dop853", 8, henon, inside, 70 },
  { "gsl-rk2", 3, pendulum, fast, 400 }, { "gsl-rk4", 4, pendulum, middle, 400 }, { "gsl-rkf45", 5, pendulum, middle, 400 },
  { "gsl-rkck", 5, pendulum, middle, 400 }, { "gsl-rk8pd", 8, henon, inside, 70 },
}
for _, row in ipairs(rows) do
  local method, p, system, start, n = table.unpack(row)
  local goal = final(system, "gauss(8)", start, 20, 800)
  near(order(system, dm.curve(method), start, 20, n, goal), p, 0.1, method .. " made variational has order " .. p)
  ok(dm.curve(method).order == p, "and says so")
end
-- the far end of an ellipse through the near one, exactly by Kepler's equation; odd orders show as even ones there
local e, T = 0.6, 4
local far, E = { q = { -1 - e, 0 }, v = { 0, -0.8 / (1 + e) } }, pi + T
for _ = 1, 60 do E = E - (E - e * sin(E) - pi - T) / (1 - e * cos(E)) end
local exact = dm.vector { cos(E) - e, 0.8 * sin(E) }
for _, row in ipairs { { "straight", 2, 400 }, { "euler", 1, 1600 }, { "heun", 2, 800 }, { "kutta3", 3, 280 }, { "rk4", 4, 400 },
  { "dopri5", 5, 200 }, { "butcher6", 6, 400 }, { "fehlberg7", 7, 70 }, { "dop853", 8, 100 }, { "gsl-rk8pd", 8, 100 } } do
  local p, measured = row[2], order(kepler, "curve(" .. row[1] .. ")", far, T, row[3], exact)
  ok(measured > p - 0.15 and measured < 2 * ((p + 1) // 2) + 0.15, row[1] .. " on Kepler's ellipse: order " .. p, measured)
end
local swing = { q = { 0.3, 0.8 }, v = { 0.2, -0.4 } }
local goal = final(cart, "gauss(8)", swing, 2, 200)
for _, row in ipairs { { "straight", 2, 160 }, { "euler", 1, 320 }, { "heun", 2, 320 }, { "kutta3", 3, 160 }, { "rk4", 4, 80 },
  { "gsl-rkck", 5, 40 } } do
  near(order(cart, dm.curve(row[1]), swing, 2, row[3], goal), row[2], 0.1, row[1] .. ": order " .. row[2] .. " with a mass that varies, and time")
end
-- around its middle a segment makes an even order of an odd one
local pend = final(pendulum, "gauss(8)", middle, 20, 800)
for _, row in ipairs { { "euler", 2, 400 }, { "kutta3", 4, 200 }, { "dopri5", 6, 140 }, { "fehlberg7", 8, 50 } } do
  local rule = dm.curve(row[1], { bias = 0.5 })
  near(order(pendulum, rule, middle, 20, row[3], pend), row[2], 0.15, row[1] .. " to both sides has order " .. row[2])
  ok(rule.order == row[2], "and says so")
end
near(order(pendulum, dm.curve("rk4", { bias = 0.3 }), middle, 20, 400, pend), 4, 0.1, "rk4 with a bias of 0.3 has order 4")

-- methods written in Lua are what they write
local function rk4(x, f, h)
  local k1 = f(x)
  local k2 = f(x + h / 2 * k1)
  local k3 = f(x + k2 * h / 2)
  return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(x + h * k3))
end
local own = dm.curve { method = rk4, order = 4 }
ok(own.order == 4 and tostring(own):find "own method", "a method written in Lua knows its order", own)
near((final(kepler, own, far, T, 100) - final(kepler, "curve(rk4)", far, T, 100)):norm(), 0, 1e-13, "and steps like the built-in one")
local timed = dm.curve { method = function(x, f, h, t) return x + h * f(x + h / 2 * f(x, t), t + h / 2) end }
near((final(cart, timed, swing, 2, 40) - final(cart, dm.curve "midpoint", swing, 2, 40)):norm(), 0, 1e-14, "with the time of its points")
ok(timed.order == 2, "order 2 is found")

-- methods that treat positions and velocities each in its way; Ld is then summed at Gauss nodes
local function part(y, first)
  local z = {}
  for i = 1, #y // 2 do z[i] = y[first + i] end
  return dm.vector(z)
end
local function both(q, v)
  local y = {}
  for i = 1, #q do y[i], y[#q + i] = q[i], v[i] end
  return dm.vector(y)
end
local function acceleration(f, q, v) return part(f(both(q, v)), #q) end
local split = {
  { 1, function(x, f, h)  -- symplectic Euler
    local q, v = part(x, 0), part(x, #x // 2)
    local v1 = v + h * acceleration(f, q, v)
    return both(q + h * v1, v1)
  end },
  { 2, function(x, f, h)  -- leapfrog, its force in the middle
    local q, v = part(x, 0), part(x, #x // 2)
    local v1 = v + h * acceleration(f, q + h / 2 * v, v)
    return both(q + h / 2 * (v + v1), v1)
  end },
  { 4, function(x, f, h)  -- Nystroem 1925
    local q, v = part(x, 0), part(x, #x // 2)
    local k1 = acceleration(f, q, v)
    local k2 = acceleration(f, q + h / 2 * v + h ^ 2 / 8 * k1, v)
    local k3 = acceleration(f, q + h * v + h ^ 2 / 2 * k2, v)
    return both(q + h * v + h ^ 2 / 6 * (k1 + 2 * k2), v + h / 6 * (k1 + 4 * k2 + k3))
  end },
}
for _, row in ipairs(split) do
  local rule = dm.curve { method = row[2] }
  ok(rule.order == row[1], "a method that treats q and v differently: order " .. row[1] .. " is measured", rule.order)
  near(order(kepler, rule, { q = { 1, 0 }, v = { 0, 1.1 } }, 2, 160, final(kepler, "gauss(8)", { q = { 1, 0 }, v = { 0, 1.1 } }, 2, 400)),
    row[1], 0.1, "  and is that of its variational form")
  local run = kepler:solver { rule = dm.curve { method = row[2], bias = 0.3 }, h = 0.05 }:run { q = { 1, 0 }, v = { 0, 1.1 }, steps = 20000, every = 10 }
  local J, worst = run:momentum(dm.SO(2)), 0
  for i = 1, #J do worst = max(worst, abs(J[i] - 1.1)) end
  ok(worst < 5e-14 and abs(run:drift("energy").per_time) < 1e-8, "  angular momentum to round-off, no drift of the energy", worst)
end

-- the bare methods drift, these do not
local function bare(method, n, h)
  local function f(x) return dm.vector { x[2], -sin(x[1]) } end
  local x = dm.vector { 1.2, 0.5 }
  for _ = 1, n do x = method(x, f, h) end
  return x[2] ^ 2 / 2 - cos(x[1])
end
local E0 = 0.5 ^ 2 / 2 - cos(1.2)
local plain = { euler = function(x, f, h) return x + h * f(x) end, rk4 = rk4,
  heun = function(x, f, h) local k = f(x); return x + h / 2 * (k + f(x + h * k)) end }
for _, method in ipairs { "euler", "heun", "rk4" } do
  local h = method == "rk4" and 0.4 or 0.1
  local path = pendulum:solver { rule = dm.curve(method), h = h }:run { q = low.q, v = low.v, steps = 100000, every = 25 }
  local energy, worst = path:energy(), 0
  for i = 1, #path do worst = max(worst, abs(energy[i] - energy[1])) end
  local drift = path:drift "energy"
  local lost = abs(bare(plain[method], 4000, h) - E0) / (4000 * h)
  ok(abs(drift.per_time) < 1e-7 and abs(drift.per_time) < 0.01 * lost,
    method .. ": no drift of the energy over 10^5 steps where the bare method drifts", drift.per_time .. " against " .. lost)
  ok(worst < 0.2, "  the energy stays in a band", worst)
end
-- Noether
for _, method in ipairs { "euler", "rk4", "dop853" } do
  local path = kepler:solver { rule = dm.curve(method), h = 0.05 }:run { q = { 1, 0 }, v = { 0, 1.1 }, steps = 20000, every = 10 }
  local J, worst = path:momentum(dm.SO(2)), 0
  for i = 1, #J do worst = max(worst, abs(J[i] - 1.1)) end
  ok(worst < 5e-14, method .. " keeps the angular momentum to round-off over 20,000 steps", worst)
end

-- the same bits on the tape and as native code, as text and as an object
for _, system in ipairs { kepler, cart } do
  local solver = { rule = "curve(butcher6, 0.4)", h = 0.05 }
  local rows_of = {}
  for i, backend in ipairs { "tape", "jit" } do
    local path = system:solver { rule = i == 1 and solver.rule or dm.curve("butcher6", { bias = 0.4 }), h = 0.05, backend = backend }
      :run { q = { 1, 0.2 }, v = { 0.1, 1 }, steps = 500 }
    rows_of[i] = table.concat { tostring(path.q[501][1]), ("%a %a %a"):format(path.q[501][1], path.q[501][2], path.p[501][1]) }
  end
  ok(rows_of[1] == rows_of[2], "tape and native code give the same bits", rows_of[1] .. " " .. rows_of[2])
end
-- a checkpoint keeps what a step leaves to the next one
for _, rule in ipairs { "curve(rk4)", dm.curve("kutta3", { bias = 0.5 }) } do
  local solver, file = cart:solver { rule = rule, h = 0.05 }, os.tmpname()
  local begin = { q = swing.q, v = swing.v }
  local whole = solver:run { q = begin.q, v = begin.v, steps = 300, every = 300 }
  solver:run { q = begin.q, v = begin.v, steps = 137, every = 137 }:checkpoint(file)
  local rest = dm.resume(file, cart):run { steps = 163, every = 163 }
  os.remove(file)
  ok(rest.q[#rest] == whole.q[2] and rest.p[#rest] == whole.p[2], "a restart goes on bit for bit: " .. tostring(rule))
end
-- members of an ensemble have the bits of runs of their own
local ensemble = kepler:solver({ rule = dm.curve("gsl-rkck", { bias = 0.5 }), h = 0.05 })
  :ensemble { members = 6, q = function(i) return { 1, 0.1 * i } end, v = function() return { 0, 1 } end, steps = 40, threads = 2 }
local third = kepler:solver({ rule = dm.curve("gsl-rkck", { bias = 0.5 }), h = 0.05 }):run { q = { 1, 0.1 * 3 }, v = { 0, 1 }, steps = 40, every = 40 }
ok(ensemble.q[3] == third.q[2] and ensemble.p[3] == third.p[2], "a member of an ensemble is a run of its own", ensemble)
-- sums, and many coordinates
local ring = dm.system { Q = dm.R(20), L = function(q, v)
  return v:dot(v) / 2 - dm.sum_over(q, function(a, b) return (b - a) ^ 2 / 2 + (b - a) ^ 4 / 4 end, { shift = 1, periodic = true }) end }
local fine, path = pcall(function()
  local q, v = {}, {}
  for i = 1, 20 do q[i], v[i] = sin(2 * pi * i / 20), 0 end
  return ring:solver { rule = dm.curve "rk4", h = 0.05 }:run { q = q, v = v, steps = 400 }
end)
ok(fine and abs(path:energy()[401] - path:energy()[1]) < 1e-4 * path:energy()[1], "twenty bodies with neighbours", path)

-- misuse
local function bad(words, method, more)
  raises(words, function()
    local options = more or {}
    options.method = method
    return dm.curve(options)
  end)
end
bad("not consistent", function(x, f, h) return x + h / 2 * f(x) end)
bad("not consistent", function(x) return x end)
bad("has order 1 only", function(x, f, h) return x + h * f(x) end, { order = 2 })
bad("as many entries as x", function() return 3 end)
bad("as many entries as x", function() end)
bad("argument of f", function(x, f, h) return x + h * f(x[1]) end)
bad("argument of f", function(x, f, h) return x + h * f { 1, 2 } end)
bad("dm.where", function(x, f, h) if x[1] > 0 then return x end; return x + h * f(x) end)
bad("not consistent", function(x, f, h) return x + h * f(x):norm() * x end)
bad("not consistent", function(x, f, h) local k = f(x); return x + h * dm.vector { k[1] / (1 + k[1]), k[2], k[3], k[4] } end)
bad("more than 40 times", function(x, f, h) for _ = 1, 41 do x = x + h * f(x) end; return x end)
bad("t + c h", function(x, f, h, t) return x + h * f(x, t + h) end)
bad("mine", function() error "mine" end)
bad("not consistent", function(x, f, h) local k = f(x); return dm.vector { x[1], x[2], x[3] + h * k[3] ^ 2, x[4] } end)
bad("not consistent", function(x, f, h) local k = f(x); return dm.vector { x[1] + h * k[1], x[2] + h * k[2], x[3], x[4] } end)
bad("has order 2 only", split[2][2], { order = 3 })
bad("field 'method'", 7)
bad("field 'method'", nil)
bad("field 'bias'", "rk4", { bias = 2 })
bad("field 'order'", rk4, { order = 0 })
bad("did you mean", "rk4", { bais = 1 })
raises("unknown one-step method 'rk5'", dm.curve, "rk5")
raises("table", dm.curve, 3)
raises("curve takes the name", function() kepler:solver { rule = "curve", h = 1 } end)
raises("no such one-step method", function() kepler:solver { rule = "curve(rk5)", h = 1 } end)
raises("from 0 to 1", function() kepler:solver { rule = "curve(rk4, 3)", h = 1 } end)
raises("hyper-dual", function()
  dm.system({ Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 end })
    :solver({ rule = dm.curve "rk4", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 1 }
end)
raises("degenerate", function()
  dm.system({ Q = dm.R(2), L = function(q, v) return q[1] * v[2] - q[2] ^ 2 end })
    :solver({ rule = dm.curve "rk4", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 0 }, steps = 1 }
end)
-- steps too large: a failure that carries the path
local steep = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.exp(q[1]) end }
local _, failure = pcall(function() return steep:solver { rule = dm.curve "straight", h = 2 }:run { q = { -9 }, v = { 0 }, steps = 1000 } end)
ok((failure.code == "no_convergence" or failure.code == "singular") and #failure.path == failure.step, "steps too large: code, step and path", failure)
ok(tostring(failure):find "try", "and what to try", failure)
tap.done()
