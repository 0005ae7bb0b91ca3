-- Is it a symmetry? In any units: what breaks it is compared with L and forces, not with 1.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, abs = dm.sin, dm.cos, math.abs

local function turn(t, q)
  return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2] }
end

for _, E in ipairs { 1, 1e-12, 1e-20, 1e20 } do
  local function rotor(q, v) return E * ((v[1] ^ 2 * (1 + q[2] ^ 2) + v[2] ^ 2) / 2 - q[2] ^ 2 / 2) end
  local function system(more, n)
    local given = { Q = dm.R(n or 2), L = function(q, v)
      return rotor(q, v) + (n == 3 and E * v[3] ^ 2 / 2 or 0)
    end }
    for key, value in pairs(more) do given[key] = value end
    return given
  end
  local function refused(words, given, how)
    how = how or { cyclic = "q1" }
    how.mu = E / 2
    raises(words, function() dm.system(given):routh(how) end)
  end
  refused("L is not invariant under translations of 'q1'", { Q = dm.R(2), L = function(q, v)
    return rotor(q, v) - E * sin(q[1]) / 2
  end })
  refused("L is not invariant under the action", { Q = dm.R(2), L = function(q, v)
    return E * (v:dot(v) / 2 - q:dot(q) / 2 - 0.3 * q[1])
  end }, { action = turn, section = function(x) return { x[1], 0 } end })
  refused("the force has a component along the group", system { force = function(_, v)
    return { -0.1 * E * v[1], 0 }
  end })
  refused("the force is not invariant", system { force = function(q, v)
    return { 0, -0.1 * E * v[2] * (1 + sin(q[1])) }
  end })
  refused("the constraint is not invariant", system({ constraint = function(q)
    return E * (q[3] - q[2] ^ 2 - 0.3 * sin(q[1]))
  end }, 3))

  local shape = dm.system(system {}):routh { cyclic = "q1", mu = E / 2 }
  local function Ld(more, slope)
    local given = { Q = dm.R(2), h = 0.1, Ld = function(a, b, h)
      return h * rotor((a + b) / 2, (b - a) / h) + h * E * (slope or 0) * sin((a[1] + b[1]) / 2)
    end }
    for key, value in pairs(more) do given[key] = value end
    return dm.discrete_lagrangian(given)
  end
  raises("this Ld is not invariant", function() shape:discrete(Ld({}, 1e-4)) end)
  raises("along the group: it pushes 'q1'", function()
    shape:discrete(Ld { force = function(a, b) return { 0.1 * E * (a - b), 0 * b } end })
  end)
  raises("F1 of this Ld is not invariant: entry 2", function()
    shape:discrete(Ld { force = function(a) return { { 0, 0.1 * E * sin(a[1]) }, { 0, 0 } } end })
  end)
  ok(shape:discrete(Ld { force = function(a, b)
    local f = -0.1 * E * (b[2] - a[2])
    return { { 0, f }, { 0, f } }
  end }), ("friction of the shape, L of size %g"):format(E))

  -- a constraint of Ld beside that of its system, in units of its own
  local function bowl(c) return function(q) return E * (q[3] - (q[1] ^ 2 + q[2] ^ 2) / c) end end
  local bead = dm.system { Q = dm.R(3), constraint = bowl(2),
    L = function(q, v) return E * (v:dot(v) / 2 - q[3]) end }
  raises("the constraint of this Ld is not that of its system", function()
    bead:routh({ mu = 0.3 * E, section = function(x) return { x[1], 0, x[2] } end,
      action = function(t, q) local x = turn(t, q) return { x[1], x[2], q[3] } end })
      :discrete(dm.discrete_lagrangian { Q = dm.R(3), h = 0.1, constraint = bowl(2.2),
        Ld = function(a, b, h) return h * bead.L((a + b) / 2, (b - a) / h, 0) end })
  end)

  -- rolling: multipliers are of the size of L
  local function blade(q, v) return rotor(q, v) + E * (v[3] ^ 2 - q[3] ^ 2) / 2 end
  local Lb = dm.discrete_lagrangian { Q = dm.R(3), h = 0.1,
    Ld = function(a, b, h) return h * blade((a + b) / 2, (b - a) / h) end,
    rolling = function(a, b, h) return (b[3] - a[3] - (a[2] + b[2]) / 2 * (b[2] - a[2])) / h end,
    reaction = function(a) return { { 0, -a[2], 1 } } end }
  local cart, q, v = dm.system { Q = dm.R(3), L = blade }, { 0.2, 0.7, 0.1 }, { 0.8, 0.3, 0.21 }
  local round = cart:routh { cyclic = "q1", q = q, v = v }
  local x, u, theta = round:start(q, v)
  local full = Lb:solver {}:run { q = q, p = cart:momentum(q, v), steps = 100 }
  local back = round:discrete(Lb):solver {}:run { q = x, p = round:momentum(x, u), steps = 100 }
    :reconstruct { theta = theta }
  ok((back.q[101] - full.q[101]):norm() < 1e-12 and (full.q[101] - full.q[1]):norm() > 0.1,
    ("rolling, L of size %g"):format(E), (back.q[101] - full.q[101]):norm())

  -- groups
  local G = dm.SO(3)
  local function top(g, xi) return E * ((xi[1] ^ 2 + 2 * xi[2] ^ 2 + 3 * xi[3] ^ 2) / 2 - 0.3 * g[3][3]) end
  local heavy = dm.system { Q = G, L = top }
  raises("L is not invariant under SO(3)", function() heavy:reduce { group = G, rule = "lie(1)", h = 0.1 } end)
  raises("L is not invariant", function() dm.euler_poincare(heavy) end)
  raises("L is not invariant under SO(3)", function()
    dm.system({ Q = dm.product(G, dm.R(1)), L = function(q, v)
      return top(q[1], v) + E * (v[4] ^ 2 - q[2][1] ^ 2) / 2
    end }):routh { group = G, mu = { 0, 0, 4 * E } }
  end)
  local spin = dm.action { group = dm.SO(2), on = dm.R(2) }
  ok(not spin:invariant(function(q) return E * (q:dot(q) + 0.1 * q[1]) end)
    and spin:invariant(function(q) return E * q:dot(q) end), "functions under an action")
  local up = dm.action { group = dm.R(1), on = dm.R(1) }
  local function pulled(c)
    return dm.system { Q = dm.R(1), L = function(q, v) return E * (v[1] ^ 2 / 2 - q[1] - c * q[1] ^ 2) end }
  end
  local fine, _, found = up:invariant(pulled(0))
  ok(not fine and found.divergence and abs(found.divergence({ 0 }, 2) + 2 * E) < 1e-12 * E,
    "a divergence of the size of L")
  ok(not select(3, up:invariant(pulled(1e-3))), "no symmetry up to one")
end
tap.done()
