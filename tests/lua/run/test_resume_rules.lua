-- dm.resume with a rule of coefficients or functions of its own: it must be the checkpoint's
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local quartic = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 4 / 4 end }
local file = os.tmpname()

local function save(rule)
  quartic:solver({ rule = rule, h = 0.1 }):run({ q = { 1 }, v = { 0 }, steps = 5 }):checkpoint(file)
end
local function resume(rule)
  return dm.resume(file, quartic, rule and { rule = rule }):run { steps = 5 }
end

local galerkin = dm.galerkin
local function space(w)
  return galerkin { functions = function(t) return { 1, t, math.cos(w * t) } end, quadrature = "gauss(4)" }
end
local function curve(power)
  return galerkin { parameters = 3, quadrature = "gauss(4)",
    start = function(q, v) return { q[1], v[1], 0 } end,
    curve = function(t, z) return { z[1] + z[2] * t + z[3] * t ^ power } end }
end
local function own(c)
  return dm.curve { method = function(x, f, h)
    local k = f(x)
    return x + h * ((1 - 0.5 / c) * k + 0.5 / c * f(x + h * c * k))
  end }
end
local function taylor(c)
  return dm.curve { method = function(x, f, h)
    local k = f(x)
    return x + h * k + h ^ 2 / 2 * f:along(x, k) + c * h ^ 3 * k
  end }
end
local function substeps(n)
  return dm.curve("rk4", { substeps = function() return n end })
end
local sixth = galerkin { degree = 2, nodes = { 0, 0.5, 1 } }
local half = dm.sprk { a = { { 0.25, 0 }, { 0.5, 0.25 } }, b = { 0.5, 0.5 } }

for _, case in ipairs {
  { "nodes", sixth, galerkin { degree = 2, nodes = { 0, 0.3, 1 } } },
  { "weights", galerkin { degree = 1, nodes = { 0, 0.5, 1 } },
    galerkin { degree = 1, nodes = { 0, 0.5, 1 }, weights = { 0.25, 0.5, 0.25 } } },
  { "a space", space(1), space(2) }, { "a curve", curve(2), curve(3) },
  { "a tableau", half, dm.sprk { a = { { 0.3, 0 }, { 0.6, 0.2 } }, b = { 0.6, 0.4 } } },
  { "segments", own(0.5), own(0.6) }, { "Taylor segments", taylor(0), taylor(0.01) },
  { "substeps", substeps(2), substeps(3) } } do
  local what, was, other = table.unpack(case)
  save(was)
  raises("the rule is not the one of the checkpoint", function() resume(other) end)
  ok(#resume(was) == 6, what .. ": the same rule goes on")
end

-- names: a rule of one's own that is called like another one, and text for an object
save(substeps(2))
raises("the rule is not the one of the checkpoint", resume)
save "verlet"
raises("the rule is not the one of the checkpoint", function()
  resume(dm.sprk { a = { { 0.25, 0 }, { 0.5, 0.25 } }, b = { 0.5, 0.5 }, name = "verlet" })
end)
save(dm.curve "rk4")
ok(#resume() == 6 and #resume "curve(rk4)" == 6, "what a name tells needs no object")

-- discrete Lagrangians of a rule: their runs go on from a file with them
local function pairs_of(rule, h) return dm.discrete_lagrangian(quartic, { rule = rule, h = h }) end
local start = { q = { 1 }, p = { 0.2 }, steps = 9 }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)", "galerkin(2, gauss(3))" } do
  local Ld = pairs_of(rule, 0.1)
  local whole = Ld:solver():run(start)
  Ld:solver():run({ q = { 1 }, p = { 0.2 }, steps = 5 }):checkpoint(file)
  local fine, rest = pcall(function() return dm.resume(file, Ld):run { steps = 4 } end)
  ok(fine and rest.q[5] == whole.q[10] and rest.p[5] == whole.p[10],
    rule .. ": a run of its discrete Lagrangian goes on bit for bit", rest)
end
raises("h = 0.2", dm.resume, file, pairs_of("galerkin(2, gauss(3))", 0.2))
raises("not 'gauss(2)'", dm.resume, file, pairs_of("gauss(2)", 0.1))
os.remove(file)
-- a formula Ld(q0, q1) and a rule that steps a Lagrangian are not taken for each other, whatever their names
do
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
  local function Ld(rule) return dm.discrete_lagrangian(s, { rule = rule, h = 0.1 }) end
  local start, file = { q = { 1, 0 }, p = { 0, 1 }, steps = 5 }, os.tmpname()
  local function resumed(of, model)
    of:run(start):checkpoint(file)
    return function() return dm.resume(file, model) end
  end
  local own = "give the system of the checkpoint here"
  tap.raises("the checkpoint is of rule 'gauss(2)', and this discrete Lagrangian is a formula Ld(q0, q1), stepped by 'del'", resumed(dm.solver { Ld "gauss(2)" }, Ld "midpoint"))
  tap.raises(own, resumed(s:solver { rule = "midpoint", h = 0.1 }, Ld "midpoint"))
  tap.raises("the checkpoint is of a formula Ld(q0, q1), stepped by rule 'del': give that discrete Lagrangian here", resumed(dm.solver { Ld "midpoint" }, Ld "gauss(2)"))
  tap.raises("give that discrete Lagrangian here", resumed(dm.solver { Ld "midpoint" }, s))
  tap.raises("the checkpoint is of rule 'verlet', not 'gauss(2)'", resumed(dm.solver { Ld "verlet" }, Ld "gauss(2)"))
  os.remove(file)
end
tap.done()
