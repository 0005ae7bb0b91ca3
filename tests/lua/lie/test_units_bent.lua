-- the unit of mass changes nothing where the inertia depends on xi, whatever it is at rest
local tap = require "tap"
local dm = require "dm"

local G = dm.SO(3)
local function square(w) return w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2 end
local start = { q = G:exp { 0.4, 0, 0 }, v = { 0.2, 0.1, 1.5 } }
local function finish(kinetic, c, rule, h, steps)
  local system = dm.system { Q = G, L = function(g, w)
    return c * (kinetic(square(w)) - g[3][3])
  end }
  local path = system:solver { rule = rule, h = h }
    :run { q = start.q, v = start.v, steps = steps, every = steps }
  return path.q[2]
end

local kinetics = {
  { "finite at rest", function(k) return k / 2 + k ^ 2 / 8 end },
  { "relativistic", function(k) return -4 * (1 - k / 4) ^ 0.5 end },
  { "zero at rest", function(k) return k ^ 2 / 4 end },
  { "infinite at rest", function(k) return k ^ 0.75 end },
}
for _, row in ipairs(kinetics) do
  local name, kinetic = row[1], row[2]
  local exact = finish(kinetic, 1, "lie(3)", 0.02, 100)  -- an intrinsic rule, without that mass
  for _, rule in ipairs { "verlet", "lobatto(3)", "gauss(2)", "galerkin(2, gauss(3))" } do
    local one = finish(kinetic, 1, rule, 0.1, 20)
    local half = finish(kinetic, 1, rule, 0.05, 40)
    local order = math.log(G:distance(one, exact) / G:distance(half, exact), 2)
    tap.near(order, rule == "verlet" and 2 or 4, 0.15, ("%s, %s: order"):format(name, rule))
    for _, c in ipairs { 1e-3, 1e3, 1e8 } do
      tap.near(G:distance(finish(kinetic, c, rule, 0.1, 20), one), 0, 1e-11,
        ("%s, %s: masses of %g"):format(name, rule, c))
    end
  end
end

-- the same where the inertia also depends on the place, on SL(2)
local SL = dm.SL(2)
local function of_sl(c, rule)
  local system = dm.system { Q = SL, L = function(g, w)
    local k = w[1] ^ 2 + 1.3 * w[2] ^ 2 + 0.8 * w[3] ^ 2
    return c * ((1 + 0.1 * g[1][1] ^ 2) * (k / 2 + k ^ 2 / 8) - g[1][2] ^ 2)
  end }
  local path = system:solver { rule = rule, h = 0.05 }
    :run { q = SL:identity(), v = { 0.2, 0.3, -0.1 }, steps = 20, every = 20 }
  return path.q[2]
end
for _, rule in ipairs { "verlet", "lobatto(3)" } do
  local one = of_sl(1, rule)
  for _, c in ipairs { 1e-3, 1e8 } do
    tap.near(SL:distance(of_sl(c, rule), one), 0, 1e-11,
      ("SL(2), %s: masses of %g"):format(rule, c))
  end
end

-- starts that are no elements say why; project = true does not start at another one of them
local function start_of(Q, q, project)
  local system = dm.system { Q = Q, L = function(_, w) return w:dot(w) / 2 end }
  local v = {}
  for i = 1, Q.dimension do v[i] = 0.1 end
  return system:solver { rule = "lie(1)", h = 0.1 }
    :run { q = q, v = v, project = project, steps = 1 }
end
for _, project in ipairs { false, true } do
  tap.raises("this is no element of GL(2), it is singular", start_of, dm.GL(2),
    { { 1, 2 }, { 2, 4 } }, project)
  tap.raises("its determinant is -1, not 1: no positive multiple", start_of, SL,
    { { -1, 0 }, { 0, 1 } }, project)
  tap.raises("no nearest symplectic matrix was found: several", start_of, dm.Sp(4),
    { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, -1 } }, project)
  tap.raises("no single nearest rotation", start_of, G,
    { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } }, project)
end
tap.raises("project = true starts at the nearest one", start_of, SL, { { 1.1, 0 }, { 0, 1 } })
local near_by = start_of(SL, { { 1.1, 0 }, { 0, 1 } }, true).q[1]
tap.near(near_by[1][1] * near_by[2][2] - near_by[1][2] * near_by[2][1], 1, 1e-15, "and it does")
tap.done()
