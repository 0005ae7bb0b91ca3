-- solver:ensemble: members equal single runs, threads do not matter, failures stay alone; then misuse
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function q0(i) return { 0.4 + i * 1e-3, 0 } end
local function v0(i) return { 0, 2 - i * 1e-3 } end

for _, rule in ipairs { "verlet", "kahan-li(6)", "blanes-moan(6, 14)", "gauss(2)", "rk8pd", "log-hamiltonian(yoshida(4))" } do
  local solver = kepler:solver { rule = rule, h = 0.01 }
  local one = solver:ensemble { members = 41, q = q0, v = v0, steps = 30, threads = 1 }
  local many = solver:ensemble { members = 41, q = q0, v = v0, steps = 30, threads = 5 }
  local same, threads = true, one.q == many.q and one.p == many.p
  for i = 1, 41 do
    local path = solver:run { q = q0(i), v = v0(i), steps = 30, every = 30 }
    same = same and path.q[2] == one.q[i] and path.p[2] == one.p[i]
  end
  ok(same, rule .. ": members are single runs, bit for bit")
  ok(threads, rule .. ": five threads give the same bits as one")
end

-- starts from tables and matrices, momenta, a duration
local solver = kepler:solver { rule = "verlet", h = 0.01 }
local rows = solver:ensemble { members = 2, q = dm.matrix { { 0.4, 0 }, { 0.5, 0 } }, p = { { 0, 2 }, { 0, 1.5 } }, t = 0.3 }
ok(rows.steps[1] == 30 and rows.t == 0.3 and #rows == 2, "starts from a matrix and a table, a duration")
ok(rows.q == solver:ensemble({ members = 2, q = { { 0.4, 0 }, { 0.5, 0 } }, p = function(i) return { 0, 2.5 - i / 2 } end, t = 0.3 }).q,
  "tables and functions are the same starts")
ok(rows.q[1] == solver:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 30 }.q[31], "and the same end")
ok(tostring(rows):find "2 members", "an ensemble prints itself", tostring(rows))

-- a member that leaves the domain of its Lagrangian
local bowl = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.sqrt(1 - q[1] ^ 2) end }
for _, rule in ipairs { "verlet", "gauss(2)" } do
  local mixed = bowl:solver({ rule = rule, h = 0.05 }):ensemble { members = 40, threads = 3, steps = 400,
    q = function() return { 0 } end, v = function(i) return { i % 20 == 5 and 10 or 0.5 } end }
  local failures = mixed:failures()
  ok(#failures == 2 and failures[1].member == 5 and failures[2].member == 25, rule .. ": two members fail alone", #failures)
  ok(mixed.status[4] == "ok" and mixed.steps[4] == 400 and mixed.steps[5] < 400, rule .. ": the others finish")
  ok(mixed.q[5][1] == mixed.q[5][1], rule .. ": a failed member keeps its last good state")
end
local lost = bowl:solver({ rule = "verlet", h = 0.05 }):ensemble { members = 2, steps = 1, q = function(i) return { i - 1 + 0.5 } end, v = function() return { 0 } end }
ok(lost.status[1] == "ok" and lost.status[2] == "not_finite", "a start outside the domain is one member's failure", lost.status[2])

-- lanes: numbers of members that do not fill them, failures among them, time-dependent forces; steps too
local moved = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 + q[1] * math.cos(2 * t) end }
local lanes = solver:ensemble { members = 1, q = q0, v = v0, steps = 1 }.lanes
local function as_alone(e, single, start)
  for i = 1, #e do
    local fine, path = pcall(single.run, single, start(i))
    local code, finished = "ok", 0
    if not fine then code, finished, path = path.code, path.step - 1, path.path end
    if path.q[#path] ~= e.q[i] or path.p[#path] ~= e.p[i] or code ~= e.status[i] then return i end
    if not fine and e.steps[i] ~= finished then return i end
  end
end
for _, case in ipairs { { bowl, "verlet" }, { bowl, "kahan-li(8)" }, { bowl, "blanes-moan(6, 14)" }, { moved, "verlet" }, { moved, "blanes-moan(6, 14)" } } do
  local single = case[1]:solver { rule = case[2], h = 0.05 }
  local function start(i) return { q = { 0.01 }, v = { i % 7 == 3 and 1.2 + i * 0.01 or 0.3 + i * 1e-3 }, steps = 300, every = 300, t0 = 0.3 } end
  local failed = 0
  for _, members in ipairs { 1, 3, 8, 9, 101 } do
    local e = single:ensemble { members = members, steps = 300, t0 = 0.3, threads = 2,
      q = function() return { 0.01 } end, v = function(i) return start(i).v end }
    local different = as_alone(e, single, start)
    ok(not different, ("%s: %d members as alone, those that fail too"):format(case[2], members), different)
    ok(e.lanes == lanes, case[2] .. ": all lanes are used", e.lanes)
    failed = failed + #e:failures()
  end
  ok((failed > 0) == (case[1] == bowl), case[2] .. ": members fail where they leave the domain", failed)
end
ok(kepler:solver({ rule = "gauss(2)", h = 0.01 }):ensemble({ members = 9, q = q0, v = v0, steps = 3 }).lanes == lanes, "implicit rules take all lanes, too")
ok(kepler:solver({ rule = "verlet", h = 0.01, backend = "tape" }):ensemble({ members = 9, q = q0, v = v0, steps = 3 }).lanes == 1, "so does the tape")

-- a repelling centre stops members of the logarithmic Hamiltonian
local hill = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() - 0.5 end }
local far = hill:solver { rule = "log-hamiltonian", h = 0.05 }
local function leaving(i) return { q = { 0.5, 0 }, v = { 0, 1.5 + 0.05 * i }, steps = 400, every = 400 } end
local out = far:ensemble { members = 21, steps = 400, q = function() return { 0.5, 0 } end, v = function(i) return leaving(i).v end }
ok(#out:failures() > 0 and #out:failures() < 21, "members leave the well of V < 0", #out:failures())
ok(not as_alone(out, far, leaving), "and stop where they do alone", as_alone(out, far, leaving))

-- the same ends whatever the processor offers
local dmlua = os.getenv "DMLUA" or arg[-1]
local function under(environment, code)
  local pipe = io.popen(("%s %s -e '%s' 2>&1"):format(environment, dmlua, code))
  local text = pipe:read "a"
  pipe:close()
  return text
end
local script = [[
  local dm = require "dm"
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  local e = s:solver { rule = "kahan-li(6)", h = 0.01 }:ensemble { members = 21, steps = 99,
    q = function(i) return { 0.4 + i / 100, 0 } end, v = function(i) return { 0, 2 } end }
  for i = 1, #e do print(("%a %a"):format(e.q[i][1], e.p[i][2])) end
  io.stderr:write("lanes ", e.lanes, "\n")]]
local plain = under("", script)
for _, most in ipairs { 0, 1, 4, 8 } do
  local text = under("DMLUA_LANES=" .. most, script)
  local used = tonumber(text:match "lanes (%d+)")
  ok(text:gsub("lanes %d+", "") == plain:gsub("lanes %d+", "") and #text > 100, "DMLUA_LANES=" .. most .. " changes no bit", text)
  ok(used and used <= math.max(most, 1), "and is a limit", used)
end
for _, processor in ipairs { "plain", "fma", "avx512" } do
  local one = under("DMLUA_LANES=1 DMLUA_PROCESSOR=" .. processor, script):gsub("lanes %d+", "")
  for _, most in ipairs { 0, 4, 8 } do
    local text = under(("DMLUA_LANES=%d DMLUA_PROCESSOR=%s"):format(most, processor), script):gsub("lanes %d+", "")
    ok(text == one and #text > 100, ("a processor of level %s has the same bits in %d lanes"):format(processor, most), text)
  end
end
ok(under("DMLUA_PROCESSOR=z80", "print(1)"):find "must be plain, fma or avx512", "another processor is refused")
ok(under("DMLUA_LANES=3", "print(1)"):find "DMLUA_LANES must be 0, 1, 4 or 8", "another number is refused", under("DMLUA_LANES=3", "print(1)"))

-- parameters of their own
local spring = dm.system { Q = dm.R(1), params = { k = 1, m = 1 }, L = function(q, v, t, c) return c.m * v[1] ^ 2 / 2 - c.k * q[1] ^ 2 / 2 end }
for _, rule in ipairs { "verlet", "gauss(2)" } do
  local varied = spring:solver({ rule = rule, h = 0.01 }):ensemble { members = 12, steps = 100, threads = 2,
    q = function(i) return { i } end, p = function() return { 0 } end,
    vary = { k = function(i) return 1 + i // 4 end, m = { 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2 } } }
  local same = true
  for i = 1, 12 do
    local own = dm.system { Q = dm.R(1), params = { k = 1 + i // 4, m = i > 8 and 2 or 1 }, L = spring.L }
    local path = own:solver({ rule = rule, h = 0.01 }):run { q = { i }, p = { 0 }, steps = 100, every = 100 }
    same = same and path.q[2] == varied.q[i] and path.p[2] == varied.p[i]
  end
  ok(same, rule .. ": members with parameters of their own are runs of such systems")
  tap.near(varied.q[12][1], 12 * math.cos(math.sqrt(4 / 2)), 1e-3, rule .. ": the frequency is sqrt(k/m)")
end
ok(spring.params.k == 1 and spring.params.m == 1, "the system keeps its own parameters")

-- a parameter, or a start, outside of the domain of L is one member's failure
for _, rule in ipairs { "verlet", "midpoint" } do
  local function status(L, q, k)
    local s = dm.system { Q = dm.R(1), params = { k = 1 }, L = L }:solver { rule = rule, h = 0.1 }
    local e = s:ensemble { members = 4, steps = 10, q = q, v = { { 0 }, { 0 }, { 0 }, { 0 } }, vary = k and { k = k } }
    return table.concat(e.status, " "), e
  end
  local function root(q, v, t, c) return v[1] ^ 2 / 2 - math.sqrt(c.k) * q[1] ^ 2 / 2 end
  local all, e = status(root, { { 1 }, { 1 }, { 1 }, { 1 } }, { 2, 3, -1, 3 })
  ok(all == "ok ok not_finite ok" and e.steps[3] == 0 and e.q[2] == e.q[4], rule .. ": a root of a negative parameter", all)
  local own = dm.system { Q = dm.R(1), params = { k = 3 }, L = root }:solver({ rule = rule, h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 10 }
  ok(own.q[11] == e.q[4], rule .. ": those beside it are single runs")
  -- log(k - q) has a finite force where it is none: L itself is looked at, as a single run does
  local function log(q, v, t, c) return v[1] ^ 2 / 2 - math.log(c.k - q[1]) end
  all = status(log, { { 0 }, { 0 }, { 0 }, { 0 } }, { -1, 3, 4, 2 })
  ok(all == "not_finite ok ok ok", rule .. ": a logarithm of a negative number, the first member", all)
  all = status(log, { { 3 }, { 0 }, { 2 }, { -1 } })
  ok(all == "not_finite ok not_finite ok", rule .. ": starts outside, the first among them", all)
  raises("NaN at the start", status, log, { { 3 }, { 3 }, { 4 }, { 2 } })
end

-- starts by random numbers: the same in any order
local r = dm.random(7)
ok(r:normal(3, 1) == dm.random(7):normal(3, 1) and r:normal(3, 1) ~= r:normal(4, 1) and r.seed == 7, "random numbers depend on seed and place")
ok(r:uniform(1, 0, 2, 3) == 2 * (1 - r:uniform(1, 0)) + 3 * r:uniform(1, 0), "uniform between bounds")
ok(r:normal(5, 0, 10, 0) == 10 and dm.random(8):uniform(1, 0) ~= r:uniform(1, 0), "normal about a mean, other seeds")
raises("between 0 and 2^32 - 1", r.uniform, r, 1, -1)
raises("both ends", r.uniform, r, 1, 1, 2)
raises("negative", r.normal, r, 1, 1, 0, -1)
raises("integer", dm.random, 1.5)
raises("finite", r.uniform, r, 1, 1, 0, 1 / 0)

-- misuse
local good = { members = 2, q = q0, v = v0, steps = 1 }
local function with(changes)
  local options = {}
  for key, value in pairs(good) do options[key] = value end
  for key, value in pairs(changes) do if value == "none" then options[key] = nil else options[key] = value end end
  return solver:ensemble(options)
end
raises("'members'", with, { members = 0 })
raises("'members'", with, { members = "none" })
raises("at most", with, { members = 1e12 })
raises("'q' of member 1 must have 2 entries", with, { q = function() return { 1 } end })
raises("'v' of member 2", with, { v = function(i) return i == 1 and { 0, 1 } or { 0, "x" } end })
raises("rows for 2 members", with, { q = { { 1, 0 } } })
raises("field 'q' must be a function", with, { q = 3 })
raises("one of 'v' and 'p'", with, { v = "none" })
raises("'threads'", with, { threads = 0 })
raises("at most 256", with, { threads = 1000 })
raises("too many", with, { steps = "none", t = 1e300 })
raises("'steps'", with, { steps = "none" })
raises("did you mean", with, { membres = 3 })
raises("oops", with, { q = function() error "oops" end })
raises("'q' of member 2 must have 2 entries", with, { q = { { 1, 0 }, { 1, 0, 0 } } })
raises("no parameters", with, { vary = { k = { 1, 2 } } })
raises("field 'vary' must be a table", with, { vary = 3 })
local function vary(what)
  return spring:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, steps = 1, q = { { 1 }, { 2 } }, p = { { 0 }, { 0 } }, vary = what }
end
raises("'l' is not a number among the params", vary, { l = { 1, 2 } })
raises("its parameters are k, m", vary, { l = { 1, 2 } })
-- what is read is found by one trace of the system, whatever its parameters are called
do
  local traces = 0
  local named = dm.system { Q = dm.R(1), params = { k = 1, all = 2, idle = 3 }, L = function(q, v, _, p)
    if type(q[1]) ~= "number" then traces = traces + 1 end
    return v[1] ^ 2 / 2 - p.k * p.all * q[1] ^ 2
  end }
  local each = {}
  local function members(which)
    traces = 0
    named:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, q = { { 1 }, { 1 } }, v = { { 0 }, { 0 } }, steps = 1, vary = which }
    each[#each + 1] = traces
  end
  for _ = 1, 3 do members { k = { 1, 2 } } end
  ok(each[2] == each[1] - 1 and each[3] == each[2], "one trace tells what is read", table.concat(each, " "))
  raises("would not differ by parameter 'idle'", members, { idle = { 1, 2 } })
end
-- what nothing reads makes no member another one
for _, rule in ipairs { "verlet", "gauss(2)" } do
  local idle = dm.system { Q = dm.R(1), params = { k = 1, idle = 1, mode = 1, deep = 1 }, L = function(q, v, _, p)
    return v[1] ^ 2 / 2 - p.k * (p.mode == 2 and p.deep or 1) * q[1] ^ 2 / 2
  end }
  local function members(which)
    return idle:solver({ rule = rule, h = 0.1 }):ensemble { members = 3, q = function() return { 1 } end, v = function() return { 0 } end, steps = 10, vary = which }
  end
  raises("members would not differ by parameter 'idle': no function of the system reads it", members, { idle = { 1, 2, 3 } })
  raises("would not differ by parameter 'idle'", members, { k = { 1, 2, 3 }, idle = { 1, 2, 3 } })
  local mixed = members { mode = { 1, 2, 2 }, deep = { 1, 1, 4 } }
  ok(mixed.q[1] == mixed.q[2] and mixed.q[2] ~= mixed.q[3], rule .. ": a parameter that some members read")
end
raises("'k' of member 2 must be a finite number", vary, { k = { 1, "x" } })
raises("'k' of member 1 must be a finite number", vary, { k = function() return 0 / 0 end })
raises("rows for 2 members", vary, { k = { 1, 2, 3 } })
raises("field 'k' must be a function", vary, { k = 1 })
raises("field 'vary' must be a table", vary, { { 1, 2 } })
ok(#vary {} == 2, "nothing varied")
-- rows on the way are those of a run of its own: of failing members, watched numbers, varied parameters
local pulled = dm.system { Q = dm.R(2), params = { g = 1 }, L = function(q, v, _, P) return v:dot(v) / 2 + P.g / q:norm() end }
local watch = { "q1", "energy", r = function(q) return q:norm() end }
for _, rule in ipairs { "verlet", "gauss(2)", "log-hamiltonian(yoshida(4))" } do
  local one = pulled:solver { rule = rule, h = 0.01 }
  for _, asked in ipairs { { every = 7 }, { watch = watch }, { every = 3, watch = { "energy" } } } do
    local e = one:ensemble { members = 13, q = q0, v = v0, steps = 100, every = asked.every, watch = asked.watch, threads = 3,
      vary = { g = function(i) return 1 + (i // 5) * 0.01 end } }
    local different
    for i = 1, 13 do
      local same = dm.system { Q = dm.R(2), params = { g = 1 + (i // 5) * 0.01 }, L = pulled.L }
      local path = same:solver({ rule = rule, h = 0.01 }):run { q = q0(i), v = v0(i), steps = 100, every = asked.every, watch = asked.watch }
      local rows = e:path(i)
      if #rows ~= #path or #rows.columns ~= #path.columns then different = i end
      for _, name in ipairs(path.columns) do
        if rows:column(name) ~= path:column(name) then different = name end
      end
      if not asked.watch and rows:energy() ~= path:energy() then different = "energy" end
    end
    ok(not different, rule .. ": rows of members are rows of runs", different)
  end
end
for _, rule in ipairs { "verlet", "gauss(2)" } do
  local single = bowl:solver { rule = rule, h = 0.05 }
  local e = single:ensemble { members = 20, threads = 2, steps = 400, every = 9,
    q = function() return { 0 } end, v = function(i) return { i % 20 == 5 and 10 or 0.5 } end }
  local _, failure = pcall(single.run, single, { q = { 0 }, v = { 10 }, steps = 400, every = 9 })
  ok(e:path(5):column "q1" == failure.path:column "q1" and #e:path(4) == 46, rule .. ": a member that fails keeps its rows")
end
raises("kept only the ends", function() solver:ensemble({ members = 2, q = q0, v = v0, steps = 3 }):path(1) end)
raises("ensemble:path: there are members 1 to 2 (got 3)", function() solver:ensemble({ members = 2, q = q0, v = v0, steps = 3, every = 1 }):path(3) end)
raises("larger 'every'", function() solver:ensemble { members = 1e6, q = q0, v = v0, steps = 1e6, every = 1 } end)
-- plain sums, by name: the same bits alone, side by side, on the tape and from a checkpoint; other rules refuse them
local drawn = dm.system { Q = dm.R(2), L = function(q, v, t) return v:dot(v) / 2 + 1 / q:norm() + 0.1 * q[1] * math.cos(t) + q[2] / 8 end }
for _, case in ipairs { { kepler, "verlet" }, { kepler, "kahan-li(6)" }, { kepler, "blanes-moan(6, 11)" }, { drawn, "verlet" }, { drawn, "symplectic-euler" } } do
  local plain = case[1]:solver { rule = case[2], h = 0.01, sums = "plain" }
  local tape = case[1]:solver { rule = case[2], h = 0.01, sums = "plain", backend = "tape" }
  local full = case[1]:solver { rule = case[2], h = 0.01 }
  local e, different, worst = plain:ensemble { members = 19, q = q0, v = v0, steps = 150 }, nil, 0
  for i = 1, 19 do
    local path = plain:run { q = q0(i), v = v0(i), steps = 150, every = 150 }
    local same, exact = tape:run { q = q0(i), v = v0(i), steps = 150, every = 150 }, full:run { q = q0(i), v = v0(i), steps = 150, every = 150 }
    if path.q[2] ~= e.q[i] or path.p[2] ~= e.p[i] or same.q[2] ~= path.q[2] then different = i end
    worst = math.max(worst, (path.q[2] - exact.q[2]):norm())
  end
  ok(not different, case[2] .. ": plain sums, members are single runs, on the tape too", different)
  ok(worst > 0 and worst < 1e-12, case[2] .. ": and differ from compensated ones by round-off", worst)
  local rows, every = plain:ensemble { members = 19, q = q0, v = v0, steps = 150, every = 7 }, plain:run { q = q0(9), v = v0(9), steps = 150 }
  local times = plain:run { q = q0(9), v = v0(9), at = { 0.4137, 1.5 } }
  ok(rows.q == e.q and rows.p == e.p and every.p[151] == e.p[9] and rows:path(9).p[5] == every.p[29] and times.q[2] == every.q[151],
    case[2] .. ": what is recorded on the way changes no bit")
  local half = plain:run { q = q0(1), v = v0(1), steps = 70 }
  ok(dm.resume(half):run({ steps = 80 }).q[81] == plain:run({ q = q0(1), v = v0(1), steps = 150 }).q[151], case[2] .. ": they are resumed as plain ones")
end
-- what an ensemble makes for a system is made once
local function held()
  collectgarbage()
  collectgarbage()
  return collectgarbage "count"
end
for _, case in ipairs { { kepler, "verlet" }, { kepler, "log-hamiltonian" }, { pulled, "verlet" }, { pulled, "blanes-moan(6, 11)" } } do
  local one = case[1]:solver { rule = case[2], h = 0.01 }
  local function often() for _ = 1, 60 do one:ensemble { members = 9, q = q0, v = v0, steps = 2, threads = 1 } end end
  often()
  local before = held()
  often()
  ok(held() - before < 50, case[2] .. ": ensembles leave no memory behind", held() - before)
end
raises("always compensates", function() kepler:solver({ rule = "gauss(2)", h = 0.01, sums = "plain" }):run { q = q0(1), v = v0(1), steps = 1 } end)
raises("always compensates", function() kepler:solver({ rule = "gauss(2)", h = 0.01, sums = "plain" }):ensemble { members = 3, q = q0, v = v0, steps = 1 } end)
raises("field 'sums'", kepler.solver, kepler, { rule = "verlet", h = 0.01, sums = 3 })
local fast = dm.system { Q = dm.R(1), L = function(q, v) return -math.sqrt(1 - 0.3 * v[1] ^ 2) - q[1] ^ 2 / 2 end }
local quick = fast:solver { rule = "midpoint", h = 0.05 }
local function seen(threads)
  return quick:ensemble { members = 60, threads = threads, steps = 20, every = 5, watch = { "energy", speed = function(_, v) return v[1] end },
    q = function(i) return { 0.01 * i } end, v = function(i) return { 0.02 * i } end }
end
local alone, shared, differ = seen(1), seen(4), nil
for i = 1, 60 do
  local single = quick:run { q = { 0.01 * i }, v = { 0.02 * i }, steps = 20, every = 5, watch = { "energy", speed = function(_, v) return v[1] end } }
  for _, name in ipairs { "energy", "speed" } do
    local x = single:column(name)
    if x ~= alone:path(i):column(name) or x ~= shared:path(i):column(name) then differ = i end
  end
end
ok(not differ, "what is watched has the bits of a single run, whatever the number of threads", differ)

-- nothing varies
local plain = solver:ensemble { members = 3, q = q0, v = v0, steps = 4, every = 2, vary = {} }
local bare = solver:ensemble { members = 3, q = q0, v = v0, steps = 4, every = 2 }
ok(plain.q == bare.q and plain.p == bare.p, "vary = {} of a system without params")
raises("there are members 1 to 3", plain.path, plain, math.mininteger)
raises("there are members 1 to 3", plain.path, plain, math.maxinteger)

-- what was watched, without a name: its extent over the rows of all members
local few = { watch = { "energy", place = function(q) return q[1] end }, members = 3, steps = 8, every = 2,
  q = function(i) return { 0.1 * i } end, v = function() return { 0 } end }
local watched = quick:ensemble(few)
local all, least, largest, sum = watched:summary(), math.huge, -math.huge, 0
for i = 1, 3 do
  local x = watched:path(i):column "place"
  for k = 1, #x do least, largest, sum = math.min(least, x[k]), math.max(largest, x[k]), sum + x[k] end
end
ok(all.place.least == least and all.place.largest == largest and math.abs(all.place.mean - sum / 15) < 1e-15,
  "a summary without a name lists the columns", dm.pretty(all))
ok(all.energy and not all.t, "but for the time")
raises("rows have no column 'x', but t, energy, place", watched.summary, watched, "x")
ok(bare:summary().q1.largest >= bare:path(1).q[1][1] and bare:summary().p1, "rows of states have their columns")

-- members without a start are told together
local function starts_of(of, q, v) return of.ensemble, of, { members = 12, steps = 1, q = q, v = v } end
local function none() return { 0 } end
raises("'q' of member 3: entry 1 is NaN, but must be finite (4 of 12 members have no start: 3, 6, 9, 12)",
  starts_of(quick, function(i) return { i % 3 == 0 and 0 / 0 or 1 } end, none))
local rows = {}
for i = 1, 12 do rows[i] = { i % 3 == 0 and 0 / 0 or 1 } end
for what, source in pairs { table = rows, matrix = dm.matrix(rows) } do
  raises("'q' of member 3: entry 1 is NaN, but must be finite (4 of 12 members have no start: 3, 6, 9, 12)", starts_of(quick, source, none))
  raises("'v' of member 3: entry 1 is NaN", starts_of(quick, none, source))
  raises("'q' of member 3: entry 1 is NaN", starts_of(quick, source, dm.zeros(12, 1)))
  ok(not pcall(starts_of(quick, none, source)), "so of a " .. what)
end
raises("'v' of member 5 must have 1 entries (got 2)", starts_of(quick, none, function(i) return i == 5 and { 1, 2 } or { 1 } end))
raises("my own mistake", starts_of(quick, function(i) if i > 2 then error("my own mistake", 0) end return { 1 } end, none))
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return q:dot(q) - 1 end }
raises("member 2: no start: it is off the constraints: constraint 1: |g(q)| = 3.0; project = true moves it to the nearest q on them "
  .. "(11 of 12 members have no start: 2, 3, 4, 5, 6, 7, 8, 9, ...)", starts_of(rod:solver { rule = "rattle", h = 0.1 },
  function(i) return { 0, i > 1 and -2 or -1 } end, function() return { 0, 0 } end))
tap.done()
