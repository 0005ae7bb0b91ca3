--- S(n): unit vectors of R^(n+1); a manifold, not a group: exp and log are those of its great
-- circles, from a point. Among the factors of a product of groups it is vectors of R(n + 1) with
-- the constraint x . x = 1, which lie(s) keeps.
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local smooth = require "dm.group.smooth"

local M = {}

local LOOSE = 1e-6  -- how far a vector may lean out of the tangent space, of its length
local LEAST = 1e-307 -- and below the least normal number by its rounding

-- w without its part along z, which must be small
local function tangent(z, w)
  if not kits.is_finite(w) then error("the tangent vector is not finite", 0) end
  local along, size = w:dot(z), w:norm()
  if type(along) == "number" and type(size) == "number"
    and not (math.abs(along) <= LOOSE * size + LEAST) then
    error(("this is no tangent vector at the point: w . z = %.6g; w - z*(w . z) is one")
      :format(along), 0)
  end
  return w - z * along
end

-- z cos|w| + w sin|w|/|w|
local function shoot(z, w)
  local square, size = w:dot(w), w:norm()
  if type(size) == "number" then
    return size == 0 and z or z * math.cos(size) + w * (math.sin(size) / size)
  end
  return z * smooth.stumpff_circular(0, square) + w * smooth.stumpff_circular(1, square)
end

-- sine of the angle below which round-off alone says where the antipode is seen
local OPPOSITE = 1e-14

-- theta u/|u|: u = y - z (z . y), taken from the smaller of y - z and y + z
local function aim_of_numbers(z, y)
  local cosine = z:dot(y)
  local d = cosine < 0 and y + z or y - z
  local u = d - z * z:dot(d)
  local sine = u:norm()
  if cosine < 0 and sine < OPPOSITE then
    error("log: the points are antipodes: every great circle from one goes through the other", 0)
  end
  return sine == 0 and u or u * (math.atan(sine, cosine) / sine)
end

-- the same, smooth through y = z: with the half angle a, theta/sin theta = (a/sin a)/cos a
local function aim(z, y)
  if type(z:dot(y)) == "number" then return aim_of_numbers(z, y) end
  local d = y - z
  local square = d:dot(d) / 4
  local cosine = core.sqrt(1 - square)
  return (d - z * z:dot(d)) * (smooth.arc(cosine, square) / cosine)
end

function M.kit(n)
  local kit = { dimension = n, coordinates = n + 1, manifold = true, vectors = true, angles = {},
    form = "a unit vector", entries = kits.list_of, rebuild = core.vector }
  function kit.element(g) return kits.vector(g, n + 1, "the point") end
  kit.raw = kit.element
  kit.flat, kit.unflat = kit.entries, kit.rebuild
  function kit.bonds(list)
    local sum = -1
    for i = 1, n + 1 do sum = sum + list[i] * list[i] end
    return { sum }
  end
  function kit.defect(z) return math.abs(z:norm() - 1) end
  function kit.project(z)
    local size = z:norm()
    if type(size) == "number" and not (size > 0) then
      error("the zero vector is near no point of the sphere", 0)
    end
    return z * (1 / size)
  end
  function kit.sample(stream, i) return kit.project(kits.normals(stream, i, n + 1, 1)) end
  -- the angle: 2 atan2(|a - b|, |a + b|) has all digits at 0 and at pi
  function kit.distance(a, b) return 2 * core.atan(kits.norm(a - b), kits.norm(a + b)) end
  function kit.tangent(z, w) return tangent(z, kits.vector(w, n + 1, "the tangent vector")) end
  kit.shoot, kit.aim = shoot, aim
  return kit
end

---- among the factors of a product ----

local function joined(out, more)
  for _, x in ipairs(lists.entries(more)) do out[#out + 1] = x end
  return out
end

-- the same product with R(n + 1) for S(n); the places of these in its elements, as lists of indices
local function without_spheres(space, found, at)
  if not space.parts then
    if not kits.of(space).manifold then return space end
    found[#found + 1] = at
    return core.R(space.n + 1)
  end
  local parts = {}
  for k, part in ipairs(space.parts) do
    local there = table.move(at, 1, #at, 1, {})
    there[#there + 1] = k
    parts[k] = without_spheres(part, found, there)
  end
  return core.product(table.unpack(parts))
end

-- the constraint, behind x . x - 1 of every sphere
local function with_spheres(constraint, found)
  return function(q, ...)
    local out = {}
    for _, at in ipairs(found) do
      local x = q
      for _, k in ipairs(at) do x = x[k] end
      out[#out + 1] = x:dot(x) - 1
    end
    return constraint and joined(out, constraint(q, ...)) or out
  end
end

--- The options of a system in a copy, without spheres.
function M.unfold(options)
  local out, found = {}, {}
  for key, value in pairs(options) do out[key] = value end
  if not options.Q.parts or not kits.of(options.Q).manifold then return out end
  out.Q = without_spheres(options.Q, found, {})
  out.constraint = with_spheres(options.constraint, found)
  return out
end

return M
