--- The Levi-Civita connection on the edges of an oriented surface: a frame at every vertex, in
-- which the neighbour j lies in the direction phi_ij, the angles of the triangles one after the
-- other, stretched so that they fill 2 pi at an inner vertex. Along an edge the direction of the
-- edge is kept: the rotation from i to j is by phi_ji + pi - phi_ij, that round a triangle by the
-- sum of its stretched angles less pi.
local core = require "dm.core"
local options = require "dm.base.options"

local M = {}

local pi = math.pi

-- the angles of every triangle at its three vertices
local function corners_of(K)
  local length, area, out = K:volume(1), K:volume(2), {}
  for t = 1, K:count(2) do
    local edges, square, angle = K:faces(2, t), {}, {}
    for k = 1, 3 do square[k] = length[edges[k]] ^ 2 end
    for k = 1, 3 do
      local rest = square[k % 3 + 1] + square[(k + 1) % 3 + 1] - square[k]
      angle[k] = math.atan(2 * area[t], rest / 2)
    end
    out[t] = angle
  end
  return out
end

-- after[a][b] = { c, angle at a, triangle, place of a } of the triangles (a, b, c) in the sense of
-- the orientation; before[a][c] = true
local function stars_of(K, corners)
  local triangles, sign, after, before = K:simplices(2), K:orientation(), {}, {}
  for v = 1, K:count(0) do after[v], before[v] = {}, {} end
  for t = 1, #triangles do
    local v = triangles[t]
    for k = 1, 3 do
      local a, b, c = v[k], v[k % 3 + 1], v[(k + 1) % 3 + 1]
      if sign[t] < 0 then b, c = c, b end
      after[a][b], before[a][c] = { c, corners[t][k], t, k }, true
    end
  end
  return after, before
end

-- directions of the neighbours of a, from the first one: at the boundary where the fan begins
local function directions_of(a, after, before, stretched)
  local first
  for b in pairs(after[a]) do
    if not before[a][b] then
      first = b
      break
    end
    if not first or b < first then first = b end
  end
  local phi, b, sum, found = {}, first, 0, {}
  while b and not phi[b] do
    phi[b] = sum
    local next_one = after[a][b]
    if not next_one then break end
    sum, found[#found + 1] = sum + next_one[2], next_one
    b = next_one[1]
  end
  local scale = b == first and 2 * pi / sum or 1
  for neighbour, angle in pairs(phi) do phi[neighbour] = angle * scale end
  for _, corner in ipairs(found) do stretched[corner[3]][corner[4]] = corner[2] * scale end
  return phi
end

--- The directions and angles of a connection; frames(vertex) turns its own frame.
function M.make(c, frames)
  local K = c.mesh
  if K.dimension ~= 2 or not K.orientable then
    options.fail("K:levi_civita", "on = \"primal\" is for oriented surfaces, triangles%s",
      K.dimension == 2 and ": this one has no orientation" or "; take on = \"dual\"")
  end
  local rotation_of = require "dm.dec.curvature".rotation_of
  local corners, stretched = corners_of(K), {}
  local after, before = stars_of(K, corners)
  for t = 1, #corners do stretched[t] = {} end
  c.phi, c.stretched, c.triangles, c.sign = {}, stretched, K:simplices(2), K:orientation()
  for a = 1, K:count(0) do
    c.phi[a] = directions_of(a, after, before, stretched)
    local T = frames and rotation_of(frames(a), 2,
      ("K:levi_civita: the frame of vertex %d"):format(a))
    local turn = T and math.atan(T[2][1], T[1][1]) or 0
    for b, angle in pairs(c.phi[a]) do c.phi[a][b] = angle - turn end
  end
end

function M.count(c) return c.mesh:count(0) end

function M.rotation(c, i, j)
  local there, back = c.phi[i] and c.phi[i][j], c.phi[j] and c.phi[j][i]
  if not there or not back then
    error(("the vertices %s and %s are no neighbours: there is no edge between them")
      :format(tostring(i), tostring(j)), 0)
  end
  local angle = back + pi - there
  local cosine, sine = math.cos(angle), math.sin(angle)
  return core.matrix { { cosine, -sine }, { sine, cosine } }
end

function M.angle(c)
  local out = core.result {}
  for t, angle in ipairs(c.stretched) do out[t] = angle[1] + angle[2] + angle[3] - pi end
  return out
end

function M.curvature(c, t)
  local v = c.triangles[t]
  if not v then
    error(("there is no triangle %s: they are 1 to %d"):format(tostring(t), #c.triangles), 0)
  end
  local path = { v[1], v[2], v[3], v[1] }
  if c.sign[t] < 0 then path[2], path[3] = path[3], path[2] end
  return require "dm.dec.curvature".along(c, path)
end

function M.frame()
  error("A:frame: frames at vertices have no axes in space: take on = \"dual\"", 0)
end

return M
