--- Objects of every class, small ones: what methods are called on, and arguments of functions.
local dm = require "dm"
local core = require "dm.core"

local M = {}

local list = {} -- what was made

-- what the function makes stands in the list, unless it raises
local function add(make)
  local fine, object = pcall(make)
  if not fine then list.failed[#list.failed + 1] = tostring(object) end
  if fine and object ~= nil then list[#list + 1] = object end
  return fine and object or nil
end

local function oscillator(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end

local function values()
  add(function() return dm.vector { 1, 2, 3 } end)
  add(function() return dm.vector { 1, 0 } end)
  add(function() return dm.zeros(0) end)
  add(function() return dm.matrix { { 1, 2 }, { 3, 4 } } end)
  add(function() return dm.matrix { { 1, 2 }, { 2, 4 } } end)
  add(function() return dm.identity(3) end)
  add(function() return dm.random(3) end)
  add(function() return dm.hyperdual(1, 1, 0, 0) end)
  add(function() return dm.trace(function(x) return x[1] * x[2] end, 2) end)
  add(function()
    return dm.derivative(function(x)
      return dm.where(x[1], x[1] ^ 2, x[2]) * math.exp(x[2])
    end, 2)
  end)
  add(function()
    return dm.root { equations = function(y, x) return y[1] ^ 3 - x[1] end, start = { 1 },
      unknowns = 1 }
  end)
  local stale, stale_vector -- symbols that outlived their trace
  pcall(function() dm.derivative(function(x) stale = x[1]; return x[1] end, 1) { 1 } end)
  pcall(function() dm.derivative(function(x) stale_vector = x; return x[1] end, 2) { 1, 2 } end)
  add(function() return stale end)
  add(function() return stale_vector end)
  add(function() return io.stderr end)
  add(function() return coroutine.create(error) end)
end

local function spaces()
  for _, name in ipairs { "R", "T", "S", "SO", "SE", "SL", "GL" } do
    for n = name:find "^S[OEL]" and 2 or 1, 3 do add(function() return dm[name](n) end) end
  end
  add(function() return dm.Sp(2) end)
  add(function() return dm.Heisenberg(1) end)
  add(function() return dm.product(dm.SO(3), dm.R(2)) end)
  add(function() return dm.semidirect(dm.SO(2), dm.R(2)) end)
  add(function() return dm.R(1) end)
  add(function() return dm.SO(4) end)
end

local function lagrangians()
  local kepler = add(function()
    return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  end)
  add(function()
    return dm.system { Q = dm.T(1), L = function(q, v) return v:dot(v) / 2 + math.cos(q[1]) end }
  end)
  add(function()
    return dm.system { Q = dm.R(1), L = function(q, v)
      return v[1] ^ 2 * (2 + q[1] ^ 2) - q[1] ^ 4
    end }
  end)
  add(function()
    return dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v)
      return v[1] ^ 2 / 2 - (q[1] > 0 and q[1] ^ 2 or q[1] ^ 4)
    end }
  end)
  add(function()
    return dm.system { Q = dm.R(1), params = { k = 2 }, L = function(q, v, _, p)
      return v[1] ^ 2 / 2 - p.k * q[1] ^ 2
    end }
  end)
  local tied = add(function()
    return dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end,
      constraint = function(q) return q:dot(q) - 1 end }
  end)
  local rolls = add(function()
    return dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end,
      rolling = function(q, v) return v[3] - q[2] * v[1] end }
  end)
  local damped = add(function()
    return dm.system { Q = dm.R(1), L = oscillator,
      force = function(_, v, _, u) return { u[1] - v[1] } end,
      control = function(q) return { -q[1] } end }
  end)
  local saddle = add(function()
    return dm.system { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 / 2 - q[2] end,
      constraint = function(q) return q[2] - q[1] ^ 2 / 2 end }
  end)
  local fast = add(function()
    return dm.system { Q = dm.R(1), L = function(q, v) return -(1 - v[1] ^ 2) ^ 0.5 - q[1] ^ 2 end }
  end)
  add(function() return tied:solver { rule = "rattle", h = 0.05 } end)
  add(function() return tied:solver { rule = "lobatto(3)", h = 0.05 } end)
  add(function() return rolls:solver { rule = "gauss(2)", h = 0.05 } end)
  add(function() return damped:solver { rule = "midpoint", h = 0.05 } end)
  add(function() return saddle:solver { rule = "rattle", h = 0.1 } end)
  add(function() return fast:solver { rule = "verlet", h = 0.1 } end)
  return kepler
end

local function hamiltonians()
  local H = add(function()
    return dm.system { Q = dm.R(1), H = function(q, p) return p[1] ^ 2 / 2 + q[1] ^ 4 / 4 end }
  end)
  add(function() return H:solver { rule = "gauss(2)", h = 0.1 } end)
  local driven = add(function()
    return dm.system { Q = dm.R(1), H = function(q, p, t)
      return p[1] ^ 2 / 2 + q[1] ^ 2 * (1 + 0.1 * math.cos(t))
    end }
  end)
  add(function() return driven:solver { rule = "midpoint", h = 0.1 } end)
  add(function() return H:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, p = { 0 },
    steps = 5 } end)
end

local function groups()
  local G = dm.SO(3)
  local top = add(function()
    return dm.system { Q = G, L = function(R, W)
      return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3]
    end }
  end)
  local at = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, steps = 5 }
  for _, rule in ipairs { "lie(1)", "lie(2)", "lie(1, cayley)" } do
    local s = add(function() return top:solver { rule = rule, h = 0.1 } end)
    add(function() return s:run(at) end)
  end
  local free = add(function()
    return dm.euler_poincare { group = G, l = function(W)
      return (W[1] ^ 2 + 2 * W[2] ^ 2 + 3 * W[3] ^ 2) / 2
    end }
  end)
  local s = add(function() return free:solver { rule = "lie(1)", h = 0.1 } end)
  add(function() return s:run { v = { 1, 2, 3 }, steps = 5 } end)
  local carried = add(function()
    return dm.euler_poincare { group = G, advected = dm.action { group = G, on = dm.R(3) },
      l = function(W, a) return W:dot(W) / 2 - a[3] end }
  end)
  add(function() return carried:solver { rule = "lie(2)", h = 0.1 } end)
  add(function()
    return dm.step { unknowns = 1, order = 1, start = function(y) return { y.p[1] } end,
      equation = function(y, x, h) return { x[1] - y.p[1] + h * y.q[1] } end,
      next = function(y, x, h) return { q = { y.q[1] + h * x[1] }, p = { x[1] } } end }
  end)
  add(function()
    return dm.system { Q = dm.SE(2), L = function(_, W) return W:dot(W) / 2 end }
  end)
end

local function rules(kepler)
  for _, rule in ipairs { "verlet", "gauss(2)", "lobatto(3)", "yoshida(4)", "rk4" } do
    add(function() return kepler:solver { rule = rule, h = 0.1 } end)
  end
  add(function() return dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 },
    weights = { 1 / 6, 2 / 3, 1 / 6 } } end)
  add(function() return dm.sprk { a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 } } end)
  add(function() return dm.curve "rk4" end)
  add(function() return dm.bundle { system = kepler, h = 0.1, segments = "rk4" } end)
  add(function() return dm.bundle { Q = dm.R(1), h = 0.1 } end)
  add(function() return dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 }) end)
  add(function() return dm.discrete_lagrangian(kepler, { rule = "gauss(2)", h = 0.1 }) end)
  local own = add(function()
    return dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(q0, q1, h)
      return (q1[1] - q0[1]) ^ 2 / (2 * h) - h * (q0[1] + q1[1]) ^ 2 / 8
    end }
  end)
  add(function() return dm.solver { own } end)
  add(function()
    return dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
      Ld = function(q0, q1, h) return (q1[1] - q0[1]) ^ 2 / (2 * h) end,
      force = function(q0, q1, h) return { -h * q0[1], -h * q1[1] } end }
  end)
end

local function runs(kepler)
  local s = kepler:solver { rule = "verlet", h = 0.05 }
  add(function() return s:run { q = { 1, 0 }, v = { 0, 1 }, steps = 20 } end)
  add(function() return s:run({ q = { 1, 0 }, v = { 0, 1 }, steps = 3 }).q end)
  add(function()
    return s:run { q = { 1, 0 }, v = { 0, 1 }, steps = 40,
      events = { apsis = function(q, v) return q:dot(v) end } }
  end)
  add(function()
    return s:section { q = { 1, 0 }, v = { 0, 1.1 }, g = function(q) return q[2] end, t = 30,
      x = "q1", y = "p1" }
  end)
  add(function()
    return s:ensemble { members = 3, q = function(i) return { i, 0 } end,
      v = function() return { 0, 1 } end, steps = 10 }
  end)
  add(function()
    return dm.chart { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" },
      h = { 0.1, 0.05 }, repeats = 1 }
  end)
  add(function()
    return dm.stability { system = kepler, rule = "midpoint", q = { 1, 0 }, v = { 0, 1 },
      steps = 50, h = { 0.1, 1, 3 } }
  end)
  add(function()
    return dm.scene { kepler, q = { 1, 0 }, v = { 0, 1 }, watch = { "q1" }, tolerance = 1e-2,
      until_t = 1, seconds = 1 }
  end)
  add(function()
    return dm.scaling { system = kepler, start = function() return { 1, 0 }, { 0, 1 } end,
      members = { 1, 2 }, rules = { "verlet" }, h = 0.1, steps = 3, repeats = 1 }
  end)
  local stiff = add(function()
    return dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.exp(q[1]) end }
  end)
  local _, failure = pcall(function()
    stiff:solver { rule = "midpoint", h = 2 }:run { q = { 0 }, v = { 0 }, steps = 1000 }
  end)
  add(function() return failure end)
end

local function reduced()
  local planet = add(function()
    return dm.system { Q = dm.R(2), L = function(q, v)
      return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2]
    end }
  end)
  local shape = add(function() return planet:routh { cyclic = 1, mu = 1 } end)
  local s = add(function() return shape:solver { rule = "gauss(2)", h = 0.1 } end)
  add(function() return s:run { q = 1, v = 0.1, steps = 20 } end)
  add(function() return shape:discrete { rule = "gauss(2)", h = 0.1 } end)
  local at_rest = add(function()
    return shape:relative_equilibria { region = { 0.5, 2 }, starts = 5 }[1]
  end)
  add(function() return shape:continue(at_rest, { mu = { 0.5, 1.5 }, step = 0.2 }) end)
end

local function frames()
  local shift = add(function()
    return dm.action { group = dm.R(1), on = dm.R(2),
      map = function(g, z) return { z[1] + g[1], z[2] } end }
  end)
  local turn = add(function() return dm.action { group = dm.SO(2), on = dm.R(2) } end)
  add(function()
    return dm.moving_frame { action = shift, cross_section = function(z) return z[1] end }
  end)
  add(function()
    return dm.moving_frame { action = turn, cross_section = function(z) return z[2] end,
      branch = function(z) return z[1] end }
  end)
  local pairs_of = add(function()
    return dm.moving_frame { action = shift, points = 2,
      cross_section = function(a) return a[1] end }
  end)
  local problem = add(function()
    return dm.invariant_problem { frame = pairs_of, points = 2,
      L = function(I) return ((I[2][1]) ^ 2 + (I[2][2] - I[1][2]) ^ 2) / 2 end }
  end)
  add(function() return problem:solve { points = { { 0, 0 }, { 1, 0.5 } }, n = 5 } end)
end

-- forms, chains, fields, operators and cones of a mesh
local function on_mesh(K, n)
  local f = add(function() return K:form(0, function(...) return 1 + (...) ^ 2 end) end)
  for k = 0, n do
    add(function() return K:form(k, K:volume(k)) end)
    add(function() return K:chain(k, { { 2, K:simplices(k)[1] } }) end)
    add(function() return K:form(k, K:volume(k)):star() end)
  end
  add(function() return f:d() end)
  add(function() return K:d(0) end)
  add(function() return K:star(1) end)
  add(function() return K:laplacian(0) end)
  add(function() return K:laplace_beltrami() end)
  add(function() return K:incidence(1) end)
  add(function() return K:laplacian(0).matrix end)
  add(function() return K:laplacian(0).matrix:factor "lu" end)
  add(function() return K:vector_field(function(x, y, z) return { y, x, z } end) end)
  add(function() return K:vector_field(function(...) return { ... } end, { on = "cells" }) end)
  add(function() return f:grad() end)
  add(function() return core.matching(K) end)
  add(function() return K:cone {} end)
  add(function()
    local same = {}
    for i = 1, K:count(0) do same[i] = i end
    return dm.simplicial_map(K, K, same)
  end)
end

local function meshes()
  for _, given in ipairs { { grid = 2 }, { square_torus = 4 }, { icosphere = 0 },
    { named = "rp2" }, { annulus = { 1, 4 }, ratio = 1.5 }, { simplex_boundary = 4 },
    { cross_polytope = 4 }, { shells = { 3, 1 } }, { cube_tiling = 1 }, { klein = 3 },
    { simplices = { { 1, 2 }, { 2, 3 }, { 1, 3 }, { 4 } } },
    { points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1.1, 1.2 } } } } do
    add(function() return dm.mesh(given) end)
  end
  on_mesh(dm.mesh { grid = 2 }, 2)
  on_mesh(dm.mesh { simplices = { { 1, 2, 3, 4 } }, points = { { 0, 0, 0 }, { 1, 0, 0 },
    { 0, 1, 0 }, { 0, 0, 1 } } }, 3)
end

--- The list of what can be made, the same every time; list.failed says what could not.
function M.list()
  list = { failed = {} }
  values()
  spaces()
  local kepler = lagrangians()
  hamiltonians()
  groups()
  rules(kepler)
  runs(kepler)
  reduced()
  frames()
  meshes()
  return list
end

return M
