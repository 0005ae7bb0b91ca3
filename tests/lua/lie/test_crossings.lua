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
tap.done()
