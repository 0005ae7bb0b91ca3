-- class wrong: bounded, but not the motion: closed forms of errors and shifts in time, the velocity that constraints leave over, who made chaos; resonances, limits of what is right
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, asin, atan, cos, sin, pi, abs, huge = math.sqrt, math.asin, math.atan, math.cos, math.sin, math.pi, math.abs, math.huge
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local function map_of(system, o)
  o.chaos = o.chaos or false
  return system:stability(o)
end

-- Verlet on the oscillator is cos(omega t) at its steps, omega = 2 asin(h/2)/h; the midpoint rule has 2 atan(h/2)/h
for _, h in ipairs { 0.05, 0.1, 0.5, 1 } do
  local cell, largest, omega = map_of(oscillator, { q = { 1 }, v = { 0 }, rule = "verlet", h = h, t = 100 }):at(1, 1), 0, 2 / h * asin(h / 2)
  for k = 0, 100 // h do largest = math.max(largest, abs(cos(omega * k * h) - cos(k * h))) end
  near(cell.off, largest, 1e-8, ("Verlet, h = %g: the largest error at a step"):format(h))
  near(cell.phase, 100 * (omega - 1), 1e-8, "and by how much it is ahead")
  near(cell.range, 2, 1e-6, "of a range of 2")
  ok(cell.class == (largest > 0.02 and "wrong" or "bounded") and cell.observable == "q1", "right or wrong by a hundredth of it", cell.why)
end
near(map_of(oscillator, { q = { 1 }, v = { 0 }, rule = "midpoint", h = 0.1, t = 100 }):at(1, 1).phase, 100 * (20 * atan(0.05) - 1), 1e-8, "the midpoint rule is behind")

-- up to where it is right, refined; the h of a thousand cells tell the same
local right = map_of(oscillator, { q = { 1 }, v = { 0 }, rules = { "verlet", "gauss(4)" }, h = { 0.01, 1.9, 23, "log" }, t = 100 })
local edge = 0.0696
for k = 0, 2000 do
  local h, worst = 0.069 + k * 1e-6, 0
  for j = 0, 100 // h do worst = math.max(worst, abs(cos(2 * asin(h / 2) * j) - cos(h * j))) end
  if worst > 0.02 then edge = h break end
end
near(right:limit(1, "right"), edge, 1.5e-3 * edge, "the largest step that is right to a hundredth")
ok(select(2, right:limit(1, "right")):find("q1 is off by 0.02", 1, true), "and what is wrong beyond", select(2, right:limit(1, "right")))
ok(right:limit(1) == huge and right:limit(2, "right") == huge, "nothing is lost, and gauss(4) is right", tostring(right))
raises('"right"', right.limit, right, 1, "left")
local unjudged = map_of(oscillator, { q = { 1 }, v = { 0 }, rule = "verlet", h = { 0.1, 1 }, steps = 100 })
ok(unjudged:limit(1, "right") == nil and select(2, unjudged:limit(1, "right")):find "give t" and unjudged:at(1, 2).class == "bounded", "with steps in place of t nothing is compared")

-- resonances of the step
local marks = right:resonances(1)
ok(#marks == 4, "four resonances of one oscillation inside of the steps", #marks)
for i, n in ipairs { 6, 5, 4, 3 } do
  near(marks[i].h, 2 * sin(pi / n), 1e-9, ("Verlet turns by 2 pi/%d"):format(n))
  ok(marks[i].n == n and abs(marks[i].omega - 1) < 1e-9, "with its n and omega")
end
ok(#map_of(oscillator, { q = { 1 }, v = { 0 }, rule = "verlet", h = { 0.1, 0.2 }, t = 10 }):resonances(1) == 0, "none outside of the steps")

-- what is observed
local kepler = dm.system { Q = dm.R(2), coordinates = { "x", "y" }, L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local orbit = { q = { 0.4, 0 }, v = { 0, 2 }, rule = "verlet", h = 0.05, t = 60 }
local function observed(what)
  orbit.observe = what
  local cell = map_of(kepler, orbit):at(1, 1)
  orbit.observe = nil
  return cell
end
ok(observed({ "x", "y" }).class == "wrong" and observed({ "x", "y" }).phase, "positions of Verlet on Kepler are wrong", observed({ "x", "y" }).why)
local momentum = observed { J = function(q, _, _, p) return q[1] * p[2] - q[2] * p[1] end }
ok(momentum.class == "bounded" and momentum.observable == "J", "its angular momentum is right", momentum.why)
ok(observed("p_x").observable == "p_x" and observed("p2").observable == "p2", "momenta by both names")
raises("there is no 'z'", observed, { "z" })
raises("'observe' must be a list", observed, 3)
-- a coordinate that does not move is right where it does not
local plane = dm.system { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }
ok(map_of(plane, { q = { 1, 0 }, v = { 0, 0 }, rule = "verlet", h = 0.01, t = 30 }):at(1, 1).class == "bounded", "a coordinate without a range")

-- constraints: SHAKE leaves the hidden one, RATTLE keeps it
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end }
local swing = { q = { 0.6, -0.8 }, v = { 0.8, 0.6 }, rules = { "shake", "rattle" }, h = 0.01, t = 5 }
local pair = map_of(rod, swing)
local largest, path = 0, rod:solver({ rule = "shake", h = 0.01 }):run { q = swing.q, v = swing.v, t = 5 }
for i = 1, #path do largest = math.max(largest, abs(2 * path.q[i]:dot(path.p[i]))) end
near(pair:at(1, 1).hidden, largest, 1e-12, "SHAKE: the largest 2 |q . v|")
ok(pair:at(1, 1).class ~= "bounded" and pair:at(2, 1).class == "bounded" and pair:at(2, 1).hidden < 1e-12, "RATTLE leaves nothing", pair:at(1, 1).why)
local _, left = map_of(rod, { q = swing.q, v = swing.v, rule = "shake", h = { 0.002, 0.05, 3, "log" }, t = 5 }):limit(1, "right")
ok(left:find "leaves the constraint" and not left:find "range", "the limit of what is right says that it is the velocity", left)
-- forced and damped
local forced = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1] ^ 2 - 4 * q[1] ^ 2) / 2 + q[1] * cos(t) end, force = function(_, v) return -0.1 * v end }
local driven = map_of(forced, { q = { 0 }, v = { 0 }, rules = { "midpoint", "gauss(4)" }, h = { 0.01, 0.4 }, t = 60 })
ok(driven:at(1, 1).class == "bounded" and driven:at(1, 2).class == "wrong" and driven:at(2, 2).class == "bounded", "a driven oscillator with friction", driven:at(1, 2).why)
-- starts off the steps of zero: t0
local late = map_of(forced, { q = { 0 }, v = { 0 }, rule = "gauss(4)", h = 0.1, t = 20, t0 = 7.3 }):at(1, 1)
ok(late.class == "bounded" and late.off < 1e-6 and abs(late.phase) < 1e-6, "a run that begins at t0", late.why)
-- rows, steps and parameters of one map have flows of their own
local springs = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, P) return (v[1] ^ 2 - P.k * q[1] ^ 2) / 2 end }
local many = map_of(springs, { k = { 1, 4, 25 }, q = { 1 }, v = { 0 }, rule = "verlet", h = { 0.002, 0.4, 20, "log" }, t = 40 })
for i, k in ipairs { 1, 4, 25 } do near(many:limit(i, "right") * sqrt(k), sqrt(24 * 0.02 / (40 * sqrt(k))), 0.06 * sqrt(24 * 0.02 / (40 * sqrt(k))), ("k = %g: T omega (h omega)^2 / 24 = 0.02"):format(k)) end

-- chaos of the flow has a horizon, and cells are told what made it
local henon = dm.system { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3 end }
local wild = map_of(henon, { q = { 0, 0.1 }, v = { 0.5603570290448759, 0.1 }, rule = "gauss(4)", h = 0.1, t = 1000, chaos = true }):at(1, 1)
ok(wild.class == "chaotic" and wild.cause == "flow" and wild.why:find "the flow itself", "chaos of the flow", wild.why)
local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local made = map_of(pendulum, { q = { pi - 0.05 }, v = { 0 }, rule = "verlet", h = 1.2, t = 1000, chaos = true }):at(1, 1)
ok(made.class == "chaotic" and made.cause == "step", "chaos that the step has made", made.why)

-- time, and misuse
local cut, left = henon:stability { y = { -0.3, 0.5, 8, "linear" }, q = function(y) return { 0, y } end, v = { 0.3, 0 }, rule = "gauss(6)", h = { 1e-3, 1, 200, "log" }, t = 3000, seconds = 0.5 }, 0
for i = 1, 8 do
  for j = 1, 200 do left = left + (cut:at(i, j).class == "not run" and 1 or 0) end
end
ok(left > 0 and cut.cut and cut.cut:find(("after 0.5 s of CPU time: %d of 1600 cells were not run"):format(left), 1, true), "a map ends when its seconds are over, and says what is left out", cut.cut)
ok(tostring(cut):find(left .. " not run", 1, true), "in its text, too", tostring(cut))
raises("'seconds' must be", henon.stability, henon, { q = { 0, 0 }, v = { 1, 0 }, rule = "verlet", h = 0.1, t = 1, seconds = 0 })
raises("'accuracy'", map_of, oscillator, { q = { 1 }, v = { 0 }, rule = "verlet", h = 0.1, t = 1, accuracy = -1 })
raises("give t, a duration", map_of, oscillator, { q = { 1 }, v = { 0 }, rule = "verlet", h = 0.1, steps = 9, accuracy = 0.1 })
-- more coordinates than a run watches: 48 of them, evenly, which the map says
local many = dm.system { Q = dm.R(70), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }
local ones = dm.zeros(70):totable()
for i = 1, 70 do ones[i] = 1 end
local wide = many:stability { rule = "verlet", q = ones, v = dm.zeros(70), t = 25, h = { 0.12, 0.16 }, chaos = false, refine = false }
ok(wide:at(1, 1).class == "bounded" and wide:at(1, 2).class == "wrong", "70 coordinates: right and wrong")
ok(wide.notes[1]:find "^of 70 coordinates 48 are observed", "and what is observed", wide.notes[1])
-- the limit of what is right: every step is looked at about it, not only some rows; Verlet's steps and the flow are cosines
do
  local function off(h)
    local worst = 0
    for n = 0, math.floor(20 / h + 1e-9) do worst = math.max(worst, math.abs(math.cos(2 * n * math.asin(h / 2)) - math.cos(n * h))) end
    return worst / 2
  end
  local first = 0.04
  while off(first) <= 1e-3 do first = first * 1.0001 end
  local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  local map = oscillator:stability { rule = "verlet", q = { 1 }, v = { 0 }, t = 20, h = { 1e-3, 1, 40, "log" }, accuracy = 1e-3, chaos = false }
  near(map:limit(1, "right"), first, 0.006 * first, "right to the first step that is off")
  tap.raises("a column is its number", map.at, map, { rule = "verlet" }, 0 / 0)
  -- so are cells of the grid that are right by little
  local h, astray = {}, {}
  for i = 1, 80 do h[i] = first * (0.9 + 0.0025 * i) end
  local near_it = oscillator:stability { rule = "verlet", q = { 1 }, v = { 0 }, t = 20, h = h, accuracy = 1e-3, chaos = false, refine = false }
  for i = 1, 80 do
    local ratio = off(h[i]) / 1e-3
    local told = require "dm.stability.classes".CLASSES[near_it.cells[1][i].class].name
    if math.abs(ratio - 1) > 3e-3 and told ~= (ratio > 1 and "wrong" or "bounded") then astray[#astray + 1] = ("%g: %s"):format(ratio, told) end
  end
  ok(#astray == 0, "80 columns about the limit: right or wrong as the closed form", table.concat(astray, "\n"))
end
tap.done()
