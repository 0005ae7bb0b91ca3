-- Through which of the three doors of Henon and Heiles' potential do random starts at E = 0.2 leave?
-- V has the symmetry of a triangle, so all doors are alike; at E > 1/6 they are open. The sweep is
-- stopped half-way, as by a crash, and taken up again.
local dm = require "dm"
local sqrt, pi, floor = math.sqrt, math.pi, math.floor
local picture = (arg and arg[1] or ".") .. "/escape.png"
local E, N = 0.2, 6000

local function V(x, y) return (x * x + y * y) / 2 + x * x * y - y ^ 3 / 3 end
local star = dm.system { name = "Henon-Heiles", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - V(q[1], q[2]) end }
local solver = star:solver { rule = "verlet", h = 0.05 }

-- uniform in the disk of radius 0.9 where V < E, in any direction: as symmetric as V
local dice = dm.random(1964)
local function start(i)
  for k = 0, 1000, 2 do
    local r, phi = 0.9 * sqrt(dice:uniform(i, k)), 2 * pi * dice:uniform(i, k + 1)
    local x, y = r * math.cos(phi), r * math.sin(phi)
    if V(x, y) < E then
      local speed, way = sqrt(2 * (E - V(x, y))), 2 * pi * dice:uniform(i, 2001)
      return { x, y }, { speed * math.cos(way), speed * math.sin(way) }
    end
  end
end

local journal = os.tmpname() .. ".journal"
local sweep = { members = N, steps = 6000, journal = journal, q = function(i) return (start(i)) end,
  v = function(i) return (select(2, start(i))) end }
local whole = solver:ensemble(sweep)
do  -- the crash: only a half of the file is there
  local f <close> = assert(io.open(journal, "rb"))
  local bytes = f:read "a"
  local g <close> = assert(io.open(journal, "wb"))
  g:write(bytes:sub(1, #bytes // 2))
end
local cloud = solver:ensemble(sweep)
os.remove(journal)
print(("%d starts were in the journal, %d were run again"):format(cloud.journal.found, cloud.journal.run))
assert(cloud.journal.found > 0 and cloud.journal.run > 0 and cloud.journal.found + cloud.journal.run == N)

-- who leaves falls down the cubic slope until the numbers end; the door is a third of the circle
local doors, inside, points = { 0, 0, 0 }, 0, {}
for k = 1, 3 do points[k] = { x = {}, y = {} } end
for i = 1, N do
  assert(cloud.q[i][1] == whole.q[i][1] and cloud.p[i][2] == whole.p[i][2], "the bits of one call")
  local q, x = cloud.q[i], start(i)
  local door = floor((math.atan(q[2], q[1]) + pi / 2) / (2 * pi / 3) + 1) % 3 + 1
  if cloud.status[i] == "ok" then inside = inside + 1 else
    doors[door] = doors[door] + 1
    table.insert(points[door].x, x[1])
    table.insert(points[door].y, x[2])
  end
end
local left = N - inside
print(("%d left by t = 300, through the doors %d, %d, %d; %d are still inside"):format(left, doors[1], doors[2], doors[3], inside))
local error = sqrt(left * 1 / 3 * 2 / 3)  -- of counting
for _, n in ipairs(doors) do assert(math.abs(n - left / 3) < 3 * error, "equal shares") end
for k, p in ipairs(points) do p.name, p.colour = "door " .. k, ({ "blue", "orange", "black" })[k] end
print("picture  " .. dm.figure { { points[1], points[2], points[3], style = "points", equal = true, xlabel = "x at the start",
  ylabel = "y at the start", title = "Starts by the door they leave through, E = 0.2" }, file = picture, size = { 700, 640 } })
