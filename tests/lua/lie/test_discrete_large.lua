-- discrete Lagrangians of lie(3) on larger groups: the graph is that of L at one point, whatever
-- the number of points; their momenta, two-forms
local tap = require "tap"
local dm = require "dm"
local near, ok = tap.near, tap.ok

local function unit(d, k, size)
  local e = dm.zeros(d)
  e[k] = size
  return e
end

local function try(G, rule, far)
  local d, name = G.dimension, tostring(G) .. ", " .. rule .. ": "
  local system = dm.system { Q = G, L = function(g, xi)
    local T = 0.1 * xi[1] * xi[2]
    for i = 1, d do T = T + (1 + 0.1 * i) * xi[i] ^ 2 / 2 end
    return T - 0.3 * g[1][2] * g[2][1]
  end }
  local v = {}
  for i = 1, d do v[i] = 0.2 + 0.01 * i * (-1) ^ i end
  local path = system:solver { rule = rule, h = 0.1 }:run { q = G:identity(), v = v, steps = 1 }
  local Ld = dm.discrete_lagrangian(system, { rule = rule, h = 0.1 })
  local q0, q1 = path.q[1], path.q[2]
  near((Ld:legendre_minus(q0, q1) - path.p[1]):norm(), 0, 1e-14, name .. "-D1 Ld is p0")
  near((Ld:legendre_plus(q0, q1) - path.p[2]):norm(), 0, 1e-14, name .. "D2 Ld is p1")
  if not far then return end
  local Omega, worst, along = Ld:two_form(q0, q1), 0, 0
  for b = 1, d, 3 do
    local right, left = q1 * G:exp(unit(d, b, 1e-5)), q1 * G:exp(unit(d, b, -1e-5))
    local change = (Ld:legendre_minus(q0, right) - Ld:legendre_minus(q0, left)) * (1 / 2e-5)
    for a = 1, d do worst = math.max(worst, math.abs(change[a] - Omega[a][b])) end
    along = math.max(along, math.abs((Ld(q0, right) - Ld(q0, left)) / 2e-5 - path.p[2][b]))
  end
  ok(worst < 1e-8, name .. "the two-form is the derivative of p0 by g1", worst)
  ok(along < 1e-9, name .. "the value has p1 for a derivative", along)
end

try(dm.SL(3), "lie(3)", true)
try(dm.SO(4), "lie(3)", true)
try(dm.SO(5), "lie(3, gauss(3), cayley)", true)
try(dm.SL(4), "lie(3)")
try(dm.GL(3), "lie(3, lobatto(4))")

tap.done()
