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

--- Of elements and body momenta, lists of rows; the group must be SO(3).
function M.of_rows(group, elements, momenta)
  if kits.of(group) ~= kits.of(core.SO(3)) then
    error(("%s: of groups that are not abelian phases are known for SO(3), not for %s (abelian "
      .. "groups: system:routh)"):format(WHERE, tostring(group)), 0)
  end
  local mu = directions(momenta)
  local axis = elements[1] * mu[1]
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

--- Of a dm.path on a group that dm.euler_poincare made.
function M.of_path(path)
  local q, mu, elements, momenta = path.q, path.mu, {}, {}
  for k = 1, #path do elements[k], momenta[k] = q[k], mu[k] end
  return M.of_rows(path.system.Q, elements, momenta)
end

return M
