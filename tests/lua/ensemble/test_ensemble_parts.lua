-- members that have no equations of motion fail alone; where none has any, the ensemble says why
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function L(q, v, _, c)
  if c.k < 0 then error "a spring that pushes" end
  return c.m * v[1] ^ 2 / 2 - c.k * q[1] ^ 2 / 2
end
local spring = dm.system { Q = dm.R(1), params = { m = 1, k = 1 }, L = L }
local function sweep(rule, vary, more)
  local options = { members = 6, q = function() return { 1 } end, v = function() return { 0.25 } end, steps = 20, vary = vary }
  for key, value in pairs(more or {}) do options[key] = value end
  return spring:solver { rule = rule, h = 0.1 }:ensemble(options)
end

for _, rule in ipairs { "verlet", "gauss(2)", "midpoint", "rk4", "rk8pd", "trapezoidal", "curve(rk4)" } do
  local function mass(i) return i == 3 and 0 or i / 2 end
  local e = sweep(rule, { m = mass })
  local failed, same = e:failures(), true
  ok(#failed == 1 and failed[1].member == 3 and failed[1].code == "no_start" and e.status[3] == "no_start", rule .. ": a mass of zero fails alone")
  ok(failed[1].message and failed[1].message:find "L has no velocity in it" ~= nil, rule .. ": it says why", failed[1].message)
  ok(e.q[3][1] == 1 and e.p[3][1] ~= e.p[3][1] and e.steps[3] == 0, rule .. ": its position is as it was given, it has no momentum")
  for i = 1, 6 do
    if i ~= 3 then
      local alone = dm.system({ Q = dm.R(1), params = { m = mass(i), k = 1 }, L = L }):solver({ rule = rule, h = 0.1 })
        :run { q = { 1 }, v = { 0.25 }, steps = 20 }
      same = same and alone.q[21] == e.q[i] and alone.p[21] == e.p[i]
    end
  end
  ok(same, rule .. ": the others are runs of their own, bit for bit")
end

local function infinite(i) return i == 2 and 1e200 or i end
local squared = dm.system { Q = dm.R(1), params = { m = 1 }, L = function(q, v, _, c) return c.m ^ 2 * v[1] ^ 2 / 2 - q[1] ^ 2 end }
local heavy = squared:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, q = { { 1 }, { 1 }, { 1 } }, v = { { 1 }, { 1 }, { 1 } }, steps = 5,
  vary = { m = infinite } }
ok(heavy.status[1] == "ok" and heavy.status[2] == "no_start" and heavy.status[3] == "ok", "so does a mass that overflows", heavy.status[2])
local sign = sweep("verlet", { k = function(i) return i == 1 and -1 or i end })
ok(sign:failures()[1].message:find "a spring that pushes" ~= nil and sign.status[2] == "ok", "and a Lagrangian that raises", sign.status[1])
local rows = sweep("verlet", { m = function(i) return i == 6 and 0 or 1 end }, { every = 5, threads = 3 })
ok(#rows:path(1) == 5 and #rows:path(6) == 0, "rows of the others are kept")

raises("L has no velocity in it", sweep, "verlet", { m = function() return 0 end })
raises("must be a finite number", sweep, "verlet", { m = function(i) return 1 / (i - 2) end })
raises("'q' of member 3 must have 1 entries", sweep, "verlet", { m = function(i) return i % 3 end }, { q = function(i) return i == 3 and { 1, 2 } or { 1 } end })
-- s of CPU, the least of three looks: about as the number of mistakes, where its square would be a hundred times as long
local function told_after(members)
  local least = math.huge
  for _ = 1, 3 do
    local before = dm.cpu()
    raises("L has no velocity in it", sweep, "verlet", { m = function(i) return 0 * i end, k = function(i) return i end }, { members = members })
    least = math.min(least, dm.cpu() - before)
  end
  return least
end
local few, many = told_after(200), told_after(2000)
ok(many < 40 * few, "2000 mistakes of one kind are told soon", many / few)
tap.done()
