-- dmlua tests/bench/dm/steps.lua [FILE]: ns per step with Lua-written models; the implicit runs are
-- compared with the end states that the C program left in FILE.
local dm = require "dm"

local function best(f)
  local least = math.huge
  for _ = 1, 9 do
    local t = os.clock()
    f()
    least = math.min(least, os.clock() - t)
  end
  return least * 1e9
end

local function line(what, method, ns, newton) print(("step\tdmlua\t%s\t%s\t%.3f\t%.2f"):format(what, method, ns, newton or 0)) end

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local solver, steps = kepler:solver { rule = "verlet", h = 0.01 }, 2000000
line("leapfrog, one Kepler orbit", "verlet",
  best(function() solver:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = steps, every = steps } end) / steps)
if solver.ensemble then
  local members, count = 4096, 1000
  local q, v = {}, {}
  for i = 1, members do q[i], v[i] = { 0.4 + i * 1e-5, 0 }, { 0, 2 } end
  q, v = dm.matrix(q), dm.matrix(v)
  line("leapfrog, ensemble of Kepler orbits", "verlet, 4096 members",
    best(function() solver:ensemble { members = members, q = q, v = v, steps = count, threads = 1 } end) / (members * count))
  local plain = kepler:solver { rule = "verlet", h = 0.01, sums = "plain" }
  line("leapfrog, ensemble of Kepler orbits", "the same, plain sums",
    best(function() plain:ensemble { members = members, q = q, v = v, steps = count, threads = 1 } end) / (members * count))
else
  io.stderr:write "skipped  ensemble: solver:ensemble is not there\n"
end

-- heavy tops: rotations in lanes, the natural chart by its row and by a table of Lua functions
local G = dm.SO(3)
local top = dm.system { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end }
local tilted = G:exp { 0.4, 0, 0 }
do
  local members, count, turns = 4096, 400, top:solver { rule = "rotations(2)", h = 0.05 }
  local function many(n)
    return best(function()
      turns:ensemble { members = members, q = function() return tilted end, p = function(i) return { 0.2, 0.1, 1.5 + 1e-5 * i } end, steps = n, threads = 1 }
    end)
  end
  line("rotations(2), ensemble of heavy tops", "rotations(2), 4096 members", (many(count) - many(0)) / (members * count))
  for _, rule in ipairs { "rotations(2)", "lie(1)", "lie(2)", "gauss(2)", "gauss(8)" } do
    local one, n = top:solver { rule = rule, h = 0.05 }, 20000
    line("heavy top", rule, best(function() one:run { q = tilted, p = { 0.2, 0.1, 1.5 }, steps = n, every = n } end) / n, one:report().newton_per_step)
  end
end

-- end states of the hand-written C
local ends = {}
if arg[1] then
  for text in io.lines(arg[1]) do
    local row = {}
    for field in text:gmatch "[^\t]+" do row[#row + 1] = tonumber(field) or field end
    ends[row[1]] = row
  end
end

for _, model in ipairs(dofile "tests/bench/dm/step_models.lua") do
  local rule = model.rule or "midpoint"
  local one, count, known = model.system:solver { rule = rule, h = model.h }, 20000, ends[model.key]
  local ns = best(function() one:run { q = model.q, v = model.v, steps = count, every = count } end) / count
  local report = one:report()
  line(("%s, %s"):format(rule, model.key), ("%s, %s"):format(rule, report.backend), ns, report.newton_per_step)
  local path, worst = one:run { q = model.q, v = model.v, steps = 500, every = 500 }, 0
  for i = 1, known and #model.q or 0 do worst = math.max(worst, math.abs(path.q[#path][i] - known[i + 1])) end
  io.stderr:write(("%s: after 500 steps %.1e from the C program's state\n"):format(model.key, worst))
  assert(worst < 1e-9, "dmlua and the hand-written C step different equations")
end
