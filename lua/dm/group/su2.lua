--- SU(2): unit quaternions (w, x, y, z), vectors of 4, in the algebra basis of SO(3), which it
-- covers twice: exp(xi) turns by the angle |xi|, and is -1 at 2 pi.
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local smooth = require "dm.group.smooth"
local so3 = require "dm.group.so3"

local M = {}

local choose, circular = smooth.choose, smooth.stumpff_circular
local times = so3.smooth.carry

local function joined(w, v, s) return core.vector { w, s * v[1], s * v[2], s * v[3] } end

local function imaginary(q) return core.vector { q[2], q[3], q[4] } end

local function exp(xi)
  local t = 0.25 * xi:dot(xi)
  return joined(circular(0, t), xi, 0.5 * circular(1, t))
end

-- the angle of (w, |v|) over |v|, up to pi; at -1, where any axis would do, the first is taken
local function log(q)
  local w, v = q[1], imaginary(q)
  local s = v:dot(v)
  if w == -1 and s == 0 then return core.vector { 2 * math.pi, 0, 0 } end
  local ratio = choose(w, function() return smooth.arc(w, s) end, function()
    local safe = smooth.guarded(-w, s)
    return math.pi / core.sqrt(safe) - smooth.arc(-w, safe)
  end)
  return v * (2 * ratio)
end

-- quaternions as matrices of 4 x 4, products from the left
local function left_matrix(q)
  local w, x, y, z = q[1], q[2], q[3], q[4]
  return core.matrix { { w, -x, -y, -z }, { x, w, -z, y }, { y, z, w, -x }, { z, -y, x, w } }
end

-- X/2 is the quaternion xi/4: all maps are rational
local function cayley_maps(kit)
  function kit.cayley(xi)
    local t = xi:dot(xi) * (1 / 16)
    local s = 1 / (1 + t)
    return joined((1 - t) * s, xi, 0.5 * s)
  end
  function kit.cayleyinv(q)
    if type(q[1]) == "number" and 1 + q[1] < 1e-12 then
      error("the Cayley map does not reach this element: -1 is one of its eigenvalues", 0)
    end
    return imaginary(q) * (4 / (1 + q[1]))
  end
  -- (1 + a) eta (1 - a) of quaternions, a = sign xi/4
  local function turned(xi, eta, sign, t)
    return eta * (1 - t) + xi * (xi:dot(eta) * (1 / 8)) + xi:cross(eta) * (0.5 * sign)
  end
  function kit.dcay(xi, eta)
    local t = xi:dot(xi) * (1 / 16)
    return turned(xi, eta, 1, t) * (1 / ((1 + t) * (1 + t)))
  end
  function kit.dcayinv(xi, eta) return turned(xi, eta, -1, xi:dot(xi) * (1 / 16)) end
end

local function matrix_maps(kit)
  kit.matrix = left_matrix
  function kit.from_matrix(m) return m:column(1) end
  function kit.hat(xi) return left_matrix { 0, 0.5 * xi[1], 0.5 * xi[2], 0.5 * xi[3] } end
  function kit.vee(m)
    return core.vector { 0.5 * (m[2][1] - m[1][2] + m[4][3] - m[3][4]),
      0.5 * (m[3][1] - m[1][3] + m[2][4] - m[4][2]),
      0.5 * (m[4][1] - m[1][4] + m[3][2] - m[2][3]) }
  end
end

-- quaternions move R^4, their rotations R^3
local function linear_action(m)
  if m == 4 then return function(q, z) return core.vector(times(q, z)) end end
  if m == 3 then return function(q, z) return so3.rotation(q) * z end end
end

-- coordinates of a run: those of SO(3), where q and -q are two elements
local function coordinates(kit)
  local of = so3.smooth
  return { carry = times, exp = of.exp, dexp = of.dexp, near = of.near, tidy = of.tidy,
    apart = of.apart, mend = of.mend, scale = of.scale, velocity = of.velocity, scales = 1,
    turn = of.turn, turned = of.turned,
    cayley = function(xi) return kits.list_of(kit.cayley(xi)) end }
end

local function facts(kit)
  kit.acts = { linear = linear_action }
  function kit.element(g) return kits.vector(g, 4, "the group element") end
  kit.raw = kit.element
  kit.form, kit.bonds = "a unit quaternion, a vector of 4 numbers", so3.norm_bond
  kit.body = { pose = so3.rotation, turning = 0 }
  function kit.arcs(xi) return { xi:dot(xi) } end
  function kit.project(q)
    if linear.is_plain(core.matrix { q }) and q:norm() == 0 then
      error("there is no nearest unit quaternion: it is zero", 0)
    end
    return q * (1 / q:norm())
  end
  function kit.defect(q)
    local off = math.abs(q:norm() - 1)
    return off, ("its norm is off 1 by %.3g"):format(off)
  end
  function kit.sample(stream, i)
    local q = kits.normals(stream, i, 4, 1)
    return q * (1 / q:norm())
  end
end

function M.kit()
  local kit = { dimension = 3, coordinates = 4, vectors = true, liftable = true, exp = exp,
    log = log }
  facts(kit)
  function kit.identity() return core.vector { 1, 0, 0, 0 } end
  function kit.compose(a, b) return core.vector(times(a, b)) end
  function kit.inverse(q) return joined(q[1], imaginary(q), -1) end
  function kit.near(xi) return joined(1, xi, 0.5) end
  function kit.Ad(q, xi) return so3.rotation(q) * xi end
  function kit.ad(xi, eta) return xi:cross(eta) end
  kit.coAd = kit.Ad
  function kit.coad(xi, mu) return mu:cross(xi) end
  function kit.dexp(xi, eta) return so3.dexp(xi) * eta end
  function kit.dexpinv(xi, eta) return so3.dexpinv(xi) * eta end
  kit.momenta = { ["SU(2)"] = kit.coAd, ["SO(3)"] = kit.coAd,
    ["SO(2)"] = function(q, mu) return core.vector { kit.coAd(q, mu)[3] } end }
  cayley_maps(kit)
  matrix_maps(kit)
  kit.smooth = coordinates(kit)
  return kits.complete(kit)
end

return M
