-- Steps over a change of inertia of d2L/dv2 end a run and are named; solver:singularities sees the
-- place, on the velocities that constraints allow.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local abs, cosh = math.abs, dm.cosh

local function run(system, rule, h, options)
  local solver = system:solver { rule = rule, h = h }
  local fine, result = pcall(solver.run, solver, options)
  return fine, result
end

-- L = v cosh(v) - 3 v^2 - q: p = cosh v + v sinh v - 6 v falls by t, and folds where 2 cosh v + v
-- sinh v = 6; the motion ends there
local function fold_of(from)
  local v = from
  for _ = 1, 60 do
    local c, s = (math.exp(v) + math.exp(-v)) / 2,
      (math.exp(v) - math.exp(-v)) / 2
    v = v - (2 * c + v * s - 6) / (3 * s + v * c)
  end
  return v
end
local function momentum(v)
  return (math.exp(v) + math.exp(-v)) / 2 + v * (math.exp(v) - math.exp(-v)) / 2 - 6 * v
end
local folding = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] * cosh(v[1]) - 3 * v[1] ^ 2 - q[1]
end }
local v0, v1 = 0.3, fold_of(1.2)
local ends = momentum(v0) - momentum(v1) -- dp/dt = -1
ok(ends > 1, "the motion ends after a while", ends)
for _, rule in ipairs { "verlet", "gauss(2)", "midpoint", "rk4", "yoshida(4)" } do
  for _, every in ipairs { 1, 7, 1000 } do
    local fine, e = run(folding, rule, 0.01, { q = { 0 }, v = { v0 }, t = 2 * ends, every = every })
    local path = not fine and e.path
    ok(not fine and tostring(e):find("d2L/dv2", 1, true),
      ("%s, every = %d: the step over the fold is told"):format(rule, every), tostring(e))
    ok(path and abs(e.time - ends) < 0.02 and abs(path.t[#path] - e.time) < 1e-12,
      "where it is, with the path up to there", tostring(e))
  end
end

-- two rods by their horizontal parts: a mass that is definite wherever it is a number, but grows at
-- the level of their upper ends; a step that is too long leaves the domain there, and no more
local function rod(x, y, dx, dy)
  local z = dm.sqrt(1 - x * x - y * y)
  return z, (x * dx + y * dy) / z
end
local chart = dm.system { Q = dm.R(4), L = function(q, v)
  local d1, z1 = rod(q[1], q[2], v[1], v[2])
  local d2, z2 = rod(q[3], q[4], v[3], v[4])
  local first, second = v[1] ^ 2 + v[2] ^ 2 + z1 ^ 2, v[3] ^ 2 + v[4] ^ 2 + z2 ^ 2
  return first + second / 2 + v[1] * v[3] + v[2] * v[4] + z1 * z2 + 9.81 * (2 * d1 + d2)
end }
for _, at in ipairs { { "midpoint", { -0.39, -0.57, 0.466, -0.435 }, { -0.134, -1.82, 2.05, -2.975 } },
  { "gauss(3)", { 0.49, -0.048, -0.048, 0.567 }, { -2.03, 0.135, -2.466, 0.825 } } } do
  local fine, e = run(chart, at[1], 0.2, { q = at[2], v = at[3], steps = 100 })
  ok(not fine and tostring(e):find("domain", 1, true) and e.code ~= "inertia",
    at[1] .. ": the edge of a chart is no change of inertia", tostring(e))
end

-- a mass that vanishes at q1 = 0: q1 q1'^2 = 2 E1, so that q1^(3/2) falls by 3/2 sqrt(2 E1) t
local thin = dm.system { Q = dm.R(2), L = function(q, v)
  return q[1] * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 end }
local function start(x) return { q = { x, 0 }, v = { -1, 0.5 }, steps = 60 } end
for _, rule in ipairs { "gauss(2)", "midpoint", "lobatto(3)" } do
  local options, seen = start(1), nil
  for _, every in ipairs { 1, 4, 60 } do
    options.every = every
    local fine, e = run(thin, rule, 0.05, options)
    seen = seen or not fine and e.step
    ok(not fine and (e.code == "inertia" or e.code == "no_convergence") and e.step == seen
      and abs(e.time - 2 / 3) < 0.06, ("%s, every = %d: a mass that vanishes"):format(rule, every),
      tostring(e))
  end
  local members = thin:solver({ rule = rule, h = 0.05 }):ensemble { members = 21, steps = 60,
    threads = 1, q = function(i) return { 0.8 + 0.07 * i, 0 } end,
    v = function() return { -1, 0.5 } end }
  local unlike = 0
  for i = 1, 21 do
    local one = start(0.8 + 0.07 * i)
    one.every = 60
    local fine, e = run(thin, rule, 0.05, one)
    local last = fine and e.q[#e] or e.path.q[#e.path]
    local code, steps = fine and "ok" or e.code, fine and 60 or e.step - 1
    if members.status[i] ~= code or members.steps[i] ~= steps
      or (members.q:row(i) - last):norm() ~= 0 then
      unlike = unlike + 1
    end
  end
  ok(unlike == 0, rule .. ": members end as runs of their own", unlike)
end

-- regular masses that move, indefinite ones too, are none of that
local moving = dm.system { Q = dm.R(2), L = function(q, v)
  return (2 + dm.sin(q[1])) * v[1] ^ 2 / 2 - (1.5 + dm.cos(q[2])) * v[2] ^ 2 / 2 - q:dot(q) / 2
end }
for _, rule in ipairs { "gauss(2)", "verlet" } do
  ok(run(moving, rule, 0.01, { q = { 0.3, 0.1 }, v = { 0.5, -0.2 }, t = 3 }),
    rule .. ": a mass with a value of each sign")
end
local fast = dm.system { Q = dm.R(2), L = function(q, v)
  return -(1 - v:dot(v)) ^ 0.5 + 0.3 / q:norm() end }
ok(run(fast, "gauss(2)", 0.02, { q = { 1, 0 }, v = { 0, 0.5 }, t = 5 }), "nor a relativistic one")

-- with constraints: singular across them is regular; what counts is along them
local function on_circle(L)
  return dm.system { Q = dm.R(2), L = L, constraint = function(q) return q:dot(q) - 1 end }
end
local across = on_circle(function(q, v)
  local spin = q[1] * v[2] - q[2] * v[1]
  return spin ^ 2 / 2 - (q[1] * v[1] + q[2] * v[2]) ^ 2 * q[1] - q[2]
end)
local fine, e = run(across, "gauss(2)", 0.02, { q = { 0.6, 0.8 }, v = { 0.8, -0.6 }, t = 6 })
ok(fine, "a mass that changes across the constraint alone", tostring(e))
local along = on_circle(function(q, v)
  return (q[1] + 0.4) * (q[1] * v[2] - q[2] * v[1]) ^ 2 / 2 + (q[1] * v[1] + q[2] * v[2]) ^ 2
end)
fine, e = run(along, "gauss(2)", 0.02, { q = { 0.6, 0.8 }, v = { -0.8, 0.6 }, t = 6 })
ok(not fine and e.path.q[#e.path][1] > -0.45, "and one that vanishes along it", tostring(e))

---- a value that vanishes inside a step, with the right sign at both ends ----

-- is a run told, at the time when M v^2 = const takes it to the place?
local function told(name, system, rule, h, options, place, late)
  options.steps = math.ceil(2 * place / h) + 20
  for _, every in ipairs { 1, 13 } do
    options.every = every
    local good, e = run(system, rule, h, options)
    ok(not good and (e.code == "inertia" or e.code == "no_convergence")
      and abs(e.time + h / 2 - place) <= h * (late or 1), ("%s, %s, h = %g, every = %d"):format(name,
      rule, h, every), ("%s, at %.6g"):format(tostring(e), place))
  end
end
-- M(x) v^2 = 1 - 2 V: t = integral of sqrt M
local function arrival(M, from, to)
  local sum, n = 0, 20000
  for i = 1, n do sum = sum + M(from + (to - from) * (i - 0.5) / n) ^ 0.5 end
  return sum * (to - from) / n
end
local places = {
  -- two zeros 0.063 apart, jumped over by steps of 0.1 and more
  { "a band", function(x) return (x - 1) ^ 2 - 1e-3 end, 0, 1 - 1e-3 ^ 0.5 },
  { "a narrow band", function(x) return (x - 1) ^ 2 - 1e-5 end, 0, 1 - 1e-5 ^ 0.5 },
  { "a mass that touches zero", function(x) return (x - 1) ^ 2 end, 0, 1 },
  { "behind which none comes back", function(x) return 1 - x ^ 2 end, 0.1, 1 },
}
for _, place in ipairs(places) do
  local name, M, from, to = table.unpack(place)
  local system = dm.system { Q = dm.R(2), L = function(q, v)
    return M(q[1]) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 - q[2] ^ 2 / 2 end }
  for _, h in ipairs { 0.05, 0.11 } do
    for _, rule in ipairs { "gauss(2)", "gauss(7)", "rk4", "midpoint" } do
      told(name, system, rule, h, { q = { from, 0 }, v = { M(from) ^ -0.5, 0.1 } },
        arrival(M, from, to), rule == "midpoint" and 2)
    end
  end
  local members = system:solver({ rule = "gauss(2)", h = 0.07 }):ensemble { members = 9, steps = 40,
    threads = 1, q = function() return { from, 0 } end,
    v = function(i) return { (0.8 + i / 20) * M(from) ^ -0.5, 0.1 } end }
  local unlike = 0
  for i = 1, 9 do
    local good, e = run(system, "gauss(2)", 0.07, { q = { from, 0 },
      v = { (0.8 + i / 20) * M(from) ^ -0.5, 0.1 }, steps = 40 })
    if good or members.status[i] ~= e.code or members.steps[i] ~= e.step - 1 then
      unlike = unlike + 1
    end
  end
  ok(unlike == 0, name .. ": members", unlike)
end
-- from the first step on, with a mass that is not diagonal: thrown back, energy off by 2.6
local edge = dm.system { Q = dm.R(2), L = function(q, v)
  return (1 - q[1] ^ 2) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 + 0.3 * q[2] * v[1] * v[2] - 0.1 * q[1] end }
for _, rule in ipairs { "rk4", "gauss(7)" } do
  local good, e = run(edge, rule, 0.05, { q = { 0.99, 0.1 }, v = { 3, 0 }, steps = 20 })
  ok(not good and e.code == "inertia" and e.step == 1, rule .. ": in the first step", tostring(e))
end
-- what touches zero where no momentum is left, or p = v^3, goes on
local swing = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + dm.sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + dm.cos(q[1]) end }
local cubed = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 4 / 4 - q[1] ^ 2 / 2 end }
for _, rule in ipairs { "gauss(2)", "gauss(8)", "verlet", "rk4" } do
  ok(run(swing, rule, 0.05, { q = { 0.7, 0 }, v = { 0, 0 }, t = 20 }), rule .. ": through a pole")
  ok(run(swing, rule, 0.02, { q = { 0.7, 0 }, v = { 0, 0.1 }, t = 20 }), rule .. ": beside a pole")
  ok(run(cubed, rule, 0.05, { q = { 1 }, v = { 0.5 }, t = 9 }), rule .. ": p = v^3")
end

---- and unseen by looks, in a dip narrower than a step: sqrt M v = const on the way there ----

local function dip(s, width) return 1 - 1.1 * math.exp(-(s / width) ^ 2) end
-- 0 at s = -width sqrt(log 1.1)
local dips = {
  { "along q1", dm.R(2), function(q, v)
    return dip(q[1] - 1, 3e-3) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 - q[2] ^ 2 / 2 end },
  { "narrower still", dm.R(2), function(q, v)
    return dip(q[1] - 1, 1e-4) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 - q[2] ^ 2 / 2 end },
  { "of a rational mass, across both", dm.R(2), function(q, v)
    local s = (q[1] + 0.3 * q[2] - 1) / 2e-3
    return v[1] ^ 2 / 2 + 0.2 * v[1] * v[2] + v[2] ^ 2 / 2 - 1.5 / (1 + s ^ 2) * v[1] ^ 2 / 2 end },
  { "in time", dm.R(2), function(q, v, t)
    return dip(t - 1, 3e-3) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 - q:dot(q) / 2 end },
}
for _, x in ipairs(dips) do
  local name, Q, L = table.unpack(x)
  local system = dm.system { Q = Q, L = L }
  for _, rule in ipairs { "gauss(2)", "verlet", "midpoint", "rk4", "gauss(5)", "curve(rk4)" } do
    local good, e = run(system, rule, 0.04, { q = { 0, 0.1 }, v = { 1, 0 }, t = 3, every = 9 })
    ok(not good and (e.code == "inertia" or e.code == "no_convergence")
      and abs(e.time + 0.02 - 1) < 0.05, ("a dip %s, %s"):format(name, rule), tostring(e))
  end
end
local narrow = dm.system { Q = dm.R(2), L = dips[1][3] }
for name, options in pairs { ["rows at times"] = { at = { 0.4, 1.13, 2 } },
  ["chosen steps"] = { control = { tolerance = 1e-5 }, t = 3 },
  ["events"] = { events = { x = function(q) return q[2] - 9 end }, t = 3 },
  ["steps by energy"] = { rule = "sem(1, gauss(1))", steps = 60 } } do
  options.q, options.v = { 0, 0.1 }, { 1, 0 }
  local rule = options.rule or "gauss(2)"
  options.rule = nil
  local good, e = run(narrow, rule, 0.05, options)
  local last = not good and e.path.q[#e.path][1]
  ok(not good and e.code == "inertia" and e.time < 1 and (last < 1), "a dip and " .. name,
    tostring(e))
end
for _, rule in ipairs { "gauss(2)", "midpoint", "rk4" } do
  local function start(i) return { 0.01 * i, 0.1 }, { 0.9 + 0.01 * i, 0 } end
  local solver, unlike = narrow:solver { rule = rule, h = 0.05 }, 0
  local members = solver:ensemble { members = 9, steps = 40, threads = 1,
    q = function(i) return (start(i)) end, v = function(i) return (select(2, start(i))) end }
  for i = 1, 9 do
    local q, v = start(i)
    local good, e = pcall(solver.run, solver, { q = q, v = v, steps = 40 })
    if good or members.status[i] ~= e.code or members.steps[i] ~= e.step - 1 then
      unlike = unlike + 1
    end
  end
  ok(unlike == 0, rule .. ": members with a dip", unlike)
end
-- a motion that turns before the dip, one beside it, and a mass that falls to 0.1 go on
local turns = dm.system { Q = dm.R(1), L = function(q, v)
  return dip(q[1] - 1, 0.02) * v[1] ^ 2 / 2 - math.exp(40 * (q[1] - 0.8)) - q[1] ^ 2 / 2 end }
local beside = dm.system { Q = dm.R(2), L = function(q, v)
  return (1 - 1.1 * math.exp(-((q[1] - 1) ^ 2 + q[2] ^ 2) / 1e-4)) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 end }
local shallow = dm.system { Q = dm.R(1), L = function(q, v)
  return (1 - 0.9 * math.exp(-((q[1] - 1) / 2e-3) ^ 2)) * v[1] ^ 2 / 2 end }
for _, rule in ipairs { "gauss(2)", "rk4", "midpoint" } do
  ok(run(turns, rule, 0.02, { q = { 0 }, v = { 1 }, t = 20 }), rule .. ": turns before a dip")
  ok(run(beside, rule, 0.05, { q = { 0, 0.05 }, v = { 1, 0 }, t = 2 }), rule .. ": beside a dip")
  ok(run(shallow, rule, 0.05, { q = { 0 }, v = { 1 }, t = 2 }), rule .. ": a shallow dip")
end

---- solver:singularities ----

local report = folding:solver({ rule = "verlet", h = 0.01 }):singularities { q = { 0 }, v = { v0 },
  t = 2 * ends }
ok(#report.places > 0 and report.worst == math.huge and abs(report.t - ends) < 0.02
  and report.failure and report.why:find("a value of d2L/dv2 passes through zero", 1, true),
  "a scalar mass that folds is no regular one", report.why)
-- behind this fold another velocity has the momentum: rules that find it go over the place
local double = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 4 / 8 - v[1] ^ 2 / 3 - q[1] ^ 2 end }
for _, rule in ipairs { "verlet", "gauss(2)", "midpoint" } do
  local solver = double:solver { rule = rule, h = 0.03 }
  local seen = solver:singularities { q = { 0.8 }, v = { 0.1 }, t = 2 }
  local step = select(2, run(double, rule, 0.03, { q = { 0.8 }, v = { 0.1 }, t = 2, every = 9 }))
  local crossed = step.code == "inertia"
  ok((crossed or step.fading) and #seen.places > 0 and seen.t == step.time
    and seen.why:find(crossed and "passes through zero" or "d2L/dv2 is singular", 1, true)
    and (crossed or rule == "gauss(2)"), rule .. ": and where it is gone over", seen.why)
end
local slow = folding:solver({ rule = "verlet", h = 0.01 }):singularities { q = { 0 }, v = { v0 },
  t = ends / 2 }
ok(#slow.places == 0 and slow.why:find("stay regular", 1, true), "before that it is", slow.why)
local near = dm.system { Q = dm.R(1), L = function(q, v)
  return (q[1] ^ 2 + 1e-5) * v[1] ^ 2 / 2 end }
local passed = near:solver({ rule = "gauss(2)", h = 1e-3 }):singularities { q = { 1 }, v = { -0.1 },
  t = 6 }
ok(passed.worst > 1e2 and #passed.places >= 0 and passed.worst < 2e5,
  "a scalar mass that all but vanishes is seen beside what it was", passed.worst)
-- values that are small by their units alone change no sign
local turned = { { 2.5, -0.7, 0.9 }, { 0.6, 2.2, -0.8 }, { -0.9, 0.5, 2.7 } }
local units = dm.system { Q = dm.R(3), L = function(q, v)
  local T = 0
  for i, row in ipairs(turned) do
    local u = 1e-6 * row[1] * v[1] + row[2] * v[2] + 1e6 * row[3] * v[3]
    T = T + (i == 2 and 1 + 0.5 * dm.sin(q[2]) or 1) * u ^ 2 / 2
  end
  return T - q[2] ^ 2 / 2
end }
local by_units = units:solver({ rule = "gauss(2)", h = 0.02 }):singularities { q = { 0, 0.4, 0 },
  v = { 1e5, 0.3, 1e-7 }, steps = 300 }
ok(not by_units.change, "values that are small by their units alone", by_units.why)
local held = across:solver({ rule = "gauss(2)", h = 0.02 }):singularities { q = { 0.6, 0.8 },
  v = { 0.8, -0.6 }, t = 6 }
ok(#held.places == 0, "under a constraint the velocities that it allows count", held.why)
-- rows between two looks: the inertia changes for one or a few steps, the motion is thrown back
local function barrier(a, b, c, d)
  local function m(x) return 1 - (a * x) ^ 2 end
  return dm.system { Q = dm.R(3), L = function(q, v)
    return m(q[1]) * v:dot(v) / 2 + d * q[1] + c * q[2]
  end, constraint = function(q) return q[1] + b * q[2] + q[3] end }, m
end
for _, case in ipairs { { "yoshida(4, midpoint)", 0.02 }, { "midpoint", 0.02 }, { "gauss(2)", 0.02 },
  { "suzuki(4, midpoint)", 0.1 }, { "galerkin(2, gauss(2))", 0.05 }, { "lobatto(3)", 0.02 } } do
  local rule, h = table.unpack(case)
  local hidden, ended, alike = 0, 0, true
  for i = 1, 20 do
    local system, m = barrier(0.7 + 0.06 * i, 1, 0.1 * i - 1, 2 - 0.07 * i)
    local v = { 0.5 - 0.03 * i, 0.02 * i - 0.5 }
    v[3] = -v[1] - v[2]
    local solver, start = system:solver { rule = rule, h = h }, { q = { 0, 0, 0 }, v = v, steps = 150 }
    local fine, path = pcall(solver.run, solver, start)
    path = fine and path or path.path
    for k = 1, #path do if m(path.q[k][1]) < 0 then hidden = hidden + 1 end end
    ended = ended + (fine and 0 or 1)
    local e = solver:ensemble { members = 2, steps = 150, q = function() return start.q end,
      v = function() return v end }
    alike = alike and (e.status[1] == "ok") == fine and (e.status[2] == "ok") == fine
  end
  ok(hidden == 0 and ended > 0 and alike, rule .. ": no row is behind a change of inertia",
    ("%d rows, %d ended, alike %s"):format(hidden, ended, alike))
end
-- coordinates without a mass of their own beside a body in another unit: m scales their part of L
local function unlike(m)
  return dm.system { Q = dm.R(3), L = function(q, v)
    local light = (2 + dm.cos(q[1])) * v[1] * v[2] - q[1] ^ 2 - q[2] ^ 2
    return m * light + v[3] ^ 2 * (1 + q[3] ^ 2) / 2 - q[3] ^ 2
  end }
end
local start = { q = { 0.1, 0.2, 0.3 }, v = { 0.3, 0.4, 0.5 }, steps = 50 }
local in_ones = unlike(1):solver { rule = "midpoint", h = 0.01 }:run(start)
for _, m in ipairs { 1e-16, 1e-27, 1e20 } do
  local fine, path = run(unlike(m), "midpoint", 0.01, start)
  local off = fine and (path.q[51] - in_ones.q[51]):norm() or path
  ok(fine and off < 1e-13, ("masses beside the diagonal of the size %g are regular"):format(m), off)
end

-- L is convex in v, and its mass touches zero without a change of sign: a step over that place, long
-- after a look or right behind one, ends the run
do
  local function mass(power, V)
    return dm.system { Q = dm.R(1), L = function(q, v) return q[1] ^ power * v[1] ^ 2 / 2 - V(q[1]) end }
  end
  local bowl, wave = mass(2, function(x) return x ^ 2 / 2 end), mass(4, function(x) return -dm.cos(x) end)
  for _, row in ipairs { { mass(2, function() return 0 end), "midpoint", 0.01, 1, -1 },
    { bowl, "gauss(2)", 0.02, 0.45, 0.125 }, { bowl, "gauss(2)", 0.02, 0.75, -0.125 },
    { bowl, "gauss(2)", 0.02, 0.85, 0.5 }, { bowl, "gauss(2)", 0.02, -0.95, -0.375 },
    { wave, "midpoint", 0.02, 0.35, 0.125 }, { wave, "midpoint", 0.02, 0.75, 0.5 },
    { wave, "rk4", 0.2, -0.65, -0.625 }, { wave, "rk4", 0.2, -0.45, 0.625 } } do
    local system, rule, h, q, p = table.unpack(row)
    local fine, why = run(system, rule, h, { q = { q }, p = { p }, steps = 200 })
    ok(not fine and why.code == "inertia", ("a mass that touches zero ends a run of %s from %g"):format(rule, q),
      tostring(why))
  end
end

---- del: L = v^4/4 - v^2/2 - q^2/2 as an Ld, with weights w of the ends and 1 - w of the middle: the motion of E = 3 v^4/4 - v^2/2 + q^2/2
-- ends where v^2 = 1/3, in no step from the start on a step of another branch is taken ----
local function fold(h, w)
  return dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = function(a, b)
    local v = (b[1] - a[1]) / h
    return h * (v ^ 4 / 4 - v ^ 2 / 2 - w * (a[1] ^ 2 + b[1] ^ 2) / 4 - (1 - w) * ((a[1] + b[1]) / 2) ^ 2 / 2)
  end }
end
local named = 0
for _, h in ipairs { 0.1, 0.05, 0.02, 0.013 } do
  for _, w in ipairs { 0, 0.5, 1 } do
    for _, v in ipairs { 0.2, -0.3 } do
      local fine, lost = pcall(function() return fold(h, w):solver():run { q = { 1 }, p = { v ^ 3 - v }, steps = math.floor(2 / h) } end)
      local told = not fine and (lost.code == "inertia" or lost.fading) and lost.message:find("D1 D2 Ld", 1, true)
      named = named + (told and 1 or 0)
      if not fine then
        local q = lost.path.q[#lost.path][1]
        local s = lost.path.t[#lost.path]
        tap.ok(s < 0.85 and math.abs(q) < 1.2, ("del ends near to the fold, h = %g, w = %g, v = %g"):format(h, w, v), s)
      end
    end
  end
end
-- before: none, and h = 0.1, w = 1, v = -0.3 went on
tap.ok(named == 24, "del names the place where p0 determines no q1", named)
local free = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(a, b)
  local v = (b - a) / 0.1
  return 0.1 * ((v[1] ^ 2 - v[2] ^ 2) / 2 - dm.cos(a[1] + b[2]))
end }
tap.ok(#free:solver():run { q = { 1, 0 }, p = { 0.3, 0.2 }, steps = 500 } == 501, "a mass that is indefinite all along is none")

-- where what the steps before foretell leads to a root on another branch, the step takes the one that is near: a pendulum, which h =
-- 0.8 turns by up to 60 degrees a step, against rattle, which is the same step; before, it ended at t = 20
local function on_circle(q) return q:dot(q) - 1 end
local coarse = dm.discrete_lagrangian { Q = dm.R(2), h = 0.8, constraint = on_circle, Ld = function(a, b)
  return (b - a):dot(b - a) / 1.6 - 0.4 * (a[2] + b[2])
end }
local start = { q = { 0, -1 }, p = { 1, 0 }, steps = 60 }
local by_rattle = dm.system { Q = dm.R(2), constraint = on_circle, L = function(q, v) return v:dot(v) / 2 - q[2] end }
  :solver { rule = "rattle", h = 0.8 }:run(start)
tap.near((coarse:solver():run(start).q[61] - by_rattle.q[61]):norm(), 0, 1e-9, "del goes on by the root that is near")
tap.done()
