--- SE(n): matrices {{R, a}, {0, 1}}, for n >= 3. Algebra: n translations, then the rotations of
-- SO(n). Flat coordinates: those of R in SO(n), then a. SE(2), vectors, has a file of its own.
local acts = require "dm.group.acts"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = class.module(function() return require "dm.base.linear" end)
local lists = class.module(function() return require "dm.base.lists" end)
local matrices = require "dm.group.matrices"
local matrix_functions = class.module(function() return require "dm.group.matrix_functions" end)
local smooth = require "dm.group.smooth"
local rotations = class.module(function() return require "dm.group.son" end)
local so3 = require "dm.group.so3"

local M = {}

local function rotation(g, n)
  local out = g:totable()
  out[n + 1] = nil
  for i = 1, n do out[i][n + 1] = nil end
  return core.matrix(out)
end
local function shift(g, n)
  local out = {}
  for i = 1, n do out[i] = g[i][n + 1] end
  return core.vector(out)
end
local function joined(R, a)
  local out, last = R:totable(), {}
  local n = #out
  for i = 1, n do out[i][n + 1], last[i] = a[i], 0 end
  last[n + 1] = 1
  out[n + 1] = last
  return core.matrix(out)
end

local function sequence(a, b)
  local out = kits.list_of(a)
  for i = 1, #b do out[#out + 1] = b[i] end
  return out
end

-- what is the same in all dimensions; `turns` is the kit of SO(n)
local function common(n, turns)
  local kit = { dimension = n + turns.dimension, liftable = true }
  kit.acts = { affine = acts.affine(kit, n) }
  function kit.hat(xi)
    local omega = {}
    for a = 1, turns.dimension do omega[a] = xi[n + a] end
    local out, last = turns.hat(core.vector(omega)):totable(), {}
    for i = 1, n do out[i][n + 1], last[i] = xi[i], 0 end
    last[n + 1] = 0
    out[n + 1] = last
    return core.matrix(out)
  end
  function kit.vee(m) return core.vector(sequence(shift(m, n), turns.vee(m))) end
  function kit.inverse(g)
    local R = rotation(g, n):transpose()
    return joined(R, -(R * shift(g, n)))
  end
  function kit.flat(g) return sequence(turns.flat(rotation(g, n)), shift(g, n)) end
  function kit.unflat(list)
    local k = turns.coordinates
    local a = {}
    for i = 1, n do a[i] = list[k + i] end
    return joined(turns.unflat(list), core.vector(a))
  end
  function kit.bonds(list) return turns.bonds(list) end
  function kit.project(m)
    return joined(matrix_functions.nearest_rotation(rotation(m, n)), shift(m, n))
  end
  function kit.defect(g)
    local worst, why = rotations.defect(g, n)
    for j = 1, n + 1 do worst = math.max(worst, math.abs(g[n + 1][j] - (j > n and 1 or 0))) end
    return worst, why
  end
  function kit.sample(stream, i)
    local a = {}
    for k = 1, n do a[k] = stream:normal(i, n * n + k) end
    return joined(turns.sample(stream, i), core.vector(a))
  end
  function kit.distance(a, b)
    local g = kit.compose(kit.inverse(a), b)
    return kits.norm(kit.log(g))
  end
  return kit
end

-- (v, omega) of an algebra vector of SE(3)
local function parts(xi)
  xi = core.vector(xi)
  return xi:slice(1, 3), xi:slice(4, 6)
end

-- the blocks of phi(ad xi) = {{P, Q}, {0, P}}, P = 1 + c2 W + c3 W^2, and Q its derivative along
-- hat(v): with t = |omega|^2, dt = 2 omega . v, dc2/dt = (2 c4 - c3)/2, dc3/dt = (3 c5 - c4)/2
local function blocks(xi)
  local v, omega = parts(xi)
  local t, dt, c = omega:dot(omega), 2 * omega:dot(v), {}
  for k = 2, 5 do c[k] = smooth.stumpff_circular(k, t) end
  local W, V = so3.hat(omega), so3.hat(v)
  local Q = V * c[2] + (W * V + V * W) * c[3] + W * (0.5 * dt * (2 * c[4] - c[3]))
    + W * W * (0.5 * dt * (3 * c[5] - c[4]))
  return so3.combine(omega, c[2], c[3]), Q
end

-- a quaternion and a shift (group/flat.lua), given those of R and the matrices of the group
local function coordinates(kit)
  local turns = so3.smooth
  local function of(name)
    return function(xi)
      local _, omega = parts(xi)
      return sequence(turns[name](omega), shift(kit[name](xi), 3))
    end
  end
  local function carry(a, b)
    local moved = so3.rotation(a) * core.vector { b[5], b[6], b[7] }
    return sequence(turns.carry(a, b), core.vector { a[5], a[6], a[7] } + moved)
  end
  -- gains along an axis, and of the covector carried there: (f, m) -> R^T (f, m - v x f)
  local function turn(a, x, q, right)
    local still, along = { 0, 0, 0 }, a <= 3 and linear.unit(3, a) * x
    if a <= 3 then return sequence({ 0, 0, 0, 0 }, right and along or so3.rotation(q) * along) end
    local moved = right and turns.turned(a - 3, -x, { q[5], q[6], q[7] }) or still
    return sequence(turns.turn(a - 3, x, q, right), moved)
  end
  local function turned(a, x, mu)
    local f, m = parts(mu)
    local function around(y) return turns.turned(a - 3, x, y) end
    if a > 3 then return sequence(around(f), around(m)) end
    return sequence({ 0, 0, 0 }, -(linear.unit(3, a) * x):cross(f))
  end
  local function velocity(q, v)
    local turning = turns.velocity(q, v)
    local moving = so3.rotation(q):transpose() * core.vector { v[5], v[6], v[7] }
    return sequence(moving, turning)
  end
  return { carry = carry, turn = turn, turned = turned, velocity = velocity, scales = 1,
    scale = function(list) return sequence(turns.scale(list), { 1, 1, 1 }) end,
    exp = of "exp", near = of "near", cayley = of "cayley",
    follow = function(list, last)
      return sequence(turns.follow(list, last), { list[5], list[6], list[7] })
    end,
    apart = function(list)
      return sequence(turns.apart(list), { list[5], list[6], list[7] })
    end,
    mend = function(list) return sequence(turns.mend(list), { 0, 0, 0 }) end,
    tidy = function(list) return sequence(turns.tidy(list), { list[5], list[6], list[7] }) end }
end

local function three()
  local kit = common(3, so3.kit())
  kit.smooth = coordinates(kit)
  function kit.arcs(xi)
    local _, omega = parts(xi)
    return { omega:dot(omega) }
  end
  function kit.exp(xi)
    local u, v, w = xi[1], xi[2], xi[3]
    local rows, slope = so3.exp_and_slope(xi[4], xi[5], xi[6])
    for i, s in ipairs(slope) do rows[i][4] = s[1] * u + s[2] * v + s[3] * w end
    rows[4] = { 0, 0, 0, 1 }
    return core.matrix(rows)
  end
  function kit.flat(g)
    local rows = g:totable()
    return sequence(so3.quaternion(g), { rows[1][4], rows[2][4], rows[3][4] })
  end
  function kit.log(g)
    local omega = so3.log(rotation(g, 3))
    return core.vector(sequence(so3.dexpinv(omega) * shift(g, 3), omega))
  end
  -- Ad (v, omega) = (R v + a x R omega, R omega)
  function kit.Ad(g, xi)
    local v, omega = parts(xi)
    local R = rotation(g, 3)
    local turned = R * omega
    return core.vector(sequence(R * v + shift(g, 3):cross(turned), turned))
  end
  function kit.ad(xi, eta)
    local v, omega = parts(xi)
    local w, nu = parts(eta)
    return core.vector(sequence(omega:cross(w) + v:cross(nu), omega:cross(nu)))
  end
  function kit.dexp(xi, eta)
    local P, Q = blocks(xi)
    local w, nu = parts(eta)
    return core.vector(sequence(P * w + Q * nu, P * nu))
  end
  function kit.dexpinv(xi, eta)
    local _, Q = blocks(xi)
    local _, omega = parts(xi)
    local w, nu = parts(eta)
    local back = so3.dexpinv(omega)
    local turned = back * nu
    return core.vector(sequence(back * (w - Q * turned), turned))
  end
  kit.body = { pose = function(g) return rotation(g, 3), shift(g, 3) end, turning = 3, moving = 0 }
  matrices.complete(kit, 4)
  local function part(first, last)
    return function(g, mu) return kit.coAd(g, mu):slice(first, last) end
  end
  kit.momenta = { ["R^3"] = part(1, 3), ["SO(3)"] = part(4, 6), ["SO(2)"] = part(6, 6) }
  return kit
end

function M.kit(n)
  if n == 3 then return three() end
  local turns = rotations.kit(n)
  local kit = common(n, turns)
  if turns.arcs then
    function kit.arcs(xi) return turns.arcs(lists.part(xi, n, turns.dimension)) end
  end
  function kit.log(g)
    local omega = turns.log(rotation(g, n))
    return core.vector(sequence(matrix_functions.phi(turns.hat(omega)):solve(shift(g, n)), omega))
  end
  return matrices.complete(kit, n + 1)
end

return M
