-- dm.moving_frame tries what it is given: right frames of many groups are taken, wrong ones refused
-- with the point and the defect, sections that orbits cut twice with a word about the branch
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local atan, cos, exp, log, sin, sqrt = dm.atan, dm.cos, dm.exp, dm.log, dm.sin, dm.sqrt
local action, frame = dm.action, dm.moving_frame
local R1, R2, R3 = dm.R(1), dm.R(2), dm.R(3)

local turn = action { group = dm.SO(2), on = R2 }
local back = action { group = dm.SO(2), on = R2, side = "right" }
local plane = action { group = dm.SE(2), on = R2 }
local plane_back = action { group = dm.SE(2), on = R2, side = "right" }
local space = action { group = dm.SE(3), on = R3 }
local rotations = action { group = dm.SO(3), on = R3 }
local moebius = action { group = dm.SL(2), on = R1 }
local areas = action { group = dm.SL(2), on = R2 }
local linear = action { group = dm.GL(2), on = R2 }
local affine = action { group = dm.semidirect(dm.GL(2), R2), on = R2 }
local line = action { group = dm.semidirect(dm.GL(1), R1), on = R1 }
local heisenberg = action { group = dm.Heisenberg(), on = dm.Heisenberg() }
local torus = action { group = dm.T(2), on = dm.T(2) }
local similar = action { group = dm.product(dm.SO(2), R1), on = R2, map = function(g, z)
  local c, s, e = cos(g[1]), sin(g[1]), exp(g[2][1])
  return { e * (c * z[1] - s * z[2]), e * (s * z[1] + c * z[2]) }
end }
local half_line = action { group = R1, on = R1, domain = function(z) return z[1] end,
  map = function(g, z) return { z[1] * exp(g[1]) } end }
local shifts = action { group = R1, on = R2, map = function(g, z) return { z[1] + g[1], z[2] } end }
local four = action { group = dm.SO(4), on = dm.R(4) }
-- turns by one and two angles at once; symmetric matrices, which some half turns leave alone
local weights = action { group = dm.SO(2), on = dm.R(4), map = function(g, z)
  local c, s, C, S = cos(g), sin(g), cos(2 * g), sin(2 * g)
  return { C * z[1] - S * z[2], S * z[1] + C * z[2], c * z[3] - s * z[4], s * z[3] + c * z[4] }
end }
local symmetric = action { group = dm.SO(3), on = dm.R(6), map = function(g, z)
  local m = dm.matrix { { z[1], z[4], z[5] }, { z[4], z[2], z[6] }, { z[5], z[6], z[3] } }
  local r = g * m * g:transpose()
  return { r[1][1], r[2][2], r[3][3], r[1][2], r[1][3], r[2][3] }
end }

---- sections, branches, formulas ----

local function first(z) return z[1] end
local function second(z) return z[2] end
local function angle(z) return -atan(z[2], z[1]) end
local function chord(a, b) return { a[1], a[2], b[2] } end
local function along(_, b) return b[1] end
local function triangle(a, b, c) return { a[1], a[2], a[3], b[2], b[3], c[3] } end
local function upright(a, b) return { a[2], a[3], b[3] } end
local function three(a, b, c) return { a[1] + 1, b[1], c[1] - 1 } end
local function rigid(a, b)
  local t = -atan(b[2] - a[2], b[1] - a[1])
  local c, s = cos(t), sin(t)
  return { -(c * a[1] - s * a[2]), -(s * a[1] + c * a[2]), t }
end
local function gram_schmidt(a, b)
  local e1 = a / a:norm()
  local w = b - e1 * e1:dot(b)
  local e2 = w / w:norm()
  return e1, e2, e1:cross(e2)
end
local function rows(e1, e2, e3) return dm.matrix { e1:totable(), e2:totable(), e3:totable() } end
local function moved(a, b, c)
  local e1, e2, e3 = gram_schmidt(b - a, c - a)
  local out = {}
  for i, e in ipairs { e1, e2, e3 } do out[i] = { e[1], e[2], e[3], -e:dot(a) } end
  out[4] = { 0, 0, 0, 1 }
  return dm.matrix(out)
end
local function thesis(a, b, c)  -- (6.5), up to a factor
  local u, v, w = a[1], b[1], c[1]
  return dm.matrix { { w - u, -(w - u) * v }, { w - 2 * v + u, w * v - 2 * w * u + v * u } }
end
local function volume(a, b, c) return 2 * (c[1] - a[1]) * (c[1] - b[1]) * (b[1] - a[1]) end

---- right ones ----

local good = {
  { "turns", turn, 1, second, first, angle },
  { "turns, solved", turn, 1, second, first },
  { "turns, a formula that takes one of two cuts", turn, 1, second, nil, angle },
  { "turns to an oblique line", turn, 1, function(z) return z[2] - 0.3 * z[1] end, first },
  { "turns to x = 1, which few orbits meet", turn, 1, function(z) return z[1] - 1 end, second,
    function(z) return dm.acos(1 / z:norm()) + angle(z) end },
  { "turns to x = 1, solved", turn, 1, function(z) return z[1] - 1 end, second },
  { "turns to a tiny section", turn, 1, function(z) return 1e-12 * z[2] end, first, angle },
  { "turns to a huge section", turn, 1, function(z) return 1e12 * z[2] end, first },
  { "a right action", back, 1, second, first, function(z) return -angle(z) end },
  { "a right action, solved", back, 1, second, first },
  { "rigid motions", plane, 2, chord, along, rigid },
  { "rigid motions, solved", plane, 2, chord, along },
  { "rigid motions, steep", plane, 2, function(a, b)
    return { dm.tanh(20 * a[1]), dm.tanh(20 * a[2]), dm.tanh(20 * b[2]) }
  end, along },
  { "rigid motions from the right", plane_back, 2, chord, along },
  { "velocities", plane:tangent(), 1, function(z) return { z[1], z[2], z[4] } end,
    function(z) return z[3] end },
  { "graphs", plane:jet(2, { independent = 1 }), 1,
    function(z) return { z[1], z[2], z[3] } end, function(z) return z[4] end },
  { "space", space, 3, triangle, function(_, b, c) return { b[1], c[2] } end, moved },
  { "space, solved", space, 3, triangle, function(_, b, c) return { b[1], c[2] } end },
  { "rotations", rotations, 2, upright, function(a, b) return { a[1], b[2] } end,
    function(a, b) return rows(gram_schmidt(a, b)) end },
  { "the sphere", action { group = dm.SO(3), on = dm.S(2) }, 2, upright,
    function(a, b) return { a[1], b[2] } end },
  { "SL(2) on a line", moebius, 3, three, nil,
    function(a, b, c) return thesis(a, b, c) / sqrt(volume(a, b, c)) end },
  { "SL(2) on a line, solved", moebius, 3, three },
  { "SL(2) on vectors", areas, 2, function(a, b) return { a[1] - 1, a[2], b[1] } end, nil,
    function(a, b)
      local d = a[1] * b[2] - a[2] * b[1]
      return dm.matrix { { b[2] / d, -b[1] / d }, { -a[2], a[1] } }
    end },
  { "GL(2)", linear, 2, function(a, b) return { a[1] - 1, a[2], b[1], b[2] - 1 } end, nil,
    function(a, b) return dm.matrix { { a[1], b[1] }, { a[2], b[2] } }:inverse() end },
  { "affine maps of the plane", affine, 3,
    function(a, b, c) return { a[1], a[2], b[1] - 1, b[2], c[1], c[2] - 1 } end },
  { "multiples, of both signs", action { group = dm.GL(1), on = R2 }, 1,
    function(z) return z:dot(z) - 1 end, first },
  { "affine maps of the line", line, 2, function(a, b) return { a[1], b[1] - 1 } end, nil,
    function(a, b)
      local s = 1 / (b[1] - a[1])
      return { dm.matrix { { s } }, { -s * a[1] } }
    end },
  { "Heisenberg", heisenberg, 1, function(z) return z end, nil, function(z) return -z end },
  { "similarities", similar, 1, function(z) return { z[1] - 1, z[2] } end, nil,
    function(z) return { angle(z), { -log(z:norm()) } } end },
  { "similarities, solved", similar, 1, function(z) return { z[1] - 1, z[2] } end },
  { "the torus", torus, 1, function(z) return { sin(z[1]), sin(z[2]) } end,
    function(z) return { cos(z[1]), cos(z[2]) } end },
  { "few orbits that meet the section", shifts, 1, function(z) return z[1] ^ 2 - z[2] end, first },
  { "SL(2), where few have a diagonal", areas, 2,
    function(a, b) return { a[2], b[1], a[1] - b[2] } end, first },
  { "a local action", half_line, 1, function(z) return z[1] - 1 end, nil,
    function(z) return { -log(z[1]) } end },
}
-- a section of two pieces, one of them outside of the branch
good[#good + 1] = { "shifts, a branch", shifts, 1, function(z) return z[1] * (z[1] - 60) end,
  function(z) return 30 - z[1] end }
local function options(case)
  return { action = case[2], points = case[2].base and case[2].points and nil or case[3],
    cross_section = case[4], branch = case[5], solution = case[6] }
end
for _, case in ipairs(good) do
  local fine, rho = pcall(frame, options(case))
  local defect = fine and rho:check { samples = 3 }
  ok(fine and defect < 1e-11, case[1], fine and defect or rho)
end

---- wrong ones: what the error says ----

local off, twice = "is not on the cross-section (off by", "cuts the cross-section more than once"
local function on(where, wrong)  -- the wrong formula there, the right one elsewhere
  return function(z) return where(z) and wrong(z) or angle(z) end
end
local function mirrored(z) return -angle(z) end
local bad = {
  { "its inverse is", turn, 1, second, first, mirrored },
  { off, turn, 1, second, first, on(function(z) return z[1] < 0 end, mirrored) },
  { off, turn, 1, second, first, on(function(z) return z[1] > 1.5 end, mirrored) },
  { off, turn, 1, second, first, on(function(z) return z[2] < -2 end, mirrored) },
  { off, turn, 1, second, first, function(z) return angle(z) + 1e-5 * dm.max(0, z[1] - 0.3) end },
  { off, turn, 1, second, first, function(z) return angle(z) + 0.1 * dm.max(0, z:norm() - 4) end },
  { off, turn, 1, function(z) return 1e-12 * z[2] end, first, function() return 0 end },
  { "the branch condition does not hold", turn, 1, second, first,
    function(z) return -atan(z[2] / z[1]) end },
  { twice, turn, 1, second, nil, function(z) return -atan(z[2] / z[1]) end },
  { off, back, 1, second, first, angle },
  { off, plane_back, 2, chord, along, rigid },
  { off, plane, 2, chord, along,
    function(a, b) return { -a[1], -a[2], -atan(b[2] - a[2], b[1] - a[1]) } end },
  { "is no element of SO(3): its determinant is -1", rotations, 2, upright,
    function(a, b) return { a[1], b[2] } end, function(a, b)
      local e1, e2, e3 = gram_schmidt(a, b)
      return rows(e1, e2, -e3)
    end },
  { "is no element of SO(3): its columns are off", rotations, 2, upright,
    function(a, b) return { a[1], b[2] } end, function(a, b)
      local e1, e2, e3 = gram_schmidt(a, b)
      return rows(e1, e2, e3 * 1.0001)
    end },
  { "is no element of SL(2): its determinant is", moebius, 3, three, nil, thesis },
  { "is no element of SL(2): its determinant is -1", moebius, 3, three, nil,
    function(a, b, c) return thesis(a, b, c) / sqrt(dm.abs(volume(a, b, c))) end },
  { off, linear, 2, function(a, b) return { a[1] - 1, a[2], b[1], b[2] - 1 } end, nil,
    function(a, b) return dm.matrix { { a[1], a[2] }, { b[1], b[2] } }:inverse() end },
  { off, heisenberg, 1, function(z) return z end, nil,
    function(z) return { -z[1], -z[2], z[3] } end },
  { "the solution gives something else", turn, 1, second, first, function() return { 1, 2 } end },
  { "the solution gives something else", turn, 1, second, first, function() end },
  -- sections that orbits cut more than once, solved for
  { "give branch", turn, 1, second },
  { "branch holds at both", turn, 1, second, function() return 1 end },
  { "give branch", turn, 1, function(z) return z[1] - 1 end },
  { "give branch", turn, 1, function(z) return z[2] - z[1] ^ 2 end },
  { "branch holds at both", turn, 1, function(z) return z[2] - z[1] ^ 2 end, second },
  { "give branch", back, 1, second },
  { "give branch", plane, 2, chord },
  { "give branch", space, 3, triangle },
  { "branch holds at both", space, 3, triangle, along },
  { "give branch", line, 2, function(a, b) return { a[1], b[1] ^ 2 - 1 } end },
  { "give branch", action { group = dm.GL(1), on = R2 }, 1, function(z) return z:dot(z) - 1 end },
  { "give branch", similar, 1, function(z) return { z[1] ^ 2 - 1, z[2] } end },
  { "give branch", torus, 1, function(z) return { sin(z[1]), sin(z[2]) } end },
  { "branch holds at both", torus, 1, function(z) return { sin(z[1]), sin(z[2]) } end,
    function(z) return cos(z[1]) end },
  { "give branch", shifts, 1, function(z) return z[1] ^ 2 - z[2] end },
  { "give branch", shifts, 1, function(z) return z[1] * (z[1] - 15) end },
  { "give branch", areas, 2, function(a, b) return { a[1] ^ 2 - 1, a[2], b[1] } end },
  { "give branch", areas, 2, function(a, b) return { a[1] ^ 2 - 1, a[2] - a[1] / 3, b[1] } end },
  { "give branch", affine, 3,
    function(a, b, c) return { a[1], a[2], b[1] ^ 2 - 1, b[2], c[1], c[2] - 1 } end },
  { "branch holds at both", space, 3, triangle, function(_, _, c) return c[2] end },
  { "branch holds at both", four, 3,
    function(a, b, c) return { a[2], a[3], a[4], b[3], b[4], c[4] } end,
    function(a, _, c) return { a[1], c[3] } end },
  { "give branch", plane:jet(2, { independent = 1 }), 1,
    function(z) return { z[1], z[2], z[3] } end },
  -- actions that are free locally only
  { "cuts the cross-section more than once", weights, 1, second, first },
  { "since the action is not free at z", symmetric, 1, function(z) return { z[4], z[5], z[6] } end,
    function(z) return { z[1] - z[2], z[2] - z[3] } end },
  { "cuts the cross-section more than once", symmetric, 1,
    function(z) return { z[4], z[5], z[6] } end },
}
-- two cuts far apart along the orbit, and cuts again and again
for _, far in ipairs { 20, 60, 200, -20, -60, -200 } do
  local function twice_at(x) return x * (x - far) end
  for _, case in ipairs {
    { shifts, 1, function(z) return twice_at(z[1]) end },
    { plane, 2, function(a, b) return { twice_at(a[1]), a[2], b[2] - a[2] } end,
      function(a, b) return b[1] - a[1] end },
    far > 0 and { space, 3, function(a, b, c)
      b, c = b - a, c - a
      return { twice_at(a[1]), a[2], a[3], b[2], b[3], c[3] }
    end, function(a, b, c) return { b[1] - a[1], c[2] - a[2] } end } or nil,
  } do
    bad[#bad + 1] = { twice, table.unpack(case, 1, 4) }
  end
end
bad[#bad + 1] = { twice, shifts, 1, function(z) return sin(z[1] / 20) end }
bad[#bad + 1] = { twice, shifts, 1, function(z) return sin(z[1] / 60) end,
  function(z) return cos(z[1] / 60) end }
for i, case in ipairs(bad) do
  local fine, why = pcall(frame, options(case))
  ok(not fine and tostring(why):find("dm.moving_frame: no moving frame: ", 1, true)
    and tostring(why):find(case[1], 1, true) and tostring(why):find "z = %(",
    "refused: " .. case[1], ("%d: %s"):format(i, tostring(why)))
end
raises("the solution fails at random points", frame, { action = turn, cross_section = second,
  solution = function() return nil + 1 end })
raises("the branch must return a number", frame, { action = turn, cross_section = second,
  branch = function(z) return z[1] > 0 end })
raises("the branch gives nothing", frame, { action = turn, cross_section = second,
  branch = function() end })
raises("the branch fails at", frame, { action = turn, cross_section = second,
  branch = function(z) return z[1] + nil end })
raises("solution must return one value", frame, { action = turn, cross_section = second,
  solution = function(z) return angle(z), 1 end })
raises("sigma must return one value", function()
  frame(options(good[1])):invariantize { sigma = function() return 1, 2 end,
    Ld = dm.discrete_lagrangian { Q = R2, h = 1, Ld = function(a, b, h) return a:dot(b) * h end } }
end)
raises("option 'invariants' must be a table { name = { point, entry } or a function }", frame,
  { action = turn, cross_section = second, branch = first, invariants = 3 })
raises("nowhere transversal", frame, { action = turn, branch = first,
  cross_section = function(z) return dm.tanh(20 * z:norm()) end })
raises("nowhere transversal", frame, { action = turn, branch = first,
  cross_section = function(z) return z[2] ^ 2 end })
local function by_the_sign(z) return z[1] > 0 and z[2] or 2 * z[2] end
raises("dm.moving_frame: the cross-section has no derivative: ", frame, { action = turn,
  cross_section = by_the_sign, branch = first, solution = angle })
raises("met a symbol while 'equations' of the moving frame is traced", frame, { action = turn,
  cross_section = by_the_sign, branch = first })
raises("dm.moving_frame: the group element must be a vector", frame, { action = turn,
  cross_section = second, branch = first, start = function() return "here" end })
-- sections that are something else on numbers, at first or later
raises("is not what its trace says", frame, { action = turn, branch = first,
  cross_section = function(z) return { type(z[2]) == "number" and z[2] or z[2] - 0.1 } end })
local calls = 0
raises("is not on the cross-section", frame, { action = turn, branch = first,
  cross_section = function(z)
    calls = calls + 1
    return { z[2] - (calls > 40 and 0.1 or 0) }
  end })
-- groups of one's own: of matrices without relations that have a name, of vectors longer than d
local similar = dm.group { name = "Sim", basis = { { { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 0 } },
  { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 } }, { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 } } } }
local own = { action = dm.action { group = similar, on = dm.R(2) }, points = 2,
  cross_section = function(a, b) return { a[1], a[2], b[1] - 1, b[2] } end }
local ratio = dm.moving_frame(own):invariants { { 1, 2 }, { 1, 4 }, { 0, 2 } }[3]
near(ratio[1] + 2 * ratio[2], 1, 1e-13, "three points up to similarity: i/2")
own.start = function() return similar:identity() end
near(dm.moving_frame(own):invariants({ { 0, 0 }, { 2, 0 }, { 3, 0 } })[3][1], 1.5, 1e-13,
  "a start that is an element")
local circle = dm.group { dimension = 1, identity = { 1, 0 },
  mul = function(a, b) return { a[1] * b[1] - a[2] * b[2], a[1] * b[2] + a[2] * b[1] } end,
  inv = function(a) return { a[1], -a[2] } end,
  exp = function(x) return { dm.cos(x[1]), dm.sin(x[1]) } end,
  log = function(a) return { dm.atan(a[2], a[1]) } end }
near(dm.moving_frame { action = dm.action { group = circle, on = dm.R(2),
  map = function(a, z) return { a[1] * z[1] - a[2] * z[2], a[2] * z[1] + a[1] * z[2] } end },
  cross_section = function(z) return { z[2] } end, branch = function(z) return z[1] end }
  :invariants({ { 3, -4 } })[1][1], 5, 1e-13, "unit complex numbers")

tap.done()
