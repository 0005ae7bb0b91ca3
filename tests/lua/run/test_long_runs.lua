-- checkpoints, events, watched rows, rows in a file
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local pi, abs, sin = math.pi, math.abs, math.sin

local kepler = dm.system { name = "Kepler", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.4, 0 }, v = { 0, 2 } }
local function run(solver, more, s)
  local options = { q = (s or start).q, v = (s or start).v }
  for key, value in pairs(more) do options[key] = value end
  return solver:run(options)
end
local function same(a, b) return a.q[#a] == b.q[#b] and a.p[#a] == b.p[#b] and a.t[#a] == b.t[#b] end

-- a run in two parts has the bits of a whole one: rules with sums, memory, a time of their own; L with t
local swing = dm.system { Q = dm.T(1), L = function(q, v, t) return v[1] ^ 2 / 2 + (1 + 0.3 * sin(2 * t)) * math.cos(q[1]) end }
local file = os.tmpname()
for _, case in ipairs { { kepler, "verlet" }, { kepler, "gauss(3)" }, { kepler, "gauss(4, 3)" }, { kepler, "midpoint" },
  { kepler, "lobatto(3)" }, { kepler, "log-hamiltonian(kahan-li(6))" }, { kepler, "yoshida(4, midpoint)" },
  { kepler, "rk8pd" }, { swing, "gauss(2)" }, { swing, "verlet" } } do
  local system, rule = case[1], case[2]
  local s = system == swing and { q = { 1 }, v = { 0 } } or start
  local solver = system:solver { rule = rule, h = 0.01 }
  local whole = run(solver, { steps = 200, every = 200, t0 = 0.7 }, s)
  local half = run(solver, { steps = 77, every = 77, t0 = 0.7 }, s)
  half:checkpoint(file)
  ok(same(whole, dm.resume(file, system):run { steps = 123, every = 1000 }), rule .. ": from a file, bit for bit")
  ok(same(whole, dm.resume(half):run { steps = 123, every = 1000 }), rule .. ": from the path itself")
end
local twice = dm.resume(run(kepler:solver { rule = "gauss(2)", h = 0.05 }, { steps = 5 })):run { steps = 5 }
twice = dm.resume(twice):run { steps = 5 }
ok(same(twice, run(kepler:solver { rule = "gauss(2)", h = 0.05 }, { steps = 15 })), "a resumed run can be resumed")
ok(#twice == 6 and abs(twice.t[1] - 0.5) < 1e-15, "its rows begin where it goes on")

-- while it runs, and after a failure
local doomed = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 4 end }
local solver = doomed:solver { rule = "verlet", h = 0.1 }
local fine, failure = pcall(solver.run, solver, { q = { 1 }, v = { 1 }, steps = 1000, checkpoint = file })
ok(not fine and failure.code == "not_finite", "a run that fails")
local again = dm.resume(file, doomed)
local t = failure.path.t[#failure.path]
local part, other = pcall(again.run, again, { steps = 1 })
ok(not part and other.step == 1 and abs(other.time - t) < 1e-12, "its checkpoint is the last good state")

-- times asked for after resuming; looking between steps leaves every rule's bits alone
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local half = oscillator:solver({ rule = "gauss(4)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 50 }
local late = dm.resume(half):run { at = { 5, 5.37, 5.74, 9.99, 12 } }
local worst_at = 0
for i = 1, #late do worst_at = math.max(worst_at, abs(late.q[i][1] - math.cos(late.t[i]))) end
ok(#late == 5 and worst_at < 1e-12, "times asked for of a resumed run", worst_at)
for _, rule in ipairs { "verlet", "gauss(3)", "midpoint", "curve(rk4)", "curve(euler)", "kahan-li(6)", "galerkin(2, lobatto(3))" } do
  local one = kepler:solver { rule = rule, h = 0.02 }
  local plain = run(one, { steps = 60, every = 60 })
  local seen = run(one, { steps = 60, every = 60, events = { apsis = function(q, v) return q:dot(v) - 0.3 end } })
  local listed = run(one, { at = { 0.013, 0.5, 0.777, 1.2 } })
  ok(plain.q[2] == seen.q[2] and plain.p[2] == seen.p[2] and plain.q[2] == listed.q[4], rule .. ": looking between steps changes no bit")
end

-- a run that stopped at an event goes on without meeting it again
for _, rule in ipairs { "gauss(4)", "verlet", "yoshida(4)", "log-hamiltonian(kahan-li(6))" } do
  local one = kepler:solver { rule = rule, h = 0.05 }
  local turns = { steps = 400, events = { near = { g = function(q, v) return q:dot(v) end, direction = "up", stop = true } } }
  local path, times = run(one, turns), {}
  for k = 1, 8 do
    times[k] = path.events[1].t
    path = dm.resume(path):run(turns)
  end
  local even = true
  for k = 2, 8 do even = even and times[k] - times[k - 1] > 5 end
  ok(even, rule .. ": eight times to the next pericentre", table.concat(times, " "))
end
local few = run(kepler:solver { rule = "log-hamiltonian(kahan-li(6))", h = 0.05 }, { at = { 0.1, 0.2, 0.3, 0.55, 0.58, 0.59, 0.7 },
  events = { noon = { g = function(_, _, time) return time - 0.6 end, stop = true } } })
ok(#few == 6 and few.t[6] == 0.59, "times before the end are rows, with a time of its own too", few.t[#few])
local long_at = {}
for i = 1, 6000 do long_at[i] = 0.0005 * i end
local npy_at = os.tmpname() .. ".npy"
oscillator:solver({ rule = "gauss(4)", h = 1 }):run { q = { 1 }, v = { 0 }, at = long_at, file = npy_at,
  events = { noon = { g = function(_, _, time) return time - 2.0482 end, stop = true } } }
ok(#dm.load(npy_at).t == 4096, "rows of a file that ends at an event", #dm.load(npy_at).t)
os.remove(npy_at)
raises("memory", oscillator.solver(oscillator, { rule = "verlet", h = 1e-3 }).run, oscillator:solver { rule = "verlet", h = 1e-3 }, { q = { 1 }, v = { 0 }, steps = math.maxinteger })

raises("goes on from a checkpoint", function() dm.resume(half):ensemble { members = 2, q = { { 1 }, { 2 } }, v = { { 0 }, { 0 } }, steps = 1 } end)

-- misuse of checkpoints
local hollow = os.tmpname()
raises("not a whole checkpoint", dm.resume, hollow, kepler)
os.remove(hollow)
raises("/dev/null: it is a device", dm.resume, "/dev/null", kepler)
raises("cannot open", dm.resume, "/no/such/file", kepler)
raises("coordinates, this one has 1", dm.resume, run(kepler:solver { rule = "verlet", h = 1e-3 }, { steps = 1 }), swing)
local heavier = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 2 / q:norm() end }
run(kepler:solver { rule = "verlet", h = 1e-3 }, { steps = 1, checkpoint = file })
raises("not the one of the checkpoint", function() dm.resume(file, heavier):run { steps = 1 } end)
-- a wall and a current that the motion has not met yet
local function bounded(stiff, push)
  return dm.system { Q = dm.R(2), force = function(q, v) return { -0.1 * v[1], dm.where(-q[2] - 5, push, 0) } end,
    L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - dm.where(q[1] - 3, stiff * (q[1] - 3) ^ 2, 0) end }
end
local walled = os.tmpname()
bounded(1, 1):solver { rule = "midpoint", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 0 }, steps = 50, checkpoint = walled }
raises("differ far from the state", function() dm.resume(walled, bounded(2, 1)):run { steps = 1 } end)
raises("differ far from the state", function() dm.resume(walled, bounded(1, 2)):run { steps = 1 } end)
ok(#dm.resume(walled, bounded(1, 1)):run { steps = 1 }.t == 2, "the same system, made again, goes on")
os.remove(walled)
raises("has its own state and time", function() dm.resume(file, kepler):run { steps = 1, q = { 1, 0 } } end)
local text = io.open(file):read "a"
io.open(file, "w"):write(text:sub(1, #text - 20)):close()
raises("not a whole checkpoint", dm.resume, file, kepler)
-- a checkpoint takes the place of a file, and of nothing else that has its name
local fifo = os.tmpname()
os.remove(fifo)
if os.execute(("mkfifo %s 2>/dev/null"):format(fifo)) then
  raises("cannot write " .. fifo, function() half:checkpoint(fifo) end)
  raises("cannot write " .. fifo, run, kepler:solver { rule = "verlet", h = 1e-3 }, { steps = 3, checkpoint = fifo })
  ok(os.execute("test -p " .. fifo), "what is no file stays")
  os.remove(fifo)
end
raises("field 'checkpoint': cannot write /no/such/folder/c", run, kepler:solver { rule = "verlet", h = 1e-3 },
  { steps = 3, checkpoint = "/no/such/folder/c" })
local gone = file .. ".folder"
os.execute("mkdir " .. gone)
local function leave(q)  -- the folder is removed while the run is under way
  os.execute("rm -rf " .. gone)
  return q[1]
end
fine, failure = pcall(run, kepler:solver { rule = "verlet", h = 1e-3 },
  { steps = 3, checkpoint = gone .. "/c", record = { x = leave } })
ok(not fine and failure.code == "not_written" and failure.path.steps == 3, "a checkpoint that cannot be written keeps the path")

-- events: apsides of an ellipse of period 2 pi lie at multiples of pi
local gauss = kepler:solver { rule = "gauss(6)", h = 0.05 }
local apsis = function(q, v) return q:dot(v) end
local path = run(gauss, { steps = 1000, every = 1000, events = { apsis = apsis } })
local worst = 0
for i, e in ipairs(path.events) do worst = math.max(worst, abs(e.t - i * pi)) end
ok(#path.events == 15 and worst < 1e-9, "all apsides of eight turns", ("%d %.1e"):format(#path.events, worst))
-- a pole is no zero, a jump is; a function that is NaN is named
do
  local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }:solver { rule = "verlet", h = 0.1 }
  local function seen(g)
    local out = {}
    for i, e in ipairs(free:run { q = { 0.05 }, v = { 1 }, steps = 99, events = { here = g } }.events) do out[i] = e.t end
    return out
  end
  local zeros, jumps = seen(function(q) return math.tan(q[1]) end), seen(function(q) return dm.where(q[1] - 2, 1, -1) end)
  ok(#zeros == 3 and abs(zeros[3] - 3 * math.pi + 0.05) < 1e-12, "tan: zeros, not its poles", #zeros)
  ok(#seen(function(q) return 1 / (q[1] - 3) end) == 0, "1/x has none")
  local narrow = seen(function(q) return (q[1] - 4) * dm.exp(-1e5 * (q[1] - 4) ^ 2) end)
  ok(abs(narrow[1] - 3.95) < 1e-12, "a zero beside which all but nothing is left at the ends of the step", narrow[1])
  ok(#jumps == 1 and abs(jumps[1] - 1.95) < 1e-12, "a jump through zero", jumps[1])
  local fine, why = pcall(seen, function(q) return math.sqrt(1 - q[1]) end)
  ok(not fine and why.code == "no_value" and why.message:find("event 'here' is NaN there", 1, true) and #why.path == 10, "NaN", tostring(why))
end
near(path.events[1].q[1], -1.6, 1e-11, "the first is the far one")
path = run(gauss, { steps = 1000, every = 1000, events = { far = { g = apsis, direction = "down" }, near = { g = apsis, direction = "up" } } })
ok(#path.events == 15 and path.events[1].name == "far" and path.events[2].name == "near", "directions tell them apart")
path = run(gauss, { steps = 1000, every = 7, events = { far = { g = apsis, direction = "down", stop = true } } })
near(path.t[#path], pi, 1e-10, "stop ends the run at the event")
ok(path.steps == 63 and #path == 10 and path.q[#path] == path.events[1].q, "with a row there")
local rest = dm.resume(path):run { steps = 63, events = { near = { g = apsis, direction = "up", stop = true } } }
near(rest.t[#rest], 2 * pi, 1e-10, "and it goes on from there")
path = run(gauss, { at = { 1, 2, 3, 3.2, 4 }, events = { far = { g = apsis, stop = true, direction = "down" } } })
ok(#path == 3 and path.t[3] == 3, "times asked for after the end are none of the run's")
-- the steps are the same as without events
ok(same(run(gauss, { steps = 100, every = 100, events = { apsis = apsis } }), run(gauss, { steps = 100, every = 100 })),
  "looking for events changes no bit")
path = run(kepler:solver { rule = "log-hamiltonian(kahan-li(8))", h = 0.05 }, { steps = 300, events = { apsis = apsis } })
near(path.events[2].t, 2 * pi, 1e-9, "events of a rule with a time of its own")
local driven = swing:solver { rule = "gauss(4)", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 100, events = { tick = function(q, v, time) return sin(time) end } }
near(driven.events[3].t, 3 * pi, 1e-13, "an event of the time alone")
raises("events.a must be a function", run, gauss, { steps = 1, events = { a = 3 } })
raises("direction", run, gauss, { steps = 1, events = { a = { g = apsis, direction = "left" } } })
raises("is empty", run, gauss, { steps = 1, events = {} })
raises("already", run, gauss, { steps = 1, watch = { "q1", "q1" } })
raises("already", run, gauss, { steps = 1, watch = { t = apsis } })
local midpoint = dm.curve { method = function(x, f, h) return x + h * f(x + h / 2 * f(x)) end, order = 2 }
run(kepler:solver { rule = midpoint, h = 0.02 }, { steps = 3, checkpoint = file })
raises("does not hold", dm.resume, file, kepler)
ok(#dm.resume(file, kepler, { rule = midpoint }):run { steps = 2 } == 3, "a rule of one's own is given again")
raises("not 'verlet'", dm.resume, file, kepler, { rule = "verlet" })

-- watched rows
path = run(gauss, { steps = 100, watch = { "q1", "energy", r = function(q) return q:norm() end,
  J = function(q, v, time, p) return { q[1] * p[2] - q[2] * p[1], time } end } })
local whole = run(gauss, { steps = 100 })
ok(table.concat(path.columns, " ") == "t q1 energy J1 J2 r", "columns of what is watched", table.concat(path.columns, " "))
local r, J, E = path:column "r", path:column "J1", path:column "energy"
local good = true
for i = 1, #path do
  good = good and r[i] == whole.q[i]:norm() and abs(J[i] - 0.8) < 1e-14 and path:column "q1"[i] == whole.q[i][1]
    and path:column "J2"[i] == whole.t[i]
end
ok(good and E == whole:energy() and path:energy() == E, "with the numbers of the whole path")
ok(abs(path:drift "energy".largest) < 1e-9, "drift of a watched column")
raises("recorded only what it watched", function() return path.q end)
raises("recorded only what it watched", path.velocity, path)
raises("no column 'q2'", path.column, path, "q2")
raises("no column 'z'", run, gauss, { steps = 1, watch = { "z" } })
raises("a function needs a name", run, gauss, { steps = 1, watch = { apsis } })

-- rows in a file, more than memory holds at a time
local npy = os.tmpname() .. ".npy"
path = run(gauss, { steps = 10000, file = npy })
whole = run(gauss, { steps = 10000 })
local data = dm.load(npy)
ok(#data.t == 10001 and data.q2 == whole:column "q2" and data.p1 == whole:column "p1", "all rows are in the file, bit for bit")
ok(#path == 1 and path.q[1] == whole.q[#whole] and path.file == npy, "the path keeps the last")
path = run(gauss, { steps = 4095, file = npy, watch = { "energy" } })
ok(#dm.load(npy).energy == 4096, "a file of one watched column, as many rows as the buffer has")
fine, failure = pcall(solver.run, solver, { q = { 1 }, v = { 1 }, steps = 1000, file = npy })
ok(not fine and #dm.load(npy).t == #failure.path.t - 1 + failure.path.steps + 1, "rows before a failure are in the file")
raises("cannot open", run, gauss, { steps = 1, file = "/no/such/folder/x.npy" })
raises(".npy", run, gauss, { steps = 1, file = "x.csv" })
os.remove(npy); os.remove(file)
-- a zero that ends a run is behind the state: one that goes on from there does not meet it again
local swinging, before, again = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  :solver { rule = "gauss(2)", h = 0.37 }, 0, 0
for i = 1, 20 do
  local c, up = -0.9 + 1.8 * i / 21, i % 2 == 0
  local met = { hit = { g = function(q) return q[1] - c end, direction = up and "up" or "down", stop = true } }
  local first = swinging:run { q = { up and -1 or 1 }, v = { 0.1 }, t = 20, events = met }
  local x, second = first.q[#first], swinging:run { q = first.q[#first], p = first.p[#first], t = 7, events = met }
  before = before + ((up and x[1] < c or not up and x[1] > c) and 1 or 0)
  again = again + (second.t[#second] < 1 and 1 or 0)
end
ok(before == 0 and again == 0, "ends of runs lie behind the zero", before)

-- the standard error of a drift: of few rows by their residuals, of many by those of block means; a line has none
local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
local function drift_of(rows, f)
  local path, y = free:solver({ rule = "verlet", h = 1 }):run { q = { 0 }, v = { 1 }, steps = rows - 1 }, dm.zeros(rows)
  for i = 1, rows do y[i] = f(i - 1) end
  return path:drift(y)
end
local few = drift_of(4, function(i) return i % 2 end)
near(few.per_time, 0.2, 1e-15, "drift: slope of four rows")
near(few.error, math.sqrt(0.08), 1e-15, "  and its error: residuals of two degrees of freedom")
local blocks = drift_of(64, function(i) return i // 4 % 2 == 0 and 1 or -1 end)
near(blocks.per_time, -32 * 4 / 21840, 1e-15, "drift: slope of blocks of four rows to and fro")
near(blocks.error, math.sqrt((16 - 64 / 340) / 14 / 340) / 4, 1e-14, "  and its error, by sixteen means")
local line = drift_of(1000, function(i) return 3 - 0.25 * i end)
ok(abs(line.per_time + 0.25) < 1e-15 and line.error < 1e-15 and line.mean == 3 - 0.25 * 499.5
  and line.largest == 0.25 * 999, "drift: of a line")

tap.done()
