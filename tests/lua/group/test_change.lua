-- What a step in a chart adds to coordinates and momentum (lua/dm/group/change.lua): that of its end
-- less its beginning, and for small steps to the digits of the step itself
local tap = require "tap"
local dm = require "dm"
local kits = require "dm.group.kit"
local place = require "dm.group.place"
local ok = tap.ok
local abs, max = math.abs, math.max

local groups = { dm.SO(2), dm.SE(2), dm.SO(3), dm.SE(3), dm.SU(2), dm.Heisenberg(3), dm.SL(2),
  dm.GL(2), dm.Sp(2), dm.SO(4), dm.semidirect(dm.SO(3), dm.R(3)),
  dm.product(dm.SE(3), dm.T(2), dm.SO(3)) }
for _, G in ipairs(groups) do
  for _, side in ipairs { "left", "right" } do
    local P = place.of(G, { trivialization = side })
    local kit, worst, maps = P.kit, 0, 0
    for _, tau in ipairs { "exp", "cayley", "pade(2)" } do
      local _, finish = place.chart(P, tau)
      local change = finish and place.change(P, tau)
      for i = 1, change and 5 or 0 do
        maps = maps + (i == 1 and 1 or 0)
        local q0 = dm.vector(P.flat(kit.sample(dm.random(5), i)))
        local xi = kits.normals(dm.random(6), i, kit.dimension, 0.4)
        local mu = kits.normals(dm.random(7), i, kit.dimension, 1)
        local from = { table.unpack(kits.list_of(q0)) }
        for _, x in ipairs(kits.list_of(mu)) do from[#from + 1] = x end
        local all, gain = finish(q0, xi, mu), change(q0, xi, mu)
        for k = 1, #from do
          worst = max(worst, abs(all[k] - from[k] - gain[k]) / (1 + abs(all[k])))
        end
      end
    end
    -- from the left angles of SE(2) turn the coordinates: no polynomial
    local known = not (G == groups[2] and side == "right")
    ok((maps > 0) == known and worst < 1e-13, ("%s, %s: the change of a step"):format(tostring(G), side), worst)
  end
end

-- a turn by 1e-9 of a quaternion: 1 - cos(5e-10) = 1.25e-19, which a difference of ends loses
local P = place.of(dm.SO(3), {})
local change = place.change(P, "exp")
local x = change(dm.vector { 1, 0, 0, 0 }, dm.vector { 1e-9, 0, 0 }, dm.vector { 0, 1, 0 })
ok(abs(x[1] / -1.25e-19 - 1) < 1e-12, "to its own digits", x[1])
ok(abs(x[5 + 2] / -1e-9 - 1) < 1e-12 and abs(x[5 + 1] / -5e-19 - 1) < 1e-12,
  "mu turns the other way", x[7])

-- a chart that treats the factors of a semidirect product apart is not equivariant
ok(not place.change(place.of(dm.semidirect(dm.SO(3), dm.R(3)), {}), "pade(2)"),
  "nothing where tau knows one basis from another")

tap.done()
