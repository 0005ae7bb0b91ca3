-- rows at given times, and rules with a time of their own
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, sqrt, abs, pi = math.sin, math.cos, math.sqrt, math.abs, math.pi

-- Kepler's equation by Newton: an independent road to the orbit
local function orbit(e, t)
  local E = t
  for _ = 1, 60 do E = E - (E - e * sin(E) - t) / (1 - e * cos(E)) end
  return { cos(E) - e, sqrt(1 - e * e) * sin(E) }
end
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function start(e) return { 1 - e, 0 }, { 0, sqrt((1 + e) / (1 - e)) } end
local function worst(path, e)
  local w = 0
  for i = 1, #path do w = math.max(w, (path.q[i] - orbit(e, path.t[i])):norm()) end
  return w
end

-- times on the grid are the grid's states; times between have the order of the rule; the run is left alone
local q, v = start(0.6)
for _, rule in ipairs { "verlet", "gauss(3)", "rk8pd", "kahan-li(6)" } do
  local solver = kepler:solver { rule = rule, h = 0.01 }
  local path = solver:run { q = q, v = v, steps = 100 }
  local some = solver:run { q = q, v = v, at = { 0, 0.25, 0.333, 0.5, 1 } }
  ok(#some == 5 and some.q[1] == path.q[1] and some.q[2] == path.q[26] and some.q[5] == path.q[101], rule .. ": rows on the grid are the states there")
  near((some.q[3] - orbit(0.6, 0.333)):norm(), 0, rule == "verlet" and 1e-3 or 1e-9, rule .. ": a row between two steps")
end

-- logarithmic Hamiltonian: the orbit is exact but for its timing, at every eccentricity
for _, e in ipairs { 0.3, 0.9, 0.99 } do
  q, v = start(e)
  local path = kepler:solver { rule = "log-hamiltonian(kahan-li(8))", h = 0.5 }:run { q = q, v = v, steps = 500 }
  local E, off = path:energy(), 0
  for i = 1, #path do off = math.max(off, abs(E[i] + 0.5)) end
  ok(off < 2e-12 / (1 - e), ("e = %g: energy to round-off"):format(e), off)
  ok(path.t[#path] > 100, "t is part of the state", path.t[#path])
end
local at, errors = {}, {}
for i = 1, 32 do at[i] = 20 * pi * i / 32 end
q, v = start(0.9)
for _, case in ipairs { { "verlet", 2, 0.01 }, { "yoshida(4)", 4, 0.05 }, { "kahan-li(8)", 8, 0.3 }, { "kahan-li(6)", 6, 0.2 } } do
  for i = 1, 2 do
    local path = kepler:solver { rule = ("log-hamiltonian(%s)"):format(case[1]), h = case[3] / i }:run { q = q, v = v, at = at }
    ok(#path == 32, "every time asked for is there", #path)
    errors[i] = worst(path, 0.9)
  end
  near(math.log(errors[1] / errors[2], 2), case[2], 0.05, ("log-hamiltonian(%s) has order %d at e = 0.9"):format(case[1], case[2]))
end
-- steps that end just at the last time asked for: its row is there too
q, v = start(0.1)
for _, m in ipairs { 25, 50, 80 } do
  local times = {}
  for i = 1, 32 do times[i] = 200 * pi * i / 32 end
  local path = kepler:solver { rule = "log-hamiltonian(sofroniou-spaletta(10))", h = 200 * pi / 32 / m }:run { q = q, v = v, at = times }
  ok(#path == 32 and path.t[32] == times[32], "the last row is there with " .. m .. " steps a row", #path)
end
q, v = start(0.9)
local plain = worst(kepler:solver { rule = "kahan-li(6)", h = 0.02 }:run { q = q, v = v, at = at }, 0.9)
ok(errors[2] < plain / 10, "and beats fixed steps at e = 0.9", errors[2] .. " against " .. plain)

-- a mass matrix that is not the identity, and three dimensions
local heavy = dm.system { Q = dm.R(3), L = function(x, u) return u[1] ^ 2 + u[2] ^ 2 + u[1] * u[2] + 2 * u[3] ^ 2 + 3 / sqrt(x:dot(x)) end }
local a = heavy:solver { rule = "gauss(6)", h = 0.01 }:run { q = { 1, 0, 0.2 }, v = { 0, 1.2, 0.1 }, at = { 1, 2.5 } }
local b = heavy:solver { rule = "log-hamiltonian(sofroniou-spaletta(10))", h = 0.1 }:run { q = { 1, 0, 0.2 }, v = { 0, 1.2, 0.1 }, at = { 1, 2.5 } }
near((a.q[2] - b.q[2]):norm(), 0, 1e-10, "coupled masses: the same motion as gauss(6)")
local s1, s2 = kepler:solver { rule = "log-hamiltonian", h = 0.1 }:step { q = q, v = v }
ok(s1:norm() > 0 and s2:norm() > 0, "one step of a rule with a time of its own")

-- misuse
local solver = kepler:solver { rule = "verlet", h = 0.01 }
raises("growing", solver.run, solver, { q = q, v = v, at = { 1, 1 } })
raises("growing", solver.run, solver, { q = q, v = v, at = { -1, 1 } })
raises("times", solver.run, solver, { q = q, v = v, at = {} })
raises("give one of", solver.run, solver, { q = q, v = v, at = { 1 }, steps = 3 })
raises("composition", function() kepler:solver { rule = "log-hamiltonian(gauss(2))", h = 0.1 } end)
raises("time of its own", function() kepler:solver { rule = "log-hamiltonian", h = 0.1 }:run { q = q, v = v, t = 1 } end)
raises("separable", function()
  dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 * (1 + x[1] ^ 2) end }:solver { rule = "log-hamiltonian", h = 0.1 }:run { q = { 1 }, v = { 1 }, steps = 1 }
end)
local fine, failure = pcall(function()
  return dm.system { Q = dm.R(1), L = function(x, u) return (u[1] ^ 2 - x[1] ^ 2) / 2 end }:solver { rule = "log-hamiltonian", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 9 }
end)
ok(not fine and failure.code == "not_finite", "a repelling potential is refused at the first step", failure)
raises("time of its own", function() kepler:solver { rule = "log-hamiltonian", h = 0.1 }:run { q0 = q, q1 = q, steps = 1 } end)
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(x0, x1) return (x1[1] - x0[1]) ^ 2 / 0.2 end }
raises("fixed step", function() dm.solver { Ld }:run { q0 = { 0 }, q1 = { 1 }, at = { 0.15 } } end)
-- steps with a time of their own, in any units: their length is no time, and rows are at the times asked for all the same
for _, mass in ipairs { 1e-40, 1, 5.97e24 } do
  local mu, a = 1.32712440018e20, 1.496e11
  local year = 2 * math.pi * math.sqrt(a ^ 3 / mu)
  local earth = dm.system { Q = dm.R(2), L = function(q, v) return mass * (v:dot(v) / 2 + mu / q:norm()) end }
  local run = earth:solver({ rule = "log-hamiltonian(kahan-li(8))", h = mass * mu / (0.5 * a) * year / 4000 }):run { q = { 0.5 * a, 0 },
    v = { 0, math.sqrt(3 * mu / a) }, at = { 0, year / 2, year } }
  local off = math.abs(run.q[2][1] + 1.5 * a) + math.abs(run.q[3][1] - 0.5 * a)
  tap.ok(#run == 3 and off < 1, ("half a year and a year, of a mass of %g"):format(mass), off)
end
-- far from t = 0, where times are rounded: no row is lost at the end of controlled steps
for _, t0 in ipairs { 1e4, 1e6, -1e6 } do
  local at, driven = {}, dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end, force = function(_, v) return { -v[1] / 2 } end }
  for i = 1, 100 do at[i] = t0 + 20 * i / 100 end
  local run = driven:solver({ rule = "rk8", h = 20 / 256 }):run { q = { 1 }, v = { 1 }, t0 = t0, at = at, control = { tolerance = 1e-9 } }
  tap.ok(#run == 100 and math.abs(run.q[100][1] - 3 + 2 * math.exp(-10)) < 1e-8, ("rows from t = %g on"):format(t0), #run)
end
-- the time of a failure is that of the last state, by rules with a time of their own, too
local edge = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 + 3 - dm.sqrt(2 - q[1]) end }
for _, rule in ipairs { "log-hamiltonian(verlet)", "verlet" } do
  local fine, failure = pcall(function() edge:solver({ rule = rule, h = 1e-2 }):run { q = { 1 }, v = { 1 }, t0 = 5, steps = 1000 } end)
  tap.ok(not fine and failure.time == failure.path.t[#failure.path] and failure.time > 5.5, rule .. ": time of a failure", failure.time)
end

-- a run that ends at a zero ends behind it, and what goes on from there meets the next one
local swing = dm.system { Q = dm.R(1), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }
local before, again = 0, 0
for i = 1, 60 do
  local solver, side = swing:solver { rule = "gauss(3)", h = 0.05 + 0.01 * i }, i % 2 * 2 - 1
  local crossing = { x = { g = function(q) return q[1] end, stop = true } }
  local first = solver:run { q = { -side }, v = { 0.1 * side }, t = 9, events = crossing }
  local q, p = first.q[#first.q], first.p[#first.p]
  if not (q[1] * side >= 0) then before = before + 1 end
  local next = solver:run { q = q, p = p, t = 9, events = crossing }
  if abs(next.t[#next.t] - pi) > 1e-2 then again = again + 1 end
end
ok(before == 0, "runs that end at a zero end behind it", before)
ok(again == 0, "and do not meet it again", again)

-- log-hamiltonian up a hill, x = 2 sin t: V = x^2/2 - 1 is 0 at t = pi/4, s = sin(2 t)/2 = 1/2,
-- whether steps go alone or in bursts
local hill = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 + 1 end }
for _, every in ipairs { 1, 100, 100000 } do
  local solver = hill:solver { rule = "log-hamiltonian", h = 1e-3 }
  local fine, e = pcall(solver.run, solver, { q = { 0 }, v = { 2 }, steps = 100000, every = every })
  ok(not fine and abs(e.step - 501) <= 1 and abs(e.path.q[#e.path][1] - sqrt(2)) < 1e-2,
    "the last step before V = 0, every = " .. every, tostring(e))
end

-- at most so many steps, which a run that goes on from there counts anew; its rows have the bits of one
do
  local solver = kepler:solver { rule = "log-hamiltonian", h = 0.1 }
  local function run(more) return solver:run { q = { 0.5, 0 }, v = { 0, sqrt(3) }, at = { 5, 20 }, most = more } end
  local whole, fine, e = run(), pcall(run, 100)
  ok(not fine and e.code == "out_of_time" and e.step == 100 and e.path.t[#e.path] == 5, "no more than 100 steps", tostring(e))
  ok(solver:report().steps == 100, "which were made")
  local rest = dm.resume(e.path):run { at = { 20 }, most = 200 }
  ok(rest.q[#rest] == whole.q[2], "and it goes on", rest.q[#rest])
  raises("goes with 'at'", function() solver:run { q = { 0.5, 0 }, v = { 0, sqrt(3) }, steps = 5, most = 9 } end)
  raises("goes with 'at'", function()
    kepler:solver { rule = "verlet", h = 0.1 }:run { q = { 0.5, 0 }, v = { 0, sqrt(3) }, at = { 1 }, most = 9 }
  end)
end

-- where doubles are further apart than steps, time stood still: the force cos(t) was a constant one, without a word
do
  local pushed = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1]^2 - q[1]^2)/2 + q[1]*math.cos(t) end }
  local solver = pushed:solver { rule = "gauss(2)", h = 0.05 }
  local function late(t0) return function() return solver:run { q = { 1 }, v = { 0 }, steps = 100, t0 = t0 } end end
  raises("field 't0': numbers near 1e+17 are 16.0 apart, which is too far for steps of h = 0.05", late(1e17))
  raises("field 't0'", late(-1e15))
  raises("field 't0'", late(1e300))
  local by_energy = solver.system:solver { rule = "sem(2, gauss(2))", h = 0.05 } -- steps of about h
  raises("field 't0'", by_energy.run, by_energy, { q = { 1 }, v = { 0 }, steps = 100, t0 = 1e17 })
  raises("field 't0'", function()
    solver:ensemble { members = 2, q = function() return { 1 } end, v = function() return { 0 } end, steps = 10, t0 = 1e17 }
  end)
  raises("field 't0'", function() solver:step { q = { 1 }, v = { 0 }, t0 = 1e17 } end)
  local string = dm.field { x = { 0, 1, 4 }, fixed = "ends", L = function(_, ut, ux) return (ut^2 - ux^2)/2 end }
  raises("t0", function() string:solver { h = 0.01 }:run { u = 0, t = 0.1, t0 = 1e17 } end)
  -- a rule whose steps of t are known at the start: h/2 here, of which 2^-7 is the eighth
  local own = kepler:solver { rule = "log-hamiltonian", h = 2^-3 }
  local function at(t0) return { q = { 0.5, 0 }, v = { 0, sqrt(3) }, steps = 3, t0 = t0 } end
  raises("the run could not start at step 1 (t = 1e+17); numbers near the time of the start, t0, are too far apart", own.run, own, at(1e17))
  raises("numbers near the time of the start, t0, are too far apart", own.run, own, at(-2^46))
  tap.near(own:run(at(2^45)).t[4] - 2^45, own:run(at(0)).t[4], 2^-8, "numbers that are 2^-7 apart will do")
  local many = own:ensemble { members = 2, q = function() return { 0.5, 0 } end, v = function() return { 0, sqrt(3) } end, steps = 3, t0 = 1e17 }
  tap.ok(many.status[2] == "no_start" and many:failures()[1].message:find("too far apart", 1, true), "and of members", many:failures()[1].message)
  -- a step of what knows no time has none in it
  for _, rule in ipairs { "verlet", "gauss(2)" } do
    local still = kepler:solver { rule = rule, h = 0.05 }
    local q, p = still:step { q = { 0.5, 0 }, v = { 0, sqrt(3) }, t0 = 1e17 }
    local q0, p0 = still:step { q = { 0.5, 0 }, v = { 0, sqrt(3) } }
    tap.ok(q == q0 and p == p0, rule .. ": a step at a late time of what does not depend on it", q)
    raises("from 0 where nothing depends on it", still.run, still, at(1e17))
  end
  -- the same force, whole turns of cos later: 2 pi * 1e9 is rounded by 5e-7
  local now, then_ = late(0)(), late(2*math.pi*1e9)()
  ok((now.q[101] - then_.q[101]):norm() < 1e-5, "a late start that is told apart", then_.q[101])
end
tap.done()
