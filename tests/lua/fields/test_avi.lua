-- asynchronous steps: against Verlet, a plain program, Gauss's law, momentum, reports, refusals
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local X, H = { 0, 0.5, 1.5, 2, 3 }, { 0.05, 0.08, 0.03, 0.07 }
local points = {}
for i, x in ipairs(X) do points[i] = { x } end
local chain = dm.mesh { simplices = { { 1, 2 }, { 2, 3 }, { 3, 4 }, { 4, 5 } }, points = points }
local function L(u, v)
  return v:dot(v) / 2 - chain:sum(1, function(a, cell) local d = a[2] - a[1] return cell.star * (d ^ 2 / 2 + d ^ 4 / 4) end, u)
end
local springs = chain:field { L = L }
local start = { q = { 0.3, -0.2, 0.1, 0.4, -0.1 }, v = { 0, 0.5, 0, -0.25, 0 }, t = 2.003 }
local path = springs:solver { rule = "avi", h = H }:run(start)

-- the same in a few lines of Lua, without a heap
local m, q, p, last, kicks = {}, { table.unpack(start.q) }, {}, { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0 }
for i = 1, 5 do m[i] = ((X[i + 1] or X[i]) - (X[i - 1] or X[i])) / 2 p[i] = m[i] * start.v[i] end
while true do
  local k
  for j = 1, 4 do if not k or (kicks[j] + 1) * H[j] < (kicks[k] + 1) * H[k] then k = j end end
  local t = (kicks[k] + 1) * H[k]
  if t > start.t then break end
  for a = k, k + 1 do q[a], last[a] = q[a] + (t - last[a]) * p[a] / m[a], t end
  local d = q[k + 1] - q[k]
  local kick = H[k] / (X[k + 1] - X[k]) * (d + d ^ 3)
  p[k], p[k + 1], kicks[k] = p[k] + kick, p[k + 1] - kick, kicks[k] + 1
end
local off = 0
for a = 1, 5 do
  off = math.max(off, math.abs(q[a] + (start.t - last[a]) * p[a] / m[a] - path.q[#path][a]), math.abs(p[a] - path.p[#path][a]))
end
ok(off < 1e-14, "as a plain program", off)
near(path.p[#path]:sum(), 0.1875, 1e-14, "momentum")
near(path.t[#path], 2.003, 0, "the last row is at t, which no step divides")
near(path.t[2], 0.08, 0, "rows at every largest step")

start.t = 2
for _, rows in ipairs { 1, 5 } do
  start.every = rows
  local one, two = springs:solver { rule = "avi", h = 0.05, start = "half" }:run(start), springs:solver { rule = "verlet", h = 0.05 }:run(start)
  off = 0
  for i = 1, #one do off = math.max(off, (one.q[i] - two.q[i]):norm(), (one.p[i] - two.p[i]):norm()) end
  ok(#one == #two and off < 1e-13, "equal steps with half a start are Verlet's, rows too", off)
end
start.every = nil

-- cells of a surface, whose steps have common multiples: equal times go by the number of the cell
local run
local torus = dm.mesh { hex_torus = 4 }
local ends, stars, weights = torus:simplices(1), torus:star_weights(1), torus:star_weights(0)
local list, u, w, then_, fired = {}, {}, {}, {}, {}
for k = 1, #ends do list[k], fired[k] = (1 + k % 3) / 64, 0 end
for a = 1, torus:count(0) do u[a], w[a], then_[a] = math.sin(a), 0, 0 end
run = torus:field { L = function(f, v) return v:dot(v) / 2 - torus:sum(1, function(a, cell) local d = a[2] - a[1] return cell.star * (d ^ 2 / 2 + d ^ 4 / 4) end, f) end }
  :solver { rule = "avi", h = list }:run { q = u, v = w, t = 1, at = { 1 } }
while true do
  local k
  for j = 1, #ends do if not k or (fired[j] + 1) * list[j] < (fired[k] + 1) * list[k] then k = j end end
  local t = (fired[k] + 1) * list[k]
  if t > 1 then break end
  for _, a in ipairs(ends[k]) do u[a], then_[a] = u[a] + (t - then_[a]) * w[a] / weights[a], t end
  local a, b = ends[k][1], ends[k][2]
  local d = u[b] - u[a]
  local by = list[k] * stars[k] * (d + d ^ 3)
  w[a], w[b], fired[k] = w[a] + by, w[b] - by, fired[k] + 1
end
off = 0
for a = 1, #u do off = math.max(off, math.abs(u[a] + (1 - then_[a]) * w[a] / weights[a] - run.q[#run][a]), math.abs(w[a] - run.p[#run][a])) end
ok(off < 1e-12, "neighbours fire in the order of their times", off)

-- a force that reads no entry, and one that depends on t
for name, potential in pairs { constant = function(a, cell) return cell.star * a end, ["of t"] = function(a, cell, t) return cell.star * a ^ 2 * (1 + dm.sin(t)) / 2 end } do
  local field = chain:field { L = function(f, v, t) return v:dot(v) / 2 - chain:sum(0, function(a, s, cell) return potential(a, cell, s) end, f, t) end }
  start.t = 1
  local one, two = field:solver { rule = "avi", h = 0.05, start = "half" }:run(start), field:solver { rule = "verlet", h = 0.05 }:run(start)
  ok((one.q[#one] - two.q[#two]):norm() < 1e-13, "Verlet's for a force that is " .. name, (one.q[#one] - two.q[#two]):norm())
end

-- a factor of t outside of a sum is the same factor inside, with steps of every cell's own; one that is no function of t alone is refused
do
  local function energy(a, by) return (a[2] - a[1]) ^ 2 / 2 * by end
  local outside = chain:field { L = function(f, v, t) return v:dot(v) / 2
    - (1 + dm.sin(3 * t) / 2) * chain:sum(1, function(a, cell) return energy(a, cell.star) end, f) - chain:sum(0, function(a, cell) return cell.star * a ^ 2 end, f) end }
  local inside = chain:field { L = function(f, v, t) return v:dot(v) / 2
    - chain:sum(1, function(a, s, cell) return energy(a, cell.star * (1 + dm.sin(3 * s) / 2)) end, f, t) - chain:sum(0, function(a, cell) return cell.star * a ^ 2 end, f) end }
  start.t = 1
  for _, begin in ipairs { "whole", "half" } do
    local function of(field) return field:solver { rule = "avi", start = begin, h = function(cell) return 0.02 + 0.03 * cell.points[1][1] end } end
    local one, two = of(outside):run(start), of(inside):run(start)
    local gap = (one.q[#one] - two.q[#two]):norm() + (one.p[#one] - two.p[#two]):norm()
    ok(#one == #two and gap < 1e-13 and (one.q[#one] - one.q[1]):norm() > 0.1, "a factor of t outside is one inside, start = " .. begin, gap)
  end
  local off = outside:solver { rule = "avi" }:run(start)
  start.t = 0.4
  local half = outside:solver { rule = "avi" }:run(start)
  local rest = dm.resume(half):run { t = 0.6 }
  ok(rest.q[#rest] == off.q[#off] and rest.p[#rest] == off.p[#off], "and goes on with the same bits")
  raises("no function of t alone", function()
    chain:field { L = function(f, v) local all = chain:sum(0, function(a) return a ^ 2 end, f) return v:dot(v) / 2 - all * all end }:solver { rule = "avi", h = 0.1 }:run(start)
  end)
  start.t = 1
end

-- Gauss's law over 10^5 events of uneven steps; cells of two sums; steps by position
local cavity = dm.mesh { triangle = 8 }
local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local maxwell = cavity:field { form = 1, fixed = "boundary", L = wave }
local solver = maxwell:solver { rule = "avi", h = function(cell) return 0.02 + 0.02 * cell.points[1][1] end }
run = solver:run { q = cavity:form(1, function(x, y) return { y ^ 2 * x, x * y } end), v = function(x, y) return { x, -y } end, t = 45, every = 20 }
local report = solver:report()
ok(report.events > 1e5, "10^5 events", report.events)
ok(run:drift "gauss".largest < 1e-12, "keep Gauss's law", run:drift "gauss".largest)
ok(report.beyond == 0 and report.gain > 1.2 and report.cells == 64, "report", report.gain)
local two = cavity:field { L = function(u, v) return wave(u, v) - cavity:sum(0, function(a, cell) return cell.star * a ^ 2 / 2 end, u) end }
solver = two:solver { rule = "avi" }
run = solver:run { q = function(x, y) return x * y end, v = function() return 0 end, t = 5 }
ok(run:drift "energy".largest < 0.2 * run:energy()[1], "default steps are stable", run:drift "energy".largest)
ok(solver:report().cells == cavity:count(0) + cavity:count(1), "cells of both sums")
local at = solver:run { q = function(x, y) return x * y end, v = function() return 0 end, at = { 1, 5 } }
ok(#at == 3 and at.t[2] == 1 and (at.q[3] - run.q[#run]):norm() == 0, "rows at given times")

-- order 1 as it stands, order 2 in time for equal and for half starts (energy)
raises("steps beyond their own", function() springs:solver { rule = "avi", h = 1.5 }:run { q = start.q, v = start.v, t = 400 } end)
raises("the step of cell 1 must be a number > 0 (got nil)", function() two:solver { rule = "avi", h = function() end }:run { q = function() return 0 end, v = function() return 0 end, t = 1 } end)
raises("for one sum in the potential", function() two:solver { rule = "avi", h = { 1, 2 } }:run { q = function() return 0 end, v = function() return 0 end, t = 1 } end)
raises("3 steps are given for the 4 cells", function() springs:solver { rule = "avi", h = { 1, 2, 3 } }:run(start) end)
raises("must be a number > 0", function() springs:solver { rule = "avi", h = { 1, 2, 3, 0 } }:run(start) end)
raises("a step > 0", function() springs:solver { rule = "avi", h = -1 } end)
raises("one of 'v'", function() springs:solver { rule = "avi", h = 1 }:run { q = start.q, t = 1 } end)
raises("for fields on meshes", function() dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end }:solver { rule = "avi" } end)
raises("take rattle", function() cavity:field { L = wave, on = dm.S(2) }:solver { rule = "avi", h = 0.1 }:run { q = function() return { 1, 0, 0 } end, v = function() return { 0, 0, 0 } end, t = 1 } end)

-- growth without end is told, also where the energy overflows and where rows are in a file
local plate = dm.mesh { triangle = 6 }:field { form = 0, L = wave }
local name = os.tmpname() .. ".npy"
for _, rule in ipairs { "avi", "verlet" } do
  for _, t in ipairs { 20, 50 } do
    for _, file in ipairs { false, name } do
      local fine, failure = pcall(function()
        return plate:solver { rule = rule, h = 0.2 }:run { q = function(x, y) return math.sin(3 * x) * y end, v = function() return 0 end, t = t,
          file = file or nil }
      end)
      ok(not fine and failure.code == "blow_up" and failure.message:find(rule == "avi" and "63 of 63 cells" or "limit of stability, 0.136083"),
        ("%s to t = %d%s"):format(rule, t, file and ", rows in a file" or ""), failure.message)
    end
  end
end
os.remove(name)

tap.done()
