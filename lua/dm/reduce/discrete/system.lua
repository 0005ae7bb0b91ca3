--- Is an Ld of this system? For a pair of steps of length k along a curve with velocity v and
-- acceleration a, (D2 Ld + D1 Ld) / k approaches L_q - d/dt L_v as k goes to 0, and the momentum
-- (D2 Ld - D1 Ld) / 2 of a step approaches L_v: along the group, or mu would mean something else.
-- What is left at k must be explained by how it changes with k and by round-off: eps |L_vv| |q| / k
-- of momenta, by k once more of equations, or more, as it scatters.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local forces = require "dm.reduce.discrete.forces"

local M = {}

local abs, max, min = math.abs, math.max, math.min

-- steps that are looked at, whatever the units of time: of their own, and parts of h
local STEPS, PARTS = { 2 ^ -6, 2 ^ -9, 2 ^ -12, 2 ^ -14 }, { 2 ^ -2, 2 ^ -5, 2 ^ -8 }
local ENOUGH = 2              -- steps that must say no
local SCATTER = { 1, 2, 3, 5 } -- k is changed by these times NEAR, to see round-off
local NEAR, ROUNDED = 1e-7, 20
local UNEXPLAINED, SMALL = 10, 1e-6 -- of the change with k, of the size of terms
local SLOW = 0.1 -- velocities at which a formula for one h is looked at
local EPS, BEYOND = 2 ^ -52, 100 -- of the size of terms: no limit

---- what Ld and L say ----

-- everything about L at (q, v): gradient, hessian, an acceleration of the size of the true one
local function state_of(L, p, slow)
  local n, q, v = #p.q, p.q, slow * p.v
  local s = { q = q, v = v, n = n, g = L:gradient(q, v), H = L:hessian(q, v), L = L, p = p }
  local force, mass = 0, 0
  for i = 1, n do
    force = max(force, abs(s.g[i]))
    for k = 1, n do mass = max(mass, abs(s.H[n + i][n + k])) end
  end
  local size, a = force > 0 and mass > 0 and force / mass or 1, {}
  for i = 1, n do a[i] = (0.3 + 0.1 * i) * size end
  s.a, s.rounded = core.vector(a), EPS * mass * q:norm()
  return s
end

-- L_q - d/dt L_v along the curve, and the size of its terms
local function equation(s)
  local n, out, size = s.n, {}, 0
  for i = 1, n do
    out[i] = s.g[i]
    size = max(size, abs(s.g[i]))
    for k = 1, n do
      local inertia = s.H[n + i][k] * s.v[k] + s.H[n + i][n + k] * s.a[k]
      out[i], size = out[i] - inertia, max(size, abs(inertia))
    end
  end
  return core.vector(out), size
end

-- the same of an Ld with these slopes, a time k apart
local function equation_at(slope, s, k)
  local n, out = s.n, {}
  local before, after = s.q - k * s.v + k * k / 2 * s.a, s.q + k * s.v + k * k / 2 * s.a
  local last, now = slope(before, s.q, k), slope(s.q, after, k)
  for i = 1, n do out[i] = (last[n + i] + now[i]) / k end
  return core.vector(out)
end

-- L_v, and its size
local function momentum(s)
  local out, size = {}, 0
  for i = 1, s.n do out[i] = s.g[s.n + i] end
  for i = 1, s.n do
    for k = 1, s.n do size = max(size, abs(s.H[s.n + i][s.n + k] * s.v[k])) end
  end
  return core.vector(out), max(size, core.vector(out):norm())
end

local function momentum_at(slope, s, k)
  local n, out = s.n, {}
  local D = slope(s.q - k / 2 * s.v, s.q + k / 2 * s.v, k)
  for i = 1, n do out[i] = (D[n + i] - D[i]) / 2 end
  return core.vector(out)
end

-- (F1 + F2) / k of a step, the force of Ld in the mean
local function force_at(push, s, k)
  local F1, F2 = push(s.q - k / 2 * s.v, s.q + k / 2 * s.v, k)
  return (F1 + F2) / k
end

---- the limit of small steps ----

-- f(k) and how far it scatters where k is changed by so little that nothing else is seen
local function sample(f, k)
  local x, noise = f(k), 0
  for _, part in ipairs(SCATTER) do noise = max(noise, (f(k * (1 + NEAR * part)) - x):norm()) end
  return x, noise
end

-- does c.f(k) approach c.want? The value in its place where it does not
local function other_limit(c, k)
  local x, r = sample(c.f, k)
  local y, s = sample(c.f, k / 2)
  local z, t = sample(c.f, k / 4)
  local limit, before, after = 2 * z - y, (x - y):norm(), (y - z):norm()
  local noise = ROUNDED * (r + s + t + c.rounded(k / 4))
  local off = (limit - c.want):norm()
  if off > UNEXPLAINED * (before + after) + noise + SMALL * c.size then return limit end
  if after > 1.5 * before and z:norm() > BEYOND * c.size + noise then return z end
end

-- the value that c.f approaches in place of c.want, by most of the steps, or nothing
local function wrong_limit(c, steps)
  local count, limit = 0, nil
  for _, k in ipairs(steps) do
    local fine, other = blame.try(other_limit, c, k)
    if fine and other then count, limit = count + 1, other end
    if count == ENOUGH then return limit end
  end
end

---- a formula for one h ----

-- slopes of h L at one node of the straight line: what an Ld of L differs from by no more than
-- these differ from each other, about
local function node(L, c)
  return function(q0, q1, h)
    local n, w, out = #q0, (q1 - q0) / h, {}
    local g = L:gradient(q0 + c * (q1 - q0), w)
    for i = 1, n do
      out[i], out[n + i] = h * (1 - c) * g[i] - g[n + i], h * c * g[i] + g[n + i]
    end
    return core.vector(out)
  end
end

-- is h short beside the oscillations of L at s?
local function is_short(s, h)
  local n, stiffness, mass = s.n, 0, 0
  for i = 1, n do
    for k = 1, n do
      stiffness = max(stiffness, abs(s.H[i][k]))
      mass = max(mass, abs(s.H[n + i][n + k]))
    end
  end
  return h * h * stiffness <= mass
end

-- what Ld gives where it is none of what L gives at h, or nothing
local function wrong_value(c, s, h)
  if not is_short(s, h) then return nil end
  local x, noise = sample(function(part) return c.f(h * part) end, 1)
  local left, middle, right = c.of(node(s.L, 0), h), c.of(node(s.L, 0.5), h), c.of(node(s.L, 1), h)
  local spread = (left - middle):norm() + (right - middle):norm()
  local moved = h * s.v:norm() / max(s.q:norm(), 1e-300)
  local bar = UNEXPLAINED * spread + ROUNDED * (noise + c.rounded(h)) + (SMALL + moved ^ 2) * c.size
  if (x - middle):norm() > bar then return x end
end

---- both ----

-- the part of a covector that constraints do not take up, by the rows of their derivative
local function along_constraints(G)
  local rows = {}
  for c = 1, G and #G or 0 do
    local r = core.vector(G[c])
    for _, e in ipairs(rows) do r = r - e:dot(r) * e end
    if r:norm() > 1e-12 * G[c]:norm() then rows[#rows + 1] = r / r:norm() end
  end
  return function(x)
    for _, e in ipairs(rows) do x = x - e:dot(x) * e end
    return x
  end
end

-- the components along the group: xi_Q(q) for every coordinate of it
local function along_group(generators)
  return function(p)
    local out = {}
    for a, xi in ipairs(generators) do out[a] = xi:dot(p) end
    return core.vector(out)
  end
end

local OTHER = "discrete: this Ld is of another system: its equations D2 Ld + D1 Ld = 0 do not "
  .. "approach those of L: over a short step they leave %s where L leaves %s, at %s with the "
  .. "acceleration %s"
local MOMENTUM = "discrete: this Ld has another momentum map: along the group it gives %s where L "
  .. "gives %s, at %s, so that mu would not be the momentum of its steps: is Ld scaled, or has it "
  .. "a term that is no action, such as c (theta1 - theta0)?"

-- The comparison of `f`, one of those above, of Ld with that of L at a point: by short steps, or
-- by the one that Ld has.
local function compare(o, s, f, want, size, project, power)
  local c = { want = project(want), size = size }
  function c.of(slope, k) return project(f(slope, s, k)) end
  function c.f(k) return c.of(o.slope, k) end
  function c.rounded(k) return s.rounded / k ^ power end
  if o.timed then return wrong_limit(c, o.steps) end
  return wrong_value(c, s, o.h)
end

local FORCE = "discrete: the force of this Ld is not that of its system: (F1 + F2) / h is %s where "
  .. "the system has %s, at %s"

-- the force of the system, where it has one: by short steps or, as one may know its h only, at h,
-- by how much the force changes over such a step
local function check_force(o, s, project, place)
  if not o.force then return nil end
  local f, h = core.vector(o.force(s.q, s.v, 0)), o.h
  local function seen(k) return project(force_at(o.push, s, k)) end
  local c = { want = project(f), size = f:norm(), f = seen }
  function c.rounded(k) return s.rounded / k end
  local found = wrong_limit(c, o.steps)
  if not found then return nil end
  local change = (core.vector(o.force(s.q - h / 2 * s.v, s.v, 0)) - f):norm()
    + (core.vector(o.force(s.q + h / 2 * s.v, s.v, 0)) - f):norm()
  if (seen(h) - c.want):norm() <= UNEXPLAINED * change + 0.01 * c.size then return nil end
  return FORCE:format(check.text(found), check.text(c.want), place)
end

local function check_point(o, p, G, generators)
  local s = state_of(o.L, p, o.timed and 1 or SLOW)
  local E, size = equation(s)
  local project, place = along_constraints(G), check.at { q = s.q, v = s.v, t = 0 }
  local found = compare(o, s, equation_at, E, size, project, 2)
  if found then
    return OTHER:format(check.text(found), check.text(project(E)), place, check.text(s.a))
  end
  found = check_force(o, s, project, place)
  if found then return found end
  local J, large = momentum(s)
  project = along_group(generators)
  found = compare(o, s, momentum_at, J, large, project, 1)
  if found then return MOMENTUM:format(check.text(found), check.text(project(J)), place) end
end

--- Raises where the formula Ld is of another system than `full`, or has another momentum map or
-- force; points {q, v}, with G the derivative of the constraints there and the generators of the
-- group, xi_Q(q) for each of its coordinates.
function M.compare(full, Ld, points)
  local n, f, own, given = full.Q.dimension, Ld.Ld, Ld.params, full.given
  local function Ld_at(q0, q1, h) return f(q0, q1, h, own) end
  local o = { h = Ld.h, steps = { table.unpack(STEPS) },
    timed = core.trace(Ld_at, n, n, "number"):depends()[3][1],
    slope = core.derivative(Ld_at, n, n, "number"),
    L = core.trace(function(q, v) return given.L(q, v, 0, given.params) end, n, n),
    force = given.force and bound(given.force, given.params),
    push = given.force and forces.of(Ld).push }
  for _, part in ipairs(PARTS) do o.steps[#o.steps + 1] = min(part * Ld.h, 2 ^ 40) end
  for _, p in ipairs(points) do
    local fine, why = blame.try(check_point, o, p, p.G, p.generators)
    if fine and why then error(why, 0) end
  end
end

return M
