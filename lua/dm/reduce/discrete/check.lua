--- What shape:discrete takes: an Ld of the unreduced system, with its constraint or none, that the
-- group leaves as it is.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local forces = require "dm.reduce.discrete.forces"
local everywhere = require "dm.reduce.routh.everywhere"
local lists = require "dm.base.lists"
local check = require "dm.reduce.routh.check"
local model = require "dm.reduce.routh.model"
local places = require "dm.reduce.discrete.places"
local routh = require "dm.reduce.routh"
local system = require "dm.reduce.discrete.system"

local M = {}

local abs, max = math.abs, math.max

---- constraints ----

local INSIDE = "discrete: this system has constraints, and '%s' has them at points inside of its "
  .. "steps, for which shape:solver has the reduced equations; \"midpoint\", \"trapezoidal\" and a "
  .. "dm.discrete_lagrangian have them at their nodes alone"

--- The discrete Lagrangian of a system and a rule: it has its constraints at the nodes.
function M.of_rule(system, options)
  local fine, Ld = blame.try(core.discrete_lagrangian, system, options)
  if fine then return Ld end
  if not tostring(Ld):find("has no place for", 1, true) then error(Ld, 0) end
  error(INSIDE:format(tostring(options.rule)), 0)
end

-- a constraint of Ld is that of the system, or nobody would keep it
local function check_own_constraint(full, Ld, points)
  local own, given = Ld.constraint, full.given.constraint
  if own == nil or own == given then return end
  if not given then
    error("discrete: this Ld has a constraint that its system does not have: give it to the "
      .. "system, dm.system{..., constraint =}, and reduce that", 0)
  end
  local mine = bound(own, Ld.params)
  local yours = bound(given, full.given.params)
  local seen = {}
  for k, p in ipairs(points) do
    seen[k] = { a = check.numbers(mine(p.q, 0)), b = check.numbers(yours(p.q, 0)), q = p.q }
  end
  local usual = check.usual(seen, "b")
  for _, one in ipairs(seen) do
    local a, b, same = one.a, one.b, #one.a == #one.b
    for c = 1, same and #a or 0 do
      same = same and abs(a[c] - b[c]) <= 1e-10 * max(usual[c], abs(b[c]))
    end
    if not same then
      error(("discrete: the constraint of this Ld is not that of its system, at q = %s")
        :format(check.text(one.q)), 0)
    end
  end
end

---- rolling constraints ----

local STEP, SPAN = 1e-6, 1e-4 -- of time; of the length of a row

-- the part of a row that is at right angles to others; these, of length 1
local function beside(row, units)
  for _, unit in ipairs(units) do row = row - row:dot(unit) * unit end
  return row
end

-- rows along which the rolling constraints of a system react: those given, or phi_v
local function reactions(given, n)
  local rows, phi = bound(given.reaction, given.params), bound(given.rolling, given.params)
  if rows then return function(q, v) return check.rows(rows(q, v, 0)) end end
  local slope = core.derivative(function(v, q)
    return core.vector(lists.entries(phi(q, v, 0)))
  end, n, n)
  return function(q, v)
    local J, out = slope(v, q), {}
    for i = 1, J.rows do out[i] = lists.part(J:row(i), 0, n) end
    return out
  end
end

-- Rows of Ld for a short step lie in the span of those of the system, as many, at every point.
local function check_own_rolling(full, Ld, points)
  if not (full.given.rolling and Ld.rolling) then return end
  local own = reactions(full.given, full.Q.dimension)
  for _, at in ipairs(points) do
    local units = {}
    for i, row in ipairs(own(at.q, at.v)) do
      row = beside(core.vector(row), units)
      units[i] = row / row:norm()
    end
    local mine = check.rows(Ld.reaction(at.q, at.q + STEP * at.v, STEP, Ld.params))
    local same = #mine == #units
    for i = 1, same and #mine or 0 do
      local row = core.vector(mine[i])
      same = same and beside(row, units):norm() <= SPAN * row:norm()
    end
    if not same then
      error(("discrete: the rolling constraints of this Ld react in other directions than those of "
        .. "its system, at q = %s"):format(check.text(at.q)), 0)
    end
  end
end

---- is it of this system? ----

local OTHER = "discrete: this Ld is of another system: %s"

-- the points with what M.compare needs beside them
local function with_directions(D, full, points)
  local info, given, out = D.info, full.given, {}
  local G = given.constraint and core.derivative(function(q)
    return core.vector(lists.entries(bound(given.constraint, given.params)(q, 0)))
  end, info.n)
  for k, p in ipairs(points) do
    local generators, J = {}, info.ambient and info.ambient.slope(info.points[k].q)
    for a, i in ipairs(info.cyclic) do
      local xi = {}
      for row = 1, info.n do xi[row] = J and J[row][i] or (row == i and 1 or 0) end
      generators[a] = core.vector(xi)
    end
    out[k] = { q = p.q, v = p.v, G = G and G(p.q), generators = generators }
  end
  return out
end

local function check_system(D, full, points)
  local Ld = D.Ld
  if not Ld.system then
    system.compare(full, Ld, with_directions(D, full, points))
  elseif Ld.system ~= full and (Ld.system.L ~= full.L or Ld.system.params ~= full.params) then
    error(OTHER:format(("of %s, not of %s"):format(tostring(Ld.system), tostring(full))), 0)
  end
end

---- invariance ----

-- momenta -D1 Ld, D2 Ld in the coordinates (theta, x)
local function momenta(D, at, q0, q1)
  return places.pulled(at.J0, D.Ld:legendre_minus(q0, q1)),
    places.pulled(at.J1, D.Ld:legendre_plus(q0, q1))
end

local PLACES = { 0, 0.9, -2.1 } -- of theta at q0, where Ld is looked at, and one of check.AWAY
local SAME = 1e-8

-- the pairs of shapes at which Ld is looked at, one a point of L, and where the group is then
local function looks_of(D)
  local info, out = D.info, {}
  for k, p in ipairs(info.points) do
    local y, psi, places = {}, {}, {}
    local x, u = model.split(info, p.q), model.split(info, p.v)
    for j = 1, info.d do y[j] = x[j] + math.min(D.h, 0.1) * u[j] end
    for a = 1, info.m do psi[a] = 0.2 + 0.1 * a end
    local far = check.AWAY[(k - 1) % #check.AWAY + 1]
    for l, place in ipairs { PLACES[1], PLACES[2], PLACES[3], far } do
      places[l] = {}
      for a = 1, info.m do places[l][a] = a * place end
    end
    out[k] = { x0 = x, x1 = y, psi = psi, places = places, action = D.h * p.energy }
  end
  return out
end

-- does Ld depend on theta1 - theta0 alone, -D1 Ld = D2 Ld along the group?
-- usual: sizes of the momenta along it, where they are known; gives them
local function check_symmetry(D, looks, usual)
  local info, seen, sizes_known = D.info, {}, usual
  usual = usual or {}
  for _, look in ipairs(looks) do
    for _, theta in ipairs(look.places) do
      local fine, at, p0, p1 = blame.try(function()
        local at = places.of(D, look, theta)
        return at, momenta(D, at, at.q0, at.q1)
      end)
      if fine then seen[#seen + 1] = { p0 = p0, p1 = p1, look = look, theta = theta, at = at } end
    end
  end
  for _, i in ipairs(info.cyclic) do
    local sizes = {}
    for k, one in ipairs(seen) do sizes[k] = abs(one.p0[i]) end
    usual[i] = sizes_known and usual[i] or lists.middle(sizes)
  end
  for _, one in ipairs(seen) do
    for _, i in ipairs(info.cyclic) do
      local a, b = one.p0[i], one.p1[i]
      local function defect(q0, q1)
        local p0, p1 = momenta(D, one.at, q0, q1)
        return p0[i] - p1[i]
      end
      if abs(a - b) > SAME * max(abs(a), usual[i])
        and abs(a - b) > places.noise(one.at, defect) then
        error(("this Ld is not invariant: its momenta along '%s' are %.6g at q0 and %.6g at q1, "
          .. "for x0 = %s, x1 = %s, with the group at %.6g"):format(info.names[i], a, b,
          check.text(one.look.x0), check.text(one.look.x1), one.theta[1]), 0)
      end
    end
  end
  return usual
end

local FAR = 40 -- of group coordinates

-- d/ds of a formula Ld at ((theta + s e_a, x0), (theta + psi + s e_a, x1)), of z = (theta, psi,
-- x0, x1)
local function rate_along(D, a)
  local info, n = D.info, D.info.m + D.info.d
  local m, d = info.m, info.d
  local chart = info.ambient and info.ambient.chart or function(z) return z end
  local rate = core.derivative(function(s, z)
    local theta, there = {}, {}
    for b = 1, m do
      theta[b] = z[b] + (a == b and s or 0)
      there[b] = theta[b] + z[m + b]
    end
    return D.action.value(chart(model.embed(info, lists.part(z, 2 * m, d), theta)),
      chart(model.embed(info, lists.part(z, 2 * m + d, d), there)))
  end, "number", 2 * n)
  return function(z) return rate(0 * z[1], z)[1] end
end

-- the looks as such lists, with the group at either end
local function samples_of(D, looks)
  local out, m = {}, D.info.m
  for k, look in ipairs(looks) do
    local z, side = {}, k % 2 == 0 and 1 or -1
    for a = 1, m do z[a], z[m + a] = side * FAR / 3, side * look.psi[a] end
    for _, x in ipairs { look.x0, look.x1 } do
      for j = 1, #x do z[#z + 1] = x[j] end
    end
    out[k] = z
  end
  return out
end

-- the same between the looks, of a formula: where its bounds leave something it is looked for
local function check_between(D, looks, usual)
  local m, d = D.info.m, D.info.d
  local low, high = everywhere.box(samples_of(D, looks))
  for a, i in ipairs(D.info.cyclic) do
    local function look(z)
      local theta = lists.entries(lists.part(z, 0, m))
      check_symmetry(D, { { x0 = lists.part(z, 2 * m, d), x1 = lists.part(z, 2 * m + d, d),
        psi = lists.part(z, m, m), places = { theta } } }, usual)
    end
    everywhere.search(rate_along(D, a), low, high, SAME * usual[i], look)
  end
end

---- all of it ----

-- the points at which L was looked at, in the coordinates of Ld
local function points_of(info)
  if not info.ambient then return info.points end
  local out = {}
  for i, p in ipairs(info.points) do
    local q, v = info.ambient.lift(p.q, p.v)
    out[i] = { q = q, v = v }
  end
  return out
end

--- Raises where the system has a force or rolling constraints that Ld has not, or the time, for
-- which there is no place in an Ld, or Ld (left out: that of a rule in the coordinates (theta, x))
-- has a constraint of its own.
function M.places(info, full, Ld)
  local given = full.given
  if given.force and not (Ld and Ld.force) or given.rolling and not (Ld and Ld.rolling) then
    routh.need_free(info, "discrete")
  end
  routh.need_autonomous(info, "discrete")
  if not Ld then return end
  check_own_constraint(full, Ld, points_of(info))
  check_own_rolling(full, Ld, points_of(info))
end

--- Raises where D.Ld has not the symmetry of the shape, or is of another system.
function M.given(D, full)
  local looks = looks_of(D)
  if D.forces then forces.check(D, looks) end
  local usual = check_symmetry(D, looks)
  if not D.Ld.system and D.action.inner == 0 then check_between(D, looks, usual) end
  check_system(D, full, points_of(D.info))
end

return M
