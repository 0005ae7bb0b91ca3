-- A springy wire bent in space, chords of equal length: what stays the same along it while curvature and torsion change?
-- The integral of curvature^2, in the invariants of SE(3) acting on triples of points (the frame is solved for). Force and
-- moment are the same everywhere (Noether), so that curvature^2 torsion is a constant of every such wire: here from five
-- points of a twisted cubic, with the third bend nobody asked for. The thesis of Bogfjellmo does not treat this action.
local dm = require "dm"
local abs, asin, max = math.abs, math.asin, math.max
local picture = (arg and arg[1] or ".") .. "/space_elastica.png"

local rho = dm.moving_frame { action = dm.action { group = dm.SE(3), on = dm.R(3) }, points = 3,
  cross_section = function(a, b, c) return { a[1], a[2], a[3], b[2], b[3], c[3] } end,
  branch = function(a, b, c) return { b[1], c[2] } end }
assert(rho:check() < 1e-12)

-- five points of (t, t^2, t^3/2) at distance d, by bisection
local function beginning(d)
  local out, t = { dm.vector { 0, 0, 0 } }, 0
  for i = 2, 5 do
    local low, high, z = t, t + 2 * d, nil
    for _ = 1, 60 do
      t = (low + high) / 2
      z = dm.vector { t, t ^ 2, t ^ 3 / 2 }
      if (z - out[i - 1]):norm() < d then low = t else high = t end
    end
    out[i] = z
  end
  return out
end

local length, worst, figure = 4, {}, {}
for k, n in ipairs { 100, 200, 400, 800 } do
  local d = length / n
  local wire = dm.invariant_problem { frame = rho, points = 3, invariants = { chord = { 2, 1 }, bend = { 3, 2 } },
    L = function(I) return I.bend ^ 2 / I.chord ^ 3 end, constraint = function(I) return I.chord - d end }
  local curve = wire:solve { points = beginning(d), n = n + 1 }
  local P, s, kappa, tau, both, first = curve.points, {}, {}, {}, {}, nil
  for i = 5, n - 2 do
    local e1, e2, e3 = P[i + 1] - P[i], P[i + 2] - P[i + 1], P[i + 3] - P[i + 2]
    local b1, b2 = e1:cross(e2), e2:cross(e3)
    local j = i - 4
    s[j], kappa[j] = i * d, (b1:norm() + b2:norm()) / (2 * d ^ 3)
    tau[j] = asin(b1:cross(b2):norm() / (b1:norm() * b2:norm())) / d
    both[j] = kappa[j] ^ 2 * tau[j]
  end
  first, worst[k] = both[1], 0
  for _, c in ipairs(both) do worst[k] = max(worst[k], abs(c / first - 1)) end
  print(("%4d chords: curvature %.2f to %.2f, torsion %.2f to %.2f, curvature^2 torsion %.4f to %.1e"):format(n,
    math.min(table.unpack(kappa)), max(table.unpack(kappa)), math.min(table.unpack(tau)), max(table.unpack(tau)), first, worst[k]))
  if n == 400 then
    local x, y, z = P:column(1), P:column(2), P:column(3)
    figure = { { title = "the wire, two views", equal = true, xlabel = "x", ylabel = "y, z", { x = x, y = y, name = "(x, y)" }, { x = x, y = z, name = "(x, z)" } },
      { title = "along it", log = "y", xlabel = "arc length", ylabel = "curvature, torsion", { x = s, y = kappa, name = "curvature" }, { x = s, y = tau, name = "torsion" },
        { x = s, y = both, name = "curvature^2 torsion" } }, file = picture, size = { 1100, 480 }, title = "elastica in space, in the invariants of SE(3)" }
  end
end
assert(worst[4] < 1e-3 and worst[3] / worst[4] > 3 and worst[2] / worst[3] > 3, "it should be constant to second order in the chord")
print("picture  " .. dm.figure(figure))
