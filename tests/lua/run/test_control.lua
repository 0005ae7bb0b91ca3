-- controlled steps: as long as their error allows, none over what is narrow in the forces
local tap = require "tap"
local dm = require "dm"
local forces = require "dm.reference.forces"
local ok, near, raises = tap.ok, tap.near, tap.raises
local exp, sqrt, pi, cos, sin = math.exp, math.sqrt, math.pi, math.cos, math.sin

-- Kepler, e = 0.95, from the apocentre: back there after a revolution
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { -1.95, 0 }, v = { 0, -sqrt(0.05 / 1.95) } }
local function run(system, rule, T, s, control, more)
  local options = { q = s.q, v = s.v, t = T, control = control }
  for key, value in pairs(more or {}) do options[key] = value end
  return system:solver({ rule = rule, h = T / 50 }):run(options)
end
for _, rule in ipairs { "rk8", "gauss(5)", "kahan-li(8)", "lobatto(5)" } do
  local path = run(kepler, rule, 2 * pi, start, { tolerance = 1e-13 })
  near(path.q[#path][1], -1.95, 1e-9, rule .. ": a revolution")
  near(path.t[#path], 2 * pi, 1e-14, "that ends where it was asked to")
  local least, most = math.huge, 0
  for i = 2, #path do
    local h = path.t[i] - path.t[i - 1]
    least, most = math.min(least, h), math.max(most, h)
  end
  ok(most > 10 * least, "by steps of unlike lengths", most / least)
end
local coarse, fine = run(kepler, "rk8", 2 * pi, start, { tolerance = 1e-6 }), run(kepler, "rk8", 2 * pi, start, { tolerance = 1e-12 })
ok(#coarse < #fine, "a smaller tolerance takes more steps", #fine)
local path = run(kepler, "rk8", 2 * pi, start, { tolerance = 1e-6, largest = 0.1, ends = { 1, 2.5 } })
local met = 0
for i = 1, #path do met = met + ((path.t[i] == 1 or path.t[i] == 2.5) and 1 or 0) end
ok(met == 2 and #path > 62, "steps end at the times given, none longer than the largest", #path)

-- a kick that steps jump over, a wall in q
local w, c = 1e-4, 3.3
local kicked = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1] ^ 2 - q[1] ^ 2) / 2 + 0.2 / w * exp(-((t - c) / w) ^ 2) * q[1] end }
local exact = cos(10) + 0.2 * sqrt(pi) * exp(-w ^ 2 / 4) * sin(10 - c)
local at = { q = { 1 }, v = { 0 } }
for _, rule in ipairs { "rk8", "gauss(4)" } do
  local met_it = run(kicked, rule, 10, at, { tolerance = 1e-11, hidden = (forces.of(kicked)) })
  near(met_it.q[#met_it][1], exact, 1e-6, rule .. ": a kick of width 1e-4 is met")
end
local blind = run(kicked, "rk8", 10, at, { tolerance = 1e-11 })
ok(math.abs(blind.q[#blind][1] - exact) > 0.1, "which steps alone jump over")
local wall = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - exp(-((q[1] - 1) / 1e-5) ^ 2) end }
path = run(wall, "rk8", 2, { q = { 0 }, v = { 1 } }, { tolerance = 1e-11, hidden = (forces.of(wall)) })
ok(math.abs(path.q[#path][1]) < 1e-4, "a wall of width 1e-5 turns the motion back", path.q[#path][1])
ok(forces.of(dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 4 + q[1] * q[2] ^ 2 end }) == nil, "polynomials hide nothing")
-- narrow features that are small beside all else: of terms, factors, angles, between two jumps
local function close(what, L, q0, v0, x)
  local system = dm.system { Q = dm.R(1), L = L }
  for _, rule in ipairs { "rk8", "gauss(7)" } do
    local found = run(system, rule, 10, { q = { q0 }, v = { v0 } }, { tolerance = 1e-11, hidden = (forces.of(system)) })
    near(found.q[#found][1], x, 1e-6 * (1 + v0 / 1000), rule .. ": " .. what)
  end
end
local function pulse(t, width) return exp(-((t - 5) / width) ^ 2) end
local J = 1e-3 * sqrt(pi)
close("a pulse of a fiftieth of the force", function(q, v, t) return v[1] ^ 2 / 2 - 500 * q[1] + 10 * pulse(t, 1e-3) * q[1] end, 0, 2500, 5 * 10 * J)
close("in a factor of it", function(q, v, t) return v[1] ^ 2 / 2 - 500 * (1 + 0.02 * pulse(t, 1e-3)) * q[1] end, 0, 2500, -5 * 10 * J)
close("in an angle", function(q, v, t) return v[1] ^ 2 / 2 + q[1] * cos(pi / 2 - 0.05 * pulse(t, 1e-3)) end, 0, 0,
  5 * (0.05 * J - 0.05 ^ 3 / 6 * J / sqrt(3)))
local tanh = dm.tanh
close("a plateau of length 0.01", function(q, v, t) return v[1] ^ 2 / 2 - 500 * q[1] + (tanh((t - 5) / 1e-3) - tanh((t - 5.01) / 1e-3)) * q[1] end, 0, 2500,
  0.02 * (5 - 0.005))
-- a wall where the motion turns: q gets to 1 - 0.002, where parabolas do not lead
local grazed = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 - 1e-3 * exp(-((q[1] - 1) / 1e-3) ^ 2) end }
local free = run(grazed, "rk8", 30, { q = { 0 }, v = { 0.998 } }, { tolerance = 1e-9, hidden = (forces.of(grazed)) })
local bound = run(grazed, "rk8", 30, { q = { 0 }, v = { 0.998 } }, { tolerance = 1e-11, largest = 1e-3 })
near(free.q[#free][1], bound.q[#bound][1], 1e-5, "the foot of a wall where the motion turns")
-- rows inside of steps are as exact as those at their ends
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local rows, off = {}, 0
for k = 1, 2000 do rows[k] = k / 200 end
local inside = oscillator:solver({ rule = "rk8", h = 0.2 }):run { q = { 1 }, v = { 0 }, at = rows, control = { tolerance = 1e-7 } }
for k = 1, #inside do off = math.max(off, math.abs(inside.q[k][1] - cos(inside.t[k]))) end
ok(off < 2e-7, "rows in the second halves of steps begin in their middle", off)
-- a stiff spring, whose large forces cancel, hides nothing
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 9.81 * q[2] - 1e7 / 2 * (q:norm() - 1) ^ 2 end }
local solver = rod:solver { rule = "rk8", h = 1e-3 }
solver:run { q = { sin(0.5), -cos(0.5) }, v = { 0, 0 }, t = 0.2, control = { tolerance = 1e-9, hidden = (forces.of(rod)) } }
ok(solver:report().unseen == nil and solver:report().steps < 1000, "a stiff spring hides nothing", solver:report().steps)

-- what cannot be done
local fell, why = pcall(run, kepler, "rk8", 2, { q = { 1, 0 }, v = { 0, 0 } }, { tolerance = 1e-10 })
ok(not fell and why.code == "too_short" and not tostring(why):find "converge", "a fall ends by its shortest step", why)
near(why.time, pi / math.sqrt(8), 1e-3, "at the time of the collision")
raises("collision", run, kepler, "rk8", 2, { q = { 1, 0 }, v = { 0, 0 } }, { tolerance = 1e-10 })
raises("seconds or steps", run, rod, "rk8", 1e6, { q = { sin(0.5), -cos(0.5) }, v = { 0, 0 } }, { tolerance = 1e-10 }, { seconds = 0.05 })
raises("unknown", run, kepler, "rk8", 1, start, { tol = 1 })
raises("'control'", run, kepler, "rk8", 1, start, 3)
raises("growing", run, kepler, "rk8", 1, start, { ends = { 2, 1 } })
raises("hidden", run, kepler, "rk8", 1, start, { hidden = 1 })
raises("cannot be chosen", kepler:solver({ rule = "log-hamiltonian(verlet)", h = 0.1 }).run, kepler:solver { rule = "log-hamiltonian(verlet)", h = 0.1 },
  { q = start.q, v = start.v, at = { 1 }, control = { tolerance = 1e-6 } })
-- a force that jumps is no singularity
local pushed = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + q[1] * dm.where(t - 0.3, 1, 0) end }
path = run(pushed, "rk8", 1, { q = { 0 }, v = { 0 } }, { tolerance = 1e-12, hidden = (forces.of(pushed)) })
near(path.q[#path][1], 0.49 / 2, 1e-12, "a jump of the force becomes the end of a step")

-- the step that follows one with the difference d of its halves: 0.9 (d/(2^p - 1))^(-1/(p + 1))
local swing = dm.system { Q = dm.R(1), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }
local function verlet(q, p, h)
  p = p - h / 2 * q
  q = q + h * p
  return q, p - h / 2 * q
end
for _, h in ipairs { 0.1, 0.07 } do
  local steps = swing:solver({ rule = "verlet", h = h }):run { q = { 1 }, v = { 0.3 }, t = 3,
    control = { tolerance = 1e-3 } }
  local q, p = verlet(1, 0.3, h)
  local a, b = verlet(1, 0.3, h / 2)
  a, b = verlet(a, b, h / 2)
  local d = math.max(math.abs(q - a), math.abs(p - b) / math.max(0.3, math.abs(b))) / 1e-3
  near((steps.t[3] - steps.t[2]) / h, 0.9 * (d / 3) ^ (-1 / 3), 1e-12, "the second step, after " .. h)
end
-- a run to an earlier time has the steps of the whole where it is told how far that reaches
local function ends(at, reach)
  return kepler:solver({ rule = "rk8", h = 0.1 }):run { q = start.q, v = start.v, at = at, control = { tolerance = 1e-6, largest = 2, reach = reach } }
end
local whole, early = ends({ 1.3, 2.1, 9 }), ends({ 1.3, 2.1 }, 9)
ok(whole.q[2][1] == early.q[2][1] and whole.q[1][2] == early.q[1][2], "the same steps up to there", whole.q[2], early.q[2])
ok(#early == 2 and early.t[2] == 2.1, "and no rows behind", #early)
raises("'control.reach' must be a time", ends, { 1 }, "later")

-- a pendulum on a spring that rests: velocities along a step are differences of positions, whose round-off is no feature
local function hung(stiffness)
  return dm.system { Q = dm.R(2), L = function(x, v)
    return (v[1] ^ 2 + (1 + x[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + x[1]) * math.cos(x[2]) - stiffness / 2 * x[1] ^ 2
  end }
end
local stiff = hung(1e10)
path = run(stiff, "rk8", 0.01, { q = { 9.81 * math.cos(0.5) / 1e10, 0.5 }, v = { 0, 0 } }, { tolerance = 1e-9, hidden = (forces.of(stiff)) })
near(path.q[#path][2], 0.5 - 9.81 * math.sin(0.5) * 0.01 ^ 2 / 2, 1e-7, "a stiff spring at rest hides nothing")
-- rows inside of a step where one that leads there does not converge
local rod = dm.system { Q = dm.R(2), L = function(x, v) return v:dot(v) / 2 - 9.81 * x[2] - 1e9 / 2 * (x:norm() - 1) ^ 2 end }
local length, at = 1 + 9.81 * math.cos(0.5) / 1e9, {}
for i = 1, 1000 do at[i] = 7.8768 + 6e-7 * i end
path = rod:solver({ rule = "gauss(7)", h = 10 / 256 }):run { q = { length * math.sin(0.5), -length * math.cos(0.5) }, v = { 0, 0 }, at = at,
  control = { tolerance = 3e-10, largest = 10 / 37, reach = 10, hidden = (forces.of(rod)) } }
local furthest = 0
for i = 1, #path do furthest = math.max(furthest, math.abs(path.q[i]:norm() - 1)) end
ok(#path == 1000 and furthest < 2e-8, "rows inside of long steps over a stiff spring", furthest)
-- a run goes on from the time where a controlled one ended, whatever its steps, and a controlled one
-- from the time of the run before it: L sees t, and one run all the way is the judge
do
  local driven = dm.system { Q = dm.R(2), L = function(q, v, t)
    return v:dot(v) / 2 + 1 / q:norm() + 0.1 * sin(t) * q[1]
  end }
  local file = os.tmpname()
  for _, rule in ipairs { "rk8", "gauss(2)", "kahan-li(8)" } do
    local solver = driven:solver { rule = rule, h = 0.02 }
    local function go(of, more)
      for key, value in pairs { t = 1, control = { tolerance = 1e-9 } } do
        if more[key] == nil then more[key] = value end
      end
      if more.control == false then more.control = nil end
      return of:run(more)
    end
    local whole = go(solver, { q = { 0.4, 0 }, v = { 0, 2 }, t = 2 })
    local first = go(solver, { q = { 0.4, 0 }, v = { 0, 2 }, checkpoint = file })
    local plain = go(solver, { q = { 0.4, 0 }, v = { 0, 2 }, control = false })
    for what, path in pairs { ["from the path"] = go(dm.resume(first), {}),
      ["from the file"] = go(dm.resume(file, driven), {}),
      ["behind plain steps"] = go(dm.resume(plain), {}) } do
      local off = (path.q[#path.q] - whole.q[#whole.q]):norm()
      ok(path.t[1] == 1 and path.t[#path.t] == 2 and off < 1e-5,
        ("%s: a controlled run goes on %s"):format(rule, what), path.t[1] .. ", " .. off)
    end
    local on = go(dm.resume(first), { control = false })
    local off = (on.q[#on.q] - whole.q[#whole.q]):norm()
    ok(on.t[1] == 1 and math.abs(on.t[#on.t] - 2) < 1e-14 and off < 1e-3,
      rule .. ": and plain steps behind it", off)
  end
  os.remove(file)
end

-- an event that stops a controlled run has ended it: no time is missing
do
  local fall = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] end }
  local fallen = fall:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 2 }, v = { 0 }, t = 10, control = { tolerance = 1e-9 },
    events = { ground = { g = function(q) return q[1] end, stop = true } } }
  near(fallen.t[#fallen.t], 2, 1e-12, "a controlled fall ends on the ground")
  local up = dm.resume(fallen):run { t = 1, control = { tolerance = 1e-9 } }
  near(up.t[1], 2, 1e-12, "a run goes on from there")
  near(up.q[#up.q][1], 2 - 9 / 2, 1e-11, "to where it falls")
end

tap.done()
