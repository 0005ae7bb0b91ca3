--- Accelerations and multipliers at a state, from the equations of motion themselves:
--   d/dt L_v = L_q + f + G^T lambda + E^T mu,   d2g/dt2 = 0,   d phi/dt = 0,
-- with G = dg/dq and E = dphi/dv or given,
-- linear in (v', lambda, mu): an implicit function of (q, v, t) (dm.root), so that runs can record
-- it and look for its zeros. No step is in it: what is known of q and v to the order of a rule is
-- so known of the forces. Impulses of the step equation are another thing (solver:run, record).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local tangent_group = require "dm.measure.tangent_group"

local M = {}

local entries = lists.entries

-- the functions of a system as functions of (q, v, t), lists behind vectors; the force with its
-- control as it is at this state
local function functions_of(system)
  local given = system.given
  local p = given.params
  local L, g, phi, f = bound(given.L, p), bound(given.constraint, p), bound(given.rolling, p),
    bound(given.force, p)
  local control, E = bound(given.control, p), bound(given.reaction, p)
  return {
    place = system.place and tangent_group.entries_of(system),
    L = function(q, v, t) return L(q, v, t) end,
    g = g and function(q, t) return core.vector(entries(g(q, t))) end,
    phi = phi and function(q, v, t) return core.vector(entries(phi(q, v, t))) end,
    E = E and function(q, v, t) return E(q, v, t) end,
    f = f and function(q, v, t)
      if control then return entries(f(q, v, t, core.vector(entries(control(q, v, t))))) end
      return entries(f(q, v, t))
    end,
  }
end

-- derivatives of F(q, v, t) in (q, v, t), rows of 2 n + 1 numbers; on a group those of F(g near(e),
-- xi, t) in (e, xi, t), and xi is the rate of e (right: near(e) g)
local function derivative(f, F, n)
  local P = f.place
  if not P then return core.derivative(F, n, n, "number") end
  local slope = core.derivative(function(q, e, v, t)
    local moved = P.right and P.carry(P.near(e), q) or P.carry(q, P.near(e))
    return F(P.element(moved), v, t)
  end, P.size, n, n, "number")
  return function(g, v, t)
    local J = slope(core.vector(P.flat(g)), core.zeros(n), v, t)
    if kits.is_scalar(J[1]) then return lists.part(J, P.size, 2 * n + 1) end
    local out = {}
    for i = 1, J.rows do out[i] = lists.part(J[i], P.size, 2 * n + 1) end
    return out
  end
end

-- the change in time of a vector of (q, v, t) with the derivatives J, at the acceleration a
local function rates(J, count, v, a, t_column)
  local n, out = #v, {}
  for i = 1, count do
    local sum = J[i][t_column]
    for k = 1, n do sum = sum + J[i][k] * v[k] + J[i][n + k] * a[k] end
    out[i] = sum
  end
  return out
end

-- g' = G v + g_t as a function, and G
local function of_constraint(f, n)
  local slope = f.place and derivative(f, function(q, _, t) return f.g(q, t) end, n)
    or core.derivative(f.g, n, "number")
  local time, zero = f.place and 2 * n + 1 or n + 1, core.zeros(n)
  local function across(q, t)
    if f.place then return slope(q, zero, t) end
    return slope(q, t)
  end
  local speed = derivative(f, function(q, v, t)
    local G, out = across(q, t), {}
    for c = 1, #f.g(q, t) do
      out[c] = G[c][time]
      for k = 1, n do out[c] = out[c] + G[c][k] * v[k] end
    end
    return core.vector(out)
  end, n)
  return across, speed
end

-- rows of reactions of the rolling constraints, from J = dphi/d(q, v, t) or as given
local function reactions(f, J, count, n, q, v, t)
  if f.E then return entries(f.E(q, v, t)) end
  local out = {}
  for c = 1, count do
    out[c] = {}
    for k = 1, n do out[c][k] = J[c][n + k] end
  end
  return out
end

-- y = (v', lambda, mu) -> what is left of the equations
local function equations_of(f, n, k, l)
  local slope = derivative(f, f.L, n)
  local function momentum_of(q, v, t) return core.vector(lists.part(slope(q, v, t), n, n)) end
  local momentum = derivative(f, momentum_of, n)
  local turned = f.phi and derivative(f, f.phi, n)
  -- what of d/dt L_v = ... comes of the group itself: coad(xi, L_v), right: its negative
  local function carried(q, v, t)
    local P = f.place
    return P and P.kit.coad(P.right and -v or v, momentum_of(q, v, t))
  end
  local across, speed
  if f.g then across, speed = of_constraint(f, n) end
  return function(y, q, v, t)
    local s, force = slope(q, v, t), f.f and f.f(q, v, t)
    local out, turn = rates(momentum(q, v, t), n, v, y, 2 * n + 1), carried(q, v, t)
    for i = 1, n do
      out[i] = out[i] - s[i] - (force and force[i] or 0)
      if turn then out[i] = out[i] - turn[i] end
    end
    local function push(rows, count, first)
      for c = 1, count do
        for i = 1, n do out[i] = out[i] - rows[c][i] * y[first + c] end
      end
    end
    local function enforce(J, count)
      for _, rate in ipairs(rates(J, count, v, y, 2 * n + 1)) do out[#out + 1] = rate end
    end
    if k > 0 then push(across(q, t), k, n) end
    local J = turned and turned(q, v, t)
    if J then push(reactions(f, J, l, n, q, v, t), l, n + k) end
    if k > 0 then enforce(speed(q, v, t), k) end
    if J then enforce(J, l) end
    return out
  end
end

--- What constraints ask of a change (u, dv) of a state, as a function of (q, v, t): rows of 2 n
-- numbers, the derivatives of g, G v + g_t and phi in (q, v); on a group u is g^-1 dg (right:
-- dg g^-1).
function M.conditions(system)
  local f = functions_of(system)
  local n = system.place and system.place.dimension or system.Q.dimension
  local of, out = {}, nil
  if f.g then
    local _, speed = of_constraint(f, n)
    of = { derivative(f, function(q, _, t) return f.g(q, t) end, n), speed }
  end
  if f.phi then of[#of + 1] = derivative(f, f.phi, n) end
  return function(q, v, t)
    out = {}
    for _, J in ipairs(of) do
      local slope = J(q, v, t)
      for i = 1, f.place and #slope or slope.rows do
        out[#out + 1] = lists.part(slope[i], 0, 2 * n)
      end
    end
    return out
  end
end

--- G = dg/dq as a function of (q, t), rows of n numbers, nil without a constraint; on a group in
-- g^-1 dg (right: dg g^-1).
function M.slope(system)
  local f = functions_of(system)
  local n = system.place and system.place.dimension or system.Q.dimension
  if not f.g then return nil end
  local across = of_constraint(f, n)
  return function(q, t)
    local G, out = across(q, t), {}
    for c = 1, f.place and #G or G.rows do out[c] = lists.part(G[c], 0, n) end
    return out
  end
end

local MOST = 64  -- unknowns of an implicit function

-- constant mass: v' = M^-1 (rest - what the equations have without v'), so that multipliers alone
-- are unknown
local function of_multipliers(system, f, n, k, l)
  local zero = {}
  for i = 1, n do zero[i] = 0 end
  local place = system.place
  local inverse = system:mass(place and place.kit.identity() or zero, zero):inverse()
  local all = equations_of(f, n, k, l)
  local function accelerations(lambda, q, v, t)
    local full, a = table.move(zero, 1, n, 1, {}), {}
    for c = 1, k + l do full[n + c] = lambda[c] end
    local rest = all(full, q, v, t)
    for i = 1, n do
      a[i] = 0
      for j = 1, n do
        if inverse[i][j] ~= 0 then a[i] = a[i] - inverse[i][j] * rest[j] end
      end
    end
    return a
  end
  local function equations(lambda, q, v, t)
    local full, out = accelerations(lambda, q, v, t), {}
    for c = 1, k + l do full[n + c] = lambda[c] end
    local rest = all(full, q, v, t)
    for c = 1, k + l do out[c] = rest[n + c] end
    return out
  end
  return equations, accelerations
end

-- (q, v, t) -> v', multipliers, as one list; of many coordinates by way of the multipliers
local function solution(system, f, n, k, l)
  local failure = k + l > 0
    and "are the constraints independent of each other here, and d2L/dv2 regular along them?"
    or "is d2L/dv2 regular here?"
  local P = f.place
  local function root(count, equations)
    local found = core.root { name = "the acceleration", unknowns = count,
      equations = P and function(y, q, ...) return equations(y, P.element(q), ...) end or equations,
      failure = failure }
    return P and function(q, ...) return found(core.vector(P.flat(q)), ...) end or found
  end
  if n + k + l <= MOST then return root(n + k + l, equations_of(f, n, k, l)) end
  if k + l > MOST or not system:structure().constant_mass then
    error(("multipliers are found for up to %d accelerations and multipliers, or up to %d "
      .. "multipliers where the mass is constant (this system has %d and %d); "
      .. "a run with record = { \"impulses\" } has those of its steps")
      :format(MOST, MOST, n, k + l), 0)
  end
  local equations, accelerations = of_multipliers(system, f, n, k, l)
  local lambda = k + l > 0 and root(k + l, equations)
  return function(q, v, t)
    local found = lambda and lambda(q, v, t) or {}
    local out = accelerations(found, q, v, t)
    for c = 1, k + l do out[n + c] = found[c] end
    return out
  end
end

-- values of all functions at a state, to see whether a number that they use has changed
local function fingerprint(f, at)
  local out = { f.L(at.q, at.v, at.t) }
  for _, key in ipairs { "phi", "E", "f" } do
    out[#out + 1] = f[key] and f[key](at.q, at.v, at.t) or 0
  end
  out[#out + 1] = f.g and f.g(at.q, at.t) or 0
  local text = {}
  local function add(x)
    local fine, count = blame.try(function() return #x end)
    if type(x) == "number" or not fine then text[#text + 1] = ("%a"):format(x) return end
    for i = 1, count do add(x[i]) end
  end
  add(out)
  return table.concat(text, " ")
end

-- of velocities
local function dimension(system)
  return system.place and system.place.dimension or system.Q.dimension
end

-- system -> { f, root, n, k, l, sample, seen }
local kept = setmetatable({}, { __mode = "k" })

local function make(system)
  local given, structure = system.given, system:structure()
  if given.derivatives == "hyperdual" then
    error("multipliers and accelerations need the graph of L, and this system runs on hyper-dual "
      .. "numbers", 0)
  end
  if not given.L then
    error("multipliers and accelerations need a Lagrangian, and this H has none (d2H/dp2 is "
      .. "singular, or H is not quadratic in p)", 0)
  end
  local made = { f = functions_of(system), n = dimension(system),
    k = structure.constraints or 0, l = structure.rolling or 0 }
  made.root = solution(system, made.f, made.n, made.k, made.l)
  return made
end

local function is_numbers(...)
  for _, x in ipairs { ... } do
    if type(x) ~= "number" then
      for i = 1, #x do
        if type(x[i]) ~= "number" then return false end
      end
    end
  end
  return true
end

-- what belongs to the system as its functions are now
local function current(system, q, v, t)
  local made = kept[system]
  if made and made.seen and made.seen ~= fingerprint(made.f, made.sample) then made = nil end
  made = made or make(system)
  if not made.seen and is_numbers(q, v, t) then
    made.sample = { q = q, v = v, t = t }
    made.seen = fingerprint(made.f, made.sample)
    kept[system] = made
  end
  return made
end

local function need(system, what)
  local structure = system:structure()
  if (structure.constraints or 0) + (structure.rolling or 0) == 0 then
    error(what .. ": this system has no constraint, so it has no multipliers; give dm.system "
      .. "constraint = or rolling =", 0)
  end
end

local function part(y, first, last)
  local out = {}
  for i = first, last do out[#out + 1] = y[i] end
  return core.vector(out)
end

-- a state as it is given: vectors of n entries, numbers or symbols
local function state(system, q, v, t, what)
  local n, place = dimension(system), system.place
  local function check(key, x)
    if lists.count(x) ~= n then
      error(("%s: %s must be %d numbers (got %s)"):format(what, key, n, lists.got(x)), 0)
    end
  end
  if not place then check("q", q) end
  check("v", v)
  local fine, symbol = blame.try(function() return t == nil or type(t) == "number" or t + 0 end)
  if not fine or type(symbol) == "table" then
    error(("%s: t must be a number (got %s)"):format(what, type(t)), 0)
  end
  return place and groups.element(place.space, q) or core.vector(q), core.vector(v), t or 0
end

M.multipliers = blame.caller(function(system, q, v, t)
  need(system, "system:multipliers")
  q, v, t = state(system, q, v, t, "system:multipliers")
  local made = current(system, q, v, t)
  return part(made.root(q, v, t), made.n + 1, made.n + made.k + made.l)
end)

M.acceleration = blame.caller(function(system, q, v, t)
  q, v, t = state(system, q, v, t, "system:acceleration")
  local made = current(system, q, v, t)
  return part(made.root(q, v, t), 1, made.n)
end)

-- lambda, a vector, as a function of (q, v, t), traced anew
local function traced(system, what)
  need(system, what)
  local made = make(system)
  local first, last = made.n + 1, made.n + made.k + made.l
  return function(q, v, t) return part(made.root(q, v, t), first, last) end, made
end

--- What `watch` and `record` call "lambda", for the C of runs: a function of (q, v, t, p).
function M.watched(system) return (traced(system, "lambda")) end

M.along = blame.caller(function(path)
  if path.watched then
    error("path:multipliers needs q and p, but this run recorded only what it watched: watch "
      .. "\"lambda\"", 0)
  end
  if getmetatable(path.system).__name ~= "dm.system" then
    error("path:multipliers: a discrete Lagrangian has no equations at a state; the multipliers "
      .. "of its steps are record = { \"impulses\" }", 0)
  end
  local f, made = traced(path.system, "path:multipliers")
  local v, out = path:velocity(), {}
  local lambda = path.system.place and f or core.trace(f, made.n, made.n, "number")
  for i = 1, #path do out[i] = lambda(path.q[i], v[i], path.t[i]) end
  return core.matrix(out)
end)

core.method("dm.system", "multipliers", M.multipliers, [[
system:multipliers(q, v [, t]) -> dm.vector
The multipliers at a state, of constraints first, then of rolling ones: lambda in d/dt L_v = L_q + f
+ G^T lambda + E^T mu with G = dg/dq, E = dphi/dv (or the rows of `reaction`), such that g and phi
stay zero. So +G^T lambda is the force of the constraint on q: with g = |q| - l the multiplier is
the force along the rod, outwards, and the tension is -lambda; it is scaled with g. Numbers, or
symbols in a traced function: an event at a zero of it is where a rope goes slack. Raises where
constraints depend on each other.]])
core.method("dm.system", "acceleration", M.acceleration, [[
system:acceleration(q, v [, t]) -> dm.vector of dim Q entries
d2q/dt2 at a state by the equations of motion, with forces and constraints; a control is that of
this state. Numbers, or symbols in a traced function.]])
core.method("dm.path", "multipliers", M.along, [[
path:multipliers() -> dm.matrix, #path x constraints
system:multipliers at every row (v from p): forces of the constraints along the path, to the order
of the rule. Columns of it are plotted as path:plot("t", M:column(1)); a run records them with
record = { "lambda" }.]])

return M
