-- dm.scaling: cost against the size of a system and of an ensemble; then misuse
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function chain(n)
  return dm.system { Q = dm.R(n), L = function(q, v)
    return dm.sum_over(v, function(u) return u * u / 2 end) - dm.sum_over(q, function(a, b) return (b - a) ^ 2 / 2 + (b - a) ^ 4 / 4 end, { shift = 1, periodic = true })
  end }
end
local function wave(n)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = 0.1 * math.sin(i), 0 end
  return q, v
end
-- what is measured until it holds: other work of the machine may spoil some looks, but not ten of what is so
local function look(measure, holds)
  local found
  for _ = 1, 10 do
    found = measure()
    if holds(found) then break end
  end
  return found
end
local grown = look(function() return dm.scaling { system = chain, start = wave, n = { 64, 256, 1024, 4096 }, rules = { "verlet" }, h = 0.01, steps = 200 } end,
  function(found) return math.abs(found:exponent "verlet" - 1) < 0.5 end)
local e = grown:exponent "verlet"
ok(#grown.points == 4 and e > 0.5 and e < 1.5, "a chain costs about linearly in its length", e)
ok(grown:table():find "like n%^" and tostring(grown):find "set%-up", "told in a table")
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function start(i) return { 0.4 + i * 1e-4, 0 }, { 0, 2 } end
local function ends(wide) -- ns of a member's step alone and among many
  local alone, many
  for _, p in ipairs(wide.points) do
    if p.rule == "verlet" and p.size == 1 then alone = p.ns end
    if p.rule == "verlet" and p.size == 256 then many = p.ns end
  end
  return alone, many
end
local lanes = kepler:solver({ rule = "verlet", h = 0.01 }):ensemble({ members = 8, q = function(i) return (start(i)) end, v = function(i) return select(2, start(i)) end, steps = 1 }).lanes
local wide = look(function() return dm.scaling { system = kepler, start = start, members = { 1, 8, 64, 256 }, rules = { "verlet", "gauss(2)", "rattle" }, h = 0.01, steps = 400 } end,
  function(found) local alone, many = ends(found) return lanes == 1 or many < alone end)
ok(#wide.points >= 8, "ensembles of many sizes", #wide.points)
local alone, many = ends(wide)
ok(lanes == 1 or many < alone, "a member costs less among many where there are lanes", ("%g %g"):format(many, alone))
raises("give sizes n", dm.scaling, { system = chain, start = wave, rules = { "verlet" }, h = 0.1 })
raises("growing whole numbers", dm.scaling, { system = chain, start = wave, n = { 4, 2 }, rules = { "verlet" }, h = 0.1 })
raises("must be a function(n)", dm.scaling, { system = kepler, start = wave, n = { 2 }, rules = { "verlet" }, h = 0.1 })
raises("option 'h' is missing: a step > 0", dm.scaling, { system = chain, start = wave, n = { 2 }, rules = { "verlet" } })
raises("unknown option 'size'", dm.scaling, { size = 1 })
raises("nothing could be measured", dm.scaling, { system = kepler, start = start, members = { 1 }, rules = { "verlett" }, h = 0.1 })
raises("no point of rule", grown.exponent, grown, "gauss(2)")
-- a stop between two runs, of which core.within makes a text, is no failure of a rule
local core = require "dm.core"
local ended, why = core.within(0, dm.scaling, { system = function() core.pass_stop() end, start = function() return { 1 }, { 0 } end,
  n = { 1, 2 }, rules = { "verlet" }, h = 0.1, steps = 2, repeats = 1 })
tap.ok(ended == false and why.code == "stopped" and why.scaling, "a stop is raised, with what is there", tostring(why))
tap.done()
