-- A thin strip bent in the plane, chords of equal length: how good are its points when only chords and bends are stepped?
-- The sum of sigma^2/lambda^3, approximately the integral of curvature^2, in the invariants of rigid motions: the chord
-- lambda and the bend sigma of three points; lambda = Lambda by a multiplier. The equations in invariants are derived from the action
-- and the cross-section, the points are recovered from the frame (Bogfjellmo 2011, 6.2, figure 6.2).
local dm = require "dm"
local sin, cos, sqrt, max = math.sin, math.cos, math.sqrt, math.max
local picture = (arg and arg[1] or ".") .. "/elastica.png"

local rho = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
  cross_section = function(a, b) return { a[1], a[2], b[2] } end, branch = function(a, b) return b[1] end }
local function elastica(Lambda)
  return dm.invariant_problem { name = "elastica", frame = rho, invariants = { lambda = { 2, 1 }, sigma = { 3, 2 } },
    L = function(I) return I.sigma ^ 2 / I.lambda ^ 3 end,
    constraint = function(I) return I.lambda - Lambda end,
    inside = function(I) return I.lambda ^ 2 / 2 - I.sigma ^ 2 end } -- no sharper corners than half a right angle
end

-- the strip itself: kappa'' = -kappa^3/2, theta' = kappa, (x, y)' = (cos theta, sin theta)
local fine = 25600
local strip = dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 end,
  force = function(q, v) return { -q[1] ^ 3 / 2, v[1], -sin(q[2]) * q[1], cos(q[2]) * q[1] } end }
  :solver { rule = "gauss(5)", h = 1 / fine }
  :run { q = { 0, 0, 0, 0 }, v = { 200, 0, 1, 0 }, steps = fine, every = 1 }
local function reference(i, n) local q = strip.q[1 + i * fine // n] return { q[3], q[4] } end

local curves = { title = "points of the strip", equal = true, xlabel = "x", ylabel = "y" }
local errors = { title = "largest error", log = "xy", xlabel = "Lambda", ylabel = "error", { x = {}, y = {}, name = "elastica" } }
local last
for _, n in ipairs { 25, 50, 100, 200, 400, 800, 1600, 3200, 6400 } do
  local first, x, y, worst = {}, {}, {}, 0
  for i = 0, 4 do first[i + 1] = reference(i, n) end
  local problem = elastica(1 / n)
  local fine_run, curve = pcall(problem.solve, problem, { points = first, n = n + 1 })
  if n == 25 then -- the equation for sigma has no root with sigma^2 < Lambda^2/2 where the strip bends most
    assert(not fine_run and curve.code == "no_convergence" and #curve.path > 5, "1/25 is too coarse")
    print(curve)
    curve = curve.path
  else
    assert(fine_run, curve)
    for i = 0, n do
      local z, u = reference(i, n), curve.points[i + 1]
      worst = max(worst, sqrt((u[1] - z[1]) ^ 2 + (u[2] - z[2]) ^ 2))
    end
    print(("Lambda = 1/%-5d error %.2e%s"):format(n, worst, last and ("   order %.2f"):format(math.log(last / worst, 2)) or ""))
    assert(n <= 200 or math.abs(math.log(last / worst, 2) - 2) < 0.02, "it should be of order 2 from 1/200 on")
    local list = errors[1]
    list.x[#list.x + 1], list.y[#list.y + 1], last = 1 / n, worst, worst
  end
  for i = 1, #curve do x[i], y[i] = curve.points[i][1], curve.points[i][2] end
  if n <= 200 then curves[#curves + 1] = { x = x, y = y, name = "1/" .. n } end
end
local x, y = {}, {}
for i = 0, 400 do x[i + 1], y[i + 1] = table.unpack(reference(i, 400)) end
curves[#curves + 1] = { x = x, y = y, name = "the strip" }
print("picture  " .. dm.figure { curves, errors, file = picture, size = { 1100, 480 }, title = "elastica in the invariants of SE(2)" })
