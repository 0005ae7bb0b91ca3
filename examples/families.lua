-- How can a double spherical pendulum turn about the vertical like a rigid body, and which of these motions last?
-- Relative equilibria are the stationary points of the amended potential at the angular momentum mu. At mu = 0.5 the tool looks for them from 300
-- starts and finds four families; each is followed up and down in mu. They begin at the four straight states that can swing, at the frequency of a normal mode.
local dm = require "dm"
local sin, cos, abs = math.sin, math.cos, math.abs
local picture = (arg and arg[1] or ".") .. "/families.png"

local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8
local pendulum = dm.system { name = "double spherical pendulum", Q = dm.R(4), coordinates = { "theta", "a1", "a2", "phi" }, L = function(q, v)
  local _, a, b, phi = table.unpack(q)  -- angles of the rods from below, phi between their planes
  local around = l2 * sin(b) * (v[1] + v[4])
  local w1 = dm.vector { l1 * cos(a) * v[2], l1 * sin(a) * v[1], l1 * sin(a) * v[2] }
  local out, c, s = l2 * cos(b) * v[3], cos(phi), sin(phi)
  local w2 = dm.vector { c * out - s * around, s * out + c * around, l2 * sin(b) * v[3] }
  return (m1 * w1:dot(w1) + m2 * (w1 + w2):dot(w1 + w2)) / 2 + (m1 + m2) * g * l1 * cos(a) + m2 * g * l2 * cos(b)
end }

local shape = pendulum:routh { cyclic = { "theta" }, mu = 0.5 }
local found = shape:relative_equilibria { region = { { 0.01, 3.13 }, { -3.13, 3.13 }, { -0.5, 0.5 } }, starts = 300, copies = false }
print(found)
assert(#found == 4)

local names = { "stretched out", "folded", "lower rod up", "upper rod up" }
local range, energy, velocity, marks = { 0.02, 12 }, {}, {}, { x = {}, y = {}, z = {} }
for k, e in ipairs(found) do
  local up = shape:continue(e, { mu = range, step = 0.1 })
  local down = shape:continue(e, { mu = range, step = 0.1, back = true })
  print(names[k], up)
  local mu, E, w, rows = {}, {}, {}, {}
  for i = #down, 2, -1 do rows[#rows + 1] = down[i] end
  for i = 1, #up do rows[#rows + 1] = up[i] end
  for i, row in ipairs(rows) do mu[i], E[i], w[i] = row.momentum, row.energy, row.velocity[1] end
  energy[#energy + 1], velocity[#velocity + 1] = { x = mu, y = E, name = names[k] }, { x = mu, y = w, name = names[k] }
  for _, event in ipairs(up.events) do
    marks.x[#marks.x + 1], marks.y[#marks.y + 1], marks.z[#marks.z + 1] = event.momentum, up[event.at].energy, up[event.at].velocity[1]
  end
end
assert(found[1].stable == "energy" and found[2].stable == "spectral" and not found[3].stable and not found[4].stable)
assert(#marks.x == 1 and abs(marks.x[1] - 4.45) < 0.1, "the folded one becomes unstable, and nothing else changes")

-- normal modes of the straight states, rods down (1) or up (-1): m1/(m1 + m2) w^4 - g (s1/l1 + s2/l2) w^2 + g^2 s1 s2/(l1 l2) = 0
local modes = 0
for _, s in ipairs { { 1, 1 }, { 1, -1 }, { -1, 1 } } do
  local a, b, c = m1 / (m1 + m2), g * (s[1] / l1 + s[2] / l2), g * g * s[1] * s[2] / (l1 * l2)
  for _, sign in ipairs { -1, 1 } do
    local w2 = (b + sign * math.sqrt(b * b - 4 * a * c)) / (2 * a)
    for _, line in ipairs(velocity) do modes = modes + (w2 > 0 and abs(line.y[1] / math.sqrt(w2) - 1) < 0.01 and 1 or 0) end
  end
end
assert(modes == 4, "every family begins at a normal mode")
local mark = { x = marks.x, y = marks.y, name = "loses stability", style = "points" }
energy[#energy + 1], velocity[#velocity + 1] = mark, { x = marks.x, y = marks.z, name = "loses stability", style = "points" }
energy.xlabel, energy.ylabel, energy.title, velocity.xlabel, velocity.ylabel, velocity.title = "mu (kg m^2/s)", "energy (J)", "energy of the families", "mu (kg m^2/s)", "angular velocity (rad/s)", "and how fast they turn"
velocity.yrange = { 0, 25 }
print("picture  " .. dm.figure { energy, velocity, file = picture, width = 1000, height = 420 })
