--- SO(3): rotation matrices; flat coordinates are a unit quaternion (w, x, y, z), w >= 0.
local acts = require "dm.group.acts"
local class = require "dm.base.class"
local core = require "dm.core"
local linear = require "dm.base.linear"
local kits = require "dm.group.kit"
local matrices = require "dm.group.matrices"
local matrix_functions = class.module(function() return require "dm.group.matrix_functions" end)
local smooth = require "dm.group.smooth"
local rotations = class.module(function() return require "dm.group.son" end)

local M = {}

local choose = smooth.choose
local circular, within = smooth.stumpff_circular, smooth.stumpff_within

function M.hat(xi)
  return core.matrix { { 0, -xi[3], xi[2] }, { xi[3], 0, -xi[1] }, { -xi[2], xi[1], 0 } }
end

function M.vee(m)
  return core.vector { 0.5 * (m[3][2] - m[2][3]), 0.5 * (m[1][3] - m[3][1]),
    0.5 * (m[2][1] - m[1][2]) }
end

-- rows of 1 + a X + b X^2, X = hat((x, y, z)); entry by entry, which is 4 % of the first SE(3) of
-- docs/benchmarks/frames.md; 0 and what it is added to is no -0
local function combined(x, y, z, a, b)
  local xx, yy, zz = x * x, y * y, z * z
  local xy, xz, yz = 0 + x * y * b, 0 + x * z * b, 0 + y * z * b
  return { 1 + (-zz - yy) * b, xy - z * a, y * a + xz },
    { z * a + xy, 1 + (-zz - xx) * b, yz - x * a },
    { xz - y * a, x * a + yz, 1 + (-yy - xx) * b }
end

--- 1 + a X + b X^2, X = hat(xi)
function M.combine(xi, a, b) return core.matrix { combined(xi[1], xi[2], xi[3], a, b) } end

function M.exp(xi)
  local t = xi:dot(xi)
  return M.combine(xi, circular(1, t), circular(2, t))
end

-- 4 q q^T from the entries of R; its largest row gives q without a loss of digits (Shepperd 1978)
local function outer_square(R)
  local x, y, z = table.unpack(R:totable())
  local a, b, c = x[1], y[2], z[3]
  local wx, wy, wz = z[2] - y[3], x[3] - z[1], y[1] - x[2]
  local xy, xz, yz = x[2] + y[1], x[3] + z[1], y[3] + z[2]
  return { { 1 + a + b + c, wx, wy, wz }, { wx, 1 + a - b - c, xy, xz },
    { wy, xy, 1 - a + b - c, yz },
    { wz, xz, yz, 1 - a - b + c } }
end

--- The unit quaternion of R with w >= 0.
function M.quaternion(R)
  local q = core.quaternion(R)
  if q then return q end
  local K = outer_square(R)
  local d = { K[1][1], K[2][2], K[3][3], K[4][4] }
  local best = { K[1][1], K[1][2], K[1][3], K[1][4], d[1] }
  for k = 2, 4 do
    local better, now = d[k] - best[5], best
    best = {}
    for i = 1, 4 do
      best[i] = choose(better, function() return K[k][i] end, function() return now[i] end)
    end
    best[5] = choose(better, function() return d[k] end, function() return now[5] end)
  end
  local scale = 0.5 / core.sqrt(best[5])
  scale = choose(-best[1], function() return -scale end, function() return scale end)
  return { best[1] * scale, best[2] * scale, best[3] * scale, best[4] * scale }
end

--- The rotation of a quaternion; times |q|^2 when that is not 1.
M.rotation = core.rotation

function M.norm_bond(q) return { q[1] * q[1] + q[2] * q[2] + q[3] * q[3] + q[4] * q[4] - 1 } end

--- The rotation vector, of length 0 to pi: exact near 0 and near pi.
function M.log(R)
  local q = M.quaternion(R)
  local v = core.vector { q[2], q[3], q[4] }
  return v * (2 * smooth.arc(q[1], v:dot(v)))
end

--- dexp of so(3) as a matrix, and its inverse
function M.dexp(xi)
  local t = xi:dot(xi)
  return M.combine(xi, circular(2, t), circular(3, t))
end

--- Rows of exp and of dexp together.
function M.exp_and_slope(x, y, z)
  local t = x * x + y * y + z * z
  local c2 = circular(2, t)
  return { combined(x, y, z, circular(1, t), c2) }, { combined(x, y, z, c2, circular(3, t)) }
end
function M.dexpinv(xi) return M.combine(xi, -0.5, smooth.half_cotangent(xi:dot(xi))) end

--- A uniform rotation.
function M.sample(stream, i)
  local q = kits.normals(stream, i, 4, 1)
  return M.rotation(q * (1 / q:norm()))
end

local function cayley_maps(kit)
  function kit.cayley(xi)
    local a = 1 / (1 + 0.25 * xi:dot(xi))
    return M.combine(xi, a, 0.5 * a)
  end
  function kit.dcay(xi, eta) return (eta + xi:cross(eta) * 0.5) * (1 / (1 + 0.25 * xi:dot(xi))) end
  function kit.dcayinv(xi, eta) return eta - xi:cross(eta) * 0.5 + xi * (0.25 * xi:dot(eta)) end
end

-- unit quaternions as coordinates: products and maps without a choice of sign
local times = linear.quaternion_product

-- 2 Im(conj(q) v), and q . v: velocity of a unit quaternion and rate of its length
local function velocity(q, v)
  local w = times({ q[1], -q[2], -q[3], -q[4] }, v)
  return { 2 * w[2], 2 * w[3], 2 * w[4], w[1] }
end

local function length(q)
  local s = core.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3] + q[4] * q[4])
  return { s, s, s, s }
end

-- (w, s v)
local function joined(w, v, s) return { w, s * v[1], s * v[2], s * v[3] } end

-- cos(x/2) - 1 and sin(x/2), both without a loss of digits
local function half_turn(x)
  local w, s = core.cos(0.25 * x), core.sin(0.25 * x)
  return -2 * s * s, 2 * s * w
end

--- Coordinates of a run (group/flat.lua); `tidy` is a step of Newton's method to |q| = 1.
M.smooth = { carry = times, scale = length, velocity = velocity, scales = 1,
  exp = function(xi)
    local t = 0.25 * xi:dot(xi)
    return joined(within(0, t, 12), xi, 0.5 * within(1, t, 12))
  end,
  -- with c_2(t) = c_1(t/4)^2/2
  dexp = function(xi, eta)
    local t = xi:dot(xi)
    local s, turned = within(1, 0.25 * t, 12), xi:cross(eta)
    return eta + turned * (0.5 * s * s) + xi:cross(turned) * within(3, t, 14)
  end,
  turn = function(a, x, q, right)
    local out, w, s = { 0, 0, 0, 0 }, half_turn(x)
    out[1], out[1 + a] = w, s
    if right then return times(out, q) end
    return times(q, out)
  end,
  turned = function(a, x, mu)
    local w, s = half_turn(x)
    local c, d, out = -2 * s * s, 2 * s * (1 + w), { 0, 0, 0 }
    local i, j = a % 3 + 1, (a + 1) % 3 + 1
    out[i], out[j] = c * mu[i] + d * mu[j], c * mu[j] - d * mu[i]
    return out
  end,
  near = function(xi) return joined(1, xi, 0.5) end,
  cayley = function(xi)
    local w = 1 / core.sqrt(1 + 0.25 * xi:dot(xi))
    return joined(w, xi, 0.5 * w)
  end,
  follow = function(q, last)
    local dot = q[1] * last[1] + q[2] * last[2] + q[3] * last[3] + q[4] * last[4]
    local s = choose(dot, function() return 1 end, function() return -1 end)
    return { s * q[1], s * q[2], s * q[3], s * q[4] }
  end,
  -- w - 1 = -|v|^2/(1 + w)
  apart = function(q)
    local square = q[2] * q[2] + q[3] * q[3] + q[4] * q[4]
    return { -square / (1 + q[1]), q[2], q[3], q[4] }
  end,
  mend = function(q)
    local s = 0.5 - 0.5 * (q[1] * q[1] + q[2] * q[2] + q[3] * q[3] + q[4] * q[4])
    return { s * q[1], s * q[2], s * q[3], s * q[4] }
  end,
  tidy = function(q)
    local s = 1.5 - 0.5 * (q[1] * q[1] + q[2] * q[2] + q[3] * q[3] + q[4] * q[4])
    return { s * q[1], s * q[2], s * q[3], s * q[4] }
  end }

-- the mean over the group in Euler's angles, R_z R_y R_z: trapezoidal rules and Gauss nodes of the
-- cosine, exact for entries of R to a degree below `points`
local function mean(points)
  local c, b = core.quadrature { named = ("gauss(%d)"):format((points + 1) // 2) }
  local out, step = {}, 2 * math.pi / points
  local e2, e3 = core.vector { 0, 1, 0 }, core.vector { 0, 0, 1 }
  for i = 0, points - 1 do
    for j = 1, #c do
      local tilted = M.exp(e3 * (i * step)) * M.exp(e2 * math.acos(2 * c[j] - 1))
      for k = 0, points - 1 do
        out[#out + 1] = { tilted * M.exp(e3 * (k * step)), b[j] / points ^ 2 }
      end
    end
  end
  return out
end

function M.kit()
  local kit = { dimension = 3, coordinates = 4, exp = M.exp, log = M.log, hat = M.hat, vee = M.vee,
    liftable = true, mean = mean, body = { pose = function(g) return g end, turning = 0 },
    flat = M.quaternion, unflat = M.rotation, bonds = M.norm_bond, sample = M.sample,
    project = function(m) return matrix_functions.nearest_rotation(m) end, smooth = M.smooth }
  cayley_maps(kit)
  kit.acts = acts.rotations(kit, 3)
  function kit.inverse(g) return g:transpose() end
  function kit.arcs(xi) return { xi:dot(xi) } end
  function kit.Ad(g, xi) return g * xi end
  function kit.ad(xi, eta) return xi:cross(eta) end
  function kit.coAd(g, mu) return g * mu end
  function kit.coad(xi, mu) return mu:cross(xi) end
  kit.momenta = { ["SO(3)"] = kit.coAd,
    ["SO(2)"] = function(g, mu) return core.vector { (g * mu)[3] } end }
  function kit.dexp(xi, eta) return M.dexp(xi) * eta end
  function kit.dexpinv(xi, eta) return M.dexpinv(xi) * eta end
  function kit.distance(a, b) return kits.norm(M.log(a:transpose() * b)) end
  function kit.defect(g) return rotations.defect(g, 3) end
  return matrices.complete(kit, 3)
end

return M
