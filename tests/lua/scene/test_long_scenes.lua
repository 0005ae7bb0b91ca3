-- long scenes: which times are looked at where there are more of them than can be
local tap = require "tap"
local dm = require "dm"
local choice = require "dm.scene.choice"
local engine = require "dm.reference.engine"
local ok = tap.ok

-- peaks of the error that grow with time, more than are looked at: the largest are, and what is left is told
local t, places = {}, {}
for i = 1, 30001 do t[i] = i / 7 end
for i = 3, 30000, 3 do places[i] = i / 30000 end
local times, unseen = choice.sharp_times(t, places, 1000)
ok(#times == 16000, "eight times before and behind each", #times)
ok(times[1] > t[26998] and times[#times] == t[30001], "the largest ones, which are the last", times[1], times[#times])
ok(unseen == places[27000], "the largest that is left", unseen)
local sorted = true
for i = 2, #times do sorted = sorted and times[i] > times[i - 1] end
ok(sorted, "in the order of time")
times, unseen = choice.sharp_times(t, { [5] = 0.7 }, 1000)
ok(#times == 16 and unseen == 0, "nothing is left where all are looked at", #times, unseen)

-- what is left counts in the choice: errors of a look that sees none of it, of steps that a check lets through; the parts of the choice are those of this test
local pilot = require "dm.scene.pilot"
local own = { run = pilot.run, apart_between = pilot.apart_between, unresolved = pilot.unresolved, record = pilot.record, is_even = pilot.is_even }
local asked = 0
function pilot.run(_, _, _, at) return #at end
function pilot.apart_between(_, record) return record == #t and 0.5 or 0.1 end -- at the check, between its times
function pilot.unresolved() return places end
function pilot.record() end
function pilot.is_even() return false end
local function told(scale) -- what more steps err by, where places[i] = scale * i / 30000
  for i = 3, 30000, 3 do places[i] = scale * i / 30000 end
  local long = { best = { N = 10 }, problem = { T = 1 }, uncertainty = 0, check_times = t, checked = {}, began = 0, allowed = math.huge,
    reference = { path = function(_, at) asked = #at end } }
  choice.finer(long)
  return long.checked_error
end
ok(told(0.7) == 0.7 * 27000 / 30000, "the largest that is left is the error of the choice", told(0.7))
ok(asked == 16000, "beside the largest ones, which are looked at", asked)
ok(told(0.4) == 0.5, "unless the check found more", told(0.4))
ok(told(50) == 0.75, "and half as much again as the check at most, as where nothing is looked at", told(50))
for name, f in pairs(own) do pilot[name] = f end

-- a mesh of fewer times than the reference has steps: what it passed once, in four short steps, is looked at too
for _, place in ipairs { 1, 777, 20000, 49990 } do
  local steps, at = { 0 }, 0
  for i = 1, 50000 do
    at = at + (i >= place and i < place + 4 and 1e-3 or 1)
    steps[i + 1] = at
  end
  for _, count in ipairs { 1000, 20000 } do
    local mesh = setmetatable({ times = steps, t0 = 0, T = at }, engine):mesh(count, 0.4142135623730951)
    local inside, last = false, 0
    sorted = true
    for _, x in ipairs(mesh) do
      sorted, last = sorted and x > last, x
      inside = inside or x > steps[place] and x <= steps[place + 4]
    end
    ok(inside and sorted and last == at, ("steps %d to %d of 50000 in %d times"):format(place, place + 3, count))
    ok(#mesh > 0.7 * count and #mesh < 1.5 * count, "about so many", #mesh)
  end
end

-- fast steps that go on and a close passage, once: Kepler of e = 0.6 over 1100 periods, more steps of the reference than times of the check; its closed form in the
-- passages near the end, where the error is largest
local e, periods = 0.6, 1100
local T = 2 * math.pi * periods
local scene = dm.scene { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 1 - e, 0 }, v = { 0, math.sqrt((1 + e) / (1 - e)) },
  watch = { "p1" }, tolerance = 0.05, until_t = T, seconds = 60, rules = { "kahan-li(8)" } }
local at, worst = {}, 0
for period = periods - 20, periods - 1 do
  for i = 0, 500 do at[#at + 1] = 2 * math.pi * period + 3 * (1 - e) ^ 1.5 * (i / 250 - 1) end
end
local run = scene:run { at = at }
local p1 = run:column "p1"
for i = 1, #at do
  local mean = at[i] % (2 * math.pi)
  local E = mean + e * math.sin(mean)
  for _ = 1, 50 do E = E - (E - e * math.sin(E) - mean) / (1 - e * math.cos(E)) end
  worst = math.max(worst, math.abs(p1[i] + math.sin(E) / (1 - e * math.cos(E))))
end
ok(worst <= run.error_estimate and run.error_estimate <= 0.05, "Kepler over many periods errs by no more than is told", worst, run.error_estimate)
ok(#scene.reference.times > 10000 and worst > 1e-4, "and it is a long one", #scene.reference.times, worst)
-- Along a stiff oscillation the first method has looked at all of the path; the second, whose long steps are dear to look at, does not look again.
do
  local engine = require "dm.reference.engine"
  local function looks(k)
    local spring = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
    local seen = {}
    local watcher = setmetatable({ solver = function(_, options)
      local solver = spring:solver(options)
      return setmetatable({ run = function(_, how)
        seen[#seen + 1] = options.rule .. (how.control.hidden and " looks" or "")
        return solver:run(how)
      end }, { __index = function(_, key) return function() return solver[key](solver) end end })
    end }, { __index = function(_, key)
      local found = spring[key]
      return type(found) == "function" and function() return found(spring) end or found
    end })
    local found = engine.find { system = watcher, start = { q = { math.sin(0.5), -math.cos(0.5) }, v = { 0, 0 } }, T = 1.2, watch = { q1 = function(q) return q[1] end }, goal = 1e-6,
      distance = function(a, b) return math.abs(a:column "q1"[#a] - b:column "q1"[#b]) end }
    return table.concat(seen, ", "), found and found.distance or 1
  end
  local seen, distance = looks(1e4)
  ok(seen == "rk8 looks, gauss(7) looks, rk8, gauss(7)" and distance < 1e-6, "both methods look", seen)
  seen, distance = looks(1e8)
  ok(seen == "rk8 looks, gauss(7), rk8, gauss(7)" and distance < 1e-6, "one of them looks along a stiff oscillation", seen .. " " .. distance)
end
-- more controlled steps than are kept of a run without an end: what may go on is for the seconds
do
  local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  local path = spring:solver({ rule = "rk8", h = 0.01 }):run { q = { 1 }, v = { 0 }, t = 2300, seconds = 200, control = { tolerance = 1e-3, largest = 0.01 } }
  ok(#path > 200001 and path.t[#path] == 2300, "controlled steps that seconds end", #path)
  tap.raises("steps allowed were over", function()
    spring:solver({ rule = "rk8", h = 0.01 }):run { q = { 1 }, v = { 0 }, t = 2300, control = { tolerance = 1e-3, largest = 0.01 } }
  end)
end
-- seconds that are over before a rule is tried
tap.raises("no rule could be tried within 1 seconds", choice.choose, { finalists = {}, search = { candidates = {} }, allowed = 1, began = 0 })
tap.done()
