-- frames to the last digit however their section is written, and steps of frames that have a kink
-- where both points are the same
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local abs, cos, sin, max, pi = math.abs, math.cos, math.sin, math.max, math.pi

---- sections that are flat far away send Newton's method around many times ----

local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
local function right(z) return z[1] end
local curves = {
  { "y", function(y) return y end },
  { "tanh(5 y)", function(y) return dm.tanh(5 * y) end },
  { "atan(100 y)", function(y) return dm.atan(100 * y) end },
  { "sinh(9 y)", function(y) return dm.sinh(9 * y) end },
  { "y/(1 + y^2)", function(y) return y / (1 + y ^ 2) end },
  { "1e-9 y + y^3", function(y) return 1e-9 * y + y ^ 3 end },
}
for _, curve in ipairs(curves) do
  local name, f = curve[1], curve[2]
  local rho = dm.moving_frame { action = turn, cross_section = function(z) return f(z[2]) end,
    branch = right }
  local off, apart, turns = 0, 0, 0
  for i = 1, 50 do
    local r = i / 7
    local z = { cos(i) * r, sin(i) * r }
    local g = rho(z)
    off = max(off, abs(rho:invariants { z }[1][2]) / r)
    apart = max(apart, 2 * abs(sin((g + i) / 2)))  -- the frame is -i
    turns = max(turns, abs(g) / (2 * pi))
  end
  ok(off < 1e-14 and apart < 1e-14, "the frame of " .. name .. " to round-off", off)
  ok(turns <= 1, "and within a turn", turns)
end

-- inside of runs: the frame of each pair is a root of its own, whatever the number of revolutions
local Ld = dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(a, b, h)
  local v, q = (b - a) / h, (a + b) / 2
  return h * (v:dot(v) / 2 + 1 / q:norm())
end }
local function path_of(f, branch)
  local rho = dm.moving_frame { action = turn, points = 2, branch = branch,
    cross_section = function(a) return f(a[2]) end }
  return dm.solver { rho:invariantize(Ld) }:run { q = { 0.6, 0 }, p = { 0, 1.3 }, steps = 5000,
    every = 100 }
end
local plain = dm.solver { Ld }:run { q = { 0.6, 0 }, p = { 0, 1.3 }, steps = 5000, every = 100 }
for k = 1, 4, 3 do
  local path, off = path_of(curves[k][2], right), 0
  for i = 1, #path do off = max(off, (path.q[i] - plain.q[i]):norm()) end
  ok(off < 1e-9, "an invariant Ld made invariant by " .. curves[k][1] .. " has the same path", off)
  ok(path:drift(path:momentum(turn)).largest < 1e-12, "and keeps its momentum",
    path:drift(path:momentum(turn)).largest)
end

-- angles among other coordinates
local rho = dm.moving_frame { action = plane, points = 2, cross_section = function(a, b)
  return { dm.tanh(2 * a[1]), dm.tanh(2 * a[2]), dm.tanh(4 * b[2]) }
end, branch = function(_, b) return b[1] end }
local off, turns = 0, 0
for i = 1, 20 do
  local a = { 0.3 * cos(3 * i), 0.3 * sin(5 * i) }
  local fine, g = pcall(rho, a, { a[1] + 0.5 * cos(i), a[2] + 0.5 * sin(i) })
  if fine then off, turns = max(off, 2 * abs(sin((g[3] + i) / 2))), max(turns, abs(g[3])) end
end
ok(off < 1e-14 and turns > 0 and turns < 2 * pi, "the angle of a rigid motion", off)

-- rows of a section in units of their own: J psi of this one looked singular
local wide = dm.moving_frame { action = plane, points = 2, cross_section = function(a, b)
  return { 1e-9 * a[1], 1e6 * a[2], 1e7 * b[2] }
end, branch = function(_, b) return b[1] end }
local placed = wide:invariants { { 0.3, -1 }, { 3.3, 3 } }
ok(abs(placed[2][1] - 5) < 1e-14 and abs(placed[2][2]) < 1e-14 and abs(placed[1][1]) < 1e-14,
  "a section whose rows have units of their own", tostring(placed[2]))
local _, number = wide:transversality({ 0, 0 }, { 5, 0 })
ok(number < 100, "and its condition number is without them", number)

---- dm.root{angles=} ----

-- tanh and the like are looked through, this is not
local function flat_far_away(x, width) return x / dm.sqrt(width ^ 2 + x ^ 2) end
local function around(angles)
  return dm.root { start = 1.4, angles = angles,
    equations = function(y, x) return flat_far_away(dm.sin(y - x), 0.1) end,
    branch = function(y, x) return dm.cos(y - x) end }
end
local wound, unwound = 0, 0
for i = 1, 40 do
  local x = i / 6
  wound = max(wound, abs(around()(x)))
  local y = around { 1 }(x)
  unwound = max(unwound, abs(y))
  ok(2 * abs(sin((y - x) / 2)) < 1e-15, "an unknown that is an angle has all digits", y - x)
end
ok(wound > 100 and unwound <= 2 * pi, "whole turns are taken off it", unwound)
-- equations that are not periodic after all keep their root
local straight = dm.root { start = 0, angles = { 1 }, equations = function(y, x) return y - x end }
local steep = dm.root { start = 9.9, angles = { 1 },
  equations = function(y, x) return flat_far_away(y - x, 0.03) end }
ok(straight(10) == 10 and abs(steep(10) - 10) < 1e-14, "a root that is no angle", steep(10))
raises("field 'angles' must be a list", dm.root, { start = 1, angles = 1,
  equations = function(u) return u end })
for _, bad in ipairs { 0, 2, 1.5, "x" } do
  raises("field 'angles' must be a list of places of unknowns", dm.root { start = 1,
    angles = { bad }, equations = function(u, x) return u - x end }, 1)
end

---- a frame by Gram and Schmidt has no value where q1 is along q0: Newton's method from there ----

local space = dm.action { group = dm.SO(3), on = dm.R(3) }
local function gram_schmidt(a, b)
  local e1 = a / a:norm()
  local w = b - e1 * e1:dot(b)
  local e2 = w / w:norm()
  local e3 = e1:cross(e2)
  return dm.matrix { { e1[1], e1[2], e1[3] }, { e2[1], e2[2], e2[3] }, { e3[1], e3[2], e3[3] } }
end
for _, mass in ipairs { 1, 0.1, 10, 100 } do
  local given = dm.discrete_lagrangian { Q = dm.R(3), h = 0.05, Ld = function(a, b, h)
    local v, q = (b - a) / h, (a + b) / 2
    return mass * h * (v:dot(v) / 2 + 1 / q:norm() + 0.05 * q[1] * q[2])
  end }
  local frame = dm.moving_frame { action = space, points = 2, solution = gram_schmidt,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end }
  local invariant, refused, drift = frame:invariantize(given), 0, 0
  for k = 1, 40 do
    local a = 0.7 * k
    local fine, path = pcall(function()
      return dm.solver { invariant }:run { steps = 5,
        q = { cos(a) / 2, sin(a) / 2, 0.1 + 0.01 * k },
        p = { -1.2 * mass * sin(a), 1.2 * mass * cos(a), 0.4 * mass * cos(3 * a) } }
    end)
    refused = refused + (fine and 0 or 1)
    local J = fine and path:momentum(space)
    for i = 2, fine and #path or 0 do drift = max(drift, (J:row(i) - J:row(1)):norm() / mass) end
  end
  ok(refused == 0, ("mass %g: steps from 40 starts"):format(mass), refused .. " refused")
  ok(drift < 1e-13, "with the momentum of the invariant Ld", drift)
end

-- 0/0 at (q, q) is rounding over rounding, with derivatives of 1e22 and 1e40 there: a z of 3e-18
-- solved these equations, and the path stood still for a step
do
  local h = 0.25
  local given = dm.discrete_lagrangian { Q = dm.R(3), h = h, Ld = function(a, b)
    local d = b - a
    return d:dot(d) / (2 * h) - h * ((a:dot(a) - 1) ^ 2 + (b:dot(b) - 1) ^ 2)
  end }
  local invariant = dm.moving_frame { action = space, points = 2, solution = gram_schmidt,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end }:invariantize(given)
  local random, apart, refused = dm.random(3), 0, 0
  for k = 0, 1500 do
    local q, p = {}, {}
    for i = 1, 3 do q[i], p[i] = 2 * random:uniform(k, i) - 1, 2 * random:uniform(k, i + 3) - 1 end
    if k == 0 then
      q = { -0.087371974701071498, 0.81249487441410495, 0.40169135956853919 }
      p = { -0.94280811075176429, 0.27133692741041759, -0.98114797864814229 }
    end
    local plain, one = pcall(function() return dm.solver { given }:run { q = q, p = p, steps = 1 } end)
    local fine, other = pcall(function() return dm.solver { invariant }:run { q = q, p = p, steps = 1 } end)
    if plain and fine then apart = max(apart, (one.q[2] - other.q[2]):norm()) end
    if plain and not fine then refused = refused + 1 end
  end
  ok(apart < 1e-11, "steps of the invariant Ld are those of Ld", apart)
  ok(refused == 0, "from all starts", refused)
end

---- sections that are flat but for a narrow place: F is +-1 to its last digit, without a slope ----

-- points without a frame, and how far the others are from the section y = 0
local function judge(frame)
  local refused, off = 0, 0
  for i = 1, 50 do
    local fine, points = pcall(frame.invariants, frame, { { cos(i) * i / 7, sin(i) * i / 7 } })
    if fine then off = max(off, abs(points[1][2]) * 7 / i) else refused = refused + 1 end
  end
  return refused, off
end
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
for name, section in pairs {
  ["tanh(50 y)"] = function(z) return dm.tanh(50 * z[2]) end, ["-2 atan(1e5 y)"] = function(z) return -2 * dm.atan(1e5 * z[2]) end,
  ["sinh(40 y)"] = function(z) return dm.sinh(40 * z[2]) end,
  ["exp(20 y) - 1"] = function(z) return dm.exp(20 * z[2]) - 1 end,
  ["tanh(50 y) + tanh(50 y)^3"] = function(z) return dm.tanh(50 * z[2]) + dm.tanh(50 * z[2]) ^ 3 end,
  ["a step of width 1e-4"] = function(z) return flat_far_away(z[2], 1e-4) end } do
  local refused, off = judge(dm.moving_frame { action = turn, cross_section = section, branch = function(z) return z[1] end })
  ok(refused == 0 and off < 1e-15, name .. ": from 50 starts to round-off", refused .. " refused, " .. off)
end
local placed = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
  cross_section = function(a, b) return { dm.tanh(50 * a[1]), dm.tanh(50 * a[2]), dm.tanh(50 * b[2]) } end,
  branch = function(a, b) return b[1] - a[1] end }
local far = 0
for i = 1, 50 do
  local I = placed:invariants { { cos(i) * i / 7, sin(i) * i / 7 }, { cos(2 * i) * 3, sin(3 * i) * 2 } }
  far = max(far, I[1]:norm(), abs(I[2][2]))
end
ok(far < 5e-15, "tanh(50 x) of a rigid motion", far)
-- an unknown that is no angle: outward from its start
local shifted = dm.root { start = 0, equations = function(y, x) return flat_far_away(y - x, 1e-6) end }
ok(shifted(1e4) == 1e4 and shifted(-0.37) == -0.37, "by its signs, far away and near")
raises("has no value", dm.root { start = 0, equations = function(y, x) return 1 / (y - x) end }, 0.3) -- a pole is no root
raises("has no value", dm.root { start = 0, equations = function(y, x) return dm.where(y - x, 1, -1) end }, 0.3) -- nor a jump
tap.done()
