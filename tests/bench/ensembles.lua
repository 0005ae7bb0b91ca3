-- dmlua tests/bench/ensembles.lua: ns a step of a member of an ensemble on one core, beside a step of a run alone; best of a few runs that
-- take turns. Members start a little apart, so that their iterations differ as they do in use. Last: what starting and ending a member costs.
local dm = require "dm"
local sin, cos = math.sin, math.cos
local MEMBERS, STEPS, ALONE, TURNS = 4096, 400, 20000, 5

local function velocity(a, b, da, db)
  return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
end
local models = {
  { "J2 satellite", h = 0.05, q = { 1.1, 0, 0.1 }, v = { 0, 0.95, 0.2 }, rules = { "midpoint", "gauss(3)", "lobatto(3)" }, L = function(q, v)
    local r = q:norm()
    return v:dot(v) / 2 + 1 / r - 0.05 / (2 * r ^ 3) * (3 * q[3] ^ 2 / r ^ 2 - 1)
  end },
  { "double spherical pendulum", h = 0.01, q = { 1, 0, 0.7, 0.4 }, v = { 0, 1.5, 0, 2 },
    rules = { "midpoint", "trapezoidal", "lobatto(3)", "gauss(2)" }, L = function(q, v)
    local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
    local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
    local T = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
    return T + 9.81 * (2 * cos(q[1]) + cos(q[3]))
  end },
  { "Kepler", h = 0.05, q = { 0.4, 0 }, v = { 0, 2 }, rules = { "midpoint", "gauss(3)", "gauss(6)", "verlet", "symplectic-euler", "blanes-moan(6)" },
    L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end },
  { "chain of 12, magnetic field", h = 0.8, q = {}, v = {}, rules = { "midpoint", "lobatto(3)" }, L = function(x, u)
    local L = u:dot(u) / 2 - x[1] ^ 2 / 2 - x[12] ^ 2 / 2
    for i = 1, 11 do L = L - (x[i + 1] - x[i]) ^ 2 / 2 end
    for i = 1, 11, 2 do L = L + 0.3 * (x[i] * u[i + 1] - x[i + 1] * u[i]) end
    return L
  end },
}
for i = 1, 12 do models[4].q[i], models[4].v[i] = 0.1 * sin(i * i), 0 end

local function seconds(f)
  local t = os.clock()
  f()
  return os.clock() - t
end

local only, turns, steps = arg[1], tonumber(arg[2]), tonumber(arg[3]) -- turns: to count instructions, of small ensembles
if turns then MEMBERS, STEPS, ALONE, TURNS = steps and 64 or 16, steps or 200, steps or 1000, turns end
print "model                      rule              alone ns  member ns  ratio  lanes"
for _, model in ipairs(models) do
  local q, v = {}, {}
  for i = 1, MEMBERS do
    q[i], v[i] = { table.unpack(model.q) }, model.v
    q[i][1] = q[i][1] + 0.1 * i / MEMBERS
  end
  q, v = dm.matrix(q), dm.matrix(v)
  for _, rule in ipairs(model.rules) do
    local solver = dm.system({ Q = dm.R(#model.q), L = model.L }):solver { rule = rule, h = model.h }
    local alone, member, lanes = math.huge, math.huge, 0
    for _ = 1, (not only or only == model[1] .. " " .. rule) and TURNS or 0 do
      alone = math.min(alone, seconds(function() solver:run { q = model.q, v = model.v, steps = ALONE, every = ALONE } end) / ALONE)
      member = math.min(member, seconds(function()
        lanes = solver:ensemble({ members = MEMBERS, q = q, v = v, steps = STEPS, threads = 1 }).lanes
      end) / (MEMBERS * STEPS))
    end
    if lanes > 0 then
      print(("%-26s %-16s %9.1f  %9.2f  %5.2f  %5d"):format(model[1], rule, alone * 1e9, member * 1e9, member / alone, lanes))
    end
  end
end

if not only or only == "start" then
  local solver = dm.system({ Q = dm.R(2), L = models[3].L }):solver { rule = "verlet", h = 0.01 }
  local q, v, least = {}, {}, math.huge
  for i = 1, 16 * MEMBERS do q[i], v[i] = { 0.4 + 1e-6 * i, 0 }, { 0, 2 } end
  q, v = dm.matrix(q), dm.matrix(v)
  for _ = 1, 3 * TURNS do
    least = math.min(least, seconds(function() solver:ensemble { members = #q, q = q, v = v, steps = 1, threads = 1 } end) / #q)
  end
  print(("%-26s %-12s %9s  %9.1f"):format("start, one step, end", "verlet", "", least * 1e9))
end
