-- places where holonomic constraints on groups cross: a step over one ends the run by name, as on R^n
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

-- where a run ends, and what it says
local function ends(f)
  local fine, failure = pcall(f)
  if fine then return "no end", failure end
  return tonumber(tostring(failure):match "at t = ([%d.]+): the constraints cross") or tostring(failure), failure
end

---- the axis of a body tilts about x or about y: both ways meet where it is upright, at t = 1 ----

local G = dm.SO(3)
local function tilts(more)
  return function(g) return g[3][1] * g[3][2] - (more or 0) end
end
local function T(w) return (0.5 * w[1] ^ 2 + 0.7 * w[2] ^ 2 + 0.9 * w[3] ^ 2) / 2 end
local function L(_, w) return T(w) end
local start = { q = G:exp { -1, 0, 0 }, v = { 1, 0, 0 } }
local function tilting(given)
  given.Q, given.L, given.constraint = G, L, given.constraint or tilts()
  return dm.system(given)
end
local system = tilting {}
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(3)", "lie(1, gauss(1), cayley)", "midpoint", "gauss(2)" } do
  for _, h in ipairs { 0.1, 0.37, 0.013 } do
    local t, failure = ends(function()
      return system:solver { rule = rule, h = h }:run { q = start.q, v = start.v, t = 3 * h * math.ceil(1 / h) }
    end)
    near(t, 1, 0.02 + h ^ 2, ("%s, h = %g: when"):format(rule, h))
    ok(tostring(failure):find("derivative of constraint 1 vanishes", 1, true), rule .. ": which", failure)
  end
end
local through = tilting { crossings = true }:solver { rule = "lie(2)", h = 0.1 }:run { q = start.q, v = start.v, steps = 20 }
near(G:distance(through.q[21], G:exp { 1, 0, 0 }), 0, 1e-13, "crossings = true goes straight on")
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)" } do
  through = tilting { crossings = true }:solver { rule = rule, h = 0.01 }:run { q = start.q, v = start.v, t = 2 }
  near(G:distance(through.q[#through.q], G:exp { 1, 0, 0 }), 0, 1e-4, rule .. ": with crossings = true straight on")
end
-- past the node at a distance there is one way alone
local aside = G:exp { -0.5, 0.01, 0 }
local beside = tilting { constraint = tilts(aside[3][1] * aside[3][2]) }
local _, passed = ends(function()
  return beside:solver { rule = "lie(2)", h = 0.02 }:run { q = aside, v = { 1, 0, 0 }, steps = 100, project = true }
end)
ok(passed.q and passed.q[101][3][1] ^ 2 > 0.1, "passing by is no crossing, but a turn onto the other branch", passed)

-- members end alone, and a run that goes on from a checkpoint ends where the whole run does
local cloud = system:solver { rule = "lie(1)", h = 0.1 }:ensemble { members = 3, q = function() return start.q end,
  v = function(i) return { i == 2 and 1 or 0.1, 0, 0 } end, steps = 20 }
local failed = cloud:failures()
ok(#failed == 1 and tostring(failed[1].message or failed[1]):find "cross", "the member that goes over it", tostring(cloud))
local half = system:solver { rule = "lie(1)", h = 0.1 }:run { q = start.q, v = start.v, steps = 7 }
near(ends(function() return dm.resume(half):run { steps = 10 } end), 1, 1e-5, "a run that goes on")

---- the same of a discrete Lagrangian ----

local function pair(given)
  given.Q, given.constraint = G, tilts()
  function given.Ld(g0, g1, h) return h * T(G:log(g0:transpose() * g1) / h) end
  return dm.discrete_lagrangian(given):solver()
end
for _, h in ipairs { 0.1, 0.37, 0.013 } do
  near(ends(function() return pair { h = h }:run { q = start.q, p = { 0.5, 0, 0 }, steps = math.ceil(3 / h) } end),
    1, 1e-4, ("Ld, h = %g: when"):format(h))
end
through = pair { h = 0.1, crossings = true }:run { q = start.q, p = { 0.5, 0, 0 }, steps = 20 }
near(G:distance(through.q[21], G:exp { 1, 0, 0 }), 0, 1e-13, "crossings = true of Ld")
local line = dm.solver { dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, crossings = true,
  Ld = function(x, y, h) return (y - x):dot(y - x) / 2 / h end, constraint = function(x) return x[1] * x[2] end } }
near(line:run { q = { -1, 0 }, p = { 1, 0 }, steps = 20 }.q[21][1], 1, 1e-14, "and on R^n")
half = pair { h = 0.1 }:run { q = start.q, p = { 0.5, 0, 0 }, steps = 7 }
near(ends(function() return dm.resume(half):run { steps = 10 } end), 1, 1e-4, "an Ld that goes on")

---- a parallelogram of three bars, each with a place of its own on SE(2): flat at t = 1 ----

local S = dm.SE(2)
local bars = dm.product(S, S, S)
local function at(g, x) return g[1] + math.cos(g[3]) * x, g[2] + math.sin(g[3]) * x end
local function joints(z)
  local out = {}
  local function meet(x1, y1, x2, y2) out[#out + 1], out[#out + 2] = x1 - x2, y1 - y2 end
  local x, y = at(z[1], -0.5)
  meet(x, y, 0, 0)
  x, y = at(z[1], 0.5)
  meet(x, y, at(z[2], -1))
  x, y = at(z[2], 1)
  meet(x, y, at(z[3], 0.5))
  x, y = at(z[3], -0.5)
  meet(x, y, 2, 0)
  return out
end
local linkage = dm.system { Q = bars, constraint = joints, L = function(_, xi)
  local sum = 0
  for b = 0, 2 do
    sum = sum + (xi[3 * b + 1] ^ 2 + xi[3 * b + 2] ^ 2 + (b == 1 and 1 / 3 or 1 / 12) * xi[3 * b + 3] ^ 2) / 2
  end
  return sum
end }
local c, s = math.cos(1), math.sin(1)
local folded = { q = { { c / 2, s / 2, 1 }, { c + 1, s, 0 }, { 2 + c / 2, s / 2, 1 } },
  v = { 0, -0.5, -1, s, -c, 0, 0, -0.5, -1 } }
for _, rule in ipairs { "lie(1)", "lie(2)" } do
  for _, h in ipairs { 0.07, 0.03 } do
    local t, failure = ends(function()
      return linkage:solver { rule = rule, h = h }:run { q = folded.q, v = folded.v, t = 60 * h }
    end)
    near(t, 1, 2e-3, ("%s: the bars are flat"):format(rule))
    ok(tostring(failure):find "constraint %d depends on those before it", rule .. ": rows depend", failure)
  end
end

---- tangent maps: half of their constraints are those of the system ----

for _, rule in ipairs { "lie(1)", "lie(2)", "midpoint", "gauss(2)" } do
  local t, failure = ends(function() return system:solver { rule = rule, h = 0.13 }:tangent { q = start.q, v = start.v, steps = 20 } end)
  near(t, 1, 2e-3, ("%s: a tangent map, when"):format(rule))
  ok(tostring(failure):find("derivative of constraint 1 vanishes", 1, true), rule .. ": a tangent map, which", failure)
  ok(tilting { crossings = true }:solver { rule = rule, h = 0.13 }:tangent { q = start.q, v = start.v, steps = 20 },
    rule .. ": a tangent map goes on with crossings = true")
end

---- a body of twenty constraints: a scale of its own in each of twenty places, which the first drives, and a tilt ----

local many, wheels = dm.product(G, dm.R(20)), 20
local function driven(more)
  return dm.system { Q = many, L = function(_, v)
      local sum = T(v)
      for i = 4, 3 + wheels do sum = sum + v[i] ^ 2 / 20 end
      return sum
    end,
    constraint = function(g)
      local out = { g[1][3][1] * (more and g[1][3][2] ^ 2 + more or g[1][3][2]) }
      for i = 1, wheels do out[i + 1] = g[2][i] - g[1][3][2] / i end
      return out
    end }
end
do
  local at, v = { G:exp { -1, 0, 0 }, {} }, { 1, 0, 0 }
  for i = 1, wheels do at[2][i], v[3 + i] = at[1][3][2] / i, math.cos(1) / i end
  local function run(more) return driven(more):solver { rule = "lie(1)", h = 0.1 }:run { q = at, v = v, steps = 20, project = true } end
  local t, failure = ends(function() return run() end)
  ok(type(t) == "number" and tostring(failure):find("constraint 1 vanishes", 1, true), "of 21 constraints the one that vanishes", failure)
  ok(#run(0.05) == 21, "and none where it does not", failure)
end

---- a step that is not solved, whose equation has a double root where the constraints cross ----

-- on y = x^2 toward the node, by Newton's method y falls by a half in every iteration
local core = require "dm.core"
local function branches(g) return g[2] * (g[2] - g[1] ^ 2) end
local place = core.stand_in { Q = S, L = function(_, xi) return xi:dot(xi) / 2 end, constraint = branches }
local slow = core.tied_step { unknowns = 4, order = 1, holonomic = 1, rolling = 0, start = function() return { 0, 0, 0, 0 } end,
  equation = function(y, x)
    return { x[1] - y.p[1], x[2] - y.p[2] + x[4], x[3], branches(S:compose(y.q, S:exp { x[1], x[2], x[3] })) }
  end,
  next = function(y, x) return { q = S:compose(y.q, S:exp { x[1], x[2], x[3] }), p = y.p } end }
local function approach(along, most)
  return ends(function()
    return place:solver { rule = slow, h = 1, newton = { max_iterations = most } }:run { q = { -1, 1, 0 }, p = { along, -2, 0 }, steps = 1 }
  end)
end
for _, most in ipairs { 16, 18, 20 } do
  near(approach(1 - 1e-9, most), 1, 1e-2, ("a step that ends at the node after %d iterations"):format(most))
end
ok(tostring(approach(0.99, 16)):find("did not converge", 1, true), "and one that ends before it is not said to cross", approach(0.99, 16))
ok(tostring(approach(1 - 1e-9, 8)):find("did not converge", 1, true), "nor one that is far from a root", approach(1 - 1e-9, 8))
tap.done()
