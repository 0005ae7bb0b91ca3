-- where runs of fields fail: beyond the limit of stability, cells inside out, opposite neighbours; with the cell, the remedy and the path so far
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin = math.sin

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function failing(f, ...)
  local fine, why = pcall(f)
  ok(not fine and type(why) == "table", "a dm.failure", why)
  for _, word in ipairs { ... } do ok(tostring(why):find(word), "it says " .. word, tostring(why)) end
  return why
end

---- beyond the limit: the energy has outgrown the start, or is no number ----

for _, case in ipairs { { dm.mesh { icosphere = 1 }, 0 }, { dm.mesh { triangle = 4 }, 1 }, { dm.mesh { cube_tiling = 2 }, 0 } } do
  local field = case[1]:field { form = case[2], L = wave }
  local limit, q, v = field:stability_limit "verlet", {}, {}
  for i = 1, field.field.n do q[i], v[i] = sin(1.3 * i), 0 end
  local function run(options, more)
    more.q, more.v = q, v
    return field:solver(options):run(more)
  end
  local why = failing(function() run({ rule = "verlet", h = 1.01 * limit }, { steps = 300 }) end, "the energy has", "beyond the limit of stability",
    ("%.6g about"):format(limit):gsub("%p", "%%%0"), "at the cell {%d")
  ok(why.code == "blow_up" and #why.path == 301, "with its path")
  why = failing(function() run({ rule = "verlet", h = 1.3 * limit }, { steps = 1e5, every = 100 }) end, "NaN or infinite", "beyond the limit of stability")
  ok(why.code == "not_finite" and #why.path > 3, "with the path so far")
  local slices = {}
  for i = 0, 2000 do slices[i + 1] = 1.5 * limit * i end
  why = failing(function() run({ rule = dm.prismal(slices) }, {}) end, "beyond the limit of stability")
  ok(#why.path > 3, "of slices, too")
  why = failing(function() run({ rule = "avi", h = 3 * limit }, { t = 2000 * limit }) end, "cells have steps beyond their own limit")
  ok(why.code == "not_finite" and #why.path > 3 and why.path.t[#why.path] == why.time, "of steps of its own in every cell, with the path so far")
  ok(#run({ rule = "verlet", h = 0.999 * limit }, { steps = 300 }) == 301 and #run({ rule = "midpoint", h = 3 * limit }, { steps = 30 }) == 31, "below it none fails")
end
-- the step that fails, and the last good state, whatever the rows: bursts of one step and of many
local round = dm.mesh { icosphere = 1 }
local steep = round:field { form = 0, L = function(u, v) return wave(u, v) + round:sum(0, function(a) return a ^ 4 end, u) end }
local told = {}
for k, every in ipairs { 1, 7, 1e6 } do
  local _, why = pcall(function()
    steep:solver { rule = "verlet", h = 0.01 }:run { q = function() return 1 end, v = function() return 1 end, steps = 1e4, every = every }
  end)
  told[k] = why
  ok(why.code == "not_finite" and why.step == told[1].step and why.step > 40, "the same step fails", why.step)
  ok(why.path.q[#why.path] == told[1].path.q[#told[1].path], "the same state before it")
end
-- what leaves an unstable rest grows by 10^24 in its energies, and is let go on
local ball = dm.mesh { icosphere = 1 }
local hill = ball:field { form = 0, L = function(u, v) return wave(u, v) - ball:sum(0, function(a, cell) return cell.star * (a ^ 4 / 4 - a ^ 2 / 2) end, u) end }
local fell = hill:solver { rule = "verlet", h = 0.02 }:run { q = function() return 1e-14 end, v = function() return 0 end, t = 48, every = 10 }
local most = 0
for i = 1, #fell do most = math.max(most, fell.q[i]:norm()) end
ok(most > 1 and fell.q[1]:norm() < 1e-12, "what leaves an unstable rest is no blow-up", most)

---- an elastic body turns inside out ----

local plate = dm.mesh { triangle = 4 }
local function strain(x, cell)
  local p = cell.points
  local a, b, s, t = p[2] - p[1], p[3] - p[1], x[2] - x[1], x[3] - x[1]
  local J = (s[1] * t[2] - s[2] * t[1]) / (a[1] * b[2] - a[2] * b[1])
  return cell.volume * dm.log(J) ^ 2
end
local body = plate:field { form = 0, values = 2, fixed = "boundary", L = function(X, V) return V:dot(V) / 2 - plate:sum(2, strain, X) end }
local function place(x, y) return { x, y } end
for _, rule in ipairs { "verlet", "midpoint" } do
  local why = failing(function() body:solver { rule = rule, h = 0.02 }:run { q = place, v = function() return { 0, 20 } end, t = 1 } end, "cell {%d+, %d+, %d+} turns inside out there", "smaller step")
  ok(#why.path >= 1, "with the path so far")
end
raises("the image of cell {1, 2, 6} is inverted", function() body:solver { rule = "verlet", h = 0.01 }:run { q = function(x, y) return { x, -y } end, v = place, t = 1 } end)

---- neighbours opposite on a sphere ----

local map = plate:field { form = 0, on = dm.S(2), L = wave }
raises("neighbours opposite on the sphere: the values of the vertices {6, 10}", function()
  map:solver { rule = "rattle", h = 0.01 }:run { q = function(_, y) return { 0, 0, y > 0.3 and 1 or -1 } end, v = function() return { 0, 0, 0 } end, t = 0.1 }
end)
-- limits of rules whose steps do not keep areas: below them a spring is damped, above it grows; and a scalar on a line is no
-- bar that turns inside out
local line = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
local spring = line:field { form = 0, fixed = { 1 }, L = function(u, v)
  return line:sum(0, function(x) return x ^ 2 / 2 end, v) - line:sum(1, function(a) return (a[2] - a[1]) ^ 2 / 2 end, u)
end }
for _, rule in ipairs { "rk4", "rk8", "yoshida(4)" } do
  local limit = spring:stability_limit(rule)
  local function run(part)
    return spring:solver { rule = rule, h = part * limit }:run { q = { 0, 1 }, v = { 0, 0 }, steps = 10000, every = 10000 }
  end
  ok(run(0.99).q[2]:norm() < 2, rule .. " below its limit")
  local fine, failure = pcall(run, 1.01)
  ok(not fine and failure.message:find "is beyond the limit of stability", rule .. " beyond it", failure.message)
end
-- 3.1635 to 3.1685 is a band of growth of blanes-moan(4), far below the end of what is stable, 5.03
do
  local limit = spring:stability_limit "blanes-moan(4)"
  local function run(part)
    local path = spring:solver { rule = "blanes-moan(4)", h = part * limit }:run { q = { 0, 1 }, v = { 0, 0 }, steps = 10000, every = 10000 }
    return path.q[2]:norm()
  end
  ok(run(0.999) < 2 and run(1.0008) > 1e6, "a narrow band of growth is a limit", limit)
end
raises("one step tells no limit", function() spring:stability_limit "gauss(2, 3)" end)
-- the same motion with masses and energies of 1e-9: growth is told by its own measure, on uneven slices too
do
  local sheet = dm.mesh { grid = 6 }
  local light = sheet:field { L = function(u, v) return 1e-9 * (v:dot(v) - u:d():dot(u:d())) / 2 end }
  local begin = { q = function(x, y) return x * y ^ 2 end, v = function() return 0 end, steps = 16 }
  local fine, failure = pcall(function() return light:solver { rule = "verlet", h = 0.5 }:run(begin) end)
  ok(not fine and failure.code == "blow_up" and failure.message:find "limit of stability, 0.117851", "growth of light fields", failure)
  begin.steps = nil
  fine, failure = pcall(function() return light:solver { rule = dm.prismal { 0, 1, 2, 3, 1e6 } }:run(begin) end)
  ok(not fine and failure.code == "blow_up" and failure.message:find "limit of stability, 0.117851", "and over slices", failure)
end
tap.done()
