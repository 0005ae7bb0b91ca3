--- SE(2): (x, y, theta), the motion z -> R(theta) z + (x, y). Algebra: (u, v, omega), translations
-- first.
local acts = require "dm.group.acts"
local core = require "dm.core"
local kits = require "dm.group.kit"
local smooth = require "dm.group.smooth"
local so2 = require "dm.group.so2"

local M = {}

local circular = smooth.stumpff_circular

-- (a + b J) of the plane, J the right angle, on (x, y)
local function turn(a, b, x, y) return a * x - b * y, b * x + a * y end

function M.compose(g, h)
  local x, y = turn(core.cos(g[3]), core.sin(g[3]), h[1], h[2])
  return core.vector { g[1] + x, g[2] + y, g[3] + h[3] }
end

function M.inverse(g)
  local x, y = turn(core.cos(g[3]), -core.sin(g[3]), g[1], g[2])
  return core.vector { -x, -y, -g[3] }
end

-- phi(omega J) = sin(omega)/omega + (1 - cos(omega))/omega J
local function phi(omega)
  local t = omega * omega
  return circular(1, t), omega * circular(2, t)
end

-- its inverse: (omega/2) cot(omega/2) - omega/2 J
local function phi_inverse(omega)
  local t = omega * omega
  return 1 - t * smooth.half_cotangent(t), -0.5 * omega
end

function M.exp(xi)
  local a, b = phi(xi[3])
  local x, y = turn(a, b, xi[1], xi[2])
  return core.vector { x, y, xi[3] }
end

function M.log(g)
  local omega = so2.principal(g[3])
  local a, b = phi_inverse(omega)
  local u, v = turn(a, b, g[1], g[2])
  return core.vector { u, v, omega }
end

function M.Ad(g, xi)
  local u, v = turn(core.cos(g[3]), core.sin(g[3]), xi[1], xi[2])
  return core.vector { u + xi[3] * g[2], v - xi[3] * g[1], xi[3] }
end

-- [(v, a), (w, b)] = (a J w - b J v, 0)
function M.ad(xi, eta)
  return core.vector { eta[3] * xi[2] - xi[3] * eta[2], xi[3] * eta[1] - eta[3] * xi[1], 0 }
end

-- the last column of phi(ad xi): phi_2(omega J)(-J v), phi_2 = 1/2 + z/6 + ...
local function last_column(xi)
  local t = xi[3] * xi[3]
  return turn(circular(2, t), xi[3] * circular(3, t), xi[2], -xi[1])
end

function M.dexp(xi, eta)
  local a, b = phi(xi[3])
  local x, y = turn(a, b, eta[1], eta[2])
  local p, q = last_column(xi)
  return core.vector { x + p * eta[3], y + q * eta[3], eta[3] }
end

function M.dexpinv(xi, eta)
  local a, b = phi_inverse(xi[3])
  local p, q = last_column(xi)
  local x, y = turn(a, b, eta[1] - p * eta[3], eta[2] - q * eta[3])
  return core.vector { x, y, eta[3] }
end

local function matrix(g)
  local c, s = core.cos(g[3]), core.sin(g[3])
  return core.matrix { { c, -s, g[1] }, { s, c, g[2] }, { 0, 0, 1 } }
end

function M.kit()
  local kit = { dimension = 3, vectors = true, angles = { [3] = true },
    form = "a vector of 3 numbers (x, y, theta)", compose = M.compose, inverse = M.inverse,
    exp = M.exp, log = M.log, Ad = M.Ad, ad = M.ad,
    dexp = M.dexp, dexpinv = M.dexpinv, matrix = matrix }
  function kit.identity() return core.zeros(3) end
  function kit.element(g) return kits.vector(g, 3, "the group element") end
  kit.raw = kit.element
  function kit.hat(xi)
    return core.matrix { { 0, -xi[3], xi[1] }, { xi[3], 0, xi[2] }, { 0, 0, 0 } }
  end
  function kit.vee(m) return core.vector { m[1][3], m[2][3], 0.5 * (m[2][1] - m[1][2]) } end
  function kit.from_matrix(m)
    return core.vector { m[1][3], m[2][3], core.atan(m[2][1], m[1][1]) }
  end
  function kit.project(g) return core.vector { g[1], g[2], so2.principal(g[3]) } end
  function kit.sample(stream, i)
    return core.vector { stream:normal(i, 0), stream:normal(i, 1),
      stream:uniform(i, 2, -math.pi, math.pi) }
  end
  kit.acts = { affine = acts.affine(kit, 2), translation = acts.translation(kit) }
  function kit.turns() return { core.vector { 0, 0, 2 * math.pi } } end
  return kits.complete(kit)
end

return M
