-- lines whose L reads upvalues or params that change after solvers were made: runs follow them
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, pi = math.sin, math.pi

local k = 1
local function of(stiffness, more)
  local options = { x = { 0, 1, 20 }, fixed = "ends",
    L = function(_, ut, ux) return ut ^ 2 / 2 - stiffness() * ux ^ 2 / 2 end }
  for key, x in pairs(more or {}) do options[key] = x end
  return dm.field(options)
end
local start = { u = function(x) return sin(pi * x) + 0.2 * x * (1 - x) end,
  ut = function(x) return x * (1 - x) end, steps = 6 }

local function same(a, b) return a.u == b.u and a.p == b.p and a.energy == b.energy end

for _, free in ipairs { "none", "t", "x" } do
  for _, rule in ipairs { "cell(gauss(2))", "cell(corners)" } do
    local options = { rule = rule, h = 0.01, free = free ~= "none" and free or nil }
    local params = { k = 1 }
    local by_upvalue = of(function() return k end):solver(options)
    local by_params = dm.field { x = { 0, 1, 20 }, fixed = "ends", params = params,
      L = function(_, ut, ux, _, _, p) return ut ^ 2 / 2 - p.k * ux ^ 2 / 2 end }:solver(options)
    k = 1
    local before = by_upvalue:run(start)
    by_params:run(start)
    k, params.k = 2.5, 2.5
    local fresh = of(function() return 2.5 end):solver(options):run(start)
    local name = rule .. ", free " .. free
    ok(same(by_upvalue:run(start), fresh), name .. ": a changed upvalue, bits of a new field")
    ok(same(by_params:run(start), fresh), name .. ": a changed parameter")
    k = 1
    ok(same(by_upvalue:run(start), before), name .. ": and back")
  end
end

-- a linear wave of speed sqrt(k) over a cell a slab is exact on the diamond of its nodes
k = 1
local exact = of(function() return k end):solver { rule = "cell(corners)", h = 0.025 }
exact:run(start)
k = 4
local run = exact:run { u = function(x) return sin(pi * x) end, steps = 20 }
local most = 0
for i = 1, 21 do most = math.max(most, math.abs(run.u[21][i] + sin(pi * (i - 1) / 20))) end
ok(most < 1e-12, "speed 2: half a period at t = 1/2 turns the sign", most)

-- a solver that was resumed, and one whose L has another shape now
k = 1
local field = of(function() return k end)
local first = field:solver { h = 0.01 }:run(start)
local going = field:resume(first)
ok(same(going:run { steps = 3 }, field:resume(first):run { steps = 3 }), "resumed twice, same bits")
local power = 2
local shaped = dm.field { x = { 0, 1, 20, periodic = true },
  L = function(u, ut, ux) return ut ^ 2 / 2 - ux ^ 2 / 2 - (power == 2 and u ^ 2 or u ^ 4) end }
local solver = shaped:solver { h = 0.01 }
solver:run(start)
power = 4
local quartic = dm.field { x = { 0, 1, 20, periodic = true },
  L = function(u, ut, ux) return ut ^ 2 / 2 - ux ^ 2 / 2 - u ^ 4 end }
ok(same(solver:run(start), quartic:solver { h = 0.01 }:run(start)), "another branch of L")

-- laws are those of the L of the run
k = 1
local kept = of(function() return k end):solver { h = 0.01 }:run(start)
local form, time = kept:multisymplectic(), kept:conservation "t"
kept:conservation "x"
k = 2
ok(kept:multisymplectic() == form and kept:conservation "t" == time, "laws of the run that was")
raises("not that of the run any more", function() kept:conservation "x" end)

-- a speed that is lost
local mass = 1
local heavy = dm.field { x = { 0, 1, 20 }, fixed = "ends",
  L = function(_, ut, ux) return mass * ut ^ 2 / 2 - ux ^ 2 / 2 end }
local moved = heavy:solver { h = 0.01 }
moved:run(start)
mass = 0
raises("does not depend on ut", function() moved:run(start) end)
raises("does not depend on ut", function() heavy:solver { h = 0.01, free = "x" }:run(start) end)

-- boxes
local c = 1
local function boxes(f) return dm.multisymplectic { M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, names = { "u", "v", "w" }, x = { 0, 2 * pi, 21, periodic = true },
  S = function(z) return f() * (1 - math.cos(z[1])) + z[2] ^ 2 / 2 - z[3] ^ 2 / 2 end } end
local box = boxes(function() return c end):solver { h = 0.05 }
local z = { u = function(x) return sin(x) end, v = function() return 0 end }
local old = box:run { z = z, steps = 5 }
local form_law = old:balance "multisymplectic"
c = 3
ok(old:balance "multisymplectic" == form_law, "the form formula of the run that was")
raises("not that of the run any more", function() old:balance "energy" end)
raises("not that of the run any more", function() old:column "energy" end)
ok(box:run { z = z, steps = 5 }.u == boxes(function() return 3 end):solver { h = 0.05 }:run { z = z, steps = 5 }.u,
  "boxes")

-- S that determines a constant now, which was a gauge mode: u_t = v_x, v_t = u_x - k int u
local hold = 0
local gauged = dm.multisymplectic { M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, names = { "u", "v", "w" }, x = { 0, 1, 9, periodic = true },
  S = function(y) return hold * y[1] ^ 2 / 2 + y[2] ^ 2 / 2 - y[3] ^ 2 / 2 end }
local loose = gauged:solver { h = 0.1 }
loose:run { z = { u = function() return 1 end, v = function() return 0 end }, steps = 2 }
hold = 1
local oscillates = loose:run { z = { u = function() return 1 end, v = function() return 0 end }, steps = 10 }
-- u'' = -u by the midpoint rule: the angle of a step is 2 atan(h/2)
ok(math.abs(oscillates.u[11][4] - math.cos(20 * math.atan(0.05))) < 1e-13, "a constant that moves now")

-- what a run goes on with is what it was made with, not what it was when it was saved
local file = os.tmpname()
local ring = dm.multisymplectic { x = { 0, 1, 21, periodic = true }, names = { "u", "v", "w" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + k * z[1] ^ 2 / 2 end }
local function wave(x) return sin(2 * pi * x) end
for _, case in ipairs { { "L", of(function() return k end), start, {} }, { "L", of(function() return k end), start, { free = "x" } },
  { "L", of(function() return k end), start, { free = "t" } }, { "S", ring, { z = { u = wave, v = wave }, steps = 3 }, {} } } do
  local what, model = case[1] .. " was", case[2]
  case[4].h = 0.01
  k = 1
  local made = model:solver(case[4]):run(case[3])
  k = 2
  made:checkpoint(file)
  raises(what, function() model:resume(file) end)
  raises(what, function() model:resume(made) end)
  k = 1
  local one, two = model:resume(file), model:resume(made)
  local a, b = one:run { steps = 2 }, two:run { steps = 2 }
  ok((a.u[3] or a.z[3]) == (b.u[3] or b.z[3]), case[1] .. ": goes on with what it was")
  k = 3
  raises(what, function() one:run { steps = 2 } end)
end
os.remove(file)
tap.done()
