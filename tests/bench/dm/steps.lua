-- dmlua tests/bench/dm/steps.lua [FILE]: ns per step with Lua-written models; the implicit runs are
-- compared with the end states that the C program left in FILE.
local dm = require "dm"
local sin, cos, sqrt = math.sin, math.cos, math.sqrt

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

local J2 = 0.05
local models = {
  { "J2 satellite", h = 0.05, q = { 1.1, 0, 0.1 }, v = { 0, 0.95, 0.2 }, Q = dm.R(3), L = function(q, v)
    local r = q:norm()
    return v:dot(v) / 2 + 1 / r - J2 / (2 * r ^ 3) * (3 * q[3] ^ 2 / r ^ 2 - 1)
  end },
  { "double spherical pendulum", h = 0.01, q = { 1, 0, 0.7, 0.4 }, v = { 0, 1.5, 0, 2 }, Q = dm.R(4), L = function(q, v)
    local function velocity(a, b, da, db)
      return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
    end
    local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
    local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
    local T = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
    return T + 9.81 * (2 * cos(q[1]) + cos(q[3]))
  end },
  { "three bodies", h = 0.01, q = { 0.97000436, -0.24308753, 0, -0.97000436, 0.24308753, 0, 0, 0, 0 },
    v = { 0.466203685, 0.43236573, 0, 0.466203685, 0.43236573, 0, -0.93240737, -0.86473146, 0 }, Q = dm.R(9),
    L = function(q, v)
      local L = v:dot(v) / 2
      for i = 4, 7, 3 do
        for j = 1, i - 1, 3 do
          L = L + 1 / sqrt((q[i] - q[j]) ^ 2 + (q[i + 1] - q[j + 1]) ^ 2 + (q[i + 2] - q[j + 2]) ^ 2)
        end
      end
      return L
    end },
}

models[#models + 1] = { "spherical pendulum in space", h = 0.02, q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, Q = dm.R(3),
  L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end }

models[#models + 1] = { "double spherical pendulum in space", h = 0.01, q = { 0.6, 0, -0.8, 0.6, 0.6, -1.6 },
  v = { 0, 1, 0, 1, 1, 0 }, Q = dm.R(6), L = function(q, v) return v:dot(v) / 2 - 9.81 * (q[3] + q[6]) end,
  constraint = function(q)
    local x, y = dm.vector { q[1], q[2], q[3] }, dm.vector { q[4] - q[1], q[5] - q[2], q[6] - q[3] }
    return { x:dot(x) - 1, y:dot(y) - 1 }
  end }

-- end states of the hand-written C
local ends = {}
if arg[1] then
  for text in io.lines(arg[1]) do
    local row = {}
    for field in text:gmatch "[^\t]+" do row[#row + 1] = tonumber(field) or field end
    ends[row[1]] = row
  end
end

for _, model in ipairs(models) do
  local system = dm.system { Q = model.Q, L = model.L, constraint = model.constraint }
  local midpoint, count = system:solver { rule = "midpoint", h = model.h }, 20000
  local ns = best(function() midpoint:run { q = model.q, v = model.v, steps = count, every = count } end) / count
  local report = midpoint:report()
  line("midpoint, " .. model[1], "midpoint, " .. report.backend, ns, report.newton_per_step)
  local worst = 0
  local path = midpoint:run { q = model.q, v = model.v, steps = 500, every = 500 }
  for i = 1, #model.q do
    worst = math.max(worst, math.abs(path.q[#path][i] - (ends[model[1]] or {})[i + 1] or 0))
  end
  io.stderr:write(("%s: after 500 steps %.1e from the C program's state\n"):format(model[1], worst))
  assert(worst < 1e-9, "dmlua and the hand-written C step different equations")
end

-- the double spherical pendulum in R^6, two constraints
local double = dm.system { Q = dm.R(6), L = function(q, v) return v:dot(v) / 2 - 9.81 * (q[3] + q[6]) end,
  constraint = function(q)
    local x, y, z = q[4] - q[1], q[5] - q[2], q[6] - q[3]
    return { (q[1] ^ 2 + q[2] ^ 2 + q[3] ^ 2 - 1) / 2, (x ^ 2 + y ^ 2 + z ^ 2 - 1) / 2 }
  end }
local q, v, count = { 0.6, 0, -0.8, 0.6, 0.6, -1.6 }, { 0, 1, 0, 0.5, 1, 0 }, 50000
local rattle = double:solver { rule = "rattle", h = 0.01 }
local ns = best(function() rattle:run { q = q, v = v, steps = count, every = count } end) / count
line("rattle, double spherical pendulum in R^6", "rattle, " .. rattle:report().backend, ns, rattle:report().newton_per_step)
local path, worst = rattle:run { q = q, v = v, steps = 500, every = 500 }, 0
for i = 1, ends.rattle and 6 or 0 do worst = math.max(worst, math.abs(path.q[#path][i] - ends.rattle[i + 1])) end
io.stderr:write(("rattle: after 500 steps %.1e from the C program's state\n"):format(worst))
assert(worst < 1e-9, "dmlua and the hand-written C step different equations")
