-- Routh reduction of systems beside the book's: groups of one to four dimensions, magnetic terms, time, actions, L that is not quadratic; closed
-- forms of their bundles, relative equilibria that are known, and every misuse of the options
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sin, cos, sqrt = math.abs, math.sin, math.cos, math.sqrt

local function system(n, L, more)
  local given = { Q = dm.R(n), L = L }
  for key, value in pairs(more or {}) do given[key] = value end
  return dm.system(given)
end

-- a cart with a pendulum, a rigid body (precession, nutation, spin) with k rotors along its axes, links below a turntable, a charge in a magnetic field
local cart = system(2, function(q, v) return 3 * v[1] ^ 2 / 2 + 0.7 * cos(q[2]) * v[1] * v[2] + 0.49 * v[2] ^ 2 / 2 + 6.86 * cos(q[2]) end)
local function body(k)
  return system(3 + k, function(q, v)
    local th, ps, L = q[2], q[3], 0
    local w = { v[1] * sin(th) * sin(ps) + v[2] * cos(ps), v[1] * sin(th) * cos(ps) - v[2] * sin(ps), v[1] * cos(th) + v[3] }
    for i, I in ipairs { 3, 2, 1.2 } do L = L + I * w[i] ^ 2 / 2 end
    for i = 1, k do L = L + (0.5 - 0.1 * i) * (w[i] + v[3 + i]) ^ 2 / 2 end
    return L
  end)
end
local function links(n)
  return system(n + 1, function(q, v)
    local r, z, dr, dz, L = 0.5, 0, 0, 0, 3 * v[1] ^ 2 / 2
    for i = 1, n do
      local s, c = 0.3 * sin(q[1 + i]), 0.3 * cos(q[1 + i])
      r, z, dr, dz = r + s, z - c, dr + c * v[1 + i], dz + s * v[1 + i]
      L = L + (0.2 + 0.1 * i) * ((dr ^ 2 + dz ^ 2 + r ^ 2 * v[1] ^ 2) / 2 - 9.8 * z)
    end
    return L
  end)
end
local charge = system(3, function(q, v)
  local r = q[2]
  return (v[2] ^ 2 + r ^ 2 * v[1] ^ 2 + v[3] ^ 2) / 2 + r ^ 2 * v[1] / 2 * (1 + 0.1 * r ^ 2) - 0.2 * v[3] * r
end)
local kaluza = system(4, function(q, v)
  local x, y, z = q[2], q[3], q[4]
  return (v[2] ^ 2 + v[3] ^ 2 + v[4] ^ 2) / 2 + (v[1] + x * y * v[4] - y * y * v[2] + sin(z) * v[3]) ^ 2 / 2 - (x * x + y * y + z * z) / 2
end)
local timed = system(2, function(q, v, t) return (1 + 0.3 * sin(t)) * (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + (1 + 0.2 * cos(2 * t)) / q[2] end)
local quick = system(2, function(q, v) return -sqrt(1 - v[1] ^ 2 - q[1] ^ 2 * v[2] ^ 2) - q[1] ^ 2 / 2 end)
local torus = system(2, function(q, v) return (v[2] ^ 2 + (2 + cos(q[2])) ^ 2 * v[1] ^ 2) / 2 end, { Q = dm.T(2) })
local two = system(6, function(q, v)
  local T, r2 = 0, 0
  for i = 1, 3 do T, r2 = T + v[i] ^ 2 / 2 + 3 * v[3 + i] ^ 2 / 2, r2 + (q[i] - q[3 + i]) ^ 2 end
  return T + 3 / sqrt(r2)
end)
local function shift(t, q) return { q[1] + t[1], q[2] + t[2], q[3] + t[3], q[4] + t[1], q[5] + t[2], q[6] + t[3] } end

local all = {
  { "cart", cart, { 0.3, 0.9 }, { 0.4, -0.2 }, 0.02, { cyclic = 1 } },
  { "body with a rotor", body(1), { 0.1, 1.2, 0.4, 0.1 }, { 0.3, 0.1, 0.2, 0.2 }, 0.05, { cyclic = { 1, 4 } } },
  { "body with three rotors", body(3), { 0.1, 1.2, 0.4, 0.1, 0.2, 0.3 }, { 0.3, 0.1, 0.2, 0.2, -0.1, -0.4 }, 0.05, { cyclic = { 1, 4, 5, 6 } } },
  { "two links on a turntable", links(2), { 0.2, 0.1, 0.2 }, { 0.9, -0.05, 0 }, 0.005, { cyclic = 1 } },
  { "three links on a turntable", links(3), { 0.2, 0.1, 0.2, 0.3 }, { 0.9, -0.05, 0, 0.05 }, 0.005, { cyclic = 1 } },
  { "charge in a magnetic field", charge, { 0, 1, 0 }, { 0.2, 0.3, 0.1 }, 0.05, { cyclic = { 1, 3 } } },
  { "Kaluza-Klein in space", kaluza, { 0, 0.3, 0.5, 0.2 }, { 0.7, 0.1, -0.2, 0.3 }, 0.05, { cyclic = 1 } },
  { "masses that change in time", timed, { 0, 1 }, { 1, 0.1 }, 0.02, { cyclic = 1 } },
  { "a particle near the speed of light", quick, { 0.5, 0 }, { 0.1, 0.6 }, 0.05, { cyclic = 2 } },
  { "geodesics of a torus", torus, { 0, 0.4 }, { 0.5, 0.3 }, 0.1, { cyclic = 1 } },
  { "two bodies moved together", two, { 1, 0, 0, -0.3, 0.1, 0 }, { 0, 1.2, 0.1, 0.1, -0.4, 0 }, 0.01, { action = shift, dimension = 3 } },
}
local rules = { "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(2)", "lobatto(3)", "sprk(radau-1a, 2)", "sprk(lobatto-3b-3a, 3)", "symplectic-euler(a)", "yoshida(4, midpoint)" }
for _, case in ipairs(all) do
  local name, s, q, v, h, how = table.unpack(case)
  how.q, how.v = q, v
  local shape = s:routh(how)
  local x, u, theta = shape:start(q, v)
  local worst, where = 0, "none"
  for _, rule in ipairs(rules) do
    local a = s:solver({ rule = rule, h = h }):run { q = q, v = v, steps = 300 }
    local off = dm.compare(a, shape:solver({ rule = rule, h = h }):run({ q = x, v = u, steps = 300 }):reconstruct { theta = theta }).worst
    if not (off <= worst) then worst, where = off, rule end
  end
  ok(worst < 1e-12, name .. ": reduced and back = unreduced, " .. #rules .. " tableaus", ("%.3g by %s"):format(worst, where))
end

-- thousands of instructions of Lua that f takes, and what it gives
local function instructions(f, ...)
  local count = 0
  debug.sethook(function() count = count + 1 end, "", 1000)
  local out = table.pack(f(...))
  debug.sethook()
  return count, table.unpack(out)
end

-- what a run is looked through for costs no trace of L for every row: it was 4 ms a row without an energy to keep
do
  local shape = timed:routh { cyclic = 1, mu = 1 }
  local solver = shape:solver { rule = "gauss(2)", h = 0.02 }
  local count = instructions(solver.run, solver, { q = { 1 }, v = { 0.1 }, steps = 400 })
  ok(count < 1000, "a run of 400 steps under a force of time is looked through without a trace a row", count)
end

-- a ring of 100 pendulums turned together, with sums in L: start and way back take one LU each, not an elimination in Lua (0.3 s each)
do
  local n = 100
  local ring = system(n, function(q, v)
    return dm.sum_over(v, function(w) return w ^ 2 / 2 end) - dm.sum_over(q, function(a, b) return 1 - cos(b - a) end, { shift = 1, periodic = true })
  end)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = sin(i), cos(2 * i) end
  local shape = ring:routh { q = q, v = v, action = function(t, p) return dm.vector(p):map(function(a) return a + t end) end }
  local count, x, u, theta = instructions(shape.start, shape, q, v)
  ok(count < 1000, "the start of a group that moves 100 coordinates", count)
  local a = ring:solver({ rule = "gauss(2)", h = 0.05 }):run { q = q, v = v, steps = 5 }
  local off = dm.compare(a, shape:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = x, v = u, steps = 5 }):reconstruct { theta = theta }).worst
  near(off, 0, 1e-13, "a ring of 100 pendulums without its common angle")
end

-- closed forms
local c = cart:routh { cyclic = 1, mu = 1.5 }
near(c:connection { 0.4 }[1][1], 0.7 * cos(0.4) / 3, 1e-15, "cart: connection"); near(c:locked_inertia({ 0.4 })[1][1], 3, 0, "locked inertia")
near(c:amended_potential { 0.4 }, -6.86 * cos(0.4) + 1.5 ^ 2 / 6, 1e-14, "amended potential")
local k = kaluza:routh { cyclic = 1, mu = 2 }
local b, x, y, z = k:curvature { 0.3, 0.5, 0.2 }, 0.3, 0.5, 0.2
near(abs(b[1][2] - 4 * y) + abs(b[1][3] - 2 * y) + abs(b[2][3] - 2 * (x - cos(z))), 0, 1e-15, "Kaluza-Klein: the curvature is mu dA")
local field = charge:routh { cyclic = { 1, 3 }, mu = { 0.7, 0.1 } }
near(field:amended_potential { 1.3 }, (0.7 - 0.845 * 1.169) ^ 2 / 3.38 + 0.36 ^ 2 / 2, 1e-15, "charge: (mu - c)^2/2 I with the vector potential in c")
-- a body with two rotors, mu = (0.9, 0.2, -0.3) at theta = 1.2, psi = 0.4; sympy: A = Matrix(I).inv() * C, V = mu.I^-1.mu/2, beta = d(mu A)
local rotors = body(2):routh { cyclic = { 1, 4, 5 }, mu = { 0.9, 0.2, -0.3 } }
local A, off = rotors:connection { 1.2, 0.4 }, 0
for i, row in ipairs { { 0.164949525298984122, 0.214551203989577328 }, { 0.861192049841891625, -0.0778720279918564298 }, { -0.531021711302301818, -0.184184666500252026 } } do
  for j = 1, 2 do off = math.max(off, abs(A[i][j] - row[j])) end
end
near(off, 0, 1e-15, "body with two rotors: connection"); near(rotors:amended_potential { 1.2, 0.4 }, 0.490402711431675652, 1e-15, "amended potential")
near(rotors:curvature { 1.2, 0.4 }[1][2], -1.10188717992438046, 1e-14, "magnetic form")

-- two links hinged to each other, free in the plane: one whole turn of the second beside the first turns both by
-- -int (a + b cos x)/(A + 2 b cos x) dx = -pi (1 + (2 a - A)/sqrt(A^2 - 4 b^2)), although nothing turns them
local function hinged(Q) return dm.system { Q = Q, L = function(q, v) return 0.3 * v[1] ^ 2 / 2 + 0.4 * (v[1] + v[2]) ^ 2 / 2 + 0.1 * cos(q[2]) * v[1] * (v[1] + v[2]) end } end
local function whole_turn(s) return { 2 * math.pi * s } end
near(hinged(dm.T(2)):routh({ cyclic = 1, mu = 0 }):holonomy(whole_turn)[1], -math.pi * (1 + 0.1 / sqrt(0.7 ^ 2 - 0.2 ^ 2)), 1e-14, "falling cat of two links: one turn")
raises("whole turns; with Q = dm.T(n)", function() hinged(dm.R(2)):routh({ cyclic = 1, mu = 0 }):holonomy(whole_turn) end)
-- a steady heavy top: I1 W^2 cos - p3 W + m g l = 0 gives its precession, which reconstruction must return
local th, p3, I1 = 0.6, 3, 1.3
local W = (p3 - sqrt(p3 ^ 2 - 4 * I1 * cos(th) * 1.1)) / (2 * I1 * cos(th))
local top = system(3, function(q, v) return (I1 * (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) + 0.7 * (v[3] + v[1] * cos(q[2])) ^ 2) / 2 - 1.1 * cos(q[2]) end)
local steady = top:routh { cyclic = { 1, 3 }, mu = { I1 * sin(th) ^ 2 * W + p3 * cos(th), p3 } }
local turns = steady:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = th, v = 0, steps = 100 }):phases()
near(turns.total[101][1], 5 * W, 1e-13, "steady precession of a heavy top"); near(turns.total[101][2], 5 * (p3 / 0.7 - W * cos(th)), 1e-13, "and its spin")
near(steady:relative_equilibria({ region = { 0.1, 3 } })[1].x[1], th, 1e-12, "found as a relative equilibrium")
-- upright, the axis of both turns is one: Euler's angles have a pole there, V_mu is stationary or not by round-off, and nothing is claimed
for _, p in ipairs { 2, 3 } do
  local asleep, poles = top:routh({ cyclic = { 1, 3 }, mu = { p, p } }):relative_equilibria { region = { -1, 1 } }, 0
  for _, e in ipairs(asleep) do poles = poles + (abs(e.x[1]) < 1e-3 and 1 or 0) end
  ok(poles == 0 and #asleep == (p == 2 and 2 or 0), "a top at the pole of its angles is left out", tostring(asleep))
end
-- a saddle or hill held by the magnetic term: -(x^2 + 1.2 y^2)/2 is stable from B = mu = 1 + sqrt 1.2 on (gyroscopic stabilization)
local hill = system(3, function(q, v)
  return (v[2] ^ 2 + v[3] ^ 2) / 2 + (v[1] + (q[2] * v[3] - q[3] * v[2]) / 2) ^ 2 / 2 + (q[2] ^ 2 + 1.2 * q[3] ^ 2) / 2
end):routh { cyclic = 1, mu = 1 }
local held = hill:continue(hill:relative_equilibria({ region = { { -1, 1 }, { -1, 1 } } })[1], { mu = { 0.5, 4 }, step = 0.1 })
ok(#held.events == 1 and abs(held.events[1].momentum - 1 - sqrt(1.2)) < 1e-5 and held[#held].stable == "spectral", "gyroscopic stabilization", tostring(held))
-- Foucault: a plane oscillator seen from a table that turns by Omega; after a period its angle has gone a whole turn less Omega T
local foucault = system(2, function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * (v[1] + 0.05) ^ 2) / 2 - q[2] ^ 2 / 2 end):routh { cyclic = 1, mu = 0.3 }
local swing = foucault:solver({ rule = "gauss(4)", h = 2 * math.pi / 200 }):run({ q = 1, v = 0, steps = 200 }):phases()
near(swing.total[201][1], 2 * math.pi * (1 - 0.05), 1e-9, "Foucault's pendulum")

-- three bodies, by translations and then by turns: three collinear equilibria (Euler) and two triangles (Lagrange), whatever the size of the figure;
-- the triangles are stable where (m1 m2 + m2 m3 + m3 m1)/M^2 < 1/27 (Routh)
local function bodies(m)
  return system(6, function(q, v)
    local L = 0
    for i = 1, 3 do
      L = L + m[i] * (v[2 * i - 1] ^ 2 + v[2 * i] ^ 2) / 2
      for j = i + 1, 3 do L = L + m[i] * m[j] / sqrt((q[2 * i - 1] - q[2 * j - 1]) ^ 2 + (q[2 * i] - q[2 * j]) ^ 2) end
    end
    return L
  end)
end
for _, case in ipairs { { { 1, 0.01, 0.01 }, "spectral" }, { { 1, 0.03, 0.03 }, false }, { { 1, 2, 3 }, false } } do
  local m, stable = table.unpack(case)
  local M, p = m[1] + m[2] + m[3], m[1] * m[2] + m[2] * m[3] + m[3] * m[1]
  local a = M / p ^ 2  -- side: mu = p/M sqrt(M a) = 1
  local centred = bodies(m):routh { dimension = 2, mu = { 0, 0 }, section = function(w) return { 0, 0, w[1], w[2], w[3], w[4] } end,
    action = function(t, q) return { q[1] + t[1], q[2] + t[2], q[3] + t[1], q[4] + t[2], q[5] + t[1], q[6] + t[2] } end }
  local turned = centred:routh { mu = 1, section = function(w) return { w[1], 0, w[2], w[3] } end, action = function(t, w)
    local co, si = cos(t), sin(t)
    return { co * w[1] - si * w[2], si * w[1] + co * w[2], co * w[3] - si * w[4], si * w[3] + co * w[4] }
  end }
  local list, triangles = turned:relative_equilibria { region = { { 0.05 * a, 3 * a }, { -3 * a, 3 * a }, { -3 * a, 3 * a } }, starts = 400 }, 0
  for _, e in ipairs(list) do
    local dx, dy = e.x[2] - a / 2, abs(e.x[3]) - a * sqrt(0.75)
    if abs(e.x[1] - a) + abs(dx) + abs(dy) < 1e-9 * a and e.stable == stable and abs(e.velocity[1] - sqrt(M / a ^ 3)) < 1e-9 * e.velocity[1] then triangles = triangles + 1 end
  end
  ok(#list == 5 and triangles == 2, ("three bodies, side %.3g: five relative equilibria, two of them Lagrange's"):format(a), tostring(list))
end

-- a bead on a hoop that is free to turn, (I0 + m sin^2) W = mu: from W^2 = g on it leaves the bottom; events stand where they happen
local hoop = system(2, function(q, v) return v[1] ^ 2 + (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 + 1.5 * cos(q[2]) end)
local slow = hoop:routh { cyclic = 1, mu = 1 }
local bottom = slow:continue(slow:relative_equilibria({ region = { -0.5, 0.5 } })[1], { mu = { 0.1, 6 }, step = 0.1 })
ok(#bottom.events == 2 and abs(bottom.events[1].momentum - 2 * sqrt(1.5)) < 1e-5, "the bottom loses its stability at mu = 2 sqrt g", tostring(bottom))
local fast = slow:at_momentum(4)
local arm = fast:continue(fast:relative_equilibria({ region = { 0.1, 1.5 } })[1], { mu = { 0.1, 6 }, step = 0.1, back = true })
ok(arm.events[1].what == "fold" and abs(arm.events[1].momentum - 2 * sqrt(1.5)) < 1e-5 and abs(arm.events[1].x[1]) < 1e-3, "where the tilted ones begin", tostring(arm))

ok(#arm:series().x == #arm and arm:series("mu", "q1").y[1] == arm.x1[1] and tostring(arm[1]):find("stable (minimum)", 1, true), "columns, series and points of a branch", tostring(arm[1]))

-- the cube of an action
local planet = system(3, function(q, v) return v:dot(v) / 2 + 1 / q:norm() end)
local function turn(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2], q[3] } end
local cube = dm.commute(planet, { action = turn, q = { 1, 0, 0.1 }, v = { 0, 0.9, 0.1 }, h = 0.05, steps = 10 })
ok(cube.commutes and #cube == 12, "an action has a cube, too", tostring(cube))
near(cube.mu[1], 0.9, 1e-15, "at the momentum of the start")

local less = dm.commute(timed, { cyclic = 1, q = { 0, 1 }, v = { 1, 0.1 }, h = 0.02, steps = 10 })
ok(less.commutes and #less == 6 and tostring(less):find("without the faces of DEL and DR: discrete: L depends on the time", 1, true), "a cube says which faces it lacks", tostring(less))

-- what prints itself
local shape = hoop:routh { cyclic = 1, mu = 1 }
ok(tostring(shape:reduction()):find("reduction by q1 (momentum 1) of system on R^2", 1, true), "a reduction prints itself", tostring(shape:reduction()))
local path = shape:solver({ rule = "gauss(1)", h = 0.1 }):run { q = 1, v = 0.1, steps = 20 }
ok(tostring(path:phases()):find("21 rows", 1, true), "phases print themselves", tostring(path:phases()))
local D = shape:discrete { rule = "midpoint", h = 0.1 }
near(D:legendre_plus(1, 1.01)[1], D:legendre_plus({ 1 }, { 1.01 })[1], 0, "Legendre transforms of numbers")
near(D:legendre_minus(1, 1.01)[1], D:legendre_minus({ 1 }, { 1.01 })[1], 0, "and backwards")
near(hoop:routh({ cyclic = dm.vector { 1 }, mu = 1 }):amended_potential(1), shape:amended_potential(1), 0, "cyclic may be a vector")

-- a failure names the columns of the path that it has: q1 of the shape, whatever number that was above
do
  local bob = system(2, function(q, v) return (v[2] ^ 2 / cos(q[2]) ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 - cos(q[2]) end)
  local fine, failure = pcall(function() bob:routh({ cyclic = 1, mu = 0.01 }):solver({ rule = "gauss(2)", h = 0.01 }):run { q = 1, v = 0.9, t = 20 } end)
  ok(not fine and failure.reason ~= nil and tostring(failure):find("'q1'", 1, true) and failure.path.columns[2] == "q1", "a failure names the columns of its path", tostring(failure))
end

-- misuse
local function routh(options) return function() return hoop:routh(options) end end
local function move(t, q) return { q[1] + t, q[2] } end
raises("option 'q' must be 2 numbers", routh { cyclic = 1, q = { 0 }, v = { 1, 2 }, mu = 3 })
raises("field 'v': a list of numbers is needed", routh { cyclic = 1, q = { 0, 1 }, v = "x", mu = 3 })
raises("option 'q'[2] must be a finite number", routh { cyclic = 1, q = { 0, 0 / 0 }, v = { 1, 2 } })
raises("not both", routh { cyclic = 1, action = move, mu = 1 })
raises("option 'section' belongs to an action", routh { cyclic = 1, mu = 1, section = move })
raises("option 'at' must be 2 numbers", routh { action = move, mu = 1, at = { 1 } })
raises("option 'action' must return a point of Q: 2 numbers (got nil)", routh { mu = 1, action = function() end })
raises("option 'section' must return a point of Q: 2 numbers (got nil)", routh { mu = 1, action = move, section = function() end })
raises("option 'section' must be a function", routh { mu = 1, action = move, section = 3 })
raises("option 'names' must be 2 names", routh { mu = 1, action = move, names = { "a" } })
raises("not one of an abelian group", routh { mu = 1, action = function(t, q) return { q[1] + t * t, q[2] } end })
raises("does not move the point {0, 0, 1}", function() planet:routh { action = turn, q = { 0, 0, 1 }, v = { 1, 2, 3 } } end)
raises("at {0, 0, 1} the group does not cross the section", function() planet:routh({ action = turn, mu = 1 }):start({ 0, 0, 1 }, { 1, 2, 3 }) end)
raises("start: q must be 3 numbers", function() planet:routh({ action = turn, mu = 1 }):start({ 0, 1 }, { 1, 2, 3 }) end)
raises("theta must be 1 number", function() shape:lift(1, 1, "x") end)
raises("theta must be 1 number", function() path:reconstruct { theta = "x" } end)
raises("the time must be a finite number", function() shape:amended_potential(1, "x") end)
raises("the guess of psi must be 1 number", function() D:psi(1, 1, "x") end)
raises("no psi_mu between x0 = [0.1] and x1 = [-0.1]", function()  -- the midpoint is the axis
  system(2, function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 end):routh({ cyclic = 1, mu = 1 }):discrete({ rule = "midpoint", h = 0.1 }):psi(0.1, -0.1)
end)
raises("called with a colon", function() hoop.routh { cyclic = 1, mu = 1 } end)
raises("called with a colon, x:psi(...)", function() D.psi(1, 1.01) end)
raises("called with a colon, x:reconstruct(...)", function() path.reconstruct {} end)
raises("which is not in the range", function() slow:continue(bottom[1], { mu = { 2, 3 } }) end)
raises("there is no column 'nu'", function() bottom:series("nu", "energy") end)
raises("x0 must be a point of the shape space: 1 number (got something else)", function() D:psi({ "a" }, 1) end)
raises("entry 1 is", function() shape:magnetic_momentum(1, 0 / 0) end)
raises("the loop must give a shape, 1 number (got 2)", function() shape:holonomy(function() return { 1, 2 } end) end)
raises("dm.compare: takes two paths", function() dm.compare(dm.R(2), dm.vector { 1 }) end)
for _, what in ipairs { "connection", "curvature", "amended_potential" } do  -- both masses on the axis
  raises(what .. ": there is no value at the shape {0, 0}", function()
    local pair = system(3, function(q, v) return (q[2] ^ 2 * v[1] ^ 2 + q[3] ^ 2 * (v[1] + v[2]) ^ 2 + v[2] ^ 2 + v[3] ^ 2) / 2 end):routh { cyclic = 1, mu = 1 }
    return pair[what](pair, { 0, 0 })
  end)
end
raises("is not symplectic", function() shape:solver { rule = "rsprk(rk4)", h = 0.1 } end)
raises("of finite numbers", function() shape:relative_equilibria { region = { 0, math.huge } } end)
raises("'points' must be a whole number", function() slow:continue(bottom[1], { mu = { 0, 1 }, points = "x" }) end)

tap.done()
