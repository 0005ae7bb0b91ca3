-- the facts of groups, fields of their kits, against what their elements do
local tap = require "tap"
local dm = require "dm"
local ok, pi = tap.ok, math.pi
local stream = dm.random(3)

local function difference(a, b)
  local worst = 0
  for i = 1, #a do
    for j = 1, #a[i] do worst = math.max(worst, math.abs(a[i][j] - b[i][j])) end
  end
  return worst
end

local groups = { dm.R(3), dm.T(2), dm.SO(2), dm.SO(3), dm.SO(5), dm.SE(2), dm.SE(3), dm.SE(4),
  dm.SU(2), dm.SL(2), dm.SL(3), dm.GL(1), dm.GL(2), dm.Sp(2), dm.Sp(4), dm.Heisenberg(), dm.Heisenberg(2),
  dm.product(dm.SO(3), dm.R(2)), dm.product(dm.SO(2), dm.T(2), dm.R(1)),
  dm.semidirect(dm.SO(2), dm.R(2)) }

local kits = require "dm.group.kit"
local trivial = dm.semidirect(dm.T(1), dm.R(2), function(_, v) return v end)
for _, G in ipairs { trivial, table.unpack(groups) } do
  local kit, name = kits.of(G), tostring(G)
  local a, b = G:random(stream, 7, 0.5), G:random(stream, 8, 0.5)
  ok((kit.abelian or false) == (G:distance(G:compose(a, b), G:compose(b, a)) < 1e-12),
    name .. ": abelian where two elements commute")
  local function is_vector(x) return type(x) == "number" or kits.class_of(x) == "dm.vector" end
  local all = type(a) == "table" and kit.parts and is_vector(a[1]) and is_vector(a[2])
  ok((kit.vectors or false) == (is_vector(a) or all or false), name .. ": vectors")
  local flat = G:flat(a)
  for i = 1, kit.vectors and #flat or 0 do
    local turned = { table.unpack(flat) }
    turned[i] = turned[i] + 2 * pi
    ok((kit.angles[i] or false) == (difference(kit.matrix(kit.unflat(turned)), kit.matrix(a)) < 1e-12),
      ("%s: is coordinate %d an angle"):format(name, i))
  end
end
ok(kits.are_angles(dm.T(3)) and not kits.are_angles(dm.R(3)), "coordinates that are angles")
local mixed = kits.of(dm.product(dm.R(2), dm.T(2), dm.SE(2)))
ok(not mixed.angles[2] and mixed.angles[3] and mixed.angles[4] and mixed.angles[7]
  and not kits.are_angles(dm.product(dm.R(2), dm.T(2))), "angles of a product")
-- components of the group that exp does not reach
local upside = kits.of(dm.product(dm.R(1), dm.GL(3))).others()
ok(#upside == 1 and upside[1][1][1] == 0 and upside[1][2]:det() == -1, "an element with det < 0")
ok(not pcall(function() return dm.GL(3):log(upside[1][2]) end), "which has no logarithm")
ok(#kits.of(dm.semidirect(dm.GL(2), dm.R(2))).others() == 1 and #kits.of(dm.SO(4)).others() == 0,
  "of a semidirect product, and of a connected group")

-- rotations of quaternions that are numbers, symbols or both, and back
local core = require "dm.core"
local function corner(q)
  local R = core.rotation(q)
  return R[1][2] * R[3][1] + R[2][2]
end
local slope, e = dm.derivative(function(x) return corner { 1, x[1], 0.5, x[2] } end, 2), 1e-5
local central = (corner { 1, 0.3 + e, 0.5, 0.7 } - corner { 1, 0.3 - e, 0.5, 0.7 }) / (2 * e)
ok(math.abs(slope { 0.3, 0.7 }[1] - central) < 1e-9, "a quaternion of numbers and symbols")
local worst = 0
for i = 1, 50 do
  local R = dm.SO(3):random(stream, i, 3)
  worst = math.max(worst, difference(core.rotation(core.quaternion(R)), R), core.orthonormality(R, 3))
end
ok(worst < 1e-14, "a rotation, its quaternion, and back")
local least = 1
for i = 1, 50 do least = math.min(least, core.quaternion(dm.SO(3):random(stream, i, 3))[1]) end
ok(least >= 0 and least < 0.1, "a quaternion with w >= 0", least)
local bent = dm.matrix { { 1, 0.25, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
ok(core.orthonormality(bent, 3) == 0.25 and core.orthonormality(bent, 1) == 0, "off orthonormal columns")
tap.done()
