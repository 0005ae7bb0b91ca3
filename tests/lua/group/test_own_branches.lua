-- Groups of a basis whose elements have a principal logarithm outside of the algebra: they are elements all the same, and
-- have logarithms in it. The independent roads: one angle in the place of the group, and that products are on it.
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function largest(m)
  local most = 0
  for i = 1, m.rows do
    for j = 1, m.columns do most = math.max(most, math.abs(m[i][j])) end
  end
  return most
end

---- two planes that turn at the rates 1 and k ----
for _, k in ipairs { 2, 5 } do
  local G = dm.group { name = "turns", basis = { { { 0, -1, 0, 0 }, { 1, 0, 0, 0 }, { 0, 0, 0, -k }, { 0, 0, k, 0 } } } }
  for _, angle in ipairs { 0.5, 2, 2.9, -2.2, 5, 7 } do
    local g = G:exp { angle }
    local short = angle - 2 * math.pi * math.floor(angle / (2 * math.pi) + 0.5)
    ok(G:valid(g) and largest(G:compose(g, g) - G:exp { 2 * angle }) < 1e-13, "an element " .. angle)
    near(G:log(g)[1], short, 1e-12, "its shortest logarithm " .. angle)
    ok(largest(G:project(g) - g) < 1e-12, "is its own projection")
  end
  local off = { { 0, -1, 0, 0 }, { 1, 0, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } }
  ok(not G:valid(off), "a turn of one plane alone is no element")
  raises("no element of turns", function() return G:compose(off, off) end)
end
local G = dm.group { name = "turns", basis = { { { 0, -1, 0, 0 }, { 1, 0, 0, 0 }, { 0, 0, 0, -2 }, { 0, 0, 2, 0 } } } }
local system = dm.system { Q = G, L = function(g, xi) return xi[1] ^ 2 / 2 + g[1][1] + 0.3 * g[3][3] end }
local run = system:solver { rule = "lie(3)", h = 0.05 }:run { q = G:exp { 2 }, v = { 1.5 }, t = 6 }
local angle = dm.system { Q = dm.R(1), L = function(x, v) return v[1] ^ 2 / 2 + dm.cos(x[1]) + 0.3 * dm.cos(2 * x[1]) end }
local same = angle:solver { rule = "gauss(4)", h = 0.05 }:run { q = { 2 }, v = { 1.5 }, t = 6 }
near(run.p[#run][1], same.p[#same][1], 1e-8, "a run that begins at such an element")

---- a screw: it turns and goes along its axis; its group is a line ----
local screw = dm.group { name = "screw", basis = { { { 0, -1, 0, 0 }, { 1, 0, 0, 0 }, { 0, 0, 0, 0.3 }, { 0, 0, 0, 0 } } } }
for _, angle in ipairs { 1, 5, -7, 11, 300 } do
  ok(screw:valid(screw:exp { angle }), "an element of the screw " .. angle)
  near(screw:log(screw:exp { angle })[1], angle, 1e-11, "its one logarithm " .. angle)
end

---- SU(3), as real matrices: eigenvalues 2.5, 2.5 and -5 rad away ----
local function entry(M, i, j, re, im)
  M[i][j], M[i][j + 3], M[i + 3][j], M[i + 3][j + 3] = re, -im, im, re
end
local function complex(list)
  local M = {}
  for i = 1, 6 do M[i] = { 0, 0, 0, 0, 0, 0 } end
  for _, e in ipairs(list) do entry(M, e[1], e[2], e[3], e[4]) end
  return M
end
local a = 1 / math.sqrt(12)
local SU3 = dm.group { name = "SU(3)", basis = { complex { { 1, 2, 0, -.5 }, { 2, 1, 0, -.5 } }, complex { { 1, 2, -.5, 0 }, { 2, 1, .5, 0 } },
  complex { { 1, 1, 0, -.5 }, { 2, 2, 0, .5 } }, complex { { 1, 3, 0, -.5 }, { 3, 1, 0, -.5 } }, complex { { 1, 3, -.5, 0 }, { 3, 1, .5, 0 } },
  complex { { 2, 3, 0, -.5 }, { 3, 2, 0, -.5 } }, complex { { 2, 3, -.5, 0 }, { 3, 2, .5, 0 } },
  complex { { 1, 1, 0, -a }, { 2, 2, 0, -a }, { 3, 3, 0, 2 * a } } } }
local refused, far, wrong = 0, 0, 0
for i = 1, 60 do
  local xi = {}
  for k = 1, 8 do xi[k] = dm.random(5):normal(i, k, 0, 3) end
  local g = SU3:exp(xi)
  local fine, x = pcall(SU3.log, SU3, g)
  if not fine then refused = refused + 1 else
    far = math.max(far, largest(SU3:exp(x) - g))
    if x:norm() > dm.vector(xi):norm() + 1e-9 then wrong = wrong + 1 end
  end
end
ok(refused == 0, "no element of SU(3) is refused", refused)
ok(far < 1e-10, "exp(log g) = g", far)
ok(wrong == 0, "no logarithm is longer than the one it came from", wrong)
ok(not SU3:valid(complex { { 1, 1, math.cos(0.3), math.sin(0.3) }, { 2, 2, 1, 0 }, { 3, 3, 1, 0 } }), "of determinant exp(0.3 i) it is none")

---- half turns: eigenvalues -1 in pairs have a real logarithm in the algebra, of the size of the turn ----
local turning = dm.group { name = "turns", basis = { dm.matrix { { 0, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } },
  dm.matrix { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, dm.matrix { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } } } }
local farthest = 0
for i = 1, 20 do
  local draw = dm.random(i)
  local axis = dm.vector { draw:normal(1, 0), draw:normal(2, 0), draw:normal(3, 0) }
  axis = axis * ((i % 2 == 0 and math.pi or math.pi - 1e-9) / axis:norm())
  local x = turning:log(turning:exp(axis))
  farthest = math.max(farthest, math.min((x - axis):norm(), (x + axis):norm()))
end
tap.ok(farthest < 3e-9, "half turns of a group of a basis have logarithms", farthest)
-- and what is so near to one that its eigenvalues are taken for -1: the first of these was refused
local nearly = dm.group { name = "nearly", basis = { { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  { { 0, 0, -1 }, { 0, 0, 0 }, { 1, 0, 0 } }, { { 0, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } } } }
for i = 103, 106 do
  local draw = dm.random(i)
  local axis = dm.vector { draw:normal(1, 0), draw:normal(2, 0), draw:normal(3, 0) }
  local g = nearly:exp(axis * ((math.pi - 10 ^ (-i / 15)) / axis:norm()))
  local fine, off = pcall(function() return nearly:distance(nearly:exp(nearly:log(g)), g) end)
  tap.ok(fine and off < 1e-8, "nearly half a turn", off)
end
tap.done()
