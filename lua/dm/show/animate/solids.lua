--- Convex solids that an animation draws for a body, about their centres: vertices, faces (lists of
-- vertices, counted from 0) and a tint for each face, 0 or 1, that lets the eye see it turn.
local M = {}

local sin, cos, pi = math.sin, math.cos, math.pi

-- what the functions here fill: { vertices = flat list, faces, tints }
local function empty() return { vertices = {}, faces = {}, tints = {} } end

local function add_vertex(solid, x, y, z)
  local list = solid.vertices
  list[#list + 1], list[#list + 2], list[#list + 3] = x, y, z
end

local function add_face(solid, tint, face)
  solid.faces[#solid.faces + 1], solid.tints[#solid.tints + 1] = face, tint
end

-- corners of a box: bit k of the number of a vertex is its side along axis k
local BOX = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 2, 3, 1 },
  { 4, 5, 7, 6 } }

--- With half lengths a, b, c; the sides along the first axis are tinted.
function M.box(a, b, c)
  local out = empty()
  for k = 0, 7 do
    add_vertex(out, k & 1 > 0 and a or -a, k & 2 > 0 and b or -b, k & 4 > 0 and c or -c)
  end
  for k, face in ipairs(BOX) do add_face(out, k <= 2 and 1 or 0, face) end
  return out
end

local AROUND, ALONG = 24, 16  -- faces of an ellipsoid about its third axis, from pole to pole

--- With semi-axes a, b, c; octants take turns in their tint.
function M.ellipsoid(a, b, c)
  local out = empty()
  for i = 0, ALONG do
    local s, z = sin(pi * i / ALONG), cos(pi * i / ALONG)
    for j = 0, AROUND - 1 do
      local angle = 2 * pi * j / AROUND
      add_vertex(out, a * s * cos(angle), b * s * sin(angle), c * z)
    end
  end
  for i = 0, ALONG - 1 do
    for j = 0, AROUND - 1 do
      local next_j = (j + 1) % AROUND
      local up, down = AROUND * i, AROUND * (i + 1)
      add_face(out, (4 * j // AROUND + 2 * i // ALONG) % 2,
        { up + j, down + j, down + next_j, up + next_j })
    end
  end
  return out
end

--- With semi-axes a, b of its ends and half its height c; eighths take turns.
function M.cylinder(a, b, c)
  local out, top, bottom = empty(), {}, {}
  for j = 0, 2 * AROUND - 1 do
    local angle = pi * j / AROUND
    for _, z in ipairs { c, -c } do add_vertex(out, a * cos(angle), b * sin(angle), z) end
  end
  add_vertex(out, 0, 0, c)
  add_vertex(out, 0, 0, -c)
  local many = 4 * AROUND
  for j = 0, 2 * AROUND - 1 do
    local here, there, tint = 2 * j, (2 * j + 2) % many, 4 * j // AROUND % 2
    add_face(out, tint, { here, here + 1, there + 1, there })
    top[j + 1], bottom[j + 1] = { many, here, there }, { many + 1, there + 1, here + 1 }
  end
  for j = 1, #top do
    local tint = 4 * (j - 1) // AROUND % 2
    add_face(out, tint, top[j])
    add_face(out, tint, bottom[j])
  end
  return out
end

--- By the name of a shape.
M.shapes = { box = M.box, ellipsoid = M.ellipsoid, cylinder = M.cylinder }

-- half lengths squared over (I2 + I3 - I1)/m and so on, from the moments of each solid
local FACTORS = { box = { 1.5, 1.5, 1.5 }, ellipsoid = { 2.5, 2.5, 2.5 },
  cylinder = { 2, 2, 1.5 } }
local THIN = 0.04  -- of the longest, what is flatter or not possible

--- Half lengths of the solid of this shape that has the mass m and the principal moments I.
function M.size(shape, I, m)
  local out, most = {}, 0
  for k = 1, 3 do
    local square = FACTORS[shape][k] * (I[k % 3 + 1] + I[(k + 1) % 3 + 1] - I[k]) / m
    out[k] = math.sqrt(math.max(0, square))
    most = math.max(most, out[k])
  end
  for k = 1, 3 do out[k] = math.max(out[k], THIN * most) end
  return out
end

return M
