--- A formula Ld(g0, g1) of a script with what acts beside it: its momenta and step. Covectors
-- are those of the body: F1 . e0 + F2 . e1 is the work on g0 exp(e0), g1 exp(e1), and rows of G and
-- E are derivatives along these, too (docs/theory/discrete-forces.md).
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local part = lists.part

---- what a script gives ----

local FORMS = { constraint = "(g) that returns what shall be zero",
  rolling = "(g0, g1 [, h]) that returns what shall be zero",
  reaction = "(g0, g1 [, h]) that returns a row for every rolling one",
  force = "(g0, g1 [, h]) that returns { F1, F2 }, the forces at g0 and at g1" }

--- Raises for functions that are none, or of which one is missing.
function M.check(given, where)
  for _, key in ipairs { "constraint", "rolling", "reaction", "force" } do
    if given[key] ~= nil then options.callable(given, key, where, FORMS[key]) end
  end
  if given.rolling and not given.reaction then
    options.fail(where, "field 'reaction' is missing: the rows that span the annihilator of E_d at "
      .. "g0, in whose directions 'rolling' constraints of a discrete Lagrangian react")
  end
  if given.reaction and not given.rolling then
    options.fail(where, "field 'reaction' gives the directions in which 'rolling' constraints "
      .. "react, and there are none")
  end
end

-- f(g0, g1, h) as a function of (g, xi), g1 = g exp(h xi)
local function along(Ld, f, key)
  local kit, single = kits.of(Ld.Q), f and options.single(f, key)
  return f and function(g, xi) return single(g, kit.compose(g, kit.exp(Ld.h * xi)), Ld.h) end
end

--- The system that steps of Ld are run with: its L only says how they begin, and its constraints
-- check starts.
function M.frame(Ld)
  return core.stand_in { Q = Ld.Q, name = Ld.name, L = function(_, xi) return xi:dot(xi) / 2 end,
    constraint = Ld.constraint, crossings = Ld.crossings,
    rolling = along(Ld, Ld.rolling, "rolling"), reaction = along(Ld, Ld.reaction, "reaction") }
end

---- momenta ----

-- f of flat coordinates of g0 and g1
local function of_pair(Ld, f)
  local P = Ld.place
  return function(q0, q1) return f(P.element(q0), P.element(q1), Ld.h) end
end

-- Ld(g0 near(e0), g1 near(e1)) of (q0, e0, q1, e1)
local function moved(Ld)
  local P, f = Ld.place, of_pair(Ld, Ld.Ld)
  return function(q0, e0, q1, e1)
    return f(P.carry(q0, P.near(e0)), P.carry(q1, P.near(e1)))
  end
end

local HALVES = "force of a discrete Lagrangian must return { F1, F2 }, %d numbers each (got %s)"

-- F1, F2 of (q0, q1)
local function forces_of(Ld)
  local f, d = of_pair(Ld, options.single(Ld.force, "force")), Ld.place.dimension
  return function(q0, q1)
    local both = f(q0, q1)
    if lists.count(both) ~= 2 then error(HALVES:format(d, lists.got(both)), 0) end
    return kits.vector(both[1], d, "force: F1"), kits.vector(both[2], d, "force: F2")
  end
end

--- Calls the forces with symbols, so that what is wrong with them is told where they are given.
function M.try_forces(Ld)
  local f, N = forces_of(Ld), Ld.place.size
  local function numbers(F, name) -- those that are none are so everywhere
    return lists.numbers("force: " .. name, F, #F, "")
  end
  core.trace(function(q0, q1)
    local F1, F2 = f(q0, q1)
    return lists.joined(numbers(F1, "F1"), numbers(F2, "F2"))
  end, N, N)
end

--- The value, momenta and two-form of (q0, q1); keep(f, lengths, make) as group/discrete has it.
function M.way(Ld, keep)
  local N, d = Ld.place.size, Ld.place.dimension
  local zero, f = core.zeros(d), moved(Ld)
  local forces = Ld.force and forces_of(Ld)
  local slopes = keep(function(q0, q1) return f(q0, zero, q1, zero) end, { N, N },
    function() return core.derivative(f, N, d, N, d) end)
  local way = {}
  function way.value(q0, q1) return f(q0, zero, q1, zero) end
  function way.momenta(q0, q1)
    local y = slopes()(q0, zero, q1, zero)
    local p0, p1 = -part(y, N, d), part(y, 2 * N + d, d)
    if not forces then return p0, p1 end
    local F1, F2 = forces(q0, q1)
    return p0 - F1, p1 + F2
  end
  -- -D1 D2 Ld
  function way.two_form(q0, q1)
    local H = core.trace(f, N, d, N, d):hessian(q0, zero, q1, zero)
    return linear.fill(d, d, function(i, j) return -H[N + i][2 * N + d + j] end)
  end
  return way
end

---- the step ----

-- sum_c x[first + c] row_c
local function combined(rows, x, first, d)
  local sum = core.zeros(d)
  for c = 1, #rows do sum = sum + kits.vector(rows[c], d, "a row of reactions") * x[first + c] end
  return sum
end

-- g of (q1), and its rows at q0
local function holonomic_of(Ld, keep)
  local P, N, d = Ld.place, Ld.place.size, Ld.place.dimension
  local function g(q) return lists.entries(Ld.constraint(P.element(q))) end
  local slopes = keep(g, { N }, function()
    return core.derivative(function(q, e) return g(P.carry(q, P.near(e))) end, N, d)
  end)
  local function rows(q, count)
    local J, out = slopes()(q, core.zeros(d)), {}
    for c = 1, count do out[c] = part(J[c], N, d) end
    return out
  end
  return g, rows
end

-- E of (q0, q1); one that is alone may be one row
local function reactions_of(Ld)
  local f = of_pair(Ld, Ld.reaction)
  return function(q0, q1)
    local rows = f(q0, q1)
    return kits.is_scalar(rows[1]) and { rows } or rows
  end
end

-- what the impulses x[d + 1 ...] are to p0, and what shall be zero at the end, of (q0, q1, x); how
-- many there are
local function ties_of(Ld, keep)
  local d, facts = Ld.place.dimension, Ld.frame:structure()
  local k, l = facts.constraints or 0, facts.rolling or 0
  local g, rows, phi, E
  if k > 0 then g, rows = holonomic_of(Ld, keep) end
  if l > 0 then phi, E = of_pair(Ld, Ld.rolling), reactions_of(Ld) end
  local function pull(q0, q1, x)
    local sum = g and combined(rows(q0, k), x, d, d) or core.zeros(d)
    return E and sum + combined(E(q0, q1), x, d + k, d) or sum
  end
  local function held(q0, q1)
    local empty = {}
    return lists.joined(g and g(q1) or empty, phi and lists.entries(phi(q0, q1)) or empty)
  end
  return pull, held, k, l
end

--- The step of Ld as a rule,
--   p0 = -D1 Ld - F1 - G^T lambda - E^T mu,  g(g1) = 0,  phi(g0, g1) = 0,  p1 = D2 Ld + F2,
-- g1 = g0 exp(x). What the root leaves of the first has a mean; carried on to p1 by the coadjoint
-- action it moves no momentum map. keep: as for M.way.
function M.rule(Ld, keep)
  local kit, P, d = kits.of(Ld.Q), Ld.place, Ld.place.dimension
  local pull, held, k, l = ties_of(Ld, keep)
  local ties = k + l
  -- g1; what is left of p0; p1
  local function ends(y, x)
    local xi = part(x, 0, d)
    local g1 = kit.compose(y.q, kit.exp(xi))
    local q0, q1 = core.vector(P.flat(y.q)), core.vector(P.flat(g1))
    local p0, p1 = Ld.way.momenta(q0, q1)
    if ties > 0 then p0 = p0 - pull(q0, q1, x) end
    return g1, y.p - p0, p1, xi, q0, q1
  end
  return core.tied_step { name = Ld.name or "del", unknowns = d + ties, order = 1,
    holonomic = k, rolling = l,
    start = function() return core.zeros(d + ties) end,
    equation = function(y, x)
      local _, left, _, _, q0, q1 = ends(y, x)
      return ties > 0 and lists.joined(-left, held(q0, q1)) or -left
    end,
    next = function(y, x)
      local g1, left, p1, xi = ends(y, x)
      return { q = g1, p = p1 + kit.coAd(kit.exp(-xi), left) }
    end }
end

return M
