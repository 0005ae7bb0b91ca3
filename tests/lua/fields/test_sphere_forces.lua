-- RATTLE of fields of unit vectors with forces beside L: its order, and that of its compositions, on a nonlinear wave
-- map, against Runge's and Kutta's method on q'' = F - (F.q) q - |q'|^2 q, written here in plain Lua
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin, cos, pi = math.sin, math.cos, math.pi

local N, T = 12, 0.8
local ring, around = {}, {}
for i = 1, N do ring[i], around[i] = { i, i % N + 1 }, { cos(2 * pi * i / N), sin(2 * pi * i / N) } end
local K = dm.mesh { simplices = ring, points = around }
local width = 2 * sin(pi / N)
local function L(u, v)
  return v:dot(v) / 2 - u:d():dot(u:d()) / 2 + u:map(function(a) return { 0.3 * a[1] ^ 2, 0, -0.5 * a[3] } end):dot(u)
end

-- the force on one value, of a and v, and the same as a form
local forces = {
  drag = { function(_, v) local s = v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2 return { -s * v[1], -s * v[2], -s * v[3] } end,
    function(_, V) return V:map(function(v) return { -v:dot(v) * v[1], -v:dot(v) * v[2], -v:dot(v) * v[3] } end) end },
  both = { function(a, v, t) return { a[2] * cos(t) - 0.7 * v[1], a[3] * a[1] - 0.7 * v[2], 0.4 * sin(3 * t) - 0.7 * v[3] } end,
    function(A, V, t) return A:map(function(a) return { a[2] * cos(t), a[3] * a[1], 0.4 * sin(3 * t) } end) - 0.7 * V end },
  place = { function(a, _, t) return { a[2] * cos(t), a[3] * a[1], 0.4 * sin(3 * t) } end,
    function(A, _, t) return A:map(function(a) return { a[2] * cos(t), a[3] * a[1], 0.4 * sin(3 * t) } end) end },
}

local function accelerations(q, v, t, force)
  local out = {}
  for i = 1, N do
    local a, left, right, f = q[i], q[(i - 2) % N + 1], q[i % N + 1], force(q[i], v[i], t)
    local F, along, speed = {}, 0, 0
    for c = 1, 3 do F[c] = (left[c] + right[c] - 2 * a[c]) / width ^ 2 + f[c] end
    F[1], F[3] = F[1] + 0.9 * a[1] ^ 2, F[3] - a[3]
    for c = 1, 3 do along, speed = along + F[c] * a[c], speed + v[i][c] ^ 2 end
    for c = 1, 3 do F[c] = F[c] - (along + speed) * a[c] end
    out[i] = F
  end
  return out
end

local function added(x, h, y)
  local out = {}
  for i = 1, N do
    out[i] = {}
    for c = 1, 3 do out[i][c] = x[i][c] + h * y[i][c] end
  end
  return out
end

-- the classical method, written out
local function runge_kutta(q, v, force, steps)
  local h = T / steps
  for k = 0, steps - 1 do
    local t = k * h
    local a1 = accelerations(q, v, t, force)
    local v2 = added(v, h / 2, a1)
    local a2 = accelerations(added(q, h / 2, v), v2, t + h / 2, force)
    local v3 = added(v, h / 2, a2)
    local a3 = accelerations(added(q, h / 2, v2), v3, t + h / 2, force)
    local v4 = added(v, h, a3)
    local a4 = accelerations(added(q, h, v3), v4, t + h, force)
    q = added(added(added(added(q, h / 6, v), h / 3, v2), h / 3, v3), h / 6, v4)
    v = added(added(added(added(v, h / 6, a1), h / 3, a2), h / 3, a3), h / 6, a4)
  end
  local flat = {}
  for i = 1, N do for c = 1, 3 do flat[#flat + 1] = q[i][c] end end
  return dm.vector(flat)
end

local q, v = {}, {}
for i = 1, N do
  local a, b = 0.5 * sin(i), 0.6 * i
  q[i], v[i] = { cos(a) * cos(b), cos(a) * sin(b), sin(a) }, { -sin(b) * cos(i), cos(b) * cos(i), 0 }
end

for name, force in pairs(forces) do
  local field = K:field { values = 3, on = dm.S(2), L = L, force = force[2] }
  local exact = runge_kutta(q, v, force[1], 800)
  for rule, order in pairs { rattle = 2, ["suzuki(4, rattle)"] = 4, ["yoshida(4, rattle)"] = 4 } do
    local function off(steps)
      local run = field:solver { rule = rule, h = T / steps }:run { q = q, v = v, steps = steps, every = steps }
      return (run.q[2] - exact):norm()
    end
    local rough, fine = off(20), off(40)
    local found = math.log(rough / fine) / math.log(2)
    ok(math.abs(found - order) < 0.05 and fine < 1e-3, ("%s: order of %s"):format(name, rule), found)
  end
end

-- members that start from lists in tables are moved to the sphere as runs are, each v beside its q
local chain = K:field { values = 3, on = dm.S(2), L = L }:solver { rule = "rattle", h = 0.01 }
local function flat(rows, times)
  local out = {}
  for i = 1, N do for c = 1, 3 do out[#out + 1] = times * rows[i][c] end end
  return out
end
local turned, rates = {}, {}
for i = 1, N do turned[i], rates[i] = { -q[i][2], q[i][1], q[i][3] }, { -v[i][2], v[i][1], v[i][3] } end
local starts, speeds = { flat(q, 1 + 1e-9), flat(turned, 1 - 1e-9) }, { flat(v, 1), flat(rates, 1) }
for kind, s in pairs { tables = { starts, speeds }, matrices = { dm.matrix(starts), dm.matrix(speeds) } } do
  local cloud = chain:ensemble { members = 2, steps = 5, q = s[1], v = s[2] }
  for i = 1, 2 do
    local run = chain:run { q = starts[i], v = speeds[i], steps = 5, every = 5 }
    ok(cloud.q[i] == run.q[2] and cloud.p[i] == run.p[2], ("member %d from %s is its run"):format(i, kind))
  end
end
tap.done()
