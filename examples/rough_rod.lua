-- How far does a rod stretch whose stiffness changes forty times along it? Elements that know the material are exact at
-- their nodes, hats on the same nodes see a third of it (Leok 5.7.1, appendix C, figure 5.5).
local dm = require "dm"
local sin, pi, abs, max = math.sin, math.pi, math.abs, math.max
local folder = arg and arg[1] or "."

local eps = 0.025
local function a(x) return 10 / (1 + 0.95 * sin(2 * pi * x / eps)) end
local function f(x) return x ^ 2 end
local function rod(count, shape)
  local x = {}
  for i = 0, count do x[i + 1] = i / count end
  return dm.msfem { a = a, f = f, x = x, period = eps, shape = shape }
end
local function off(s)
  local worst = 0
  for i = 1, #s.u do worst = max(worst, abs(s.u[i] - s:exact(s.x[i]))) end
  return worst
end

for _, count in ipairs { 5, 10, 20 } do
  local multiscale, linear = off(rod(count)), off(rod(count, "linear"))
  print(("%2d elements: at the nodes multiscale is off by %.1e, hats by %.1e"):format(count, multiscale, linear))
  assert(multiscale < 1e-15, "exact to round-off")
  assert(linear > 5e-4, "hats see a stiffness that is too large by far, at any of these meshes")
end

-- the least value of figure 5.5
local s, least, at = rod(10), 0, 0
for k = 0, 20000 do
  local x = k / 20000
  local u = s:exact(x)
  if u < least then least, at = u, x end
end
print(("least value %.8f at %.4f"):format(least, at))
assert(abs(least + 0.00388885) < 1e-8 and abs(at - 0.62677) < 1e-4)

-- between the nodes: the solution, the two kinds of elements, and a shape function, which looks like the solution
local x, shape, exact, near, hats = {}, {}, {}, {}, {}
local linear = rod(10, "linear")
for k = 0, 1000 do
  local z = k / 1000
  x[#x + 1], exact[#exact + 1], near[#near + 1], hats[#hats + 1] = z, s:exact(z), s:value(z), linear:value(z)
  shape[#shape + 1] = s:shape(6, z)
end
dm.figure { file = folder .. "/rough_rod.png", title = "A rod of fast changing stiffness",
  { { x = x, y = exact, name = "exact" }, { x = x, y = near, name = "multiscale" }, { x = x, y = hats, name = "hats" },
    { x = s.x, y = s.u, name = "nodes", style = "points" }, xlabel = "x", ylabel = "u" },
  { { x = x, y = shape, name = "shape function of node 6" }, xlabel = "x", ylabel = "phi", xrange = { 0.35, 0.65 } } }
print("picture  " .. folder .. "/rough_rod.png")
