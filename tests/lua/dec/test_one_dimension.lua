-- meshes on a line: all that is asked of points has one coordinate there
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

local K = dm.mesh { points = { { 0 }, { 0.4 }, { 1 }, { 1.5 }, { 2 } } } -- Delaunay: neighbours
ok(K.dimension == 1 and K:count(1) == 4 and K.ambient == 1, "a line of points")

-- -u'' = 2, u = x (2 - x): linear elements with a lumped load are exact at the vertices
local function exact(x) return x * (2 - x) end
local u = K:poisson { f = 2, fixed = { boundary = 0 } }
near((u - K:form(0, exact)):max(), 0, 1e-14, "Poisson's equation of a number")
u = K:poisson { f = function(x) return x - x + 2 end, fixed = { boundary = exact } }
near((u - K:form(0, exact)):max(), 0, 1e-14, "of functions of the point")
local flow = K:darcy { pressure = function(x) return 3 - x end }
near((flow.flux - K:form(0, function() return 1 end)):max(), 0, 1e-14, "Darcy flow of a linear pressure")
near(K:form(1, function(x) return { 3 * x * x } end):pair(K:fundamental()), 8, 1e-13, "an integral")
local X = K:vector_field(function(x) return { 2 * x } end, { on = "cells" })
near(X:div():at { 2 }, 2, 1e-14, "a divergence") -- at 0.4: (1.4 - 0.4) / 0.5
local heat = K:laplacian(0, { fixed = "boundary" }):eigen(1)
ok(heat.values[1] > 2 and heat.values[1] < 2.6, "the first frequency is near (pi / 2)^2", heat.values[1])

-- files and pictures
local name = os.tmpname()
for _, extension in ipairs { ".obj", ".off" } do
  K:save(name .. extension)
  local L = dm.mesh(name .. extension)
  ok(L.dimension == 1 and L:count(1) == 4 and L:volume(1) == K:volume(1), extension .. " of a line", tostring(L))
end
K:save(name .. ".vtk", { forms = { u = u } })
for _, a in ipairs { u, u:d(), X } do
  a:plot { file = name .. ".svg" }
  ok(io.open(name .. ".svg"):read "a":find "<svg", "drawn: " .. tostring(a):match "^[^:]+")
end
K:animate(name .. ".html", { forms = { u = u } })
ok(io.open(name .. ".html"):read "a":find "<canvas", "a page of a line")
for _, extension in ipairs { "", ".obj", ".off", ".vtk", ".svg", ".html" } do os.remove(name .. extension) end
tap.done()
