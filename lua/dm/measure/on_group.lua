--- Linearization and tangent maps of systems on groups, in the left trivialization: a change of g
-- is u = g^-1 dg, of the body momentum dp.
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local lists = require "dm.base.lists"
local bound = require "dm.base.bound"
local lifts = require "dm.measure.lifts"
local mirror = require "dm.group.trivialization.mirror"
local own_step = require "dm.measure.own_step"
local tangent_group = require "dm.measure.tangent_group"
local tangent_space = require "dm.measure.tangent_space"

local M = {}

local abs, max = math.abs, math.max

---- the system linearized at a state ----

--- (g', mu') of an H(g, mu [, t]) on the group of a system, as functions of these: xi = H_mu and
-- mu' = coad(xi, mu) - H_g, one after the other.
function M.rates_of_momentum(system, H)
  local kit, d = system.place.kit, system.place.dimension
  local slope, N = tangent_group.slopes(system, H)
  return function(g, mu, t)
    local y = slope(g, mu, t)
    local xi = lists.part(y, N + d, d)
    local turned = kit.coad(system.place.right and -xi or xi, mu)
    return lists.joined(xi, turned - lists.part(y, N, d))
  end
end

--- (xi, xi') as a function of (g, xi, t); of an H without L (xi, mu') of (g, mu, t).
function M.rates(system)
  local given = system.given
  if not given.L then return M.rates_of_momentum(system, bound(given.H, given.params)) end
  return function(z, v, t) return lists.joined(v, system:acceleration(z, v, t)) end
end

--- The matrix of d(u, dxi)/dt at (g, xi, t), with coefficients frozen there, as a function of
-- these: u' = dxi - ad_xi u (right: + ad_xi u) and the change of the acceleration. Of an H without
-- L that of d(u, dmu)/dt at (g, mu). Second the rates.
function M.field(system)
  local kit, d = system.place.kit, system.place.dimension
  local rates = M.rates(system)
  local slope, N = tangent_group.slopes(system, rates)
  return function(g, x, t)
    local J, xi, out = slope(g, x, t), lists.part(rates(g, x, t), 0, d), core.matrix(2 * d, 2 * d)
    for k = 1, d do
      local unit = core.zeros(d)
      unit[k] = system.place.right and 1 or -1
      local turned = kit.ad(xi, unit)
      for i = 1, 2 * d do
        out[i][k] = J[i][N + k] + (i <= d and turned[i] or 0)
        out[i][d + k] = J[i][N + d + k]
      end
    end
    return out
  end, rates
end

---- tangent maps ----

local function newton(solver)
  return { tolerance = solver.tolerance, max_iterations = solver.max_iterations }
end

-- (u, dp) of the lifted state in row i of a path
local function tangent_of(path, i, kit, d)
  local z, p = path.q[i], path.p[i]
  local u = kit.Ad(kit.inverse(z[1]), z[2])
  return lists.joined(u, lists.part(p, 0, d))
end

-- a run on the tangent group, whose chart is longer than that of the group
local function run_prolonged(solver, lifted, options, what)
  local fine, path = blame.try(lifted.run, lifted, options)
  if fine then return path end
  local why = type(path) == "string" and path
  if why and why:find "it splits L" then
    error(("%s is a step of the prolonged system, and %s"):format(what, why), 0)
  end
  if why and (why:find "too many to trace" or why:find "stays on it") then
    error(("%s: '%s' steps the tangent group of %s for that, and %s; gauss(s) has a tangent map by "
      .. "the collective lift, where the group has one"):format(what, tostring(solver.rule),
      tostring(solver.system.Q), why:find "stays" and "that has no such map"
      or "its chart is too long to trace (lie(s, cayley) has a shorter one)"), 0)
  end
  error(path, 0)
end

-- along(s, steps, vectors): where the vectors (u, dp) at the state s = { q, p, t } lead in so many
-- steps; s becomes the end
local function by_prolonging(solver, what)
  local system = solver.system
  local kit, d = system.place.kit, system.place.dimension
  local lifted = tangent_group.system(system)
    :solver { rule = solver.rule, h = solver.h, newton = newton(solver) }
  return function(s, steps, vectors)
    local out, last = {}, nil
    for k, w in ipairs(vectors) do
      last = run_prolonged(solver, lifted, {
        q = { s.q, kit.Ad(s.q, core.vector(lists.part(w, 0, d))) },
        p = lists.joined(lists.part(w, d, d), s.p), t0 = s.t, steps = steps,
        every = max(steps, 1) }, what)
      out[k] = tangent_of(last, #last, kit, d)
    end
    s.q, s.p = last.q[#last][1], core.vector(lists.part(last.p[#last], d, d))
    s.t = s.t + steps * solver.h
    return out
  end
end

-- does the rule step groups by itself?
local function steps_groups(rule)
  local name = tostring(rule):match "^[%w%-]+"
  for _, row in ipairs(core.rules()) do
    if row.name == name then return row.on_groups end
  end
  return type(rule) ~= "string" and not rule.stages
end

-- of a rule in charts
local function chart_map(solver, what)
  local place = solver.system.place
  if not place.right then return by_prolonging(solver, what) end
  local kit, other = place.kit, mirror.system(solver.system)
    :solver { rule = solver.rule, h = solver.h, newton = newton(solver) }
  local along = by_prolonging(other, what)
  return function(s, steps, vectors)
    local there = mirror.state(kit, s)
    local out = along(there, steps, vectors)
    local back = mirror.state(kit, there)
    s.q, s.p, s.t = back.q, back.p, back.t
    return out
  end
end

--- The tangent map of a solver on a group, along(s, steps, vectors).
function M.map(solver, what)
  if own_step.is(solver) then return own_step.map(solver, what) end
  if steps_groups(solver.rule) then return chart_map(solver, what) end
  return lifts.map(solver, newton(solver))
end

-- tangent vectors beside runs in the chart
local function beside_in_chart(system, rule)
  local kit, d = system.place.kit, system.place.dimension
  local function start(g, mu, w)
    return { g, kit.Ad(g, core.vector(lists.part(w, 0, d))) },
      lists.joined(lists.part(w, d, d), mu)
  end
  local function vector(z, mu) return lists.joined(z[2], lists.part(mu, 0, d)) end
  return { system = tangent_group.system(system), rule = rule, start = start, vector = vector }
end

--- Tangent vectors beside runs by a rule, of ensembles: { system, rule (that steps it), start(q, v,
-- p, t, w) -> q, p with a vector w = (u, dp) that is brought onto the constraints, vector(q, p):
-- its entries then, up to a map that does not grow }.
function M.beside(system, rule)
  local in_chart = steps_groups(rule)
  local own = in_chart and system.place.right and mirror.system(system) or system
  local out = in_chart and beside_in_chart(own, rule)
    or lifts.beside(own:solver { rule = rule, h = 1 })
  local kit, start = system.place.kit, out.start
  function out.start(q, v, p, t, w)
    local s = M.start(system, { q = q, v = v, p = p, t0 = t })
    w = M.allowed(system, s)(w)
    if own ~= system then s = mirror.state(kit, s) end
    return start(s.q, s.p, w)
  end
  return out
end

-- unit vectors of (u, dp)
local function units(d)
  local out = {}
  for k = 1, 2 * d do
    out[k] = lists.zeros(2 * d)
    out[k][k] = 1
  end
  return out
end

-- the momentum of v; a reduced system keeps the quantity that this run carries along, where a call
-- from outside would take the usual one
local function momentum(system, g, v, t)
  local reduced = system.place.reduced
  local a = reduced and reduced.a
  local p = system:legendre(g, v, t)
  if reduced then reduced.a = a end
  return p
end

--- The state that options of a run begin at.
function M.start(system, start)
  local g = groups.element(system.place.space, start.q)
  local p = start.p or momentum(system, g, start.v, start.t0)
  return { q = g, p = core.vector(p), t = start.t0 or 0 }
end

-- a square part of a matrix
local function block(J, first, d)
  local out = core.matrix(d, d)
  for i = 1, d do
    for k = 1, d do out[i][k] = J[i][first + k] end
  end
  return out
end

--- x -> the change (u, dp) nearest to x that the constraints leave at a state.
function M.allowed(system, s)
  local given, d = system.given, system.place.dimension
  if not (given.constraint or given.rolling) then return function(x) return x end end
  local slope, N = tangent_group.slopes(system, bound(given.L, given.params))
  local curve = tangent_group.slopes(system, function(...)
    return lists.part(slope(...), N + d, d)
  end)
  local xi = system:velocity(s.q, s.p, s.t)
  local J = curve(s.q, xi, s.t)
  return tangent_space.projection(
    tangent_space.of_momentum(system, s.q, xi, s.t, block(J, N, d), block(J, N + d, d)))
end

--- Where the unit vectors of (u, dp), or what the constraints leave of them, lead, these, the end
-- of the run, the momentum at its start.
function M.columns(solver, start, what)
  local s, first = M.start(solver.system, start), units(solver.system.place.dimension)
  local p, allowed = s.p, M.allowed(solver.system, s)
  for k, x in ipairs(first) do first[k] = allowed(x) end
  local out = M.map(solver, what)(s, start.steps, first)
  return out, first, s.q, s.p, p
end

--- The two-form <dp', u> - <dp, u'> + <p, [u, u']> between two tangent vectors at momentum p
-- (right: - <p, [u, u']>).
local function form(place, p, a, b)
  local d, sum = place.dimension, 0
  for i = 1, d do sum = sum + a[i] * b[d + i] - a[d + i] * b[i] end
  local u, w = core.vector(lists.part(a, 0, d)), core.vector(lists.part(b, 0, d))
  if place.right then u, w = w, u end
  return sum + core.vector(p):dot(place.kit.ad(u, w))
end

--- What the two-form changed by over a run, over the square of the largest entry.
function M.defect(solver, start, what)
  local place = solver.system.place
  local out, first, _, p1, p0 = M.columns(solver, start, what)
  local worst, size = 0, 1
  for a = 1, #out do
    for i = 1, #out do size = max(size, abs(out[a][i])) end
    for b = 1, #out do
      local change = form(place, p1, out[a], out[b]) - form(place, p0, first[a], first[b])
      worst = max(worst, abs(change))
    end
  end
  return worst / size ^ 2
end

return M
