--- The rigid bodies of an animation: what each looks like, and where it is in every row.
--
-- A body is { solid = {vertices, faces, tints} in its own axes, reach = half lengths of its axes,
-- points = {{x, y, z}, ...} that leave a trail, joints = likewise without one,
-- pose(q, t) -> rotation matrix, place of its origin }.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local option = require "dm.base.options"
local so3 = require "dm.group.so3"
local solids = require "dm.show.animate.solids"

local M = {}

local WHERE = "animate"
local fail = option.failing(WHERE)
local KNOWN = { "factor", "at", "pose", "shape", "inertia", "mass", "size", "centre", "points",
  "joints" }

---- the factors of a group that turn ----

-- { kit, index of the factor or nil, first = entries of the algebra before it } of every factor
local function factors_of(place)
  local out, first = {}, 0
  for k, part in ipairs(place.kit.parts or { place.kit }) do
    out[k] = { kit = part, index = place.kit.parts and k, first = first }
    first = first + part.dimension
  end
  return out
end

-- the bodies of a group by themselves: every factor that turns, placed by the next factor R^2 or
-- R^3 that places no other
local function found(place)
  local out, free = {}, {}
  for k, factor in ipairs(factors_of(place)) do
    local kit = factor.kit
    if kit.euclidean and (kit.dimension == 2 or kit.dimension == 3) then free[#free + 1] = k end
    if kit.body then out[#out + 1] = { factor = k } end
  end
  local n = 0
  for _, body in ipairs(out) do
    if not factors_of(place)[body.factor].kit.body.moving then
      n = n + 1
      body.at = free[n]
    end
  end
  return out
end

local function entry(q, factor) return factor.index and q[factor.index] or q end

---- where it is ----

local function checked_factor(place, k, key, turns)
  local factors = factors_of(place)
  local factor = factors[k]
  if not factor or turns and not factor.kit.body then
    fail("field '%s' of a body must be the number of a factor %s (got %s)", key,
      turns and "that turns, such as SO(3) or SE(3)" or "R^2 or R^3", option.got(k))
  end
  return factor
end

-- the place of an element R^2 or R^3, in space
local function in_space(x) return { x[1], x[2], x[3] or 0 } end

-- the same of what a function of the user gave
local function given_place(x, key)
  local fine, count = blame.try(function() return #x end)
  if not fine or count ~= 2 and count ~= 3 then
    fail("field '%s' of a body must give a place {x, y, z}, or {x, y} (got %s)", key, option.got(x))
  end
  return in_space(x)
end

-- at: {x, y, z}, the number of a factor, or a function of (q, t)
local function placing(place, at)
  if at == nil then return nil end
  if type(at) == "function" then
    at = core.one(at, "field 'at' of a body")
    return function(q, t) return given_place(at(q, t), "at") end
  end
  if type(at) ~= "number" then
    local fixed = in_space(kits.vector(at, 3, "field 'at' of a body"))
    return function() return fixed end
  end
  local factor = checked_factor(place, at, "at")
  return function(q) return in_space(entry(q, factor)) end
end

-- what a function of the user gives: a rotation, and a place
local function own_pose(f)
  local space = core.SO(3)
  return function(q, t)
    local R, x = f(q, t)
    local fine, found = blame.try(require "dm.group".element, space, R)
    if not fine then
      fail("field 'pose' of a body must return a rotation matrix, and a place {x, y, z}: %s",
        blame.bare(found))
    end
    return core.matrix(found), x and given_place(x, "pose")
  end
end

local function pose_of(place, given)
  if given.pose then return own_pose(given.pose) end
  if not place then
    fail "a body needs pose = function(q, t) return R, {x, y, z} end: this path is on no group"
  end
  local factor = checked_factor(place, given.factor or found(place)[1].factor, "factor", true)
  local at, pose = placing(place, given.at), factor.kit.body.pose
  return function(q, t)
    local R, x = pose(entry(q, factor))
    if at then x = at(q, t) end
    return R, x
  end
end

---- what it looks like ----

-- inertia (3 x 3, a matrix) and mass of a factor, read off d2L/dxi2 at the first row
local function inertia_of(path, place, given)
  local factors = factors_of(place)
  local factor = factors[given.factor]
  local body = factor.kit.body
  local M_ = path.system:mass(path.q[1], core.zeros(place.dimension), path.t[1])
  local from = factor.first + body.turning
  local J = linear.fill(3, 3, function(i, j) return M_[from + i][from + j] end)
  local moving = body.moving and factor.first + body.moving
  if not moving and math.type(given.at) == "integer" then moving = factors[given.at].first end
  return J, moving and M_[moving + 1][moving + 1]
end

-- half lengths, and the axes that they are along (rows of a matrix; nothing: those of the body)
local function by_inertia(path, place, given, shape)
  local J, m = given.inertia, given.mass
  if J and type(J[1]) == "number" then
    local I = kits.vector(J, 3, "field 'inertia' of a body")
    J = core.matrix { { I[1], 0, 0 }, { 0, I[2], 0 }, { 0, 0, I[3] } }
  end
  if not J then J, m = inertia_of(path, place, given) end
  local I, axes = { J[1][1], J[2][2], J[3][3] }, nil
  if math.abs(J[1][2]) + math.abs(J[1][3]) + math.abs(J[2][3]) > 1e-12 * linear.size(J) then
    I, axes = linear.symmetric(J:totable())
  end
  local size = solids.size(shape, I, m or 1)
  if m then return size, axes end
  local most = math.max(size[1], size[2], size[3])
  return { size[1] / most, size[2] / most, size[3] / most }, axes
end

-- the solid turned to its axes and moved to its centre
local function move(solid, axes, centre)
  local list = solid.vertices
  for k = 1, #list, 3 do
    local x = core.vector { list[k], list[k + 1], list[k + 2] }
    if axes then x = axes[1] * x[1] + axes[2] * x[2] + axes[3] * x[3] end
    for i = 1, 3 do list[k - 1 + i] = x[i] + centre[i] end
  end
  return solid
end

local function triples(given, key, usual)
  local list = given[key]
  if list == nil then return usual end
  if type(list) ~= "table" then
    fail("field '%s' of a body must be a list of points {x, y, z} in its axes", key)
  end
  local out = {}
  for i, x in ipairs(list) do
    out[i] = kits.vector(x, 3, ("point %d in '%s' of a body"):format(i, key))
  end
  return out
end

local function body_of(path, place, given, which)
  option.check(given, KNOWN, WHERE, "bodies = { { factor = 1 }, ... }")
  option.callable(given, "pose", WHERE, "(q, t) that returns a rotation matrix and a place")
  local shape = option.one_of(given, "shape", WHERE, { "ellipsoid", "box", "cylinder" },
    "ellipsoid")
  if not given.pose and place and not given.factor then
    local own = found(place)[which]
    given.factor, given.at = own and own.factor, given.at or own and own.at
  end
  local pose, size, axes = pose_of(place, given), given.size, nil
  if size then
    size = kits.vector(size, 3, "field 'size' of a body")
    for i = 1, 3 do
      if not (size[i] > 0 and size[i] < math.huge) then
        fail("field 'size' of a body must be three half lengths > 0 (entry %d is %g)", i, size[i])
      end
    end
  elseif given.inertia or not given.pose then
    size, axes = by_inertia(path, place, given, shape)
  else
    size = { 1, 1, 1 }
  end
  local centre = given.centre and kits.vector(given.centre, 3, "field 'centre' of a body")
    or { 0, 0, 0 }
  local solid = solids.shapes[shape](size[1], size[2], size[3])
  return { solid = move(solid, axes, centre), reach = core.vector(size) * 1.4, pose = pose,
    points = triples(given, "points", { { 0, 0, 1.4 * size[3] + centre[3] } }),
    joints = triples(given, "joints", {}) }
end

---- all of them ----

--- The bodies of a path: those of the option, or of a group all that turn; none else.
function M.of(path, options)
  local place = type(path) == "userdata" and path.system and path.system.place
  local given = options.bodies
  if given == nil then
    given = place and not path.watched and not options.points and not options.draw and found(place)
      or {}
  end
  local out = {}
  for k, one in ipairs(given) do
    if type(one) ~= "table" then
      fail("option 'bodies' is a list of tables, { { factor = 1 }, ... } (entry %d is %s)", k,
        option.got(one))
    end
    local copy = {}
    for key, value in pairs(one) do copy[key] = value end
    out[k] = body_of(path, place, copy, k)
  end
  return out
end

--- The pose of a body as 7 numbers behind the others: a unit quaternion, the place of its origin.
function M.add_pose(out, body, q, t)
  local R, x = body.pose(q, t)
  local quaternion = so3.quaternion(core.matrix(R))
  x = x or { 0, 0, 0 }
  for i = 1, 4 do out[#out + 1] = quaternion[i] end
  for i = 1, 3 do out[#out + 1] = x[i] * 1.0 end
  return R, x
end

--- Its points, then its joints, in space.
function M.add_points(out, body, R, x)
  for _, list in ipairs { body.points, body.joints } do
    for _, X in ipairs(list) do
      for i = 1, 3 do
        out[#out + 1] = R[i][1] * X[1] + R[i][2] * X[2] + R[i][3] * X[3] + x[i]
      end
    end
  end
end

return M
