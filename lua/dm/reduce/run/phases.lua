--- Phases of rigid motions: how far a body has turned about its spatial momentum J, split exactly
-- for the discrete run (Leok 4.1, 4.8; Montgomery 1991). With body momenta mu_k and S_ab the
-- shortest rotation from a to b, g_k S_(0 k) g_0^-1 is a turn about J, by total_k; g_(k+1) S_(k,
-- k+1) g_k^-1 one by what a step turns beyond that. Their product differs from the former by the
-- holonomy of the geodesic polygon mu_0 ... mu_k mu_0, which is its area:
--   total = dynamic + geometric,  geometric = - area.
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local WHERE = "path:phases"
local TURN = 2 * math.pi

local class = { __name = "dm.phases" }

function class.__tostring(p)
  local last = #p.total
  return ("phases of %d rows; the body has turned %.9g = %.9g dynamic + %.9g geometric about its "
    .. "spatial momentum"):format(last, p.total[last], p.dynamic[last], p.geometric[last])
end

-- the shortest rotation from the unit vector a to the unit vector b; of opposite ones any
local function shortest(a, b)
  local v, c = a:cross(b), a:dot(b)
  local hat = core.matrix { { 0, -v[3], v[2] }, { v[3], 0, -v[1] }, { -v[2], v[1], 0 } }
  if c < -1 + 1e-14 then
    local e = math.abs(a[1]) < 0.6 and core.vector { 1, 0, 0 } or core.vector { 0, 1, 0 }
    local n = a:cross(e)
    n = n / n:norm()
    return n:outer(n) * 2 - core.identity(3)
  end
  return core.identity(3) + hat + hat * hat * (1 / (1 + c))
end

-- the angle of a rotation about the unit vector n
local function turn_about(R, n)
  local m = core.vector { R[3][2] - R[2][3], R[1][3] - R[3][1], R[2][1] - R[1][2] }
  return math.atan(m:dot(n) / 2, (R[1][1] + R[2][2] + R[3][3] - 1) / 2)
end

-- the signed area of a triangle of unit vectors (Van Oosterom and Strackee 1983)
local function area(a, b, c)
  return 2 * math.atan(a:dot(b:cross(c)), 1 + a:dot(b) + b:dot(c) + c:dot(a))
end

-- body momenta as unit vectors
local function directions(momenta)
  local out = {}
  for k = 1, #momenta do
    local mu = core.vector(momenta[k])
    local size = mu:norm()
    if not (size > 0) then
      error(WHERE .. ": the momentum is zero, so there is no axis to turn about", 0)
    end
    out[k] = mu / size
  end
  return out
end

local KEPT = 1e-6  -- how far the direction of J may move: rules that are not symplectic keep it so

-- raises where g mu has left its first direction
local function check_kept(elements, mu, axis)
  for k = 2, #elements do
    local off = (elements[k] * mu[k] - axis):norm()
    if not (off <= KEPT) then
      error(("%s: the spatial momentum is not kept: its direction is off by %.3g in row %d; phases "
        .. "are of motions without torque, whose L does not see g"):format(WHERE, off, k), 0)
    end
  end
end

-- raises where rows that are several steps apart are half a turn apart, by the body velocity; a
-- step itself turns by less
local function check_rows(path, first)
  local t, h = path.t, math.abs(path.h)
  for k = 2, #path do
    local far = math.abs(t[k] - t[k - 1]) > 1.5 * h
    local speed = far and path.system:velocity(path.q[k], path.p[k]):slice(first + 1, first + 3)
    local turn = far and math.abs(t[k] - t[k - 1]) * speed:norm()
    if far and turn >= math.pi then
      error(("%s: the body turns by about %.3g rad from row %d to the next: more than half a turn "
        .. "is not seen in rows, keep more of them (every =)"):format(WHERE, turn, k - 1), 0)
    end
  end
end

-- of rotations and body momenta, lists of rows
local function of_rows(elements, momenta)
  local mu = directions(momenta)
  local axis = elements[1] * mu[1]
  check_kept(elements, mu, axis)
  local total, dynamic, geometric = { 0 }, { 0 }, { 0 }
  for k = 2, #elements do
    local here, before = elements[k], elements[k - 1]
    local step = here * shortest(mu[k - 1], mu[k]) * before:transpose()
    dynamic[k] = dynamic[k - 1] + turn_about(step, axis)
    geometric[k] = geometric[k - 1] - area(mu[1], mu[k - 1], mu[k])
    local whole = turn_about(here * shortest(mu[1], mu[k]) * elements[1]:transpose(), axis)
    local guess = dynamic[k] + geometric[k]
    total[k] = whole + TURN * math.floor((guess - whole) / TURN + 0.5)
  end
  return setmetatable({ total = core.vector(total), dynamic = core.vector(dynamic),
    geometric = core.vector(geometric) }, class)
end

-- the rotation of an element, of SO(3) or of its cover
local function rotation_of(group)
  local kit = kits.of(group)
  if kit == kits.of(core.SO(3)) then return function(g) return g end end
  if kit == kits.of(core.SU(2)) then return require "dm.group.so3".rotation end
end

-- the factor of a product that turns, where there is one: its number, where it begins in momenta,
-- and its rotations; of a group that is none, number 0
local function turning(Q)
  local found, first
  local count = 0
  for k, part in ipairs(kits.of(Q).parts and Q.parts or {}) do
    if rotation_of(part) and not found then
      found, first = k, count
    elseif rotation_of(part) then
      return
    end
    count = count + part.dimension
  end
  if found then return found, first, rotation_of(Q.parts[found]) end
  return 0, 0, rotation_of(Q)
end

--- Of a dm.path on a group.
function M.of_path(path)
  local Q, place = path.system.Q, path.system.place
  local factor, first, rotation = turning(Q)
  if not rotation then
    error(("%s: of groups that are not abelian phases are known for SO(3) and SU(2), alone or as "
      .. "one factor of a product, not for %s (abelian groups: system:routh)"):format(WHERE,
      tostring(Q)), 0)
  end
  local q, p, elements, momenta = path.q, path.p, {}, {}
  for k = 1, #path do
    local g = q[k]
    elements[k] = rotation(factor > 0 and g[factor] or g)
    momenta[k] = p[k]:slice(first + 1, first + 3)
    if place.right then momenta[k] = elements[k]:transpose() * momenta[k] end
  end
  check_rows(path, first)
  return of_rows(elements, momenta)
end

return M
