-- journals of stability maps and of charts: resumed, split, refused
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local dmlua = os.getenv "DMLUA" or arg[-1]
dmlua = dmlua:sub(1, 1) == "/" and dmlua or io.popen("pwd"):read "l" .. "/" .. dmlua

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))
local function name(base) return folder .. "/" .. base end
local function text(file, new)
  local f <close> = assert(io.open(file, new and "wb" or "rb"))
  return new and f:write(new) or f:read "a"
end
local function run(words, environment)
  local pipe = assert(io.popen(("cd '%s' && %s '%s' %s 2>&1; echo status $?"):format(folder, environment or "", dmlua, words)))
  local out = pipe:read "a"
  pipe:close()
  return out, tonumber(out:match "status (%d+)%s*$")
end
local function copy(options, more)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  for key, value in pairs(more or {}) do out[key] = value end
  return out
end

---- maps ----

-- each as Lua, so that scripts of parts and ranks run the same
local MAPS = {
  springs = [[{ system = function(k) return dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - k*q[1]^2/2 - q[1]^4/4 end } end,
    rules = { "verlet", "midpoint" }, q = { 1 }, v = { 0 }, t = 30, h = { 0.05, 2.5, 17, "log" }, k = { 1, 30, 5, "log" } }]],
  params = [[{ system = dm.system { Q = dm.R(2), params = { a = 1 }, L = function(q, v, _, p)
      return v:dot(v)/2 - q:dot(q)/2 - p.a*(q[1]^2*q[2] - q[2]^3/3) end },
    rule = "verlet", q = function(e) return { 0.1, e } end, v = { 0.1, 0 }, steps = 3000, h = 0.1, a = { 0.5, 1.5, 9, "linear" },
    e = { 0.1, 1.5, 13, "linear" }, inside = function(q) return 9 - q:dot(q) end }]],
  starts = [[{ system = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.log(q[1]) end }, rule = "midpoint",
    q = function(x) return { x } end, v = { 0.3 }, t = 2, h = { 0.1, 0.8, 6, "linear" }, x = { -1, 2, 12, "linear" } }]],
  held = [[{ system = function(g) return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - g*q[2] end,
      constraint = function(q) return { q:dot(q) - 1 } end } end, rule = "rattle",
    q = { 1, 0 }, v = { 0, 0 }, t = 4, h = { 0.01, 0.7, 9, "log" }, g = { 1, 4, 8, "linear" } }]],
}
local function map_of(key) return assert(load("local dm = require 'dm' return " .. MAPS[key]))() end

for key in pairs(MAPS) do
  local options, file = map_of(key), name(key .. ".one")
  local plain = dm.stability(options)
  local whole = dm.stability(copy(options, { journal = file }))
  ok(plain:csv() == whole:csv() and plain:table() == whole:table(), key .. ": a map with a journal", whole:table())
  local cells = #plain.rows * #plain.cells[1]
  ok(whole.journal.run == cells and whole.journal.found == 0 and plain.journal == nil, key .. ": all cells were run")
  local again = dm.stability(copy(options, { journal = file, threads = 1 }))
  ok(again:csv() == plain:csv() and again:table() == plain:table() and again.journal.found == cells, key .. ": all were read")
  local bytes = text(file)
  text(file, bytes:sub(1, #bytes // 2))
  again = dm.stability(copy(options, { journal = file }))
  ok(again:csv() == plain:csv() and again:table() == plain:table() and again.journal.found + again.journal.run == cells
    and again.journal.run > 0, key .. ": the rest after a cut", again.journal.run)
  run(("--join '%s' '%s'"):format(name "joined", file))
  local joined = text(name "joined")
  text(name "map.lua", ("local dm = require 'dm'\nlocal o = %s\no.journal = 'm.journal'\nlocal m = dm.stability(o)\n"
    .. "print('whole', m.journal.found, m.journal.run)\n"):format(MAPS[key]))
  for _, n in ipairs { 2, 5 } do
    os.execute(("rm -f '%s'/m.journal*"):format(folder))
    for k = n, 1, -1 do
      local out, status = run(("--part %d/%d map.lua"):format(k, n))
      ok(status == 0 and (k == 1 or not out:find "whole"), ("%s: part %d/%d"):format(key, k, n), out)
    end
    run "--join parts m.journal.*"
    ok(text(name "parts") == joined, ("%s: %d parts joined are the bytes of one process"):format(key, n))
  end
end

local options, file = map_of "springs", name "springs.one"
local kept = text(file)
for what, other in pairs {
  ["axis h"] = { h = { 0.05, 2.5, 18, "log" } },
  ["rules"] = { rules = { "verlet", "trapezoidal" } },
  ["t"] = { t = 31 },
  ["q"] = { q = { 1.1 } },
  ["system"] = { system = function(k)
    return dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - k*q[1]^2/2 - q[1]^4/5 end }
  end },
} do
  local fine, why = pcall(dm.stability, copy(options, { journal = file }, other) and copy(options, copy(other, { journal = file })))
  local named = tostring(why):find(what .. " was", 1, true) or what == "axis h" and tostring(why):find("members was", 1, true)
  ok(not fine and named, "a map with another " .. what .. " is refused", why)
end
raises("another cell 1", dm.stability, copy(options, { journal = file, q = { 1 }, v = { 0 }, watch = nil,
  system = options.system, observe = { x = function(q) return q[1] ^ 3 end } }) and (function()
  local before = map_of "params"
  before.q = function(e) return { 0.2, e } end
  before.journal = name "params.one"
  return before
end)())
ok(text(file) == kept, "the files are as they were")
raises("'seconds' or 'journal'", dm.stability, copy(options, { journal = file, seconds = 1 }))
raises("journal", dm.stability, copy(options, { journal = 3 }))
raises("no cell has a start", dm.stability, { system = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 2 / 2 + math.log(q[1]) end }, rule = "midpoint", q = { -1 }, v = { 0 }, steps = 5, h = { 0.1, 1, 4, "linear" },
  journal = name "none" })
local data = dm.load(file)
ok(#data.member == 170 and data.k[170] == 30 and data.h[2] > data.h[1] and data.steps[1] == 600, "dm.load of a map", table.concat(data.columns, " "))
ok(tostring(dm.journal(file)):find "stability of 170 members, 170 finished", "dm.journal of a map")

---- charts: measured once, never split ----

local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
local chart_of = { q = { 1 }, v = { 0 }, t = 10, rules = { "verlet", "gauss(2)" }, h = { 0.2, 0.1, 0.05 }, repeats = 1, journal = name "c" }
local first = pendulum:chart(chart_of)
local again = pendulum:chart(chart_of)
ok(first:csv() == again:csv() and first:table() == again:table(), "a chart is read, times and all")
ok(first.journal.run == 10 and again.journal.found == 10 and again.journal.run == 0, "no point is measured again", again.journal.run)
local bytes = text(name "c")
text(name "c", bytes:sub(1, -40))
local rest = pendulum:chart(chart_of)
ok(rest.journal.run > 0 and rest.journal.found > 0 and rest.floor == first.floor, "the rest is", rest.journal.run)
for k, p in ipairs(first.points) do
  local x = rest.points[k]
  if not (x.rule == p.rule and x.h == p.h and x.error == p.error and x.steps == p.steps) then ok(false, "point " .. k) end
end
local blind = copy(chart_of, { h = false, journal = name "found" })
blind.h = nil
ok(#pendulum:chart(blind).points == #pendulum:chart(blind).points and #pendulum:chart(blind).options.h == 7, "steps that are found are kept")
local function watched(power)
  return copy(chart_of, { journal = name "w", error = function(q) return q[1] ^ power end })
end
pendulum:chart(copy(chart_of, { journal = name "w", error = function(q) return q[1] ^ 2 end }))
raises("error was", pendulum.chart, pendulum, copy(chart_of, { journal = name "w", error = function(q) return q[1] ^ 3 end }))
ok(watched(2).error ~= nil, "a function")
raises("h was", pendulum.chart, pendulum, copy(chart_of, { h = { 0.2, 0.1, 0.04 } }))
raises("'seconds' or 'journal'", pendulum.chart, pendulum, copy(chart_of, { seconds = 3 }))
text(name "chart.lua", [[
local dm = require "dm"
local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
local c = s:chart { q = { 1 }, v = { 0 }, t = 10, rules = { "verlet" }, h = { 0.2, 0.1 }, repeats = 1, journal = "p.chart" }
print("chart", c.journal.found, c.journal.run, #c.points)
]])
local out, status = run "--part 2/3 chart.lua"
ok(status == 0 and not out:find "chart\t" and out:find "part 2/3", "a part that is not the first measures nothing", out)
out, status = run "--part 1/3 chart.lua"
ok(status == 0 and out:find "chart\t0\t5\t2", "the first one all", out)
out = run "--part 3/3 chart.lua"
ok(out:find "chart\t5\t0\t2", "then the others read it", out)
out = run "chart.lua"
ok(out:find "chart\t5\t0\t2", "and the call without --part", out)

---- ranks ----

local MPI = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 300 mpirun -n 3 --oversubscribe"
local there = os.execute("command -v mpirun >/dev/null 2>&1 && " .. MPI .. " true >/dev/null 2>&1")
if there and io.open((dmlua:gsub("[^/]*$", "dm/mpi.so"))) then
  text(name "ranks.lua", ([[
local dm, mpi = require "dm", require "dm.mpi"
local o = %s
o.journal = "r.journal"
local m = dm.stability(o)
o.journal = nil
local bare = dm.stability(o)
local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
local e = s:solver { rule = "verlet", h = 0.1 }:ensemble { members = 900, q = function(i) return { i/300 } end, v = function() return { 0 } end, steps = 20, every = 5 }
local c = s:chart { q = { 1 }, v = { 0 }, t = 10, rules = { "verlet" }, h = { 0.2, 0.1 }, repeats = 1 }
local inner = mpi.map(function(i) -- each rank's own: not shared out
  return s:solver { rule = "verlet", h = 0.1 }:ensemble { members = 80 + i, q = function(k) return { k/300 } end, v = function() return { 0 } end, steps = 20 }.q[80][1]
end, 7)
local here = { m:csv(), bare:csv(), e.q[900][1], e:path(450).q[3][1], c:csv(), inner[7] }
local all = mpi.gather(here)
if mpi.rank == 0 then
  local same = m:csv() == bare:csv() and e.journal == nil and c.journal == nil
  for r = 2, mpi.size do for k = 1, #here do same = same and all[r][k] == here[k] end end
  print("ranks", same, here[3], here[4], inner[7] == inner[1])
end
]]):format(MAPS.springs))
  os.execute(("rm -f '%s'/r.journal*"):format(folder))
  local said, ended = run("-l dm.mpi ranks.lua", MPI)
  local e = pendulum:solver { rule = "verlet", h = 0.1 }:ensemble { members = 900, q = function(i) return { i / 300 } end,
    v = function() return { 0 } end, steps = 20, every = 5 }
  ok(ended == 0 and said:find(("ranks\ttrue\t%s\t%s\ttrue"):format(e.q[900][1], e:path(450).q[3][1]), 1, true),
    "maps, ensembles without a journal and charts of three ranks: the same everywhere", said)
  run "--join joined r.journal"
  run(("--join one '%s'"):format(file))
  ok(text(name "joined") == text(name "one"), "the journal of ranks has the bytes of one process")
else
  print "# skipped: ranks (make mpi, openmpi-bin)"
end

-- two rules of a user that print alike
local function mine(k)
  return dm.step { name = "mine", unknowns = 1, order = 1, start = function(y) return { y.q[1] } end,
    equation = function(y, x, h) return { x[1] - y.q[1] - k * h * y.p[1] } end,
    next = function(y, x, h) return { q = { x[1] }, p = { y.p[1] - h * x[1] } } end }
end
local spring = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 end }
local function charted(k)
  return dm.chart { spring, q = { 1 }, v = { 0 }, t = 2, rules = { "verlet", mine(k) }, h = { 0.2, 0.1 }, repeats = 1,
    rivals = false, journal = folder .. "/mine.chart" }
end
local function mapped(k)
  return dm.stability { system = spring, q = { 1 }, v = { 0 }, steps = 200, rules = { "verlet", mine(k) }, h = { 0.2, 0.3 },
    journal = folder .. "/mine.map" }
end
charted(1)
mapped(1)
ok(#charted(1).points == 4, "a chart of the same rule of a user is there", #charted(1).points)
ok(mapped(1), "so is a map")
raises("mine.chart", charted, 2)
raises("its rule gave something else", mapped, 2)

-- starts that are vectors, and elements of groups: the same one goes on, one with another last digit does not
local body = dm.system { Q = dm.SO(3), L = function(R, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 - R[3][3] end }
local function turned(x)
  return body:stability { q = dm.SO(3):exp { 0.1, x, 0 }, v = dm.vector { 0.1, 0.2, x }, steps = 200, rule = "lie(1)", h = { 0.1, 0.2, 2 },
    journal = name "turned.map" }
end
local function swung(x)
  return dm.chart { spring, q = dm.vector { x }, v = dm.vector { 0 }, t = 2, rules = { "verlet" }, h = { 0.1, 0.2 }, repeats = 1, rivals = false,
    journal = name "swung.chart" }
end
for _, case in ipairs { { turned }, { swung } } do
  case[1](1)
  ok(case[1](1).journal.run == 0, "all is found again")
  raises("the journal of another sweep", case[1], 1 + 2 ^ -52)
end

os.execute(("rm -rf '%s'"):format(folder))
tap.done()
