--- The mechanical connection of a discrete Lagrangian Ld(q0, q1) with cyclic coordinates theta:
-- psi(x0, x1) with dLd/dpsi = mu, inner velocities of a stage rule solved for at the same time; in
-- coordinates A(x0, x1) = -psi.
local action = require "dm.reduce.discrete.action"
local bundles = require "dm.connection.bundle"
local check = require "dm.reduce.routh.check"
local connections = require "dm.connection"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local options = require "dm.base.options"
local routh = require "dm.reduce.routh"

local M = {}

local WHERE = "Ld:connection"

---- what is given ----

-- is a formula, whose derivatives are `slope`, invariant at a pair?
local function check_pair(info, slope, q0, q1)
  local g = slope(q0, q1)
  for _, i in ipairs(info.cyclic) do
    local change = g[i] + g[info.n + i]
    if math.abs(change) > 1e-10 * g:norm() then
      options.fail(WHERE, "Ld is not invariant under translations of '%s': it changes at the rate "
        .. "%.6g at q0 = %s, q1 = %s", info.names[i], change, check.text(q0), check.text(q1))
    end
  end
end

-- is Ld invariant? of a rule it is when L is
local function check_invariance(Ld, info)
  local n, system = info.n, Ld.system
  if system then
    info.points = check.points(n, function(q, v, t) return system:lagrangian(q, v, t) end)
    local gradient = core.derivative(function(q, v, t) return info.L(q, v, t) end, n, n, "number")
    return check.lagrangian(info, function(q, v, t) return gradient(q, v, t) end)
  end
  local slope = action.of(Ld).slope
  info.points = check.points(n, function(q, v)
    return Ld:value(q, core.vector(q) + Ld.h * core.vector(v))
  end)
  if #info.points == 0 then options.fail(WHERE, "Ld has no value at any of 80 random pairs") end
  for _, p in ipairs(info.points) do check_pair(info, slope, p.q, p.q + Ld.h * p.v) end
end

local function refuse(Ld)
  if Ld.system and not Ld.system:structure().autonomous then
    options.fail(WHERE, "L must not depend on the time")
  end
  for _, key in ipairs { "constraint", "rolling", "force", "reaction" } do
    local of_system = Ld.system and Ld.system.given[key]
    if of_system or not Ld.system and Ld[key] then
      options.fail(WHERE, "this is for discrete Lagrangians without constraints and forces (it has "
        .. "'%s')", key)
    end
  end
  local Q = Ld.Q
  if not Q.chart or kits.of(Q).manifold then
    options.fail(WHERE, "Q must have coordinates, dm.R(n), dm.T(n) or products of these (got %s)",
      tostring(Q))
  end
end

local function momentum_of(info, mu)
  if mu == nil then return core.zeros(info.m) end
  return lists.numbers(WHERE .. ": mu", mu, info.m, "%s must be %d number%s (got %s)")
end

-- which coordinates are cyclic, as system:routh reads them
local function info_of(Ld, given)
  local of = Ld.system or Ld
  local names, n = {}, Ld.Q.dimension
  for i = 1, n do names[i] = of.coordinates and of.coordinates[i] or "q" .. i end
  if given.cyclic == nil and not Ld.system then
    options.need(given, "cyclic", WHERE, "the coordinates that Ld does not depend on")
  end
  local cyclic, is_cyclic = routh.read_cyclic(Ld.system, given.cyclic, names)
  local shape = {}
  for i = 1, n do
    if not is_cyclic[i] then shape[#shape + 1] = i end
  end
  local system = Ld.system
  return { names = names, n = n, m = #cyclic, d = #shape, cyclic = cyclic, shape = shape,
    L = system and require "dm.base.bound"(system.given.L, system.given.params) }
end

---- the bundle: points of Q ----

-- T^k of angles, R^k of the others, their product where there are both
local function space_of(angles, places)
  local count, parts = 0, {}
  for k, i in ipairs(places) do
    count, parts[k] = count + (angles[i] and 1 or 0), angles[i] and core.T(1) or core.R(1)
  end
  if count == 0 then return core.R(#places) end
  return count == #places and core.T(#places) or core.product(table.unpack(parts))
end

local FULL = "%s must be a point of Q: %d number%s (got %s)"

local function bundle_of(Q, info)
  local angles = kits.of(Q).angles
  local mixed = space_of(angles, info.cyclic)
  local group = mixed.parts and core.R(info.m) or mixed
  local B = bundles.of(group, space_of(angles, info.shape), WHERE)
  function B.take(q, what)
    local x, theta = model.split(info, lists.numbers(what, q, info.n, FULL))
    return { core.vector(x), core.vector(theta) }
  end
  function B.give(q) return model.embed(info, q[1], q[2]) end
  return B
end

---- psi ----

local FAILURE = "is the locked inertia singular there (the group does not act freely), or are the "
  .. "shapes too far apart for one step? take nearer ones"

-- psi_mu(x0, x1) of a discrete Lagrangian
local function psi_of(Ld, info, mu)
  local A, m = action.of(Ld), info.m
  local root = core.root { name = "the discrete mechanical connection", unknowns = m + A.inner,
    failure = FAILURE,
    start = function(x0, x1)
      return lists.joined(core.zeros(m),
        A.start(model.embed(info, x0), model.embed(info, x1)))
    end,
    stationary = function(y, x0, x1)
      local q0, q1 = model.embed(info, x0), model.embed(info, x1, y)
      local value = A.value(q0, q1, A.inner > 0 and lists.part(y, m, A.inner) or nil)
      for a = 1, m do value = value - mu[a] * y[a] end
      return value
    end }
  return function(x0, x1) return lists.part(root(x0, x1), 0, m) end
end

-- the system that Ld was made from, if any: of rules with one velocity the formula itself keeps it
-- (bind/rule/bind_discrete.c)
local function system_of(Ld)
  if Ld.system then return Ld.system end
  local _, kept = debug.getupvalue(Ld.Ld, 1)
  return kits.class_of(kept) == "dm.system" and kept or nil
end

-- the same discrete Lagrangian with another step
local function with_step(Ld, h)
  if Ld.system then return core.discrete_lagrangian(Ld.system, { rule = Ld.rule, h = h }) end
  return { Q = Ld.Q, Ld = Ld.Ld, h = h, params = Ld.params }
end

local function local_form_of(Ld, info, mu)
  local psi = psi_of(Ld, info, mu)
  return function(x0, x1) return -psi(x0, x1) end
end

-- the connection of Ld over a bundle, with what A:order asks for
local function made(Ld, info, mu, bundle)
  local facts = { group = bundle.group, base = bundle.base, given = "Ld", mu = mu,
    by = Ld.rule and tostring(Ld.rule) or "a formula Ld" }
  local A = connections.new(facts, bundle, local_form_of(Ld, info, mu))
  function A.own.with_step(h) return local_form_of(with_step(Ld, h), info, mu) end
  local system = system_of(Ld)
  A.own.reference = system and function()
    local accurate = core.discrete_lagrangian(system, { rule = "gauss(8)", h = Ld.h })
    return made(accurate, info, mu, bundle)
  end or nil
  return A
end

--- Of a discrete Lagrangian: points are those of Q.
function M.connection(Ld, given)
  options.check(given, { "cyclic", "mu" }, WHERE, "{ cyclic =, mu = }")
  refuse(Ld)
  local info = info_of(Ld, given)
  check_invariance(Ld, info)
  return made(Ld, info, momentum_of(info, given.mu), bundle_of(Ld.Q, info))
end

--- Of a system whose Q is a product with the group R^m or T^m as factor k: points are { x, g }.
function M.of_factor(system, given, k)
  local Ld = core.discrete_lagrangian(system, { rule = given.rule, h = given.h })
  local cyclic, first, rest = {}, 0, {}
  for i, part in ipairs(system.Q.parts) do
    for j = 1, part.dimension do
      if i == k then cyclic[j] = first + j end
    end
    if i ~= k then rest[#rest + 1] = part end
    first = first + part.dimension
  end
  refuse(Ld)
  local info = info_of(Ld, { cyclic = cyclic })
  check_invariance(Ld, info)
  local base = #rest == 1 and rest[1] or core.product(table.unpack(rest))
  local B = bundles.of(given.group, base, "system:mechanical_connection")
  return made(Ld, info, momentum_of(info), B)
end

return M
