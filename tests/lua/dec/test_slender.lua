-- areas of slender triangles against closed forms: squares of lengths know e of a height e to 1e-16 / e^2 alone
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function mesh(points) return dm.mesh { simplices = { { 1, 2, 3 } }, points = points } end

for _, e in ipairs { 1e-2, 1e-4, 1e-6, 1e-8, 1e-10 } do
  -- a cap: its corner is 180 degrees but for 4 e; a needle; both with corners in any order, and in space
  for name, points in pairs { cap = { { 0, 0 }, { 1, 0 }, { 0.5, e } }, needle = { { 0, -e / 2 }, { 0, e / 2 }, { 1, 0 } },
    far = { { 1024, 0 }, { 1025, 0 }, { 1024.5, e } } } do
    for turn = 0, 2 do
      local p = { points[turn % 3 + 1], points[(turn + 1) % 3 + 1], points[(turn + 2) % 3 + 1] }
      near(mesh(p):volume(2)[1] / (e / 2), 1, 1e-15, ("%s %g, corner %d first"):format(name, e, turn + 1))
    end
  end
  -- base sqrt(3), height e sqrt(2/3), to what rounding leaves of 1/2 + e
  local z = 0.5 + e
  near(mesh { { 0, 0, 0 }, { 1, 1, 1 }, { 0.5, 0.5, z } }:volume(2)[1] / ((z - 0.5) * math.sqrt(2) / 2), 1, 4e-16, "in space " .. e)
end
-- of lengths alone a needle keeps its digits: two sides of 1 and one of e, area e sqrt(4 - e^2) / 4
for _, e in ipairs { 1e-2, 1e-4, 1e-6 } do
  for short = 1, 3 do
    local lengths = { 1, 1, 1 }
    lengths[short] = e
    near(dm.mesh({ simplices = { { 1, 2, 3 } }, lengths = lengths }):volume(2)[1] / (e * math.sqrt(4 - e * e) / 4), 1, 1e-15, "lengths, needle " .. e)
  end
end
-- circumcentric duals of a cap: |e| |*e| is cot(opposite angle) e^2 / 2
local e = 1e-6
local K = mesh { { 0, 0 }, { 1, 0 }, { 0.5, e } }
near(K:dual_volume(1)[1] / (-0.5 * (0.25 - e ^ 2) / e), 1, 1e-11, "the dual edge of its long side")
raises("degenerate", mesh, { { 0, 0 }, { 1, 0 }, { 0.5, 1e-13 } })
raises("degenerate", mesh, { { 0.1, 0.7 }, { 0.2, 1.4 }, { 0.3, 2.1 } })
ok(not pcall(dm.mesh, { simplices = { { 1, 2, 3 } }, lengths = { 1, 0.5, 0.5 } }), "flat by its lengths")
tap.done()
