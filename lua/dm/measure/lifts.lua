--- Tangent maps of rules that step a group by a lift, which are those of coordinates on R^N, and
-- the lifted systems themselves.
local bound = require "dm.base.bound"
local core = require "dm.core"
local kits = require "dm.group.kit"
local flats = require "dm.group.flat"
local lists = require "dm.base.lists"
local place = require "dm.group.place"
local prolong = require "dm.measure.prolong"
local steps = require "dm.group.step"

local M = {}

-- a change of (q, p) from one (u, dp) of the group, at a state above it, and back; u is that of the
-- trivialization
local function between(own, to, J)
  local N, d = own.size, own.dimension
  local X = flats.directions(own, N, d, own.right)
  local rise, descend = core.derivative(to, N, d), core.derivative(J, N, N)
  local function velocity(q, z)
    local Y = X(q)
    return (Y:transpose() * Y):solve(Y:transpose() * z)
  end
  local function up(q, mu, w)
    local dq = X(q) * lists.part(w, 0, d)
    return lists.joined(dq, rise(q, mu) * lists.joined(dq, lists.part(w, d, d)))
  end
  local function down(q, p, z)
    local below, moved = J(q, p), descend(q, p) * z
    local u = velocity(lists.part(below, 0, N), lists.part(moved, 0, N))
    return lists.joined(u, lists.part(moved, N, d))
  end
  return up, down
end

-- H(q, J(q, p), t) on T*R^N (mech/group_lift.c); p of least length, and (q, J) of a state
local function collective(system)
  local own, m = system.place, steps.functions_of(system)
  local X = flats.directions(own, own.size, own.dimension, own.right)
  local function J(q, p) return X(q):transpose() * p end
  local function H(q, p, t) return m.H(own.element(q), J(q, p), t) end
  return core.system { Q = core.R(own.size), H = H },
    function(q, mu)
      local at = X(q)
      return at * (at:transpose() * at):solve(core.vector(mu))
    end,
    function(q, p) return lists.joined(q, J(q, p)) end
end

-- constraints at u = q/|q|, and reactions as covectors of R^N
local function add_constraints(options, given, own, rates, pulled)
  local N, d, params = own.size, own.dimension, given.params
  local g, phi, E = bound(given.constraint, params), bound(given.rolling, params),
    bound(given.reaction, params)
  local function state(q, v)
    local r = rates(q, v)
    return own.element(lists.part(r, 0, N)), lists.part(r, N, d)
  end
  options.constraint = g and function(q, t) return g(state(q, core.zeros(N)), t) end
  options.crossings = given.crossings
  options.rolling = phi and function(q, v, t)
    local u, xi = state(q, v)
    return phi(u, xi, t)
  end
  local control = bound(given.control, params)
  options.control = control and function(q, v, t)
    local u, xi = state(q, v)
    return control(u, xi, t)
  end
  options.reaction = E and function(q, v, t)
    local u, xi = state(q, v)
    local out = {}
    for i, row in ipairs(lists.entries(E(u, xi, t))) do out[i] = pulled(q, row) end
    return out
  end
end

-- which entries of xi move with the coordinates of each scale, told near the identity, where none
-- is zero by chance
local function entries_of_scales(own, rates)
  local N, d, out = own.size, own.dimension, {}
  local q, v = kits.normals(core.random(5), 0, N, 0.1), core.zeros(N)
  local at = own.flat(own.kit.identity())
  for i = 1, N do q[i] = q[i] + at[i] end
  local J = core.derivative(function(x, y) return core.vector(rates(x, y)) end, N, N)(q, v)
  local function moves(row, i) return math.abs(J[row][N + i]) > 1e-12 end
  for k = 1, own.scales do
    out[k] = {}
    for a = 1, d do
      local any = false
      for i = 1, N do any = any or moves(N + d + k, i) and moves(N + a, i) end
      if any then table.insert(out[k], a) end
    end
  end
  return out
end

-- masses of the scales as a function of (u, t), those of mech/group_homogeneous.c where
-- d2L/dxi2 does not depend on xi
local function scale_masses(own, rates, L)
  local N, d = own.size, own.dimension
  local entries = entries_of_scales(own, rates)
  local slope = core.derivative(function(u, x, t)
    return L(own.element(u), x, t)
  end, N, d, "number")
  local second = core.derivative(function(u, x, t)
    return lists.part(slope(u, x, t), N, d)
  end, N, d, "number")
  return function(u, t)
    local J, out = second(core.vector(u), core.zeros(d), t), {}
    for k, own_entries in ipairs(entries) do
      local sum = 0
      for _, a in ipairs(own_entries) do
        for _, b in ipairs(own_entries) do sum = sum + J[a][N + b] * J[a][N + b] end
      end
      out[k] = sum == 0 and 1 or core.sqrt(sum * (16 / #own_entries))
    end
    return out
  end
end

-- the system that does not see multiples of q (mech/group_homogeneous.c)
local function homogeneous(system)
  local own, given = system.place, system.given
  local N, d = own.size, own.dimension
  local rates, momenta = place.homogeneous(own)
  local slope = core.derivative(function(q, v)
    return lists.part(rates(q, v), N, d)
  end, N, N)
  local function pulled(q, f)
    local S, out = slope(q, core.zeros(N)), {}
    for i = 1, N do
      out[i] = 0
      for a = 1, d do out[i] = out[i] + S[a][N + i] * f[a] end
    end
    return core.vector(out)
  end
  local options, f = { Q = core.R(N) }, bound(given.force, given.params)
  local L, H = bound(given.L, given.params), bound(given.H, given.params)
  local even = own.scales > 0 and system:structure().quadratic_in_v
  local masses = L and even and scale_masses(own, rates, L)
  options.L = L and function(q, v, t)
    local r = rates(q, v)
    local u = lists.part(r, 0, N)
    local sum, mass = L(own.element(u), lists.part(r, N, d), t), masses and masses(u, t)
    for k = 1, own.scales do
      sum = sum + 0.5 * (mass and mass[k] or 1) * r[N + d + k] * r[N + d + k]
    end
    return sum
  end
  options.force = f and function(q, v, t, ...)
    local r = rates(q, v)
    return pulled(q, f(own.element(lists.part(r, 0, N)), lists.part(r, N, d), t, ...))
  end
  options.H = not L and function(q, p, t)
    local r = momenta(q, p)
    return H(own.element(lists.part(r, 0, N)), lists.part(r, N, d), t)
  end or nil
  add_constraints(options, given, own, rates, pulled)
  return core.system(options), pulled,
    function(q, p) return lists.part(momenta(q, p), 0, N + d) end
end

local LIFTS = { collective = collective, homogeneous = homogeneous }

--- The system on R^N that the rule of a solver steps by a lift (solver.lift), to(q, mu) -> p of
-- flat coordinates on the group, and down(q, p) -> these and mu, one after the other.
function M.lifted(solver) return LIFTS[solver.lift](solver.system) end

-- where vectors (u, dp) at (q, p) lead by a solver of the prolonged system, and the end
local function run_vectors(runs, q, p, t0, steps, vectors)
  local N, out, last = #q, {}, nil
  for k, w in ipairs(vectors) do
    last = runs:run { q = lists.joined(q, lists.part(w, 0, N)),
      p = lists.joined(lists.part(w, N, N), p), t0 = t0, steps = steps, every = math.max(steps, 1) }
    local q1, p1 = last.q[#last], last.p[#last]
    out[k] = lists.joined(lists.part(q1, N, N), lists.part(p1, 0, N))
  end
  return out, lists.part(last.q[#last], 0, N), lists.part(last.p[#last], N, N)
end

--- The system of tangent vectors beside runs of a solver, as on_group.beside has it.
function M.beside(solver)
  local own = solver.system.place
  local N = own.size
  local lifted, to, J = M.lifted(solver)
  local up, down = between(own, to, J)
  local function start(g, mu, w)
    local q = core.vector(own.flat(g))
    local raised = up(q, mu, w)
    return lists.joined(q, lists.part(raised, 0, N)),
      lists.joined(lists.part(raised, N, N), to(q, mu))
  end
  -- what p and its change have along the fibres of J grows by itself, and is no motion
  local function vector(x, p)
    return down(lists.part(x, 0, N), lists.part(p, N, N),
      lists.joined(lists.part(x, N, N), lists.part(p, 0, N)))
  end
  return { system = prolong.system(lifted), rule = prolong.rule(lifted, solver.rule),
    start = start, vector = vector }
end

--- along(s, steps, vectors) of on_group.lua.
function M.map(solver, newton)
  local own = solver.system.place
  local N, d = own.size, own.dimension
  local lifted, to, J = M.lifted(solver)
  local up, down = between(own, to, J)
  local runs = prolong.system(lifted):solver { rule = prolong.rule(lifted, solver.rule),
    h = solver.h, newton = newton }
  return function(s, count, vectors)
    local q = core.vector(own.flat(s.q))
    local p, raised, out = core.vector(to(q, s.p)), {}, {}
    for k, w in ipairs(vectors) do raised[k] = up(q, s.p, w) end
    local led, q1, p1 = run_vectors(runs, q, p, s.t, count, raised)
    for k, w in ipairs(led) do out[k] = down(q1, p1, w) end
    local z = J(q1, p1)
    s.q, s.p = own.element(lists.part(z, 0, N)), lists.part(z, N, d)
    s.t = s.t + count * solver.h
    return out
  end
end

return M
