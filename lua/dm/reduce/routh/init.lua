--- Routh reduction: a system without its group variables. A shape is an ordinary dm.system whose L
-- is the classical Routhian R(x, x', t) = L - mu . theta' at the momentum mu, so that every rule,
-- event, chart and ensemble steps it. A symplectic partitioned Runge-Kutta rule on R is the
-- reduction of that rule on L (Jalnapurkar, Leok, Marsden & West 2006; Leok ch. 2).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local class = require "dm.base.class"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local option = require "dm.base.options"
local parameters = require "dm.reduce.routh.params"
local starts = require "dm.base.start"

local M = {}

local abs = math.abs

-- shape -> what it was made from; also by its L, which copies with other params share
local known = setmetatable({}, { __mode = "k" })
local of_lagrangian = setmetatable({}, { __mode = "k" })

--- What a reduced system was made from, or nothing.
function M.info(system)
  local meta = getmetatable(system)
  if not meta or meta.__name ~= "dm.system" then return known[system] end
  local info = known[system] or of_lagrangian[system.L]
  return info and parameters.at(info, system.params)
end

--- The same, or an error that names what asked.
function M.need(system, what)
  local info = M.info(system)
  if not info then
    error(what .. " is for a reduced system, made by system:routh { cyclic = ..., mu = ... }", 0)
  end
  return info
end

--- Raises where constraints or forces are in the way of what asked.
function M.need_free(info, what)
  local given = info.full.given
  if given.constraint or given.rolling or given.force then
    error(("%s: this system has %s, for which shape:solver has the reduced equations")
      :format(what, given.force and "a force" or "constraints"), 0)
  end
end

--- Need a motion not keep its energy, since a force or rolling constraints act on it?
function M.is_driven(info)
  return (info.full.given.force or info.full.given.rolling) ~= nil
end

--- Does L not depend on time?
function M.is_autonomous(info)
  if info.autonomous == nil then info.autonomous = info.full:structure().autonomous end
  return info.autonomous
end

--- Raises where L depends on time.
function M.need_autonomous(info, what)
  if not M.is_autonomous(info) then
    error(what .. ": L depends on the time, and this is for one that does not; shape:solver and "
      .. "reconstruction know the time", 0)
  end
end

local KNOWN = { "cyclic", "action", "section", "branch", "dimension", "names", "at", "mu",
  "connection", "q", "v" }

M.OPTIONS = KNOWN

-- the start: as many finite numbers as Q has dimensions
local function check_start(options, n)
  for _, key in ipairs { "q", "v", "at" } do
    local given = options[key]
    if given ~= nil and lists.count(given) ~= n then
      error(("option '%s' must be %d numbers, one for each coordinate (got %s)")
        :format(key, n, lists.got(given)), 0)
    end
    for i = 1, given ~= nil and n or 0 do
      if type(given[i]) ~= "number" or not (abs(given[i]) < math.huge) then
        error(("option '%s'[%d] must be a finite number (got %s)")
          :format(key, i, tostring(given[i])), 0)
      end
    end
  end
end

local OF_ACTIONS = { "section", "branch", "dimension", "names", "at" }

-- cyclic coordinates or an action, and what belongs to the latter
local function check_kind(options)
  if options.action and options.cyclic then
    error("system:routh takes 'cyclic' or 'action', not both: an action has its own group "
      .. "coordinates", 0)
  end
  for _, key in ipairs(options.action and {} or OF_ACTIONS) do
    if options[key] ~= nil then
      error(("option '%s' belongs to an action: system:routh { action = ..., %s = ... }")
        :format(key, key), 0)
    end
  end
end

local function names_of(system)
  local names, n = system.coordinates, system.Q.dimension
  if names then return names end
  names = {}
  for i = 1, n do names[i] = "q" .. i end
  return names
end

-- the number of the coordinate called `key`, or numbered so
local function coordinate(names, key)
  local number = math.tointeger(key)
  if number and type(key) == "number" and names[number] then return number end
  for i, name in ipairs(names) do
    if name == key then return i end
  end
  error(("option 'cyclic': there is no coordinate '%s'; coordinates are %s")
    :format(tostring(key), table.concat(names, ", ")), 0)
end

-- the coordinates to eliminate: given, or all that L does not depend on
local function read_cyclic(system, cyclic, names)
  if cyclic == nil then
    cyclic = system:structure().cyclic
    if #cyclic == 0 then
      error("L depends on every coordinate, so none is cyclic: name an action, system:routh { "
        .. "action = f(theta, q), section = ... }", 0)
    end
  end
  if type(cyclic) == "string" or type(cyclic) == "number" then cyclic = { cyclic } end
  if type(cyclic) == "userdata" and lists.count(cyclic) then cyclic = lists.entries(cyclic) end
  if type(cyclic) ~= "table" or #cyclic == 0 then
    error("option 'cyclic' must be a list of coordinates, numbers or names", 0)
  end
  local out, seen = {}, {}
  for a, key in ipairs(cyclic) do
    if type(key) ~= "number" and type(key) ~= "string" then
      error(("option 'cyclic'[%d] must be a coordinate, a number or a name (got %s)")
        :format(a, type(key)), 0)
    end
    local i = coordinate(names, key)
    if seen[i] then error(("option 'cyclic': '%s' stands there twice"):format(names[i]), 0) end
    seen[i], out[a] = true, i
  end
  if #out == #names then
    error("no coordinate would be left: keep at least one of " .. table.concat(names, ", "), 0)
  end
  return out, seen
end
M.read_cyclic = read_cyclic

-- the momentum: a number, a list, or that of the start
local function read_mu(info, options)
  local mu, m = options.mu, info.m
  if mu == nil then
    if not options.q or not options.v then
      error("option 'mu' must be given, or the start q, v that has it", 0)
    end
    local fine, p = blame.try(info.derived.slope, options.q, options.v, 0)
    if not fine then
      error(("L is not finite at the start q = %s, v = %s, or its momentum is not")
        :format(check.text(options.q), check.text(options.v)), 0)
    end
    mu = {}
    for a, i in ipairs(info.cyclic) do mu[a] = p[info.n + i] end
    return mu
  end
  if type(mu) == "number" then mu = { mu } end
  local count = lists.count(mu)
  if not count then
    error(("option 'mu' must be a number, or a list of %d (got %s)"):format(m, option.got(mu)), 0)
  end
  if count ~= m then
    error(("option 'mu' must have %d entr%s, one for each dimension of the group (got %d)")
      :format(m, m == 1 and "y" or "ies", count), 0)
  end
  local out = {}
  for a = 1, m do
    if type(mu[a]) ~= "number" or mu[a] ~= mu[a] or abs(mu[a]) == math.huge then
      error(("option 'mu'[%d] must be a finite number (got %s)"):format(a, tostring(mu[a])), 0)
    end
    out[a] = mu[a]
  end
  return out
end

-- what reduction cannot do
local function refuse(system)
  local given = system.given
  if given.derivatives == "hyperdual" then
    error("system:routh needs the graph of L, and this system runs on hyper-dual numbers", 0)
  end
  if given.control then
    error("system:routh: a control held over a step is not reduced; put it into 'force'", 0)
  end
end

-- info[key](q, v, t) over the shape x, its velocity u and the numbers p; and info at these
local function at_shape(info, key)
  return function(x, u, t, p)
    local now = parameters.at(info, p, x)
    local theta = model.group_velocity(now, x, u, t)
    return now[key](model.embed(now, x), model.embed(now, u, theta), t), now
  end
end

-- rolling constraints and the directions of their reactions, which spare the group
local function add_rolling(info, out)
  check.rolling(info, info.rolling, info.reaction)
  local phi = at_shape(info, "rolling")
  function out.rolling(...) return (phi(...)) end
  if not info.reaction then return end
  local full = at_shape(info, "reaction")
  function out.reaction(...)
    local rows, now = full(...)
    local left = {}
    for i, row in ipairs(check.rows(rows)) do left[i] = model.split(now, row) end
    return left
  end
end

-- the constraint and the force of the reduced system, checked
local function add_constraint_and_force(info, out)
  if info.g then
    check.constraint(info, info.g)
    out.constraint = function(x, t, p)
      return parameters.at(info, p, x).g(model.embed(info, x), t)
    end
  end
  if info.F then
    check.force(info, info.F)
    local full = at_shape(info, "F")
    out.force = function(...)
      local F, now = full(...)
      return (model.split(now, F))
    end
  end
  if info.rolling then add_rolling(info, out) end
end

-- names, units and space of what is left
local function describe(info, out)
  local full = info.full
  out.Q = (kits.are_angles(full.Q) and core.T or core.R)(info.d)
  local named = full.coordinates or info.ambient
  info.own = {} -- what columns of its paths are called
  for i, at in ipairs(info.shape) do info.own[i] = named and info.names[at] or "q" .. i end
  if named then out.coordinates = info.own end
  out.units = full.units
  local gone = {}
  for a, i in ipairs(info.cyclic) do
    gone[a] = ("%s = %.6g"):format("momentum of " .. info.names[i], info.mu[a])
  end
  out.name = (full.name and full.name .. ", " or "") .. "reduced, " .. table.concat(gone, ", ")
end

local function make(info, start)
  if not info.quadratic then
    M.is_autonomous(info) -- which model.of_root wants to know
    info.root = require "dm.reduce.routh.quadratic".root(info)
    if start then require "dm.reduce.routh.quadratic".branch(info, start) end
  end
  local function L(x, u, t, p) return model.routhian(parameters.at(info, p, x), x, u, t) end
  local out = { L = L, params = parameters.of(info) }
  describe(info, out)
  add_constraint_and_force(info, out)
  local shape = core.system(out)
  known[shape], of_lagrangian[out.L] = info, info
  return shape
end

-- which coordinates are of the group and which are left, and L
local function read(system, options)
  local names = names_of(system)
  local cyclic, is_cyclic = read_cyclic(system, options.cyclic, names)
  local n, shape = system.Q.dimension, {}
  for i = 1, n do
    if not is_cyclic[i] then shape[#shape + 1] = i end
  end
  option.callable(options, "connection", "system:routh", "the shape")
  local given = system.given
  local p = given.params
  return { full = system, names = names, n = n, m = #cyclic, d = #shape,
    cyclic = cyclic, shape = shape, params = p, L = bound(given.L, p),
    g = bound(given.constraint, p), F = bound(given.force, p),
    rolling = bound(given.rolling, p), reaction = bound(given.reaction, p),
    given_connection = options.connection and core.one(options.connection, "connection"),
    shown = {}, variants = {} }
end

-- invariance, a regular locked inertia that does not depend on theta', at points in the domain
local function examine(info, start)
  local n, slope = info.n, info.derived.slope
  info.points = check.points(n, slope, start)
  info.sample = info.points[1]
  if not info.sample then
    error("no point was found at which L is finite: give one that is in its domain, system:routh "
      .. "{ ..., q = ..., v = ... }", 0)
  end
  check.between(info, slope, check.lagrangian(info, slope))
  local sample = info.sample
  local rows, I = model.derived(info).rows(sample.q, sample.v, sample.t), {}
  for a = 1, info.m do
    I[a] = {}
    for b, i in ipairs(info.cyclic) do I[a][b] = rows[a][n + i] end
  end
  info.order = check.inertia(info, I)
  info.diagonal = require "dm.base.linear".diagonal_order(I)
  if info.given_connection then model.connection(info, model.split(info, sample.q), sample.t) end
end

-- is it a group that is not abelian, by itself or in an action?
local function is_noncommutative(options)
  if type(options) ~= "table" then return false end
  local group = options.group
  if group == nil and type(options.action) == "table" then group = options.action.group end
  return group ~= nil and kits.class_of(group) == "dm.space"
    and (options.group ~= nil or not kits.of(group).abelian)
end

M.routh = blame.caller(function(system, options)
  if is_noncommutative(options) then return system:level(options) end
  option.check(options, KNOWN, "system:routh", "{ cyclic = ..., mu = ... }")
  check_kind(options)
  if not system.place then
    options = starts.lists(options, system)
    check_start(options, system.Q.dimension)
  end
  refuse(system)
  local ambient
  if options.action or system.place then
    local way = system.place and "dm.reduce.routh.on_group" or "dm.reduce.routh.section"
    system, options, ambient = require(way).split(system, options)
  end
  local info = read(system, options)
  info.ambient = ambient
  info.derived = model.derive(info)
  info.mu = read_mu(info, options)
  examine(info, options.q and { q = options.q, v = options.v })
  info.quadratic = require "dm.reduce.routh.quadratic".is(info)
  return make(info, options.q and options.v and not options.mu and options)
end)

M.at_momentum = blame.caller(function(shape, mu)
  local info = M.need(shape, "at_momentum")
  if mu == nil then
    error(("at_momentum takes a momentum, a number or a list of %d"):format(info.m), 0)
  end
  local other = lists.copy(info)
  other.shown, other.variants, other.general = {}, {}, nil
  other.mu = read_mu(other, { mu = mu })
  return make(other)
end)

class.method("dm.system", "routh", M.routh, [[
system:routh{cyclic=, mu=, q=, v=, connection=} -> dm.system
system:routh{action=, section=, branch=, dimension=, names=, at=, mu=, ...} -> dm.system
system:routh{group=, mu=} or {action=, section=, mu=} of a group that is not abelian -> dm.level
The system without its group variables: an ordinary dm.system in the dim Q - m coordinates that are
left, whose Lagrangian is the classical Routhian L - mu . theta' at the momentum mu. cyclic: the
coordinates that L does not depend on, by name or number (default: all of them); mu: their momentum,
a number or a list (default: that of the start q, v). action(theta, q) moves points of Q (theta: a
number, or a vector of `dimension` angles), or is a dm.action; section(x) gives a point of Q for
every shape x (default: as many coordinates as the group has dimensions are held at 0 wherever the
orbit of `at`, of the start q or of a point that is found comes to such points, else at their values
there, and theta is 0 at that point: turns leave r, which is singular at r = 0 alone); where an
orbit meets a section several times, as at r and, half a turn on, at -r, a point has the shape of
least norm, of equal norms the one whose first entry is positive, or the one of them where branch(x)
> 0; names: of theta and x (default theta, x1, x2, ..., but a coordinate that the group leaves alone
keeps its name). On a group action(theta, g), of an abelian group, and section(x), which
has to be given, make elements, for instance a top's turns about the vertical: x are coordinates
near the section, states and reconstructed paths have elements. connection(x): m rows of dim Q - m
numbers, in place of the mechanical connection. Invariance of L under cyclic coordinates is proved,
or searched, by bounds between a dozen points; all else is checked at these points. The first that
violates it is named: what differs nowhere there, such as a force along the group that sets in only
beyond some distance, is not seen, and the reduced run leaves it out. Constraints, rolling ones
whose reactions spare the group, and forces that the group keeps are reduced too. The params of the
system are those of the shape, with the momentum as mu (mu1, mu2, ... of a group of more dimensions;
mu_theta where a parameter is called mu): ensembles and stability maps vary them, and what is
changed in the system later changes in the shape, unless that was given another value of its own. A
run that jumps over a shape with a singular mass or locked inertia fails, with reason "pole" or
"collapse". The reduced system also has connection, curvature, locked_inertia, amended_potential,
lift, start, and its paths have reconstruct. Raises when L is no invariant, a force pushes along the
group, or the locked inertia is singular.]])

class.method("dm.system", "at_momentum", M.at_momentum, [[
shape:at_momentum(mu) -> dm.system
The same reduction at another momentum, a number or a list of dim G numbers; nothing is checked
again.]])

return M
