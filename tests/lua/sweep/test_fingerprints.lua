-- core.fingerprint: every part of a model that decides a run changes it, and nothing else does
local tap = require "tap"
local core = require "dm.core"
local dm = require "dm"
local ok = tap.ok

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function kinetic(_, v) return v:dot(v) / 2 end
local K, N = dm.mesh { grid = 4 }, 40

local function field(options)
  options.form, options.L = 0, options.L or wave
  return K:field(options)
end

-- a sum over bodies that stays a loop
local function bodies(options, factor)
  options.block = 3
  return dm.system { Q = dm.R(3 * N), L = function(q, v)
    return kinetic(q, v) - dm.sum_over(q, function(a, b)
      return (factor or 1) / (1 + (a - b):dot(a - b))
    end, options)
  end }
end

-- one whose bodies have weights
local function weighted(k)
  local m = {}
  for i = 1, N do m[i] = i == N and k or 1 end
  return dm.system { Q = dm.R(N), L = function(q, v)
    return kinetic(q, v) - dm.sum_over(q, m, function(x, w) return w * x ^ 4 end)
  end }
end

local function of_root(power, start)
  local f = dm.root { equations = function(y, x) return y ^ power + y - x end, start = start }
  return dm.system { Q = dm.R(1), L = function(q, v) return kinetic(q, v) - f(q[1]) end }
end

local function top(options)
  options.Q = options.Q or dm.SO(3)
  options.L = options.L or function(_, xi) return 2 * xi[1] ^ 2 + xi[2] ^ 2 + xi[3] ^ 2 end
  return dm.system(options)
end

-- the plane with motions that turn and stretch: two groups that print alike
local function own_group(stretch)
  return dm.group { name = "mine", basis = { { { stretch, -1 }, { 1, stretch } } } }
end

local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return kinetic(q, v) - q[1] ^ 4 end }

-- two models each, told apart by k = 1 or 2
local MODELS = {
  L = function(k) return dm.system { Q = dm.R(1), L = function(q, v) return kinetic(q, v) - k * q[1] end } end,
  space = function(k) return dm.system { Q = k == 1 and dm.R(1) or dm.T(1), L = kinetic } end,
  force = function(k)
    return dm.system { Q = dm.R(1), L = kinetic, force = function(_, v) return { -k * v[1] } end }
  end,
  constraint = function(k)
    return dm.system { Q = dm.R(2), L = kinetic, constraint = function(q) return q:dot(q) - k end }
  end,
  params = function(k)
    return dm.system { Q = dm.R(1), params = { k = k }, L = function(q, v, _, p) return kinetic(q, v) - p.k * q[1] end }
  end,
  ["equation of a root"] = function(k) return of_root(1 + 2 * k, 1) end,
  ["start of a root"] = function(k) return of_root(3, k) end,
  ["values of hyper-dual numbers"] = function(k)
    return dm.system { Q = dm.R(1), derivatives = "hyperdual",
      L = function(q, v) return kinetic(q, v) - (q[1] > 1.5 and k * q[1] or 0) end }
  end,
  ["pairs of bodies"] = function(k) return bodies({ pairs = true }, k) end,
  ["neighbours of bodies"] = function(k) return bodies { shift = k } end,
  ["a ring of bodies"] = function(k) return bodies { shift = 1, periodic = k == 1 } end,
  ["pairs within a distance"] = function(k) return bodies { pairs = true, within = k } end,
  ["a box of bodies"] = function(k) return bodies { pairs = true, within = 1, box = 3 * k } end,
  ["weights of bodies"] = weighted,
  ["term of a sum over cells"] = function(k)
    return field { L = function(u, v)
      return wave(u, v) - K:sum(0, function(a, cell) return k * cell.star * a ^ 4 end, u)
    end }
  end,
  ["data of a sum over cells"] = function(k)
    local values = {}
    for i = 1, K:count(0) do values[i] = i ^ k end
    local c = K:form(0, values)
    return field { data = { c = c }, L = function(u, v)
      return wave(u, v) - K:sum(0, function(a, cell) return cell.c * a ^ 4 end, u)
    end }
  end,
  ["fixed cells"] = function(k) return field { fixed = k == 1 and "boundary" or { 1, 2 } } end,
  ["absorbing cells"] = function(k) return field { absorbing = k == 1 and "boundary" or nil } end,
  ["force on a field"] = function(k) return field { force = function(_, v) return -k * v end } end,
  ["weights of a mesh"] = function(k)
    local mesh = dm.mesh { simplices = { { 1, 2, 3 }, { 2, 3, 4 } }, points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { k, k } } }
    return mesh:field { form = 0, L = wave }
  end,
  ["inertia on a group"] = function(k)
    return top { L = function(_, xi) return k * xi[1] ^ 2 + xi[2] ^ 2 + xi[3] ^ 2 end }
  end,
  group = function(k) return top { Q = k == 1 and dm.SO(3) or dm.SU(2) } end,
  trivialization = function(k) return top { trivialization = k == 1 and "left" or "right" } end,
  ["a group that prints alike"] = function(k)
    return dm.system { Q = own_group(k / 10), L = function(g, xi) return xi[1] ^ 2 / 2 + g[1][1] end }
  end,
  Ld = function(k)
    return dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h)
      return (b[1] - a[1]) ^ 2 / (2 * h) - k * h * a[1] ^ 2
    end }
  end,
  ["h of a discrete Lagrangian"] = function(k)
    return dm.discrete_lagrangian(oscillator, { rule = "midpoint", h = k / 10 })
  end,
  ["rule of a discrete Lagrangian"] = function(k)
    return dm.discrete_lagrangian(oscillator, { rule = k == 1 and "midpoint" or "gauss(2)", h = 0.1 })
  end,
}

for name, make in pairs(MODELS) do
  local one, two = core.fingerprint(make(1)), core.fingerprint(make(2))
  ok(one ~= two, name .. ": another one has another fingerprint")
  ok(one == core.fingerprint(make(1)), name .. ": made again it has the same")
  ok(one:find "^%x+$" and #one == 16, name .. ": sixteen digits")
end
tap.done()
