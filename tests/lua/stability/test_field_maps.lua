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
ok(map:limit(1) > 0.48 and map:limit(1) < 0.51 and map.notes[1]:find "not compared", "a kink, over a duration", map:limit(1))
-- ends that absorb, and L with t: the size of the field is watched in place of the energy
local open = dm.field { x = { 0, 1, 20 }, absorbing = "ends", L = linear }
map = dm.stability { open, u = function(x) return math.exp(-50 * (x - 0.5) ^ 2) end, rule = "cell(gauss(2))", h = { 0.01, 0.2, 9, "log" }, steps = 400 }
near(map:limit(1), 0.05, 2e-3, "absorbing ends take the energy away; the limit stays")

raises("steps of its own in every cell", function() dm.stability { quartic, rule = "avi", h = 0.1, steps = 10, q = function() return 0 end, v = function() return 0 end } end)
raises("not both", function() dm.stability { kink, u = 0, q = 0, rule = "cell(corners)", h = 0.1, steps = 10 } end)
raises("on a line", function() dm.stability { kink, u = 0, rule = "verlet", h = 0.1, steps = 10 } end)
raises("must be finite", function() dm.stability { kink, u = function() return 0 / 0 end, rule = "cell(corners)", h = 0.1, steps = 10 } end)
raises("must return a dm.system", function() dm.stability { system = function(N) return N end, N = { 2, 3 }, q = 0, v = 0, rule = "verlet", h = 0.1, steps = 10 } end)
tap.done()
