-- sections that turn back along orbits: bands of orbits that are cut more than once, however narrow, are looked for along the section;
-- which sections are right is told by a scan along them, of a function that is constant along orbits
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, exp = dm.sin, dm.cos, dm.exp
local R1, R2, R3 = dm.R(1), dm.R(2), dm.R(3)

local turn = dm.action { group = dm.SO(2), on = R2 }
local plane = dm.action { group = dm.SE(2), on = R2 }
local space = dm.action { group = dm.SO(3), on = R3 }
local sphere = dm.action { group = dm.SO(3), on = dm.S(2) }
local areas = dm.action { group = dm.SL(2), on = R2 }
local shift = dm.action { group = R1, on = R2, map = function(g, z) return { z[1] + g[1], z[2] } end }
local scale = dm.action { group = R1, on = R2, map = function(g, z) return { exp(g[1]) * z[1], exp(g[1]) * z[2] } end }

-- how far r falls behind its largest value so far, or rises, if it falls on the whole: 0 where it is monotone
local function band(r, from, to)
  local sign = r(to) > r(from) and 1 or -1
  local top, width = sign * r(from), 0
  for i = 1, 40000 do
    local value = sign * r(from + (to - from) * i / 40000)
    top = math.max(top, value)
    width = math.max(width, top - value)
  end
  return width
end

-- one wave of random height, length and phase
local stream = dm.random(2026)
local function wave(i)
  local k = math.exp(stream:uniform(i, 0, -0.7, 2.2))
  local A, p = stream:uniform(i, 1, -1.4, 1.4) / k ^ 0.8, stream:uniform(i, 2, 0, 1) < 0.5 and 0 or stream:uniform(i, 3, -3, 3)
  return function(x) return A * sin(k * x + p) end
end
local function radius(f) return band(function(x) return math.sqrt(x ^ 2 + f(x) ^ 2) end, 1e-6, 120) end

-- a frame's options and the width of the band
local families = {
  ["turns of the plane"] = function(f)
    return { action = turn, cross_section = function(z) return z[2] - f(z[1]) end, branch = function(z) return z[1] end }, radius(f)
  end,
  ["rigid motions to a curved section"] = function(f)
    return { action = plane, points = 2, branch = function(a, b) return b[1] - a[1] end,
      cross_section = function(a, b) return { a[1] - 0.7 * b[2], a[2] - 0.5 * sin(b[1]), b[2] - a[2] - f(b[1] - a[1]) } end }, radius(f)
  end,
  ["scalings"] = function(f)
    local function g(x) return 1.5 + f(x) end
    return { action = scale, cross_section = function(z) return z[2] - g(z[1]) end, branch = function(z) return z[1] end },
      band(function(x) return math.atan(g(x), x) end, 1e-4, 120)
  end,
  ["translations"] = function(f)
    local function g(x) return x + f(x) end
    return { action = shift, cross_section = function(z) return z[2] - g(z[1]) end }, band(g, -30, 30)
  end,
  ["areas, where the isotropy changes along the section"] = function(f)
    local function g(x) return x + f(x) end
    return { action = areas, points = 2, cross_section = function(a, b) return { a[1] - 1, a[2], g(b[1]) - b[2] } end }, band(g, -30, 30)
  end,
}
local wrong, missed = 0, 0
for name, family in pairs(families) do
  for i = 1, 30 do
    local options, width = family(wave(i))
    local fine, why = pcall(dm.moving_frame, options)
    local refused = not fine and tostring(why):find("more than once", 1, true)
    if width == 0 and not fine then ok(false, name .. ": a right section is taken", why) end
    if not fine and not refused then ok(false, name .. ": it says why", why) end
    if width > 1e-3 then wrong, missed = wrong + 1, missed + (fine and 1 or 0) end
  end
end
ok(wrong >= 60 and missed <= wrong // 20, "at most one of twenty wrong sections is taken", ("%d of %d"):format(missed, wrong))

-- z2 = A sin(3 z1): circles of radius 0.98 to 1.06 at A = 0.9, of 0.957 to 0.965 at A = 0.75
local function wavy(A)
  return { action = turn, cross_section = function(z) return z[2] - A * sin(3 * z[1]) end, branch = function(z) return z[1] end }
end
for _, A in ipairs { 0.75, 0.8, 0.85, 0.9, 0.95, -0.9 } do
  raises("branch holds at both", dm.moving_frame, wavy(A))
end
for _, A in ipairs { 0.3, 0.6, 0.7, -0.7 } do ok(pcall(dm.moving_frame, wavy(A)), "a wave that no circle cuts twice: " .. A) end

-- the same where the branch leaves out the fold, and holds on both sides of it
for _, A in ipairs { 0.75, 0.85, 0.9, 1, 1.5 } do
  local options = wavy(A)
  options.branch = function(z) return z[1], z[1] + 3 * A * z[2] * cos(3 * z[1]) end
  raises("branch holds at both", dm.moving_frame, options)
end

-- more dimensions: the fold is a surface in the section, also of points that lie on a sphere
local function standing(A, k, s)
  return function(a, b) return { a[1], a[2], b[2] - A * sin(k * (b[1] + s * b[3])) } end, function(a, b) return { a[3], b[1] } end
end
local function rotated(action, A, k, s)
  local section, branch = standing(A, k, s)
  return { action = action, points = 2, cross_section = section, branch = branch }
end
raises("branch holds at both", dm.moving_frame, rotated(space, 0.9, 3, 0.5))
raises("branch holds at both", dm.moving_frame, rotated(sphere, 0.45, 6, 0))
ok(pcall(dm.moving_frame, rotated(space, 0.6, 3, 0)), "rotations, right")
ok(pcall(dm.moving_frame, rotated(sphere, 0.3, 6, 0)), "points of a sphere, right")

-- spirals are cut once, however steep
local function spiral(w)
  local function bent(z, f, g) return f(w * z:norm()) * z[1] + g(w * z:norm()) * z[2] end
  return { action = turn, cross_section = function(z) return bent(z, function(t) return -sin(t) end, cos) end,
    branch = function(z) return bent(z, cos, sin) end }
end
for _, w in ipairs { 0.5, 2, 6 } do ok(pcall(dm.moving_frame, spiral(w)), "a spiral: " .. w) end

-- arguments of the search itself
do
  local core = require "dm.core"
  local wave = core.trace(function(x) return { 1 + x[2] - 0.9 * dm.sin(3 * x[1]) } end, 2)
  local turned = core.trace(function(y, x) return { x[1] - y[1] * x[2], x[2] + y[1] * x[1] } end, 1, 2)
  local wider = core.trace(function(x) return { x[1] + x[3] } end, 3)
  local section = core.section(wave, turned, nil)
  tap.raises("table expected", section.folds, section, "abc", 10, 3)
  tap.raises("{ x, step } expected", section.folds, section, { 1, 2 }, 10, 3)
  tap.raises("a function of x expected", core.section, wave, turned, wider)
end

-- a section against the orbits anywhere, J psi = (-2 x1, 1) . (-x2, x1) of x2 = x1^2 and turns,
-- with its row in other units too
do
  local core = require "dm.core"
  local turned = core.trace(function(y, x) return { x[1] - y[1] * x[2], x[2] + y[1] * x[1] } end, 1, 2)
  for _, unit in ipairs { 1, 1e-6, 1e9 } do
    local curve = core.trace(function(x) return { 1 + unit * (x[2] - x[1] ^ 2) } end, 2)
    local section = core.section(curve, turned, nil)
    local slope, condition = section:cut { 1, 3 }
    tap.near(slope[1][1], 7 * unit, 1e-14 * unit, "J psi")
    tap.near(condition, math.sqrt(50) / 7, 1e-14, "the turn by a relative change of the points")
    local off, _, inverse = section:distance({ 1, 3 }, { 2 * unit })
    tap.near(off, 2 / 7, 1e-15, "an angle")
    tap.near(inverse, 1 / (7 * unit), 1e-15 / unit, "of a unit of Z")
    local _, nowhere = section:cut { 0, 0 }
    ok(nowhere == math.huge, "the fixed point")
    -- psi = (-x2, x1) at (1, 3): y of least squares towards (4, 1), psi . d / psi . psi
    tap.near(section:approach({ 1, 3 }, { 4, 1 })[1], -11 / 10, 1e-15, "towards a point")
    ok(section:approach({ 0, 0 }, { 1, 0 }) == nil, "turns lead nowhere from their centre")
    ok(section:distance({ 0, 0 }, { unit }) == math.huge, "is infinitely far")
    tap.raises("must have 2 entries", section.cut, section, { 1 })
    tap.raises("must have 1 entries", section.distance, section, { 1, 3 }, { 1, 2 })
  end
  local root = core.trace(function(x) return { 1 + dm.sqrt(x[2]) } end, 2)
  tap.raises("no finite derivative", core.section(root, turned, nil).cut, core.section(root, turned, nil), { 1, 0 })
end
tap.done()
