-- Poincare sections against closed forms, and pictures of ensembles
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, pi, sin, sqrt = math.cos, math.pi, math.sin, math.sqrt

---- q1'' = -q1, q2'' = -2 q2: q1 = sin t rises through 0 at t = 2 pi k, where q2 = cos(sqrt 2 t) ----
local two = dm.system { Q = dm.R(2), coordinates = { "x", "y" }, L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - q[2] ^ 2 end }
local fine = two:solver { rule = "gauss(6)", h = 0.1 }
local start = { q = { 0, 1 }, v = { 1, 0 } }
local section = fine:section { g = "x", q = start.q, v = start.v, t = 50 }
local one = section.orbits[1]
local first = one.t[1] > 1 and 1 or 0  -- the start itself lies on the surface
local worst = 0
for k = 1, #one.t do
  local t = 2 * pi * (k - 1 + first)
  worst = math.max(worst, math.abs(one.t[k] - t), math.abs(one.x[k] - cos(sqrt(2) * t)), math.abs(one.y[k] + sqrt(2) * sin(sqrt(2) * t)))
end
ok(worst < 1e-12 and #one.t >= 7, "crossings, positions and momenta of two oscillators", worst)
ok(section.xlabel == "y" and section.ylabel == "p_y", "the other coordinate and its momentum are drawn", section.xlabel .. section.ylabel)
ok(tostring(section):find "section of 1 orbit: %d crossings as %(y, p_y%)", "it prints what it is", tostring(section))

local both = fine:section { g = "q1", direction = "both", q = start.q, v = start.v, t = 50 }
local down = fine:section { g = function(q) return q[1] end, direction = "down", q = start.q, v = start.v, t = 50, x = "t", y = function(q, p) return q[2] * p[1] end }
ok(both.count == section.count + down.count, "both directions are those up and those down", both.count)
near(down.orbits[1].x[2], 3 * pi, 1e-12, "x = \"t\"")
near(down.orbits[1].y[2], -cos(sqrt(2) * 3 * pi), 1e-12, "y is a function of (q, p, t)")
local strobe = fine:section { g = function(_, _, t) return sin(t) end, x = "x", y = "p_x", q = start.q, v = start.v, t = 50 }
ok(strobe.orbits[1].x:norm() < 1e-12 and math.abs(strobe.orbits[1].y[3] - 1) < 1e-12, "a surface of time: a stroboscope")

-- a driven oscillator: at multiples of the period of the drive, from t0 on, on the line of its closed form
local driven = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1] ^ 2 - q[1] ^ 2) / 2 + q[1] * math.cos(t / 2) end }
strobe = driven:solver({ rule = "gauss(6)", h = 0.1 }):section { period = 4 * pi, t0 = 1, q = { 0 }, v = { 0 }, t = 60 }
near(strobe.orbits[1].t[2], 1 + 8 * pi, 1e-10, "period: a row each period after the start")
near(strobe.orbits[1].x[2], 0, 1e-9, "where it is at rest again, since the drive takes two of its own periods")
raises("for a section each period T", function() driven:solver({ rule = "gauss(6)", h = 0.1 }):section { g = "t", q = { 0 }, v = { 0 }, t = 60 } end)
raises("in place of 'g'", function() fine:section { g = "x", period = 1, q = start.q, v = start.v, t = 1 } end)
raises("duration > 0", function() fine:section { period = 0, x = "x", y = "y", q = start.q, v = start.v, t = 1 } end)

-- an angle comes round: L = v^2/2 + cos q from q = 0 with v = 2/k turns each T = 2 k K(k), K by the
-- mean of Gauss; read off, it is between -pi and pi
local function turn_of(k)
  local a, b = 1, sqrt(1 - k * k)
  while math.abs(a - b) > 1e-15 do a, b = (a + b) / 2, sqrt(a * b) end
  return k * pi / a
end
local rotor = dm.system { Q = dm.T(1), coordinates = { "th" }, L = function(q, v) return v[1] ^ 2 / 2 + dm.cos(q[1]) end }
local spun = rotor:solver { rule = "gauss(6)", h = 0.1 }
for direction, v in pairs { up = 3, down = -3 } do
  local on = { g = "th", q = { direction == "up" and -1e-9 or 1e-9 }, v = { v }, t = 20, direction = direction }
  local turns, times = spun:section(on).orbits[1], 0
  for i = 1, #turns.t do times = math.max(times, math.abs(turns.t[i] - (i - 1) * turn_of(2 / 3))) end
  ok(#turns.t == 9 and times < 1e-8, "an angle passes 0 once a turn, " .. direction, times)
  ok(turns.x:norm() < 1e-12, "and is 0 there", turns.x:norm())
  on.direction = direction == "up" and "down" or "up"
  ok(spun:section(on).count == 0, "not in the other direction, where it passes pi")
end
local far = spun:section({ period = 1, q = { 3 }, v = { 3 }, t = 30 }).orbits[1]
local path, widest = spun:run { q = { 3 }, v = { 3 }, at = far.t }, 0
for i, x in ipairs(far.x:totable()) do
  widest = math.max(widest, math.abs(x))
  if math.abs(math.sin((x - path.q[i][1]) / 2)) > 1e-9 then widest = 1 / 0 end
end
ok(widest > 2 and widest <= pi and path.q[#path][1] > 60, "an angle is read off between -pi and pi, whole turns from the path's", widest)
-- the same on groups: SO(2) is one angle, and factors of products are
local disc = dm.system { Q = dm.SO(2), L = function(g, xi) return xi[1] ^ 2 / 2 + dm.cos(g) end }
for _, rule in ipairs { "gauss(6)", "lie(3)" } do
  local turns = disc:solver({ rule = rule, h = 0.05 }):section { g = "q1", q = { -1e-9 }, v = { 3 }, t = 20 }.orbits[1]
  local times = 0
  for i = 1, #turns.t do times = math.max(times, math.abs(turns.t[i] - (i - 1) * turn_of(2 / 3))) end
  ok(#turns.t == 9 and times < 1e-5 and turns.x:norm() < 1e-12, "an element of SO(2) comes round, by " .. rule, times)
end
for _, row in ipairs { { dm.product(dm.SO(2), dm.R(1)), 1 }, { dm.product(dm.R(1), dm.SO(2)), 2 }, { dm.product(dm.SO(2), dm.SO(2)), 1 } } do
  local free = dm.system { Q = row[1], L = function(_, xi) return xi:dot(xi) / 2 end }
  local angle, other = row[2], 3 - row[2]
  local v = { [angle] = 2, [other] = 3 }
  local cuts = free:solver({ rule = "gauss(2)", h = 0.1 }):section { g = "q" .. angle, q = { -1, -1 }, v = v, t = 10 }.orbits[1]
  ok(#cuts.t == 4, "an angle of " .. tostring(row[1]) .. " comes round", #cuts.t)
  local worst, is_angle = 0, tostring(row[1]) == "SO(2) x SO(2)"
  for i, t in ipairs(cuts.t:totable()) do
    local x = 3 * t - 1
    local off = is_angle and sin((cuts.x[i] - x) / 2) or cuts.x[i] - x
    worst = math.max(worst, math.abs(t - 0.5 - (i - 1) * pi), math.abs(off), is_angle and math.abs(cuts.x[i]) - pi or 0)
  end
  ok(worst < 1e-9, "  at each turn, with the other coordinate there", worst)
end
local plane = dm.system { Q = dm.SE(2), L = function(_, xi) return xi:dot(xi) / 2 end }
local heading = plane:solver({ rule = "lie(2)", h = 0.1 }):section { g = "q3", q = { 0, 0, -1 }, v = { 0, 0, 2 }, t = 10, x = "q3", y = "t" }.orbits[1]
ok(#heading.t == 4 and math.abs(heading.t[4] - 0.5 - 3 * pi) < 1e-9 and heading.x:norm() < 1e-9, "the heading of SE(2), not its place", heading.t)
local mixed = dm.system { Q = dm.product(dm.R(1), dm.T(1)), coordinates = { "s", "th" }, L = function(_, v) return v:dot(v) / 2 end }
local line = mixed:solver({ rule = "verlet", h = 0.1 }):section { g = "th", q = { 0, -1 }, v = { 1, 2 }, t = 10, x = "s", y = "t" }
near((line.orbits[1].x - dm.vector { 0.5, 0.5 + pi, 0.5 + 2 * pi, 0.5 + 3 * pi }):norm(), 0, 1e-9, "of a product the angles alone")

-- several starts, of which one leaves the domain
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() - 1e-3 / (q[1] - 3) end }
local coarse = kepler:solver { rule = "gauss(1)", h = 0.1 }
local several = coarse:section { g = "q2", t = 20, every = 10, starts = { { q = { 1, 0 }, v = { 0, 1 } }, { q = { 0.1, 0 }, v = { 0, 0 } }, { q = { 1, 0 }, p = { 0, 1.1 } } } }
ok(#several == 3 and several.failures == 1 and several.orbits[2].failure.code == "no_convergence", "one of several may fail", tostring(several))
ok(tostring(several):find("1 ended early", 1, true) and #several.orbits[1].path > 3 and #several:series() >= 2, "it says so, and keeps the paths that were asked for")
raises("no_convergence", function()
  local done, failure = pcall(coarse.section, coarse, { g = "q2", t = 20, q = { 0.1, 0 }, v = { 0, 0 } })
  error(done or failure.code)
end)

raises("'g' must be a function of (q, v, t, p) that is 0 on the surface, or one of x, y, p_x, p_y, t (got z)", fine.section, fine, { g = "z", t = 1 })
raises("'x' and 'y' say what is drawn", fine.section, fine, { g = function(q) return q[1] end, t = 1 })
raises("'direction' must be", fine.section, fine, { g = "x", direction = 1, t = 1 })
raises("unknown option 'step'", fine.section, fine, { g = "x", step = 1 })
raises("'starts' must be a list of starts", fine.section, fine, { g = "x", starts = start, t = 1 })
raises("not both", fine.section, fine, { g = "x", starts = { start }, q = { 0, 1 }, t = 1 })
raises("no orbit crossed", function() fine:section({ g = function(q) return q[1] + 9 end, x = "x", y = "y", q = start.q, v = start.v, t = 1 }):plot() end)
raises("y of crossing 1 is no number (got dm.vector)", fine.section, fine, { g = "x", x = "y", y = function(q) return q end, q = start.q, v = start.v, t = 9 })
raises("no events", function()
  dm.solver({ dm.discrete_lagrangian(two, { rule = "midpoint", h = 0.1 }) }):section { g = "x", q = start.q, p = start.v, t = 1 }
end)

---- ensembles ----
local fan = require "dm.show.fan"
local verlet = two:solver { rule = "verlet", h = 0.1 }
local function members(more)
  local o = { members = 200, q = function(i) return { i / 200, 0 } end, v = function() return { 0, 1 } end, t = 2 }
  for key, value in pairs(more) do o[key] = value end
  return verlet:ensemble(o)
end
local rows, ends = members { every = 2 }, members {}
local drawn = fan.series(rows)
ok(#drawn == 64 and drawn[1].ylabel == "x" and drawn[1].xlabel == "t", "64 of 200 paths, the first column against t", #drawn)
ok(drawn[1].name == "member 1" and drawn[64].name == "member 200" and drawn[1].colour == dm.palette "lines"[1] and drawn[64].colour == dm.palette "lines"[2], "from the first to the last, in shades")
near(drawn[64].y[#drawn[64].y], rows.q[200][1], 0, "a path ends where the member does")
ok(#fan.series(rows, "x", "p_y", 5) == 5 and fan.series(rows, "x", "p_y", { 7 })[1].name == "member 7", "as many as asked for, or those asked for")
local points = fan.series(ends, "x", "p_y")[1]
ok(#points.x == 200 and points.x[3] == ends.q[3][1] and points.y[3] == ends.p[3][2] and points.style == "points", "the ends of all members")
raises("x must be a column of q or p", ends.plot, ends, "energy")
raises("'members': there are members 1 to 200 (got 201)", rows.plot, rows, { members = { 201 } })
raises("names of columns", rows.plot, rows, 3)
raises("no column 'speed'", rows.plot, rows, "speed")
local bad = coarse:ensemble { members = 3, q = { { 1, 0 }, { 0.1, 0 }, { 1, 0 } }, v = { { 0, 1 }, { 0, 0 }, { 0, 1 } }, t = 5, every = 1 }
ok(bad.status[2] ~= "ok" and fan.series(bad)[2].colour == "#bbbbbb", "what failed is grey", bad.status[2])
local file = (os.getenv "B" or "build") .. "/pictures/test_fan.svg"
os.execute("mkdir -p '" .. file:match "^(.*)/" .. "'")
ok(rows:plot("y", { file = file, members = 9 }) == file, "into a file")

tap.done()
