--- A group as the configuration space of a system (docs/design/groups.md): flat coordinates of
-- elements, functions of elements as functions of coordinates. starts.lua has starts of runs.
--
-- A place is what a system keeps of its space, made by `M.of`:
--   space, kit     the group
--   size, dimension  N flat coordinates, d entries of velocities and momenta
--   right          is xi the spatial velocity?
--   flat(g)        -> list of N numbers; element(list) -> g
--   carry(a, b)    -> flat coordinates of the product of two elements, without a branch
--   exp, cayley, near  maps from the algebra to flat coordinates
--   dexp           that of the kit without a branch, within a chart, or nothing
--   tidy(list)     coordinates nearer to the group by what rounding left
--   apart(list)    coordinates of an element near the identity less those of the identity, where a
--                  difference would lose digits
--   mend(list)     what tidy adds
--   follow(list, last)  those of the same element that are near to `last`
local changes = require "dm.group.change"
local core = require "dm.core"
local flats = require "dm.group.flat"
local hamiltonians = require "dm.base.hamiltonian"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local spheres = require "dm.group.sphere"
local wanted = require "dm.base.options"

local M = {}

---- what a place is ----

local COLUMNS = { flat = true, matrix = true }
local SIDES = { left = true, right = true }

local function choice(options, key, known, usual, words)
  local value = options[key]
  if value == nil then return usual end
  if not known[value] then
    error(("field '%s' must be %s (got %s)"):format(key, words, tostring(value)), 0)
  end
  return value
end

--- The place of a system on the group `space`.
function M.of(space, options)
  local kit = kits.of(space)
  if kit.manifold then
    error(("field 'Q': %s has no global coordinates: systems live on products of groups, or "
      .. "on products of dm.R(n), dm.T(n), dm.S(n)"):format(tostring(space)), 0)
  end
  local matrix = choice(options, "columns", COLUMNS, "flat", [["flat" or "matrix"]]) == "matrix"
  local right = choice(options, "trivialization", SIDES, "left", [["left" or "right"]]) == "right"
  local place = flats.of(kit, matrix)
  place.space, place.kit, place.right, place.dimension = space, kit, right, kit.dimension
  place.size, place.liftable = #place.flat(kit.identity()), kits.is_liftable(kit)
  return place
end

---- functions of a state ----

-- the first d entries of a vector of N
local function body(place, v) return v:slice(1, place.dimension) end

-- one list for each factor is a likely mistake
local function refuse_lists(place, v, what)
  local first = type(v) == "table" and kits.class_of(v[1])
  if first ~= "table" and first ~= "dm.vector" then return end
  error(("%s must be one flat list of %d numbers%s (got a list of lists)"):format(what,
    place.dimension, place.kit.parts and ", factor after factor" or ""), 0)
end

--- d numbers with zeros behind them, N in all.
function M.padded(place, v, what)
  refuse_lists(place, v, what)
  local x, out = kits.vector(v, place.dimension, what), core.zeros(place.size)
  for i = 1, place.dimension do out[i] = x[i] end
  return out
end

--- f(g, xi, ...) as a function of (q, v, ...).
function M.of_velocity(place, f)
  return function(q, v, ...) return f(place.element(q), body(place, v), ...) end
end

--- f(g, ...) as a function of (q, ...).
function M.of_position(place, f)
  return function(q, ...) return f(place.element(q), ...) end
end

-- what watches, records and events see: f(g, xi, t, mu)
function M.observable(place, f)
  return function(q, v, t, p) return f(place.element(q), body(place, v), t, body(place, p)) end
end

-- L with a unit mass for every entry of v behind xi
local function lagrangian(place, f)
  local own = M.of_velocity(place, f)
  return function(q, v, ...)
    local value = own(q, v, ...)
    if not kits.is_scalar(value) then return value end
    for i = place.dimension + 1, place.size do value = value + 0.5 * v[i] * v[i] end
    return value
  end
end

-- H with unit masses for the entries of p behind mu
local function hamiltonian(place, f) return lagrangian(place, f) end

-- a covector of d entries as one of N
local function covector(place, f)
  local own = M.of_velocity(place, f)
  return function(...) return M.padded(place, own(...), "what force returns") end
end

-- rows of d entries as rows of N; a constraint that is alone may be one row
local function covectors(place, f)
  local own = M.of_velocity(place, f)
  return function(...)
    local rows, out = own(...), {}
    if type(rows) ~= "number" and kits.is_scalar(rows[1]) then rows = { rows } end
    for i = 1, #rows do out[i] = M.padded(place, rows[i], "a row of what reaction returns") end
    return out
  end
end

local REFUSED = { coordinates = "the coordinates of a group have names of their own",
  derivatives = "derivatives on a group are exact" }

--- The options of dm.system on R^N of a system on a group, and its place.
function M.unfold(given)
  local options, out = spheres.unfold(given), {}
  for key, why in pairs(REFUSED) do
    if options[key] ~= nil then
      error(("field '%s': %s"):format(key, why), 0)
    end
  end
  local place = M.of(options.Q, options)
  for key, value in pairs(options) do out[key] = value end
  local function wrap(key, how)
    local f = options[key]
    if type(f) == "function" then out[key] = how(place, wanted.single(f, key)) end
  end
  wrap("L", lagrangian)
  wrap("H", hamiltonian)
  wrap("constraint", M.of_position)
  wrap("rolling", M.of_velocity)
  wrap("control", M.of_velocity)
  wrap("force", covector)
  wrap("reaction", covectors)
  return out, place
end

--- L(g, xi, t, params) of the H that the system was given, by entries of matrices: other
-- coordinates of symbols are long expressions.
function M.on_elements(place)
  local P = M.of(place.space, { columns = "matrix" })
  return hamiltonians.on_elements(place.given.H, P.size, P.dimension, P.flat, P.element)
end

---- charts about an element, as steps use them ----

local function append(out, list)
  for i = 1, #list do out[#out + 1] = list[i] end
  return out
end


-- the left differential of tau: g^-1 g' of tau(xi), as d/dt tau(xi) = tau(xi) hat(left(xi, xi'))
local DIFFERENTIALS = { exp = "dexp", cayley = "dcay" }

-- tau and its differential on coordinates, tau on elements: "exp", "cayley", "pade(2)" ...
local function maps(place, tau)
  local kit, name, k = place.kit, DIFFERENTIALS[tau], tonumber(tau:match "^pade%((%d)%)$")
  if not k then
    local slope = tau == "exp" and kit.slope or kit[name]
    return place[tau], place[name] or slope, kit[tau]
  end
  if not kit.pade or not place.cayley then return end
  local cayley, dcay = place.cayley, place.dcay or kit.dcay
  return function(xi) return cayley((kit.pade(k, xi))) end,
    function(xi, rate) return dcay(kit.pade(k, xi, rate)) end,
    function(xi) return kit.cayley((kit.pade(k, xi))) end
end

--- What a step asks of the chart g = g0 tau(xi) (right: tau(xi) g0), tau = exp, cayley or pade(k),
-- functions that are traced: chart(q0, e, xi, rate) gives the coordinates of g0 near(e) tau(xi),
-- then the velocity of xi(t) with this rate; finish(q0, xi, mu) those of g0 tau(xi), then mu
-- carried there by the coadjoint action, then squares of the angles of exp(xi), which a step bounds
-- (dm_lie_reach in integ/lie/lie.h). turns(q0, mu, x) gives, for every axis a of the algebra, what
-- the coordinates of g0 exp(x e_a) and mu carried there have more than those of g0 and mu, for x of
-- any size, then what is to be added to those of g0 for rounding; nothing where that has no closed
-- form. Nothing at all where the group has no such tau.
function M.chart(place, tau)
  local kit, right = place.kit, place.right
  local map, slope, element = maps(place, tau)
  local arcs = kit.arcs
  if not map or not slope then return end
  local function about(q0, xi, e)
    local list = kits.list_of(q0)
    if right then return place.carry(map(xi), e and place.carry(place.near(e), list) or list) end
    return place.carry(list, e and place.carry(place.near(e), map(xi)) or map(xi))
  end
  local function chart(q0, e, xi, rate)
    return append(kits.list_of(about(q0, xi, e)), slope(right and xi or -xi, rate))
  end
  local function finish(q0, xi, mu)
    local f = element(xi)
    local carried = kit.coAd(right and f or kit.inverse(f), mu)
    local out = append(kits.list_of(place.tidy(about(q0, xi))), carried)
    return arcs and append(out, arcs(xi)) or out
  end
  local function turns(q0, mu, x)
    local out, list = {}, kits.list_of(q0)
    for a = 1, place.dimension do
      append(out, kits.list_of(place.turn(a, x, list, right)))
      append(out, kits.list_of(place.turned(a, right and -x or x, mu)))
    end
    return append(out, place.mend(list))
  end
  return chart, finish, tau == "exp" and place.turn and turns or nil
end

--- change(q0, xi, mu) of the same chart: what finish has more than q0 and mu, then the squares of
-- angles, as change.lua has it; or nothing.
function M.change(place, tau)
  local map, slope, element = maps(place, tau)
  return changes.of(place, map, slope, element, place.kit.arcs)
end

-- x[i] * f(y[i])
local function times(x, y, f)
  local out = {}
  for i = 1, #x do out[i] = f(x[i], y[i]) end
  return out
end

local function quotient(a, b) return a / b end
local function product(a, b) return a * b end

--- The homogeneous lift (src/mech/group_homogeneous.c), functions that are traced: rates(q, v)
-- gives coordinates on the group, the velocity there, the rates of the logarithms of all scales;
-- momenta(q, p) the same coordinates, the momentum, and what each coordinate was divided by.
-- Nothing where coordinates are not homogeneous.
function M.homogeneous(place)
  if not place.velocity then return end
  local N, d = place.size, place.dimension
  local X = flats.directions(place, N, d, place.right)
  local function rates(q, v)
    local s = place.scale(q)
    local unit = times(kits.list_of(q), s, quotient)
    local rate = place.velocity(unit, times(kits.list_of(v), s, quotient))
    local xi = lists.part(rate, 0, d)
    if place.right then xi = place.kit.Ad(place.element(unit), xi) end
    append(unit, kits.list_of(xi))
    for k = 1, place.scales do unit[#unit + 1] = rate[d + k] end
    return unit
  end
  local function momenta(q, p)
    local s = place.scale(q)
    local unit = times(kits.list_of(q), s, quotient)
    local mu = X(unit):transpose() * core.vector(times(kits.list_of(p), s, product))
    return append(append(unit, kits.list_of(mu)), s)
  end
  return rates, momenta
end

---- rows ----

-- "R31" or "R31_2": row, column, factor
local function entry_of(name)
  local i, j, k = name:match "^R(%d)(%d)$", nil, nil
  i, j, k = name:match "^R(%d)(%d)_?(%d*)$"
  if not i then return end
  return tonumber(i), tonumber(j), tonumber(k)
end

--- The function of an element that an entry of its matrix is, or nothing: "R31", of factor k
-- "R31_k".
function M.entry(place, name)
  local i, j, k = entry_of(name)
  local kit = place.kit
  if k and kit.parts then kit = kit.parts[k] end
  if not i or not kit or not kit.matrix then return end
  local m = kit.matrix(kit.identity())
  if i < 1 or j < 1 or i > m.rows or j > m.columns or k and not place.kit.parts then return end
  return function(g)
    if k then g = g[k] end
    return kit.matrix(g)[i][j]
  end
end

--- The column of such an entry of the elements of a path, or nothing.
function M.column(place, path, name)
  local entry, out, q = M.entry(place, name), {}, path.q
  if not entry then return end
  for row = 1, #path do out[row] = entry(q[row]) end
  return core.vector(out)
end

return M
