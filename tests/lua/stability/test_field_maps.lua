-- dm.stability of fields on meshes and on lines: maps over the step and the size, limits beside closed forms
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, pi = math.sqrt, math.pi

---- meshes ----

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end

-- edges of a hexagonal torus of size n are 1/n long: Laplacian of degree 0 up to 6 n^2, so Verlet up to 2/(n sqrt(6))
local base = { system = function(n) return dm.mesh { hex_torus = n }:field { form = 0, L = wave } end, n = { 3, 6 }, rules = { "verlet", "midpoint" },
  h = { 0.02, 1, 9, "log" }, steps = 600,
  q = function(n) local q = {} for i = 1, n * n do q[i] = math.sin(i * i) end return q end,
  v = function(n) local v = {} for i = 1, n * n do v[i] = 0 end return v end }
local map = dm.stability(base)
for _, n in ipairs(map.n) do
  local exact = map.system_of { values = { n = n } }:stability_limit "verlet"
  near(map:theory { rule = "verlet", n = n }, exact, 1e-5 * exact, ("size %d: the CFL limit of a map is that of the field"):format(n))
  near(map:limit { rule = "verlet", n = n }, exact, 2e-3 * exact, ("size %d: and so is what is measured"):format(n))
  ok(map:limit { rule = "midpoint", n = n } == math.huge and map:theory { rule = "midpoint", n = n } == math.huge, "midpoint has none")
  ok(math.type(n) == "integer", "sizes stay whole numbers")
end
near(map:theory { rule = "verlet", n = 6 }, 2 / (6 * sqrt(6)), 1e-6, "closed form")
ok(map:limit { rule = "verlet", n = 3 } > 1.9 * map:limit { rule = "verlet", n = 6 }, "the limit falls with the size")

-- a nonlinear field: the largest frequency along the orbit; starts as functions of the position
local K = dm.mesh { triangle = 4 }
local quartic = K:field { form = 0, fixed = "boundary", L = function(u, v)
  return wave(u, v) - K:sum(0, function(a, cell) return cell.star * 50 * a ^ 4 end, u) end }
local orbit = dm.stability { quartic, rule = "verlet", h = { 0.02, 0.4, 9, "log" }, steps = 400, q = function(x, y) return y * (sqrt(3) * x - y) * (sqrt(3) * (1 - x) - y) end,
  v = function() return 0 end }
ok(orbit:theory(1) < quartic:stability_limit "verlet" and orbit:theory(1) > 0.8 * quartic:stability_limit "verlet", "less than about 0, where the force is weaker")
local _, told = orbit:theory(1)
ok(told:find "largest along the orbit", "and said to be along the orbit", told)
ok(#orbit:resonances(1) >= 1, "resonances of the fastest oscillation")

-- a column of sizes at one step: refined by ones
local column = dm.stability { system = base.system, n = { 3, 8, 16 }, q = base.q, v = base.v, rule = "verlet", h = 0.1, steps = 600 }
local last = 0
for n = 3, 16 do if dm.mesh { hex_torus = n }:field { form = 0, L = wave }:stability_limit "verlet" > 0.1 then last = n end end
near(column:limit(1), last, 0, "the largest size at this step, a whole number")

-- all values of a field are observed, whatever its size, beside the range of the one that changes most
local function membrane(N) return dm.mesh { triangle = N }:field { form = 0, fixed = "boundary", L = wave } end
local function bump(x, y) return y * (sqrt(3) * x - y) * (sqrt(3) * (1 - x) - y) end
local sizes = dm.stability { system = membrane, N = { 4, 8 }, h = { 0.05, 0.08 }, rule = "verlet", t = 0.5, q = bump, v = function() return 0 end, refine = false }
for i, N in ipairs { 4, 8 } do
  local fine, rough = membrane(N):solver { rule = "verlet", h = 0.001 }, membrane(N):solver { rule = "verlet", h = 0.08 }
  local function run(solver) return solver:run { q = bump, v = function() return 0 end, t = 0.5, every = solver.h < 0.01 and 80 or 1 } end
  fine, rough = run(fine), run(rough)
  local range, off = 0, 0
  for k = 1, #fine.q[1] do
    local low, high = math.huge, -math.huge
    for r = 1, #fine do low, high = math.min(low, fine.q[r][k]), math.max(high, fine.q[r][k]) end
    range = math.max(range, high - low)
    for r = 1, 6 do off = math.max(off, math.abs(fine.q[r][k] - rough.q[r][k])) end
  end
  local cell = sizes:at(i, 2)
  near(cell.range, range, 0.02 * range, "range of all values")
  ok(cell.off > 0.95 * off and (cell.class == "wrong") == (cell.off > 0.01 * cell.range), "off as a run of small steps says", cell.off / off)
end

---- lines ----

local function linear(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function ring(cells) return dm.field { x = { 0, 1, cells, periodic = true }, L = linear } end
map = dm.stability { system = ring, N = { 12, 24 }, u = function(x) return math.cos(2 * pi * x) + math.exp(-50 * (x - 0.5) ^ 2) end, rules = { "cell(gauss(2))", "cell(corners)" },
  h = { 0.01, 0.2, 9, "log" }, steps = 300 }
for i, row in ipairs(map.rows) do
  near(map:theory(i), 1 / row.values.N, 1e-6, ("%s, %d cells: lambda = 1"):format(row.rule, row.values.N))
  near(map:limit(i), 1 / row.values.N, 3e-3 / row.values.N, "and measured")
end
ok(map:at({ N = 12, rule = "cell(corners)" }, 0.2).class == "blow-up" and map:at({ N = 12, rule = "cell(corners)" }, 0.01).class == "bounded", "classes")
local kink = dm.field { x = { -15, 15, 60 }, fixed = "ends", L = function(u, ut, ux) return linear(u, ut, ux) - (1 - dm.cos(u)) end }
map = dm.stability { kink, u = function(x) return 4 * math.atan(math.exp(x)) end, rule = "cell(gauss(2))", h = { 0.1, 1, 9, "log" }, t = 40 }
ok(map:limit(1) > 0.48 and map:limit(1) < 0.51, "a kink, over a duration", map:limit(1))
-- ends that absorb, and L with t: the size of the field is watched in place of the energy
local open = dm.field { x = { 0, 1, 20 }, absorbing = "ends", L = linear }
map = dm.stability { open, u = function(x) return math.exp(-50 * (x - 0.5) ^ 2) end, rule = "cell(gauss(2))", h = { 0.01, 0.2, 9, "log" }, steps = 400 }
near(map:limit(1), 0.05, 2e-3, "absorbing ends take the energy away; the limit stays")

raises("steps of its own in every cell", function() dm.stability { quartic, rule = "avi", h = 0.1, steps = 10, q = function() return 0 end, v = function() return 0 end } end)
raises("not both", function() dm.stability { kink, u = 0, q = 0, rule = "cell(corners)", h = 0.1, steps = 10 } end)
raises("on a line", function() dm.stability { kink, u = 0, rule = "verlet", h = 0.1, steps = 10 } end)
raises("must be finite", function() dm.stability { kink, u = function() return 0 / 0 end, rule = "cell(corners)", h = 0.1, steps = 10 } end)
raises("must return a dm.system", function() dm.stability { system = function(N) return N end, N = { 2, 3 }, q = 0, v = 0, rule = "verlet", h = 0.1, steps = 10 } end)
---- lines beside the field that they are cells of ----

-- a kink beside its closed form: how far off a cell is, and where its mesh is too coarse
local g = 1 / math.sqrt(0.75)
local function of_kink(t) return function(x) return 4 * math.atan(math.exp(g * (x - t / 2))) end end
local function kinks(N) return dm.field { x = { -8, 8, N }, fixed = "ends", L = function(u, ut, ux) return linear(u, ut, ux) - (1 - dm.cos(u)) end } end
local map = dm.stability { system = kinks, N = { 32, 64 }, h = { 0.1, 0.2 }, rule = "cell(gauss(2))", t = 4, accuracy = 1e-3,
  u = of_kink(0), ut = function(x) return -g / dm.cosh(g * x) end, refine = false }
for i, N in ipairs { 32, 64 } do
  local run = kinks(N):solver { h = 0.1 }:run { u = of_kink(0), ut = function(x) return -g / dm.cosh(g * x) end, t = 4 }
  local off = 0
  for r = 1, #run do
    for k = 1, #run.nodes do off = math.max(off, math.abs(run.u[r][k] - of_kink(run.t[r])(run.nodes[k]))) end
  end
  local cell = map:at(i, 1)
  near(cell.off, off, 2e-2 * off, "off as the closed form says")
  ok(cell.class == (off > 1e-3 * cell.range and "wrong" or "bounded"), "class of the kink", cell.class)
end
ok(map:at(1, 1).class == "wrong" and map:at(2, 1).class == "bounded", "a mesh that is too coarse is wrong")
-- exact at h = dx; heights beside it are not
map = dm.stability { system = ring(24), rules = { "cell(gauss(2))", "cell(corners)" }, h = { 1 / 30, 1 / 24 }, t = 1,
  u = function(x) return math.cos(6 * math.pi * x) end, refine = false }
for i = 1, 2 do ok(map:at(i, 1).class == "wrong" and map:at(i, 2).class == "bounded" and map:at(i, 2).off < 1e-6, "exact at h = dx") end
-- a few steps of an oscillation are no blow-up; rest at 0 is right
local tight = dm.field { x = { 0, pi, 20 }, fixed = "ends", L = function(u, ut, ux) return linear(u, ut, ux) - u ^ 2 / 2 end }
map = dm.stability { system = tight, rule = "cell(gauss(2))", h = { 0.02, 0.1 }, t = 1, u = math.sin, refine = false }
for j = 1, 2 do ok(map:at(1, j).class == "bounded" and map:at(1, j).off < 1e-3, "the beginning of an oscillation", map:at(1, j).class) end
map = dm.stability { system = tight, rule = "cell(gauss(2))", h = 0.1, t = 1, u = 0, refine = false }
ok(map:at(1, 1).class == "bounded" and map:at(1, 1).off == 0, "rest")
-- several values, a parameter of L, a function that is observed
local pair = dm.field { x = { 0, 1, 20 }, fixed = "left", values = 2, params = { k = 1 },
  L = function(u, ut, ux, _, t, P) return (ut:dot(ut) - P.k * ux:dot(ux)) / 2 - u:dot(u) ^ 2 / 4 + dm.cos(t) * u[1] end }
map = dm.stability { system = pair, rule = "cell(gauss(2))", k = { 0.5, 1.5 }, h = { 0.01, 0.035 }, t = 1, refine = false,
  u = function(x) return { math.sin(math.pi * x / 2), 0 } end, observe = { "u1", last = function(u) return u[#u] end } }
ok(map:at(1, 1).off and map:at(2, 1).off, "two values")
map = dm.stability { system = open, rule = "cell(gauss(2))", h = 0.02, t = 1, u = dm.zeros(21), ut = 1, refine = false }
ok(map.notes[1]:find "a function of x has values on finer ones", "no flow of a list", map.notes[1])
raises("on lines observe u", function() dm.stability { system = open, rule = "cell(gauss(2))", h = 0.1, t = 1, u = 0, observe = "p1" } end)
-- resolved flows of fields with values on a sphere, with friction, with absorbing ends
local function waves(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local hoop, around = {}, {}
for i = 1, 12 do hoop[i], around[i] = { i, i % 12 + 1 }, { math.cos(pi * i / 6), math.sin(pi * i / 6) } end
local maps = dm.mesh { simplices = hoop, points = around }:field { values = 3, on = dm.S(2), L = waves }
local map = dm.stability { maps, rule = "rattle", h = { 0.1, 0.5 }, t = 3, q = function(x, y) return { x, y, 0 } end, v = function(x, y) return { -0.7 * y, 0.7 * x, 0 } end }
local limit, text = map:limit(1, "right")
near(limit, math.sqrt(0.01 * math.sqrt(3) / (0.7 ^ 3 / 6 * 3)), 0.03, "a wave map is ahead by (asin(h v)/h - v) t")
ok(text:find "^wrong from h = ", "beyond it the map is wrong", text)
ok(map:at(1, 2).class == "wrong" and map:at(1, 1).class == "bounded", "and looked at")
local plate = dm.mesh { triangle = 3 }
local function middle(x, y) return math.exp(-8 * ((x - 0.5) ^ 2 + (y - 0.3) ^ 2)) end
local function still() return 0 end
for what, options in pairs { friction = { fixed = "boundary", force = function(_, v) return -0.3 * v end }, absorbing = { absorbing = "boundary" } } do
  options.L = waves
  local field = plate:field(options)
  local lossy = dm.stability { field, rule = "verlet", h = { 0.01, 0.16 }, t = 2, q = middle, v = still }
  ok(lossy:at(1, 1).class == "bounded" and lossy:at(1, 2).class == "wrong", what .. ": what takes energy away is not lost", lossy:at(1, 1).why)
  ok(lossy:at(1, 1).why:find("size of the state", 1, true), "and told by the size of the state", lossy:at(1, 1).why)
  limit = lossy:limit(1, "right")
  ok(limit and limit > 0.01 and limit < 0.16, "with a resolved flow", limit)
end

-- params of a field on a mesh
local stiff = plate:field { fixed = "boundary", params = { k = 1 }, L = function(u, v, _, p) return waves(u, v) - p.k * u:dot(u) / 2 end }
local by_k = dm.stability { stiff, rule = "verlet", h = { 0.05, 0.3 }, k = { 1, 400 }, steps = 400, q = middle, v = still }
local square = (2 / stiff:stability_limit "verlet") ^ 2 - 1
for i, k in ipairs { 1, 400 } do near(by_k:theory(i), 2 / sqrt(square + k), 1e-9, "theory over a parameter of a field") end
near(by_k:limit(2), 2 / sqrt(square + 400), 1e-3, "and the map")

-- what rows say is said by one function, of members of ensembles and of runs on lines; numbers that are none too
local core = require "dm.core"
local s = core.summary({ 0, 1, 2, 3, 4, 5, 6, 7 }, { 2, 3, 1, 4, 4, 6, 5, 9 })
ok(s.first == 2 and s.last == 9 and s.least == 1 and s.largest == 9 and s.mean == 4.25, "first, last, least, largest, mean")
ok(s.early == 1 and s.late == 7 and s.nearest == 2 and s.span == 5, "quarters and halves", tostring(s.early) .. " " .. s.late .. " " .. s.nearest .. " " .. s.span)
s = core.summary({ 0, 1, 2, 3 }, { 1, 1, 1, 0 / 0 })
ok(s.late ~= s.late and s.first == 1, "NaN shows in the last quarter")
raises("as many times as numbers", core.summary, { 0 }, {})

tap.done()
