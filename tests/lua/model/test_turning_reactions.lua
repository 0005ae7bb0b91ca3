-- reactions that turn with v, beside holonomic constraints: where momenta pass through zero the round-off of q over h is
-- all that is left of the velocities at inner points, and runs go on there
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin, tanh, max, abs = math.sin, dm.tanh, math.max, math.abs
local a, b, c = 0.3, 1.3, 0.4

local function track(x) return (0.3 - c * tanh(x ^ 2 - 1)) / 1.5 end
local system = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[1] * q[3] - q[3] / 10 end,
  constraint = function(q) return q[2] - track(q[3]) end,
  rolling = function(q, v) return b * v[3] + sin(q[1]) * v[1] + a * v[1] ^ 2 end }
local slope = dm.derivative(track)
local bend = dm.derivative(slope)

local function start(k)
  local q, u = { -0.3, 0, 0.2 + 0.01 * k }, -0.4 + 0.04 * k
  local w = -(sin(q[1]) * u + a * u ^ 2) / b
  q[2] = track(q[3])
  return q, { u, slope(q[3]) * w, w }
end
local function run(rule, k, steps)
  local q, v = start(k)
  return system:solver { rule = rule, h = 2 / steps }:run { q = q, v = v, steps = steps, every = steps }
end

-- the same system with w = v3 and v2 eliminated: rk8 of q1, q3 by the multipliers of d'Alembert's principle, which the
-- rules do not use
local function field(x, z, u)
  local s, w = slope(z), -(sin(x) * u + a * u ^ 2) / b
  local curve = bend(z)
  local r1, r3 = sin(x) + 2 * a * u, b                           -- the row of rolling
  -- u' = -z + r1 m; w' = -x - 1/10 + r3 m - s l; s w' + curve w^2 = l; b w' + r1 u' + cos(x) u^2 = 0
  local wide, pull = 1 + s * s, -x - 0.1 - s * curve * w * w      -- (1 + s^2) w' = pull + r3 m
  local m = (r1 * z - b * pull / wide - math.cos(x) * u * u) / (r1 * r1 + b * r3 / wide)
  return u, w, -z + r1 * m
end
local function reference(k)
  local q, v = start(k)
  local y, n = { q[1], q[3], v[1] }, 400
  local h = 2 / n
  local function moved(d, part) return y[1] + part * d[1], y[2] + part * d[2], y[3] + part * d[3] end
  for _ = 1, n do
    local d1 = { field(y[1], y[2], y[3]) }
    local d2 = { field(moved(d1, h / 2)) }
    local d3 = { field(moved(d2, h / 2)) }
    local d4 = { field(moved(d3, h)) }
    for i = 1, 3 do y[i] = y[i] + h / 6 * (d1[i] + 2 * d2[i] + 2 * d3[i] + d4[i]) end
  end
  return y[1], y[2]
end

local off, refused, first = 0, 0, nil
for k = 1, 20 do
  local x, z = reference(k)
  for _, rule in ipairs { "gauss(2)", "gauss(3)" } do
    for _, steps in ipairs { 200, 800 } do
      local fine, path = pcall(run, rule, k, steps)
      if fine then off = max(off, abs(path.q[#path][1] - x), abs(path.q[#path][3] - z))
      else refused, first = refused + 1, first or path end
    end
  end
end
ok(refused == 0, "80 runs over turning points end", ("%d do not: %s"):format(refused, tostring(first)))
ok(off < 3e-9, "and where a Runge-Kutta method of the equations without multipliers does", off)
tap.done()
