-- groups that stretch, as boosts: far along them points lose the digits that tell invariants, which
-- is no reason to refuse a symmetry; what is none is still refused
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local cosh, sinh = dm.cosh, dm.sinh

local function boost(t, q)
  return { cosh(t) * q[1] + sinh(t) * q[2], sinh(t) * q[1] + cosh(t) * q[2], q[3] }
end
local function square(q) return q[1] ^ 2 - q[2] ^ 2 end
local function L(q, v)
  local r = square(q)
  return (v[1] ^ 2 - v[2] ^ 2 + v[3] ^ 2) / 2 - r / 2 - 0.3 / r ^ 2 - q[3] ^ 2 / 2 - 0.1 * r * q[3]
end
local q, v, h = { 1.2, 0.3, 0.4 }, { -0.1, 0.3, 0.2 }, 0.02
local how = { action = boost, section = function(x) return { x[1], 0, x[2] } end, q = q, v = v }
local system = dm.system { Q = dm.R(3), L = L }
local fine, shape = pcall(system.routh, system, how)
ok(fine, "L of boosts is reduced, also where it has 1/r^2 and far points have no r left", shape)

-- F = -c (r(q1) - r(q0)) dr / 2 at either end
local function drag(a, b)
  local rate = -0.05 * (square(b) - square(a))
  return { { rate * a[1], -rate * a[2], 0 }, { rate * b[1], -rate * b[2], 0 } }
end
local function formula(f, force)
  return dm.discrete_lagrangian { Q = dm.R(3), h = h, force = force,
    Ld = function(a, b) return h * f((a + b) / 2, (b - a) / h) end }
end
for name, force in pairs { ["no force"] = false, drag = drag } do
  local Ld = formula(L, force or nil)
  local taken, D = pcall(shape.discrete, shape, Ld)
  ok(taken, "its Ld is, with " .. name, D)
  local x, u, theta = shape:start(q, v)
  local path = D:solver {}:run { q = x, p = shape:momentum(x, u), steps = 300 }
  local back = path:reconstruct { theta = theta }
  local full = Ld:solver {}:run { q = q, p = system:momentum(q, v), steps = 300 }
  local off = (back.q[301] - full.q[301]):norm() / full.q[301]:norm()
  ok(off < 1e-10, "and its steps are the unreduced ones", off)
end
for _, size in ipairs { 1e-6, 1e-3 } do
  for name, f in pairs { q1 = function(z) return z[1] end, wall = function(z) return dm.max(0, z[2] - 3) end } do
    local function wrong(z, w) return L(z, w) + size * f(z) end
    local other = dm.system { Q = dm.R(3), L = wrong }
    raises("L is not invariant", other.routh, other, how)
    raises("this Ld is not invariant", shape.discrete, shape, formula(wrong))
    raises("is not invariant", shape.discrete, shape, formula(L, function(a, b)
      local F = drag(a, b)
      F[1][3] = size * f(a)
      return F
    end))
  end
end
-- rules far along the group: their equations may have a root at a point and none a last bit beside
-- it, and psi_mu at made-up points is as large as 17, where squares cancel
local function plane(c)
  return dm.system { Q = dm.R(2), L = function(z, w)
    local r = z[1] ^ 2 - z[2] ^ 2
    return (w[1] ^ 2 - w[2] ^ 2) / 2 - 0.4 * r - c * r ^ 2 / 8
  end }
end
local function turned(t, z)
  return { cosh(t) * z[1] + sinh(t) * z[2], sinh(t) * z[1] + cosh(t) * z[2] }
end
local refused = {}
local function try(c, k, rule)
  local s, z, w = plane(c), { 1 + k / 30, 0.04 * k - 0.3 }, { 0.04 * k - 0.25, 0.1 + k / 50 }
  local one = s:routh { action = turned, section = function(x) return { x[1], 0 } end, q = z, v = w }
  local taken, why = pcall(one.discrete, one, dm.discrete_lagrangian(s, { rule = rule, h = 0.05 }))
  if not taken then refused[#refused + 1] = ("%s %d: %s"):format(rule, k, why) end
end
for k = 1, 12 do
  for _, rule in ipairs { "gauss(2)", "lobatto(3)" } do try(0.4, k, rule) end
end
try(0.3, 15, "trapezoidal")
ok(#refused == 0, "rules are reduced from every start", table.concat(refused, "\n"))
-- a domain that the group leaves is none of its symmetry
local edge = dm.system { Q = dm.R(2), L = function(z, w) return w:dot(w) / 2 + (4 - z[1]) ^ 0.5 end }
raises("L is not invariant", edge.routh, edge, { cyclic = { 1 }, mu = 1 })
tap.done()
