-- ensembles whose members have steps of their own: bit for bit runs of their own; what their rows say
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local moved = dm.system { Q = dm.R(2), L = function(q, v, t) return v:dot(v) / 2 - q:dot(q) / 2 + q[1] * math.cos(2 * t) end }
local sphere = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end }
local function step(i) return 0.01 + 0.005 * ((i - 1) // 3 % 4) end
local q0, v0 = { 0.8, 0 }, { 0, 1.2 }

-- the first member that is not the run of its own, or nothing
local function differs(solver, system, rule)
  local e = solver:ensemble { members = 21, q = function() return q0 end, v = function() return v0 end, t = 0.5, h = step, rows = 7, threads = 2,
    watch = { "q1", "p2" }, project = true }
  for i = 1, 21 do
    local steps = math.ceil(0.5 / step(i) - 1e-9)
    local path = system:solver({ rule = rule, h = step(i) }):run { q = q0, v = v0, t = 0.5, every = (steps - 1) // 7 + 1, project = true }
    local rows = e:path(i)
    if path.q[#path] ~= e.q[i] or path.p[#path] ~= e.p[i] or rows:column "p2" ~= path:column "p2" or rows.h ~= step(i) or rows.t[#rows] ~= path.t[#path]
      or e.steps[i] ~= steps or e.h[i] ~= step(i) or math.abs(e.t[i] - rows.t[#rows]) > 1e-12 then return i end
  end
end
for _, case in ipairs { { kepler, "verlet" }, { kepler, "kahan-li(8)" }, { kepler, "gauss(4)" }, { kepler, "rk8" }, { kepler, "rk8pd" }, { kepler, "yoshida(4, midpoint)" },
  { kepler, "curve(rk4)" }, { kepler, "lobatto(3)" }, { moved, "verlet" }, { moved, "gauss(2)" }, { sphere, "rattle" }, { sphere, "gauss(2)" } } do
  local fine, solver = pcall(case[1].solver, case[1], { rule = case[2], h = 1 })
  local i = fine and differs(solver, case[1], case[2])
  ok(fine and not i, case[2] .. ": members with steps of their own are runs of their own", fine and i or solver)
end

-- steps over three decades, some of which the rule cannot solve: one by one what a run of its own does, with all rows
local stiff = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 500 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
local cubic = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 end }
local curved = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
local function far_step(i) return 1e-3 * 10 ^ (3 * (i - 1) / 36) end
local function lonely(case, how)
  local system, rule, start = case[1], case[2], case[3]
  local e = system:solver({ rule = rule, h = 1 }):ensemble { members = 37, q = function() return start[1] end, v = function() return start[2] end, h = far_step, rows = 9,
    watch = { "q1", "p1", "energy" }, steps = how.steps, t = how.t, threads = 2 }
  local failed = 0
  for i = 1, 37 do
    local path, failure
    local fine, result = pcall(function()
      local steps = how.steps or math.ceil(how.t / far_step(i) - 1e-9)
      return system:solver({ rule = rule, h = far_step(i) }):run { q = start[1], v = start[2], steps = how.steps, t = how.t, every = (steps - 1) // 9 + 1 }
    end)
    if fine then path = result else path, failure = result.path, result end
    failed = failed + (failure and 1 or 0)
    local rows = e:path(i)
    if e.status[i] ~= (failure and failure.code or "ok") or e.steps[i] ~= path.steps or #rows ~= #path or rows:column "q1" ~= path:column "q1"
      or rows:column "p1" ~= path:column "p1" or rows.t[#rows] ~= path.t[#path] or path.q[#path] ~= e.q[i] or path.p[#path] ~= e.p[i] then return i, failed end
  end
  return nil, failed
end
local hang, fall, orbit = { { math.sin(1), -math.cos(1) }, { 0, 0 } }, { { 1 }, { 0 } }, { { 1, 0 }, { 0, 1.1 } }
for _, case in ipairs { { stiff, "midpoint", hang }, { stiff, "gauss(2)", hang }, { stiff, "gauss(3)", hang }, { stiff, "lobatto(3)", hang }, { stiff, "trapezoidal", hang },
  { stiff, "galerkin(2, gauss(3))", hang }, { cubic, "midpoint", fall }, { cubic, "gauss(2)", fall }, { curved, "midpoint", orbit }, { curved, "gauss(2)", orbit }, { curved, "lobatto(3)", orbit },
  { curved, "gauss(2, 6)", orbit }, { stiff, "verlet", hang } } do
  for _, how in ipairs { { steps = 150 }, { t = 0.4 } } do
    local i, failed = lonely(case, how)
    ok(not i, ("%s: 37 steps over three decades are 37 runs, %d of which fail"):format(case[2], failed), i)
  end
end

-- summaries against numbers worked out here
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local e = spring:solver({ rule = "gauss(4)", h = 0.1 }):ensemble { members = 2, q = function(i) return { i } end, v = function() return { 0 } end, steps = 64, every = 1,
  watch = { "q1", ramp = function(q, v, t) return 3 * t end } }
local s, r = e:summary "q1", e:summary "ramp"
for i = 1, 2 do
  local y = e:path(i):column "q1"
  local least, late = math.huge, 0
  for k = 1, #y do
    least = math.min(least, y[k])
    if k > #y - #y // 4 - 1 then late = math.max(late, math.abs(y[k] - y[1])) end
  end
  ok(s.first[i] == i and s.last[i] == y[#y] and s.least[i] == least and s.late[i] == late, "ends, extremes and the last quarter of the rows")
  local slope = e:path(i):drift "q1"
  ok(s.slope[i] == slope.per_time and s.error[i] == slope.error and s.mean[i] == slope.mean, "slope, error and mean are those of path:drift")
  near(r.slope[i], 3, 1e-13, "the slope of a ramp"); near(r.megno[i], 3 * 6.4 / 2, 0.02, "MEGNO of a growth exp(3 t) is 3 t/2")
  near(r.late[i], 19.2, 1e-13, "its end"); ok(r.early[i] < r.late[i] / 3.9, "and its first quarter")
end
near(r.nearest[1], 9.3, 1e-12, "the row of the second half nearest to the start: the 32nd of 65, at t = 3.1"); near(r.span[1], 19.2 - 9.3, 1e-12, "and what they span")
raises("no column 'x'", e.summary, e, "x")
raises("kept only the ends", function() spring:solver({ rule = "verlet", h = 0.1 }):ensemble({ members = 1, q = { { 1 } }, p = { { 0 } }, steps = 1 }):summary "q1" end)
local function run(more)
  local o = { members = 2, q = { { 1 }, { 1 } }, p = { { 0 }, { 0 } }, steps = 3 }
  for k, v in pairs(more) do o[k] = v end
  return spring:solver({ rule = "verlet", h = 0.1 }):ensemble(o)
end
raises("step of member 2 must be a number > 0", run, { h = { 0.1, -1 } })
raises("step of member 1 must be a number > 0", run, { h = function() return 0 / 0 end })
raises("'h' has 1 rows for 2", run, { h = { 0.1 } })
raises("not both", run, { h = { 0.1, 0.2 }, t = 1 })
raises("not both", run, { rows = 3, every = 2 })
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h) return (b[1] - a[1]) ^ 2 / 2 / h end }
raises("has a step of its own", function() Ld:solver({}):ensemble { members = 1, q = { { 0 } }, p = { { 1 } }, steps = 1, h = { 0.1 } } end)

-- rules with a time of their own end each member at another time: what it is, and no duration
local timed = kepler:solver { rule = "log-hamiltonian(yoshida(4))", h = 0.05 }
local function swift(i) return { 0, 0.8 + 0.2 * i } end
local cloud = timed:ensemble { members = 5, steps = 40, q = function() return q0 end, v = swift }
for i = 1, 5 do
  local alone = timed:run { q = q0, v = swift(i), steps = 40 }
  ok(cloud.t[i] == alone.t[41] and cloud.q[i] == alone.q[41], "a member ends at the time of its own run", cloud.t[i])
end
ok(tostring(cloud):find(("at t = %.14g to %.14g"):format(cloud.t[1], cloud.t[5]), 1, true), "printed, the first and the last", cloud)
for _, h in ipairs { false, function(i) return 0.01 * i end } do
  raises("time of its own", timed.ensemble, timed, { members = 2, t = 2, h = h or nil, q = function() return q0 end, v = swift })
end
raises("time of its own", timed.run, timed, { q = q0, v = v0, t = 2 })
local paced = kepler:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, t = 1, h = { 0.01, 0.03 }, q = function() return q0 end, v = swift }
ok(tostring(paced):find("at t = 1.0 to 1.02:", 1, true), "members with steps of their own: the times that these lead to", paced)
tap.done()
