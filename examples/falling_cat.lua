-- How does a cat that falls with no spin land on its feet? Three rods with two hinges: bending the joints in turn goes round a loop
-- of shapes, and the body comes back turned, although its angular momentum was zero all the time (Leok, 4.1 and 4.6.4). The
-- discrete mechanical connection of a rule takes the loop's points to the turn; -closed integral of a.dx is what it tends to.
local dm = require "dm"
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/falling_cat.png"

local cat = dm.system { name = "three rods", Q = dm.R(3), coordinates = { "theta", "a1", "a2" }, L = function(q, v) -- rods 1, 0.8, 0.8
  local w1, w2 = v[1] + v[2], v[1] + v[3]
  local u = dm.vector { -0.4 * dm.sin(q[2]) * w1, v[1] / 2 + 0.4 * dm.cos(q[2]) * w1 }
  local w = dm.vector { 0.4 * dm.sin(q[3]) * w2, -v[1] / 2 - 0.4 * dm.cos(q[3]) * w2 }
  return 0.3 * (u:dot(u) + w:dot(w)) - 0.36 / 4.4 * (u + w):dot(u + w) + v[1] ^ 2 / 24 + 0.016 * (w1 ^ 2 + w2 ^ 2)
end }
local function connection(rule) return dm.discrete_lagrangian(cat, { rule = rule, h = 0.1 }):connection { cyclic = { "theta" } } end
local function circle(n)
  local loop = {}
  for i = 0, n do loop[i + 1] = { 0.5 + 0.7 * cos(2 * pi * i / n), -0.4 + 0.7 * sin(2 * pi * i / n) } end
  return loop
end

-- -closed integral of a.dx; the trapezoidal rule of a periodic function errs less than any power of n
local exact = cat:routh { cyclic = "theta", mu = 0 }
  :holonomy(function(s) return { 0.5 + 0.7 * dm.cos(2 * pi * s), -0.4 + 0.7 * dm.sin(2 * pi * s) } end)[1]
for _, rule in ipairs { "midpoint", "gauss(2)" } do -- curves of a rule go along chords: order 2 in the number of points
  local A, errors = connection(rule), {}
  for k, n in ipairs { 32, 64, 128 } do errors[k] = abs(A:holonomy(circle(n))[1] - exact) end
  print(("%-9s 128 points: %.9f rad, error %.1e, order %.2f"):format(rule, A:holonomy(circle(128))[1], errors[3], math.log(errors[2] / errors[3], 2)))
  assert(abs(math.log(errors[2] / errors[3], 2) - 2) < 0.05 and abs(exact) > 0.03, "it has turned")
end
-- the other way round turns it back; that of a small loop is minus its area times the curvature
local A, loop, back, small, r = connection "midpoint", circle(64), {}, {}, 0.01
for i = 1, #loop do
  back[i] = loop[#loop + 1 - i]
  small[i] = { 0.5 + r * cos(2 * pi * (i - 1) / 64), -0.4 + r * sin(2 * pi * (i - 1) / 64) }
end
assert(abs(A:holonomy(loop)[1] + A:holonomy(back)[1]) < 1e-12, "the other way round it turns back")
assert(abs(A:holonomy(small)[1] / (pi * r ^ 2) / -A:curvature({ 0.5, -0.4 }, 1, 2)[1] - 1) < 0.01, "curvature")

-- ten loops, as a page that moves
local turns, columns = {}, { {}, {}, {}, {}, {}, {}, {} }
for i = 0, 640 do turns[i + 1] = circle(64)[i % 64 + 1] end
for i, q in ipairs(A:multi_lift(turns, { 0, table.unpack(turns[1]) })) do
  columns[1][i] = (i - 1) / 20
  for k = 1, 3 do columns[k + 1][i], columns[k + 4][i] = q[k], 0 end
end
local path = dm.path { system = cat, h = 0.05, columns = columns }
local function joints(q)
  local x, y = cos(q[1]) / 2, sin(q[1]) / 2
  return { { x + 0.8 * cos(q[1] + q[2]), y + 0.8 * sin(q[1] + q[2]) }, { x, y }, { -x, -y }, { -x - 0.8 * cos(q[1] + q[3]), -y - 0.8 * sin(q[1] + q[3]) } }
end
path:animate(picture:gsub("png$", "html"), { title = "a falling cat", plots = { "theta", "a1", "a2" },
  draw = function(q) return { points = joints(q), rods = { { 1, 2 }, { 2, 3 }, { 3, 4 } } } end })
local panel = { title = "before, and after ten loops", equal = true, xlabel = "x", ylabel = "y" }
for _, k in ipairs { 1, 641 } do
  local x, y = {}, {}
  for i, p in ipairs(joints(path.q[k])) do x[i], y[i] = p[1], p[2] end
  panel[#panel + 1] = { x = x, y = y, name = ("theta = %.3f"):format(path.q[k][1]) }
end
print("picture  " .. dm.figure { panel, { { x = path:column("t"), y = path:column "theta", name = "theta" }, title = "the turn, ten loops of shapes", xlabel = "t", ylabel = "theta" }, file = picture, size = { 1100, 480 }, title = "A falling cat" })
