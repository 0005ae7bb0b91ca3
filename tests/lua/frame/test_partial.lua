-- frames up to isotropy (slices), and jets of functions of several variables
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local max = math.max

---- slices ----

local turns = dm.action { group = dm.SO(3), on = dm.R(3) }
local function slice(options)
  options.action = options.action or turns
  return dm.moving_frame(options)
end
local function pole(z) return { z[1], z[2] } end
local rho = slice { partial = true, cross_section = pole, branch = function(z) return z[3] end }
near(rho:invariants({ { 3, 4, 12 } })[1][3], 13, 1e-13, "the length is the invariant")
local worst, stream = 0, dm.random(4)
for i = 1, 20 do
  local z, h = dm.vector { 1 + i / 9, -0.3 * i, 0.4 }, dm.SO(3):random(stream, i)
  local I, H = rho:invariants({ z })[1], rho:invariants({ h * z })[1]
  worst = max(worst, (I - H):norm() / z:norm())
end
ok(worst < 1e-13, "it does not change along orbits", worst)
-- rho(h z) h rho(z)^-1 leaves the pole: isotropy
local z, h = dm.vector { 1, 2, -0.5 }, dm.SO(3):exp { 0.7, -0.3, 1.1 }
local k = rho(h * z) * h * rho(z):transpose()
near(k[3][3], 1, 1e-13, "equivariant up to the isotropy of the section")
ok(select(2, rho:check()).invariance < 1e-12, "rho:check looks at what is left")
-- SE(3) on points: all are one orbit, the section is a point
local place = slice { action = dm.action { group = dm.SE(3), on = dm.R(3) }, partial = true,
  cross_section = function(p) return { p[1], p[2], p[3] } end }
near(place:invariants({ { 3, 4, 12 } })[1]:norm(), 0, 1e-13, "every point goes to the origin")
-- of a free action a partial frame is a frame
local plane = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
  partial = true, cross_section = function(a, b) return { a[1], a[2], b[2] } end,
  branch = function(_, b) return b[1] end }
ok(plane:check() < 1e-11, "of a free action it is a frame")
local fourth = slice { action = dm.action { group = dm.SO(4), on = dm.R(4) }, partial = true,
  cross_section = function(p) return { p[1], p[2], p[3] } end, branch = function(p) return p[4] end }
near(fourth:invariants({ { 1, 2, 3, 4 } })[1][4], math.sqrt(30), 1e-13, "in four dimensions")
-- by a formula, which turns about the pole as it likes
local leaning = slice { partial = true, cross_section = pole, branch = function(z) return z[3] end,
  solution = function(z)
    local e, a = z / z:norm(), dm.vector { 0.3, 0.5, -0.8 }
    local w = a - e * e:dot(a)
    w = w / w:norm()
    return dm.matrix { w:totable(), e:cross(w):totable(), e:totable() }
  end }
near(leaning:invariants({ { 3, 4, 12 } })[1][3], 13, 1e-13, "a formula up to isotropy")
ok(leaning:check() < 1e-11, "whose replacement is that of its own points", leaning:check())
-- discrete isotropy: curvatures of a surface, whose normal may be turned about by half a turn
local surface = { action = dm.action { group = dm.SE(3), on = dm.R(3) }
  :jet(2, { independent = { 1, 2 } }),
  cross_section = function(z) return { z[1], z[2], z[3], z[4], z[5], z[7] } end,
  branch = function(z) return { z[6] - z[8], z[6] + z[8] } end }
raises("or partial = true", dm.moving_frame, surface)
surface.partial = true
local bent = dm.moving_frame(surface)
local ux, uy, uxx, uxy, uyy = 0.3, -0.4, 1.2, 0.3, 0.5
local W = math.sqrt(1 + ux ^ 2 + uy ^ 2)
local I = bent:invariants { { 1, 2, 3, ux, uy, uxx, uxy, uyy } }[1]
near(I[6] + I[8], ((1 + uy ^ 2) * uxx - 2 * ux * uy * uxy + (1 + ux ^ 2) * uyy) / W ^ 3, 1e-13,
  "twice the mean curvature")
near(I[6] * I[8], (uxx * uyy - uxy ^ 2) / W ^ 4, 1e-13, "Gauss' curvature")
ok(bent:check() < 1e-10, "it is one up to isotropy", bent:check())
raises("one up to isotropy", dm.invariant_problem, { frame = bent,
  L = function(I) return I[1][6] end })
-- quadratic forms have a square root of the determinant where they are definite
local function forms(domain, least)
  return slice { action = dm.action { group = dm.SL(2), on = dm.R(3), domain = domain,
    map = function(g, s)
      local S = g * dm.matrix { { s[1], s[2] }, { s[2], s[3] } } * g:transpose()
      return { S[1][1], S[1][2], S[2][2] }
    end }, partial = true, cross_section = function(s) return { s[2], s[1] - s[3] } end,
    branch = function(s) return s[1] - (least or 0) end }
end
near(forms(function(s) return dm.min(s[1] * s[3] - s[2] ^ 2, s[1]) end)
  :invariants({ { 2, 0.5, 3 } })[1][1], math.sqrt(5.75), 1e-13, "definite forms")
near(forms():invariants({ { 2, 0.5, 3 } })[1][1], math.sqrt(5.75), 1e-13, "a fifth of all forms")
raises("no point of the section was found", forms, nil, 40)
raises("by the action's domain", dm.moving_frame, {
  cross_section = function(z) return z[1] ^ 2 + 1 end, action = dm.action { group = dm.R(1), on = dm.R(1) } })
raises("does not go with partial", function()
  slice { partial = true, cross_section = pole, start = { 1, 0, 0, 0 } }
end)
raises("isotropy group of dimension 1", function() slice { cross_section = pole } end)
raises("orbits have dimension 2, so the cross-section must give 2 numbers", function()
  slice { partial = true, cross_section = function(p) return { p[1], p[2], p[3] - 1 } end }
end)
raises("one up to isotropy", function() rho:tangent({ 1, 2, 3 }) end)
raises("must be true or false", function() slice { partial = 1, cross_section = pole } end)
raises("up to isotropy", function()
  dm.invariant_problem { frame = rho, L = function(I) return I[1][3] end }
end)

---- jets of u(x, t) ----

local boost = dm.action { group = dm.R(1), on = dm.R(3), map = function(e, p)
  return { p[1] + 2 * e[1] * p[2], p[2], p[3] * dm.exp(-e[1] * p[1] - e[1] ^ 2 * p[2]) }
end }
local jet = boost:jet(2, { independent = { 1, 2 } })
ok(jet.dimension == 8, "x, t, u, u_x, u_t, u_xx, u_xt, u_tt")
local point, e = dm.vector { 0.7, 0.4, 1.1, 0.3, -0.2, 0.5, 0.6, -0.8 }, 1e-5
local g = jet:generator(point):column(1)
local d = (jet({ e }, point) - jet({ -e }, point)) * (1 / (2 * e))
ok((g - d):norm() < 1e-9, "generators are slopes of the moved jet", (g - d):norm())
-- solutions of the heat equation go to solutions
local heat = point:map(function(x, i) return i == 5 and point[6] or x end)
local moved = jet({ 0.3 }, heat)
near(moved[5], moved[6], 1e-13, "u_t = u_xx is kept")
-- rotations of (x, y) and a Laplacian that they leave
local turn = dm.action { group = dm.SO(2), on = dm.R(3), map = function(a, p)
  local c, s = dm.cos(a), dm.sin(a)
  return { c * p[1] - s * p[2], s * p[1] + c * p[2], p[3] }
end }
local flat = turn:jet(2, { independent = { 1, 2 } })
local w = flat(0.6, point)
near(w[6] + w[8], point[6] + point[8], 1e-13, "the Laplacian")
near(w[4] ^ 2 + w[5] ^ 2, point[4] ^ 2 + point[5] ^ 2, 1e-13, "the gradient's length")
-- a frame and invariants on such jets
local frame = dm.moving_frame { action = turn:jet(1, { independent = { 1, 2 } }),
  cross_section = function(p) return { p[5] } end, branch = function(p) return p[4] end }
near(frame:invariants({ { 0.3, 0.2, 1, 3, 4 } })[1][4], 5, 1e-13, "an invariant of jets of u(x, y)")
-- two functions of two variables: order of the entries
local pair = dm.action { group = dm.R(1), on = dm.R(4),
  map = function(a, p) return { p[1] + a[1], p[2], p[3], p[4] } end }
ok(pair:jet(2, { independent = { 1, 2 } }).dimension == 4 + 4 + 6, "u_x, v_x, u_t, v_t, u_xx, ...")
raises("must be an entry", function() boost:jet(1, { independent = { 1, 1 } }) end)
raises("nothing else", function() boost:jet(1, { independent = { 1, 2, 3 } }) end)

tap.done()
