--- A system on a group in coordinates about a section, for Routh reduction by an abelian group that
-- acts on it: g = action(theta, section(x)), so that y = (theta, x) are coordinates near the
-- section and the velocity is linear in y', xi = J(y) y'. Moves of theta are then moves of
-- coordinates.
local blame = require "dm.base.blame"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local place = require "dm.group.place"

local M = {}

local WHERE = "system:routh"

local max, min = math.max, math.min

-- the numbers that give the velocity of a curve at the identity, by the entries of its rate
local function read_velocity(P, d)
  local N = #P.flat(P.kit.identity())
  local J = core.derivative(function(e) return core.vector(P.near(e)) end, d)(core.zeros(d))
  local E = linear.fill(N, d, function(i, a) return J[i][a] end)
  return (E:transpose() * E):inverse() * E:transpose()
end

-- xi of (y, y') for an element g(y)
local function velocity_of(system, element, n)
  local own, P = system.place, place.of(system.Q, { columns = "matrix" })
  local kit, read = P.kit, read_velocity(P, n)
  local slope = core.derivative(function(y) return core.vector(P.flat(element(y))) end, n)
  return function(y, rate)
    local g, out = element(y), core.vector(slope(y) * core.vector(rate))
    local w = kit.left_tangent(kit.inverse(g), g, P.element(lists.entries(out)))
    local xi = read * core.vector(P.flat(w))
    return own.right and kit.Ad(g, xi) or xi
  end
end

-- the matrix J of xi = J y'
local function rates_at(velocity, n, y)
  return linear.matrix_of(function(u) return velocity(y, u) end, n)
end

-- theta = 0, x = 0, which may be where the chart is singular, and points near it
local function starts(n)
  local out = { core.zeros(n) }
  for k = 1, 8 do
    local y = core.zeros(n)
    for i = 1, n do y[i] = (0.3 + 0.2 * (k // 2)) * (k % 2 == 0 and 1 or -1) / i end
    out[#out + 1] = y
  end
  return out
end

-- somewhere the group leaves the section, and no two shapes are one: y are coordinates there
local function check_chart(velocity, n)
  for _, y in ipairs(starts(n)) do
    local fine, values = blame.try(function()
      return linear.singular_values(rates_at(velocity, n, y))
    end)
    if fine and min(table.unpack(values)) > 1e-9 * max(table.unpack(values)) then return end
  end
  option.fail(WHERE, "no shape was found at which the group crosses the section: does the group "
    .. "move elements along it, or do many shapes give one element?")
end

-- from states of the system to those of (theta, x) and back
local function transfer(system, element, velocity, n)
  local G, own = system.Q, system.place
  local P = place.of(G, { columns = "matrix" })
  local T = { system = system, on_group = true, given = true }
  -- Newton's method for g(y) = g0 from y; nothing where it leads nowhere
  local function find(g0, y)
    for _ = 1, 50 do
      local fine, step = blame.try(function()
        local g = element(y)
        local off = G:log(G:compose(G:inverse(g), g0))
        return rates_at(velocity, n, y):solve(own.right and G:Ad(g, off) or off)
      end)
      if not fine or step:norm() ~= step:norm() then return nil end
      y = y + step
      if step:norm() < 1e-13 * (1 + y:norm()) then return y end
    end
  end
  function T.split(q, xi)
    local g0 = own.kit.element(q)
    for _, start in ipairs(starts(n)) do
      local y = find(g0, start)
      if y then return y, rates_at(velocity, n, y):solve(core.vector(xi)) end
    end
    option.fail(WHERE, "no theta and shape were found with action(theta, section(x)) = q: is q "
      .. "near the section, and does the action move it?")
  end
  function T.lift(y, u) return element(y), velocity(y, u) end
  local function size(g) return core.vector(P.flat(g)):norm() end
  -- |g| |g^-1|: what of a velocity g^-1 dg is lost to rounding
  function T.condition(y)
    local g = element(core.vector(y))
    return size(g) * size(P.kit.inverse(g))
  end
  -- (y, p_y) -> flat coordinates near to `last`, mu: J^T mu = p_y
  function T.point(y, p, last)
    y = core.vector(y)
    local q = own.flat(element(y))
    return last and own.follow(q, last) or q,
      rates_at(velocity, n, y):transpose():solve(core.vector(p))
  end
  return T
end

-- covectors on the group as covectors of y
local function pulled(velocity, n, y, f)
  local out = {}
  for k = 1, n do out[k] = core.vector(f):dot(velocity(y, linear.unit(n, k))) end
  return core.vector(out)
end

-- L, constraints and force in y
local function pulled_back(system, element, velocity, n, names)
  local given = system.given
  local out = { Q = core.R(n), params = given.params, name = system.name, coordinates = names }
  function out.L(y, u, ...) return given.L(element(y), velocity(y, u), ...) end
  if given.force then
    function out.force(y, u, ...)
      return pulled(velocity, n, y, given.force(element(y), velocity(y, u), ...))
    end
  end
  if given.rolling then
    function out.rolling(y, u, ...) return given.rolling(element(y), velocity(y, u), ...) end
  end
  if given.reaction then
    function out.reaction(y, u, ...)
      local rows = {}
      for i, row in ipairs(check.rows(given.reaction(element(y), velocity(y, u), ...))) do
        rows[i] = pulled(velocity, n, y, row)
      end
      return rows
    end
  end
  if given.constraint then
    function out.constraint(y, ...) return given.constraint(element(y), ...) end
  end
  return core.system(out)
end

local function need_function(options, key, what)
  if type(options[key]) ~= "function" then
    option.fail(WHERE, "on a group option '%s' must be %s (got %s)", key, what,
      option.got(options[key]))
  end
  return options[key]
end

-- the map y -> g
local function read_chart(system, options, m, n)
  local action = need_function(options, "action", "function(theta, g) of an abelian group")
  local section = need_function(options, "section", "function(x), an element for every shape x")
  if math.type(m) ~= "integer" or m < 1 or m >= n then
    option.fail(WHERE, "option 'dimension' must be a whole number from 1 to %d", n - 1)
  end
  return function(y)
    local theta = m == 1 and y[1] or lists.part(y, 0, m)
    return system.place.kit.element(action(theta, section(lists.part(y, m, n - m))))
  end
end

--- What reduce/routh/section.lua makes of a system on coordinates: the system in (theta, x), the
-- options of the reduction by its first m coordinates, and how states go to and fro.
function M.split(system, options)
  local n, m = system.Q.dimension, options.dimension or 1
  if not system.given.L then option.fail(WHERE, "this H has no Lagrangian") end
  if options.cyclic ~= nil or options.action == nil then
    option.fail(WHERE, "%s has no cyclic coordinates: give action = function(theta, g) ... end and "
      .. "section = function(x) ... end; dm.euler_poincare reduces by the whole group",
      tostring(system.Q))
  end
  for _, key in ipairs { "at", "branch" } do
    if options[key] ~= nil then
      option.fail(WHERE, "option '%s' is for systems on coordinates; on a group give 'section'",
        key)
    end
  end
  local element = read_chart(system, options, m, n)
  local velocity = velocity_of(system, element, n)
  check_chart(velocity, n)
  local other, names = { mu = options.mu, connection = options.connection, cyclic = {} }, {}
  for a = 1, m do
    other.cyclic[a], names[a] = a, m == 1 and "theta" or "theta" .. a
  end
  for i = m + 1, n do names[i] = "x" .. i - m end
  local T = transfer(system, element, velocity, n)
  if options.q ~= nil then
    local xi = option.need(options, "v", WHERE, "the velocity at q")
    other.q, other.v = T.split(options.q, lists.numbers("system:routh: option 'v'", xi, n,
      "%s must be %d number%s (got %s)"))
  end
  return pulled_back(system, element, velocity, n, options.names or names), other, T
end

return M
