-- How much is saved when every triangle of a mesh takes a step of its own? (asynchronous variational integrators: Lew, Marsden, Ortiz, West 2003)
-- A membrane whose mesh is fine near one corner: one step for all is that of the smallest triangle, where nothing much happens.
local dm = require "dm"
local pi, sin, cos = math.pi, math.sin, math.cos
local picture = (arg and arg[1] or ".") .. "/own_steps.png"

local N = 24
local K = dm.mesh { grid = N, map = function(x, y) local s = 0.06 + 0.94 * math.max(x, y) return { s * x, s * y } end, dual = "barycentric" }
local membrane = K:field { form = 0, fixed = "boundary", L = function(u, v)
  return v:dot(v) / 2 - K:sum(2, function(a, cell) -- |grad u|^2 / 2, of linear functions on triangles
    local p = cell.points
    local e, f, b, c = p[2] - p[1], p[3] - p[1], a[2] - a[1], a[3] - a[1]
    local D = e[1] * f[2] - e[2] * f[1]
    local x, y = (b * f[2] - c * e[2]) / D, (c * e[1] - b * f[1]) / D
    return cell.volume * (x ^ 2 + y ^ 2) / 2
  end, u)
end }
local function mode(x, y) return sin(pi * x) * sin(2 * pi * y) end
local start = { q = mode, v = function() return 0 end, t = 2 }
local own = membrane:solver { rule = "avi" }
local run = own:run(start)
local report = own:report()
local energy = run:drift "energy"
print(run)
print(("%d triangles kicked %d times; equal steps of the least would have been %.1f times as many"):format(report.cells, report.events, report.gain))

-- beside Verlet's equal steps, at half of its limit as every triangle is at half of its own
local h = membrane:stability_limit "verlet" / 2
local verlet = membrane:solver { rule = "verlet", h = h }:run { q = start.q, v = start.v, t = 2, every = 50 }
local exact = K:form(0, function(x, y) return mode(x, y) * cos(2 * 5 ^ 0.5 * pi) end)
local off, its = (run:form(#run) - exact):norm() / K:form(0, mode):norm(), (verlet:form(#verlet) - exact):norm() / K:form(0, mode):norm()
print(("after 2 units of time the membrane is off by %.4f, by Verlet's %d equal steps by %.4f"):format(off, verlet.steps, its))
assert(report.gain > 4 and report.beyond == 0, "a gain, and no triangle beyond its limit")
assert(energy.largest < 0.04 * energy.mean, "the energy stays near")
assert(off < 1.2 * its + 0.01, "as right as equal steps: what is wrong is the mesh")
print("picture  " .. run:form(#run):plot { file = picture, title = ("A membrane by steps of its own in each of %d triangles"):format(report.cells), label = "height" })
