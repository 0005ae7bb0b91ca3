-- what a trace cannot see of a term (== with a symbol), in whichever cell it is and whoever asks; second derivatives that sums do not have; names of data; time of limits
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local K = dm.mesh { grid = 4 }
local q = K:form(0, function(x, y) return x * y end)
local function field(L, options)
  options = options or {}
  options.L = function(a, v, t, p) return v:dot(v) / 2 - L(a, t, p) end
  return K:field(options)
end

-- a test that holds in one cell of many, by its data
local one = K:form(2, function() return 0 end)
one.values[9] = 1
local function odd(a) return K:sum(2, function(x, cell) if cell.w == 1 then return 100 * x[1] ^ 2 else return x[2] ^ 2 end end, a) end
local two = field(odd, { data = { w = one } })
local told = "term 9 of 32"
local start = { q = q, v = q, steps = 2 }
for _, rule in ipairs { "verlet", "midpoint" } do
  raises(told, function() two:solver { rule = rule, h = 0.01 }:run(start) end)
end
raises(told, function() two:solver { rule = "avi", h = 0.01 }:run { q = q, v = q, t = 0.1 } end)
raises(told, function() two:solver { rule = dm.prismal { 0, 0.01, 0.03 } }:run { q = q, v = q } end)
raises(told, function() two:solver { rule = "verlet", h = 0.01 }:ensemble { members = 2, steps = 1, q = function() return q end, v = function() return q end } end)
raises(told, function() two:modes(1, { q = q }) end)
raises(told, function() two:stability_limit("verlet", { q = q }) end)
raises(told, function() K:stationary { fixed = "boundary", term = odd, data = { w = one }, x = q } end)
-- by multiplication there is nothing to tell
local fine = field(function(a) return K:sum(2, function(x, cell) return cell.w * 100 * x[1] ^ 2 + (1 - cell.w) * x[2] ^ 2 end, a) end, { data = { w = one } })
ok(#fine:solver { rule = "verlet", h = 0.01 }:run(start) == 3, "a factor of 0 and 1 in its place")
-- of more cells than are all looked at: kinds of cells by their data, wherever they are
local large = dm.mesh { grid = 40 }
local last = large:form(2, function() return 0 end)
last.values[1234] = 2
local big = large:field { data = { w = last }, L = function(a, v)
  return v:dot(v) / 2 - large:sum(2, function(x, cell) if cell.w == 2 then return 9 * x[1] ^ 2 else return x[2] ^ 2 end end, a) end }
raises("term 1234 of 3200", function() big:solver { rule = "verlet", h = 1e-3 }:run { q = function(x, y) return x end, v = function() return 0 end, steps = 1 } end)
-- bodies
raises("term 21 of 100", function()
  local masses, x, v = {}, {}, {}
  for i = 1, 100 do masses[i], x[i], v[i] = i == 21 and 7 or 1, i / 100, 1 end
  dm.system { Q = dm.R(100), params = { m = masses }, L = function(y, u, _, p)
    return dm.sum_over(u, p.m, function(a, m) return m * a ^ 2 / 2 end)
      - dm.sum_over(y, function(a) if a == 0.21 then return a else return a ^ 2 / 2 end end)
  end }:solver { rule = "verlet", h = 0.1 }:run { q = x, v = v, steps = 1 } end)

-- functions of sums: their forces are had, as of the same L written out; not their second derivatives
local nonlinear = field(function(a) return 4 * a:dot(a) * a:d():dot(a:d()) end)
local weights, edges, stiff = K:star_weights(0), K:simplices(1), K:star_weights(1)
local plain = dm.system { Q = dm.R(25), L = function(x, u)
  local T, a, b = 0, 0, 0
  for i = 1, 25 do T, a = T + weights[i] * u[i] ^ 2 / 2, a + weights[i] * x[i] ^ 2 end
  for e, s in ipairs(edges) do b = b + stiff[e] * (x[s[2]] - x[s[1]]) ^ 2 end
  return T - 4 * a * b end }
for _, rule in ipairs { "verlet", "midpoint", "gauss(2)" } do
  local a = nonlinear:solver { rule = rule, h = 0.02 }:run { q = q, v = 0 * q, steps = 10 }
  local b = plain:solver { rule = rule, h = 0.02 }:run { q = q.values, v = 0 * q.values, steps = 10 }
  near((a.q[11] - b.q[11]):norm(), 0, 1e-13, "a product of sums by " .. rule)
end
raises("not linear in them", function() nonlinear:modes(2) end)
raises("not linear in them", function() nonlinear:stability_limit "verlet" end)
raises("multiplied by what is no number", function() nonlinear:solver { rule = "avi", h = 0.01 }:run { q = q, v = q, t = 0.1 } end)

-- names that cells have, forms of other meshes
for _, name in ipairs { "volume", "star", "lengths", "points" } do
  raises("every cell has a '" .. name, function() field(function(a) return a:dot(a) end, { data = { [name] = q } }) end)
  raises("every cell has a '" .. name, function() K:stationary { term = function(a) return a:dot(a) end, data = { [name] = q } } end)
end
local small = dm.mesh { grid = 1 }:form(0, { 1, 2, 3, 4 })
raises("form of this mesh", function() K:stationary { term = function(a) return K:sum(0, function(x, cell) return cell.w * x ^ 2 end, a) end, data = { w = small } } end)

-- modes and limits at a time: omega^2 of a spring that hardens as 1 + t^2
local hard = field(function(a, t) return (1 + t ^ 2) * a:d():dot(a:d()) / 2 end)
local soft = field(function(a) return a:d():dot(a:d()) / 2 end)
raises("depends on t: give { t = }", function() hard:modes(2) end)
raises("depends on t: give { t = }", function() hard:stability_limit "verlet" end)
near(hard:modes(2, { t = 2 }).values[2], 5 * soft:modes(2).values[2], 1e-11, "a mode at a time")
near(hard:stability_limit("verlet", { t = 2 }), soft:stability_limit "verlet" / math.sqrt(5), 1e-12, "a limit at a time")

-- masses that change with an upvalue of L: those of now, after they were asked for
for rule, finish in pairs { avi = false, verlet = false, modes = function(f) return f:modes(2).values end } do
  local mass = 1
  local heavy = K:field { L = function(a, v) return mass * v:dot(v) / 2 - a:d():dot(a:d()) / 2 end }
  local four = K:field { L = function(a, v) return 4 * v:dot(v) / 2 - a:d():dot(a:d()) / 2 end }
  finish = finish or function(f)
    local run = f:solver { rule = rule, h = 0.05 }:run { q = q, v = q, t = 0.5 }
    return run.q[#run]
  end
  finish(heavy)
  mass = 4
  ok(finish(heavy) == finish(four), rule .. " after the mass has changed")
end
raises("product of two forms", function() K:stationary { term = function(a) return a end } end)
raises("not of fields", function() soft:solver { rule = "midpoint", h = 0.1 }:fold { q = q.values, v = q.values } end)
for _, solver in ipairs { soft:solver { rule = "avi" }, soft:solver { rule = dm.prismal { 0, 1 } } } do
  raises("call solver:run for each start", function() solver:ensemble { members = 2 } end)
  raises("as verlet, has it", function() solver:fold { q = q.values } end)
end
tap.done()
