--- From a symmetry in the coordinates of Q to cyclic ones: q = action(theta, section(x)) makes L a
-- function of (theta, x) that does not depend on theta, if the action is abelian and leaves L as it
-- is.
local blame = require "dm.base.blame"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local kits = require "dm.group.kit"
local default_section = require "dm.reduce.routh.default_section"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local orbit = require "dm.reduce.routh.orbit"

local M = {}

local abs, max, min = math.abs, math.max, math.min

-- the map of an action given as a function, or as a dm.action, and the dimension of its group
local function read_action(options)
  local action = options.action
  if type(action) == "function" then
    return core.one(action, "action"), options.dimension or 1
  end
  local fine, map = blame.try(function() return action.map end)
  if fine and not map and blame.try(function() return action.dimension, action.exp end)
    and action.name then
    error(("option 'action': %s is a group, which acts in many ways: give function(theta, q) or "
      .. "a dm.action"):format(tostring(action)), 0)
  end
  if not fine or not map then
    error("option 'action' must be a function of (theta, q) that gives the point to which theta "
      .. "moves q, or a dm.action", 0)
  end
  local group = action.group
  if group and not kits.of(group).abelian then
    error(("option 'action': %s is not abelian, and Routh reduction is for abelian groups: give "
      .. "the action of a subgroup, such as the turns about "
      .. "one axis"):format(tostring(group)), 0)
  end
  if not action.act then
    local m = options.dimension or group and group.dimension or 1
    return function(theta, q) return map(theta, q) end, m
  end
  -- elements are lists or vectors for some groups; exp makes them of angles
  local m = options.dimension or group.dimension
  return function(theta, q) return action:act(group:exp(theta), q) end, m
end

local function check_dimension(m, n)
  if math.type(m) ~= "integer" or m < 1 or m >= n then
    error(("option 'dimension' must be a whole number from 1 to %d, the dimension of Q less one")
      :format(n - 1), 0)
  end
end

-- a point of Q that a function of the user gave, as a vector
local function point(value, n, option)
  if lists.count(value) ~= n then
    error(("option '%s' must return a point of Q: %d numbers (got %s)")
      :format(option, n, lists.got(value)), 0)
  end
  local is, out = blame.try(core.vector, value)
  if not is then
    error(("option '%s' must return a point of Q: %s")
      :format(option, tostring(out):gsub("^.-%.lua:%d+: ", "")), 0)
  end
  return out
end

-- g . q with theta a number where the group has one dimension
local function mover(map, m)
  return function(theta, q)
    return point(map(m == 1 and theta[1] or core.vector(theta), core.vector(q)), #q, "action")
  end
end

-- columns of d(g . q)/dtheta at theta = 0
local function generators(move, m, q)
  local J = core.trace(function(theta) return move(theta, q) end, m):jacobian(lists.zeros(m))
  local columns = {}
  for a = 1, m do
    columns[a] = {}
    for i = 1, #q do columns[a][i] = J[i][a] end
  end
  return columns
end

-- a point where L is finite and that the group moves in all its directions: a unit vector if one
-- will do, so that what is held is zero
local function somewhere(move, m, n, L, points)
  local rest = core.vector(lists.zeros(n))
  local function will_do(q)
    local fine, value = blame.try(L, q, rest, 0)
    local moves, columns = blame.try(generators, move, m, q)
    return fine and value == value and abs(value) < math.huge and moves
      and default_section.moved_most(columns, n)
  end
  for i = 1, n do
    local q = lists.zeros(n)
    q[i] = 1
    if will_do(core.vector(q)) then return q end
  end
  for _, p in ipairs(points) do
    if will_do(p.q) then return p.q end
  end
  error("no point was found that the group moves in as many directions as it has dimensions: "
    .. "give 'section', or a point 'at' near which "
    .. "one is made", 0)
end

-- the default section through the orbit of `at`, where its shape is there, and the theta
-- that the group moves it by so that `at` is at theta = 0
local function slice(move, m, n, at)
  local S = default_section.through(move, m, n, at)
  if not S then
    error(("the group does not move the point %s in as many directions as it has dimensions (it "
      .. "is held by a part of the group): take another one")
      :format(check.text(at)), 0)
  end
  local home, back = {}, {}
  for i = 1, n do
    if not S.held[i] then home[#home + 1] = S.q[i] end
  end
  for a = 1, m do back[a] = -S.theta[a] end
  return function(x)
    local q, j = {}, 0
    for i = 1, n do
      if S.held[i] then q[i] = S.value[i] else j = j + 1; q[i] = x[j] end
    end
    return core.vector(q)
  end, home, back
end

-- is it an action, and abelian: (a b) q = a (b q) = b (a q)?
local function check_action(move, m, points)
  local function different(p, a, b, what)
    for i = 1, #a do
      if abs(a[i] - b[i]) > 1e-9 * max(1, abs(a[i])) then
        error(("the action is not one of an abelian group: %s at %s"):format(what, check.at(p)), 0)
      end
    end
  end
  local a, b, both = {}, {}, {}
  for k = 1, m do a[k], b[k] = 0.3 + 0.1 * k, -0.7 + 0.2 * k; both[k] = a[k] + b[k] end
  for _, p in ipairs(points) do
    local fine, once, twice, other = blame.try(function()
      return move(both, p.q), move(a, move(b, p.q)), move(b, move(a, p.q))
    end)
    if fine then
      different(p, once, twice, "moving by theta1 and then by theta2 is not moving by their sum")
      different(p, once, other, "the order of two moves makes a difference")
    end
  end
end

-- from states of the system to those of (theta, x) and back
local function transfer(system, S)
  local T, Phi = { system = system }, S.Phi
  local function crossed(J, b, q)
    local fine, x = blame.try(orbit.solve, J, b)
    if fine then return x end
    error(("at %s the group does not cross the section: it does not move this point in all its "
      .. "directions, or along the section; take another one")
      :format(check.text(q)), 0)
  end
  function T.split(q, v)
    local y = orbit.find(S, core.vector(q))
    return y, crossed(Phi:jacobian(y), core.vector(v), q)
  end
  -- near: a shape, where the point has several
  function T.place(q, near)
    local known = near and { Phi = Phi, m = S.m, n = S.n, home = near } or S
    return orbit.find(known, core.vector(q))
  end
  function T.frame(y) return Phi(y), Phi:jacobian(y) end
  function T.lift(y, w) return Phi(y), Phi:jacobian(y) * core.vector(w) end
  -- how many times more round-off an invariant has at y than q: the condition of J, its rows and
  -- columns of one size
  function T.condition(y)
    local values = linear.singular_values(linear.balanced(Phi:jacobian(y)))
    return max(table.unpack(values)) / min(table.unpack(values))
  end
  -- (y, p_y) -> (q, p): J^T p = p_y
  function T.point(y, p)
    local q = Phi(y)
    return q, crossed(Phi:jacobian(y):transpose(), core.vector(p), q)
  end
  return T
end

-- somewhere the group leaves the section: Phi is a chart there
local function check_section(Phi, n)
  local found = check.points(n, function(y) orbit.solve(Phi:jacobian(y), y) end, nil, 1)
  if #found == 0 then
    error("option 'section': no shape was found at which the group crosses it: does the group "
      .. "move points along the section, or do many shapes give one point?", 0)
  end
end

-- the coordinate of the system that is y[k] wherever Phi(y) is, one that the group leaves alone, by
-- name; nil where there is none
local function kept(system, Phi, k, n)
  local found = system.coordinates and lists.plain(system.coordinates) or {}
  for j = 1, 3 do
    local y = core.zeros(n)
    for i = 1, n do y[i] = 0.2 + 0.7548776662466927 * i * j % 1 end
    local q = Phi(y)
    for i = 1, n do found[i] = q[i] == y[k] and found[i] end
  end
  for i = 1, n do
    if found[i] then return found[i] end
  end
end

-- theta and x1, x2, ..., or the system's own names of what is kept
local function default_names(system, Phi, m, n)
  local names, taken = {}, {}
  for i = 1, n do
    local own = i > m and kept(system, Phi, i, n) or nil
    local is_free = own and not taken[own] and not own:find "^x%d+$"
    local usual = i > m and "x" .. i - m or m == 1 and "theta" or "theta" .. i
    names[i] = is_free and own or usual
    taken[names[i]] = true
  end
  return names
end

local function names_of(system, options, Phi, m, n)
  local names = options.names
  if names == nil then names = default_names(system, Phi, m, n) end
  if type(names) ~= "table" or #names ~= n then
    error(("option 'names' must be %d names, of theta (%d) and of the shape (%d)")
      :format(n, m, n - m), 0)
  end
  return names
end

-- the covector F at q as one of (theta, x)
local function pulled(F, J, n)
  local all = {}
  for k = 1, n do
    all[k] = 0
    for i = 1, n do all[k] = all[k] + F[i] * J[i][k] end
  end
  return all
end

-- L, constraints and force in (theta, x)
local function pulled_back(system, Phi, slope, n, names)
  local given = system.given
  local out = { params = given.params, Q = core.R(n), name = system.name, coordinates = names,
    units = system.units }
  out.L = function(y, w, t, p) return given.L(Phi(y), slope(y) * w, t, p) end
  if given.constraint then
    out.constraint = function(y, t, p) return given.constraint(Phi(y), t, p) end
  end
  if given.force then
    out.force = function(y, w, t, p)
      local J = slope(y)
      return pulled(given.force(Phi(y), J * w, t, p), J, n)
    end
  end
  if given.rolling then
    out.rolling = function(y, w, t, p) return given.rolling(Phi(y), slope(y) * w, t, p) end
  end
  if given.reaction then
    out.reaction = function(y, w, t, p)
      local J, rows = slope(y), {}
      for i, row in ipairs(check.rows(given.reaction(Phi(y), J * w, t, p))) do
        rows[i] = pulled(row, J, n)
      end
      return rows
    end
  end
  return core.system(out)
end

--- The system in (theta, x), the options of the reduction by its first m coordinates, and how
-- states go to and fro.
function M.split(system, options)
  local n = system.Q.dimension
  local map, m = read_action(options)
  check_dimension(m, n)
  local move = mover(map, m)
  local section, home, back = core.one(options.section, "section"), nil, lists.zeros(m)
  local given = system.given
  local function L(q, v, t) return given.L(core.vector(q), core.vector(v), t, given.params) end
  local points = check.points(n, L, options.q and { q = options.q, v = options.v })
  option.callable(options, "section", "system:routh", "the shape that gives a point of Q")
  option.callable(options, "branch", "system:routh", "the shape, positive where it is meant")
  -- an action that returns no point of Q is told here
  if points[1] then move(lists.zeros(m), points[1].q) end
  check_action(move, m, points)
  if not section then
    local at = options.at or options.q or somewhere(move, m, n, L, points)
    section, home, back = slice(move, m, n, at)
  end
  local function chart(y)
    local theta, x = {}, {}
    for i = 1, m do theta[i] = back[i] == 0 and y[i] or y[i] + back[i] end
    for i = m + 1, n do x[i - m] = y[i] end
    return move(theta, point(section(core.vector(x)), n, "section"))
  end
  local Phi = core.trace(chart, n)
  local slope = core.derivative(chart, n)
  if options.section then check_section(Phi, n) end
  local split = pulled_back(system, Phi, slope, n, names_of(system, options, Phi, m, n))
  local T = transfer(system,
    { Phi = Phi, m = m, n = n, home = home, branch = options.branch })
  local other = { mu = options.mu, connection = options.connection, cyclic = {} }
  T.given = options.section ~= nil
  T.chart, T.slope = Phi, slope  -- which take symbols too
  for a = 1, m do other.cyclic[a] = a end
  if options.q and options.v then other.q, other.v = T.split(options.q, options.v) end
  return split, other, T
end

return M
