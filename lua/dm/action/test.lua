--- Questions to an action: isotropy, freeness, orbits, and what it leaves invariant.
local blame = require "dm.base.blame"
local core = require "dm.core"
local actions = require "dm.action"
local axioms = require "dm.action.axioms"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local points = require "dm.action.points"
local symmetries = require "dm.action.symmetry"

local M = {}


local abs, max = math.abs, math.max

local RANK = 1e-10

-- the vectors of the algebra that do not move z
local function stabilizer(action, z)
  local values, vectors = linear.singular_values(action:generator(z))
  local largest, basis = 0, {}
  for _, s in ipairs(values) do largest = max(largest, s) end
  for k, s in ipairs(values) do
    if s <= RANK * largest + 1e-14 * (1 + kits.norm(z)) then basis[#basis + 1] = vectors[k] end
  end
  return basis
end

actions.method("isotropy", function(action, z)
  z = points.point(action, z)
  local basis = stabilizer(action, z)
  return core.result { dimension = #basis, basis = basis,
    orbit_dimension = action.group.dimension - #basis }
end, [[
action:isotropy(z) -> { dimension, basis, orbit_dimension }
The algebra of the stabilizer of z: its dimension and an orthonormal basis, from the singular values
of the generators (below 1e-10 of the largest counts as zero), and the dimension of the orbit.]])

actions.method("free", function(action, z)
  return #stabilizer(action, points.point(action, z)) == 0
end, [[
action:free(z) -> boolean
Is the action locally free at z (no vector of the algebra leaves it where it is)? Then a moving
frame exists near z. Discrete stabilizers are not looked for.]])

actions.method("transitive", function(action, z)
  local basis = stabilizer(action, points.point(action, z))
  return action.group.dimension - #basis == action.on.dimension
end, [[
action:transitive(z) -> boolean
Does the orbit of z fill a neighbourhood: is its dimension that of the space?]])

---- invariance ----

local POINTS, TRIES, TOLERANCE = 24, 240, 1e-9

local violation = { __name = "dm.violation" }
function violation.__tostring(v)
  return ("not invariant under %s: at %s, g = %s the value %s becomes %s (by %.3g)")
    :format(tostring(v.action), v.where, points.show(v.g), points.show(v.before),
      points.show(v.after), v.defect)
end

-- values of f, or nothing where it fails or is not finite
local function values_of(f, z)
  local fine, value = blame.try(f, z)
  if not fine then return nil, value end
  local list = kits.is_scalar(value) and { value } or value
  if kits.class_of(list) ~= "table" and kits.class_of(list) ~= "dm.vector" then
    return nil, ("the function must return a number or a list of numbers (got %s)")
      :format(kits.class_of(value))
  end
  if #list == 0 then return nil, "the function returns an empty list" end
  for i = 1, #list do
    if type(list[i]) ~= "number" then
      return nil, ("the function must return a number or a list of numbers (got %s)")
        :format(kits.class_of(list[i]))
    end
    if not (abs(list[i]) < math.huge) then return nil, "its value is not finite" end
  end
  return kits.list_of(list)
end

local function largest_change(a, b)
  local worst, size = 0, 0
  for i = 1, #a do worst, size = max(worst, abs(a[i] - b[i])), max(size, abs(a[i]), abs(b[i])) end
  return worst, size
end

-- compare f at random points and where they are moved to: true, the worst defect; or false and the
-- first violation
local function compare(action, f, sample, where)
  local kit, stream = groups.kit(action.group), core.random(7020)
  local seen, sizes, worst, cause = {}, {}, 0, nil
  for i = 1, TRIES do
    local z, g = sample(stream, i), axioms.element(kit, stream, 5 * i + 2)
    local w = points.is_inside(action, z) and points.moved(action, g, z)
    local before, after
    if w then before, cause = values_of(f, z) end
    if before then after, cause = values_of(f, w) end
    if after and #after ~= #before then
      error(("action:invariant: the function must return as many numbers everywhere (got %d, then "
        .. "%d)"):format(#before, #after), 0)
    end
    if after then
      local defect, size = largest_change(before, after)
      seen[#seen + 1] = { z = z, g = g, before = before, after = after, defect = defect }
      sizes[#seen] = size
    end
    if #seen == POINTS then break end
  end
  local usual = lists.middle(sizes)
  for k, s in ipairs(seen) do
    local size = max(sizes[k], usual)
    if s.defect > TOLERANCE * size then
      return false, setmetatable({ action = action, point = s.z, g = s.g,
        before = #s.before == 1 and s.before[1] or s.before,
        after = #s.after == 1 and s.after[1] or s.after, defect = s.defect,
        where = where(s.z) }, violation)
    end
    if s.defect > 0 then worst = max(worst, s.defect / size) end
  end
  if #seen == 0 then
    error(("action:invariant: the value is finite at none of %d random points and where they are "
      .. "moved to%s"):format(TRIES, cause and ": " .. tostring(cause) or ""), 0)
  end
  return true, worst
end

-- the action on as many points as n coordinates hold
local function joint(action, n, what)
  if n % action.dimension ~= 0 then
    error(("action:invariant: %s has %d coordinates, and %s moves points of %d")
      :format(what, n, tostring(action), action.dimension), 0)
  end
  local k = n // action.dimension
  return k == 1 and action or action:on_points(k)
end

local function named(names, n)
  return function(z)
    local out = {}
    for k, name in ipairs(names) do
      out[k] = ("%s = %s"):format(name, points.show(z:slice((k - 1) * n + 1, k * n)))
    end
    return table.concat(out, ", ")
  end
end

-- symmetries up to divergence and scale, of a system on coordinates with an L that has a formula
local function looser(action, system)
  if system.place or not system.given.L or system.given.derivatives == "hyperdual" then return end
  local fine, symmetry, most, a = blame.try(symmetries.of_system, action, system)
  if not fine then return end
  return symmetry, most, a
end

-- an action on (q, t), by its generators
local function of_time(action, system)
  local symmetry, most, a = looser(action, system)
  if symmetry and most < TOLERANCE then return true, most, symmetry end
  local text = symmetry and "L is invariant up to a divergence or a scale only: the third result "
    .. "tells which, for path:noether"
    or ("generator %d is no symmetry of the action, not even up to a divergence and a scale")
      :format(a or 0)
  return false, text, symmetry
end

-- L(q, v, t) of a system, on tangent vectors
local function of_system(action, system)
  local n = system.Q.dimension
  if action.dimension == n + 1 then return of_time(action, system) end
  local lifted = joint(action, n, "the system"):tangent()
  local on = lifted.base.on
  local function L(z) return system:lagrangian(z:slice(1, n), z:slice(n + 1, 2 * n), 0.3) end
  local fine, why = compare(lifted, L, function(stream, i)
    local q, v = points.sample_point(on, stream, 5 * i), kits.normals(stream, 5 * i + 1, n, 1)
    local out = kits.list_of(q)
    for k = 1, n do out[n + k] = v[k] end
    return core.vector(out)
  end, named({ "q", "v" }, n))
  if fine then return fine, why end
  return fine, why, (looser(joint(action, n, "the system"), system))
end

-- Ld(q0, q1), on pairs of near points
local function of_discrete(action, Ld)
  local n = Ld.Q.dimension
  local base = joint(action, n, "the discrete Lagrangian")
  local k = n // action.dimension
  local function value(z) return Ld:value(z:slice(1, n), z:slice(n + 1, 2 * n)) end
  return compare(action:on_points(2 * k), value, function(stream, i)
    local q, step = points.sample_point(base.on, stream, 5 * i),
      kits.normals(stream, 5 * i + 1, n, 0.3)
    local out = kits.list_of(q)
    for c = 1, n do out[n + c] = q[c] + step[c] end
    return core.vector(out)
  end, named({ "q0", "q1" }, n))
end

actions.method("invariant", function(action, f)
  local class = kits.class_of(f)
  f = core.one(f, "the function of action:invariant")
  if class == "dm.system" then return of_system(action, f) end
  if class == "dm.discrete_lagrangian" then
    return of_discrete(action.points and action.base or action, f)
  end
  if class ~= "function" and class ~= "dm.function" then
    error(("action:invariant takes a function of z, a dm.system or a dm.discrete_lagrangian (got "
      .. "%s)"):format(class), 0)
  end
  local function sample(stream, i) return points.sample_point(action.on, stream, 5 * i) end
  return compare(action, f, sample, named({ "z" }, action.dimension))
end, [[
action:invariant(f | system | Ld) -> true, defect   or   false, violation [, symmetry]
Is a function f(z), the Lagrangian of a dm.system (under the lift to velocities) or a discrete
Lagrangian (under the joint action) invariant? Compared at random points to 1e-9; the first
violation has point, g, before, after, defect, and prints as a sentence. Systems of several bodies
are moved body by body; an action on one coordinate more than the system has moves (q, t), and is
tested by its generators. Where L is invariant up to a divergence dB/dt and a multiple c L of itself
alone, the third result is { generator, divergence, scale } as path:noether takes it (of a group of
more dimensions a list of these). Raises when the value is finite nowhere.]])

return M
