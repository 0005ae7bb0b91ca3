-- How does a telescope point without jets? Three rotors along its axes: as they spin up and down it turns the other way, so that the
-- angular momentum stays zero. The mechanical connection of rotors on SO(3) is exp(I_lock^-1 I_r dx) for one of them at a time; a
-- loop of all three leaves the body turned by its curvature, an axis that no rotor has moved (Leok, figure 4.6).
local dm = require "dm"
local pi, abs = math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/three_rotors.png"
local G, lock, rotor = dm.SO(3), { 2, 3, 4 }, { 0.5, 0.4, 0.3 }  -- with the rotors held fast; of the rotors about their axes

local telescope = dm.system { name = "three rotors", Q = dm.product(dm.R(3), G), L = function(q, v)
  local T = 0
  for i = 1, 3 do
    local u, w = v[i], v[3 + i]
    T = T + (lock[i] - rotor[i]) * w ^ 2 / 2 + rotor[i] * (w + u) ^ 2 / 2
  end
  return T
end }
local A = telescope:mechanical_connection { group = G, rule = "lie(2)", h = 0.1 }
assert(A:check().worst < 1e-12)
local form = A:continuous { 0.3, -0.2, 0.5 }
for i = 1, 3 do assert(abs(form[i][i] - rotor[i] / lock[i]) < 1e-12, "I_lock^-1 I_r") end
assert(G:distance(A:local_form({ 0, 0, 0 }, { 0.8, 0, 0 }), G:exp { 0.8 * 0.25, 0, 0 }) < 1e-13, "one rotor turns one axis")

-- a square in the plane of the rotors 1 and 2: what is left is a turn about the third axis, curvature times area
local function square(s, n)
  local loop, corners = {}, { { 0, 0 }, { s, 0 }, { s, s }, { 0, s }, { 0, 0 } }
  for c = 1, 4 do
    for i = 0, n - 1 do
      local a, b = corners[c], corners[c + 1]
      loop[#loop + 1] = { a[1] + (b[1] - a[1]) * i / n, a[2] + (b[2] - a[2]) * i / n, 0 }
    end
  end
  loop[#loop + 1] = { 0, 0, 0 }
  return loop
end
local F, areas, turns = A:curvature({ 0, 0, 0 }, 1, 2), {}, {}
for k, s in ipairs { 0.2, 0.5, 1, 2, 3, 4 } do
  local h = G:log(A:holonomy(square(s, 4)))
  areas[k], turns[k] = s ^ 2, h:norm()
  if s == 0.2 then assert((h * (1 / s ^ 2) + F):norm() < 0.05 * F:norm() and abs(h[3]) > 5 * abs(h[1]), "minus curvature times area") end
end
print(("curvature (%.4f, %.4f, %.4f); a square of side 1 turns by %.4f rad"):format(F[1], F[2], F[3], turns[3]))

-- the same loop driven: wheels that follow it, bodies that conserve momentum, no connection in sight
local loop, g = square(pi / 2, 8), G:identity()
for i = 1, #loop - 1 do g = A:lift(loop[i], loop[i + 1], { loop[i], g })[2] end
local run = telescope:solver { rule = "lie(2)", h = 0.1 }:run { q = { { 0, 0, 0 }, G:identity() }, p = { 0.1, 0.2, -0.1, 0, 0, 0 }, steps = 60 }
local path = A:multi_lift((function() local x = {} for i = 1, #run do x[i] = run.q[i][1] end return x end)(), { { 0, 0, 0 }, G:identity() })
assert(G:distance(path[#path][2], run.q[#run][2]) < 1e-11, "a free run from zero momentum is the lift of its shapes")
assert(G:distance(g, A:holonomy(loop)) < 1e-13)

local turned = {}
for i = 1, #run do turned[i] = G:log(run.q[i][2]):norm() end
run:animate(picture:gsub("png$", "html"), { title = "a telescope and its rotors", plots = { "q1", { "turn of the body, rad", turned } }, bodies = { { factor = 2, shape = "box", size = { 0.4, 0.4, 1 } } } })
local theory = { x = areas, y = {}, name = "curvature times area" }
for k, a in ipairs(areas) do theory.y[k] = a * F:norm() end
print("picture  " .. dm.figure { { { x = areas, y = turns, name = "the turn that is left" }, theory, xlabel = "area of the loop of rotor angles", ylabel = "rad" },
  file = picture, size = { 700, 480 }, title = "What a square of rotor angles leaves" })
