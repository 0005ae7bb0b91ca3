-- An upright disk rolls on a table without slipping: where does each rule put it after fifty turns?
-- Mass, radius and both inertias are 1 (Bloch 2003, 1.4). The motion is known: the disk turns at the rate w,
-- rolls at the rate r, and its point of contact goes around a circle of radius r / w.
local dm = require "dm"
local sin, cos, pi, max = math.sin, math.cos, math.pi, math.max
local picture = (arg and arg[1] or ".") .. "/rolling_disk.png"

local disk = dm.system { name = "rolling disk", Q = dm.R(4), coordinates = { "x", "y", "roll", "heading" },
  L = function(_, v) return v:dot(v) / 2 end,
  rolling = function(q, v) return { v[1] - cos(q[4]) * v[3], v[2] - sin(q[4]) * v[3] } end }

local r, w = 1, 2  -- rolling, turning, rad per unit of time
local start = { q = { 0, 0, 0, 0 }, v = { r, 0, r, w } }
local function exact(t) return dm.vector { r / w * sin(w * t), r / w * (1 - cos(w * t)), r * t, w * t } end

-- largest distance from the exact motion over fifty turns, and its growth from h to h/2
local turn, turns = 2 * pi / w, 50
local function distance(rule, n)
  local h = turn / n
  local path = disk:solver { rule = rule, h = h }:run { q = start.q, v = start.v, steps = n * turns }
  local worst = 0
  for i = 1, #path do worst = max(worst, (path.q[i] - exact(path.t[i])):norm()) end
  assert(path:worst "rolling" < 1e-13, "the disk slips")
  assert(math.abs(path:drift("energy").per_time) < 1e-15, "its energy should stay")
  return worst, path
end
local orders = { { "midpoint", 2 }, { "gauss(2)", 4 }, { "lobatto(3)", 4 }, { "gauss(3)", 6 }, { "gauss(4)", 8 } }
local lines, ns = {}, { 10, 20, 40 }
print "rule            10 steps a turn   20   40   order"
for _, row in ipairs(orders) do
  local rule, want = row[1], row[2]
  local errors = {}
  for i, n in ipairs(ns) do errors[i] = distance(rule, n) end
  local order = math.log(errors[1] / errors[2], 2)
  print(("%-12s %18.1e %8.1e %8.1e %5.2f"):format(rule, errors[1], errors[2], errors[3], order))
  assert(math.abs(order - want) < 0.25, rule .. " should have order " .. want)
  lines[#lines + 1] = { x = ns, y = errors, name = rule }
end

-- one turn by midpoint at a coarse step against the circle
local _, path = distance("midpoint", 10)
local circle, points = { {}, {} }, { {}, {} }
for i = 0, 100 do circle[1][i + 1], circle[2][i + 1] = exact(turn * i / 100)[1], exact(turn * i / 100)[2] end
for i = 1, 41 do points[1][i], points[2][i] = path.q[i][1], path.q[i][2] end
print("picture  " .. dm.figure { title = "Rolling disk", file = picture,
  { { x = circle[1], y = circle[2], name = "exact" }, { x = points[1], y = points[2], name = "midpoint, 10 steps a turn" },
    equal = true, xlabel = "x", ylabel = "y", title = "point of contact, four turns" },
  { lines[1], lines[2], lines[3], lines[4], lines[5], log = "xy", style = "linespoints", xlabel = "steps a turn",
    ylabel = "distance after 50 turns", title = "error" } })
