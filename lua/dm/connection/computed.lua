--- Discrete connections of a continuous one, g^-1 g' + AA(x) x' (Leok 4.6). With a map logbar from
-- pairs to velocities (x', eta = g^-1 g') at q0 and an approximate exponential tau,
--   A_E(q0, q1) = tau(Ad_g0 (AA(x0) x' + eta))
-- has the axioms (i) and (ii), but not (iii) unless G is abelian: the defect is O(h^2) [E2]. It is
-- completed; for the default, x' = x1 - x0 and eta = tau^-1(g0^-1 g1), in closed form to
--   A(x0, x1) = tau(AA(x0) (x1 - x0)).
local axioms = require "dm.connection.axioms"
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local complete = require "dm.connection.complete"
local connections = require "dm.connection"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local WHERE = "dm.connection"

---- exponentials and their inverses, as matched pairs ----

local CUT = 1e-8  -- nearer to a half turn than this log takes one side or the other by chance

-- xi = log(g); raises where the elements behind g, along xi, have another branch of log
local function check_branch(kit, g, xi)
  local size = kit.abelian and 0 or linear.is_plain(core.matrix { xi }) and xi:norm() or 0
  if size == 0 then return xi end
  local fine, beyond = blame.try(kit.log, kit.compose(g, kit.exp(xi * (CUT / size))))
  if fine and (beyond - xi):norm() < 0.5 * size then return xi end
  error(("log at a half turn: %s has no logarithm of its own; take points nearer to each other")
    :format(bundles.show(g)), 0)
end

local function exact_log(kit)
  return function(g) return check_branch(kit, g, kit.log(g)) end
end

-- the inverse of tau near the identity, by Newton's method
local function solved_log(kit, tau)
  local root = core.root { name = "the inverse of a Pade approximant", unknowns = kit.dimension,
    start = function(xi) return xi end,
    equations = function(y, xi)
      return kit.log(kit.compose(kit.inverse(tau(core.vector(y))), kit.exp(core.vector(xi))))
    end }
  local log = exact_log(kit)
  return function(g) return core.vector(root(log(g))) end
end

local pairs_of = {}

function pairs_of.exp(kit) return kit.exp, exact_log(kit) end

function pairs_of.cayley(kit) return kit.cayley, kit.cayleyinv end

local MOST = 4  -- degrees that kit.pade knows

local function pade(kit, k)
  if k == 1 then return pairs_of.cayley(kit) end
  if not kit.pade or not kit.cayley then return end
  local function tau(xi) return kit.cayley((kit.pade(k, xi))) end
  return tau, solved_log(kit, tau)
end

local NAMES = '"exp", "cayley", "pade(k)" with k from 1 to %d, or "geodesic"'

-- tau and its inverse, by name
local function exponentials(kit, by, group)
  local k = tonumber(by:match "^pade%((%d+)%)$")
  if k and (k < 1 or k > MOST) or not k and not pairs_of[by] then
    options.fail(WHERE, "option 'by' must be %s (got %q)", NAMES:format(MOST), by)
  end
  local tau, inverse
  if k then tau, inverse = pade(kit, k) else tau, inverse = pairs_of[by](kit) end
  if not tau or not inverse then
    options.fail(WHERE, "%s has no Cayley map, which by = %q is made of: take by = \"exp\"",
      tostring(group), by)
  end
  return tau, inverse
end

---- the connection form ----

local SHAPE = "what form(x) returns must be a matrix of %d x %d, dim G x dim S (got %s)"

-- rows of a matrix that a user gave: one of a list too, where a side has length 1
local function matrix_of(value, rows, columns)
  if kits.class_of(value) == "dm.matrix" then return value end
  if kits.is_scalar(value) then value = { value } end
  local count = lists.count(value)
  if not count or lists.count(value[1]) then
    local fine, out = blame.try(core.matrix, value)
    return fine and out
  end
  if rows == 1 then return core.matrix { lists.entries(value) } end
  return columns == 1 and linear.fill(count, 1, function(i) return value[i] end)
end

--- AA(x) as a checked d x n matrix.
local function form_of(given, B)
  local f = core.one(given.form, "form")
  return function(x)
    local value = f(x)
    local out = matrix_of(value, B.d, B.n)
    if not out or out.rows ~= B.d or out.columns ~= B.n then
      error(SHAPE:format(B.d, B.n, out and ("%d x %d"):format(out.rows, out.columns)
        or kits.class_of(value)), 0)
    end
    for i = 1, B.d do
      if not kits.is_finite(out[i]) then
        error(("form(x) is not finite at x = %s"):format(bundles.show(x)), 0)
      end
    end
    return out
  end
end

-- A form has a value at one of the points where the axioms of other data are tried.
local function check_form(given, B)
  local form, fine, what = form_of(given, B), nil, nil
  for i = 1, axioms.TRIES do
    fine, what = blame.try(form, axioms.sample(B, i).q0[1])
    if fine then return end
  end
  options.fail(WHERE, "option 'form' has no value at %d random points: %s", axioms.TRIES,
    blame.bare(what))
end

---- logbar: velocities at q0 ----

local function flat_log(kit, inverse)
  return function(q0, q1)
    return q1[1] - q0[1], inverse(kit.compose(kit.inverse(q0[2]), q1[2]))
  end
end

-- G acts on R^n by matrices: { x, g } is (g, g x) of the semidirect product
local function semidirect(B)
  local linear_map = B.kit.acts.linear and B.kit.acts.linear(B.n)
  local base = kits.of(B.base)
  local fine, space = blame.try(core.semidirect, B.group, B.base, linear_map or nil)
  if base.euclidean and fine then return space, linear_map end
  options.fail(WHERE, "log = \"group\" takes log(q1 q0^-1) of the semidirect product of the group "
    .. "and the base, R^n, on which it acts by matrices, as SO(3) on dm.R(3): %s over %s has none; "
    .. "leave log out, or give a function log(q0, q1) -> { x', g^-1 g' }", tostring(B.group),
    tostring(B.base))
end

-- log(q1 q0^-1) q0 = (xi g0, xi w0 + u) in (g, w = g x): x' = g0^-1 u, eta = Ad_(g0^-1) xi
local function group_log(B, by)
  local space, linear_map = semidirect(B)
  local kit, S = B.kit, kits.of(space)
  local act = linear_map or function(g, v) return kit.matrix(g) * v end
  local _, inverse = exponentials(S, by, space)
  local function element(q) return { q[2], core.vector(act(q[2], q[1])) } end
  return function(q0, q1)
    local X = inverse(S.compose(element(q1), S.inverse(element(q0))))
    local back = kit.inverse(q0[2])
    return core.vector(act(back, lists.part(X, B.d, B.n))), kit.Ad(back, lists.part(X, 0, B.d))
  end
end

local function user_log(B, f)
  return function(q0, q1)
    local v = f(B.give(q0), B.give(q1))
    if type(v) ~= "table" or #v ~= 2 then
      error("what log(q0, q1) returns must be a list { x', g^-1 g' }", 0)
    end
    return kits.vector(v[1], B.n, "what log returns: x'"),
      kits.vector(v[2], B.d, "what log returns: g^-1 g'")
  end
end

-- logbar, and is it the default one?
local function log_of(given, B, inverse)
  if given.log == nil then return flat_log(B.kit, inverse), true end
  if given.log == "group" then return group_log(B, given.by or "exp") end
  options.demand(type(given.log) == "function", given, "log", WHERE,
    '"group" or a function of (q0, q1)')
  return user_log(B, given.log)
end

---- A_E ----

local function tried(F, B)
  local found = axioms.check(B, F)
  for _, name in ipairs { "equivariance", "splitting" } do
    if found[name] > 1e-9 then
      options.fail(WHERE, "log: the axiom of %s fails: %s (by %.3g); log must be equivariant, and "
        .. "{ 0, log(g0^-1 g1) } of two points of a fibre", name, tostring(found.at(name)),
        found[name])
    end
  end
end

local function exponential(given, B, by)
  local kit, form = B.kit, form_of(given, B)
  local tau, inverse = exponentials(kit, by, given.group)
  local log, usual = log_of(given, B, inverse)
  local function raw(q0, q1)
    local dx, eta = log(q0, q1)
    return bundles.conjugate(B, q0[2], tau(form(q0[1]) * dx + eta))
  end
  local local_form
  if given.raw then
    local e = kit.identity()
    function local_form(x0, x1) return raw({ x0, e }, { x1, e }) end
  elseif usual then
    function local_form(x0, x1) return tau(form(x0) * (x1 - x0)) end
  else
    local_form = complete.local_form(B, raw)
  end
  if type(given.log) == "function" then tried(raw, B) end
  return local_form, given.raw and raw
end

--- The connection of a continuous form.
function M.of(given, B)
  local by = options.text(given, "by", WHERE, "exp")
  local facts = { group = given.group, base = given.base, given = "form", name = given.name,
    by = by, raw = given.raw or false }
  local local_form, raw
  if by == "geodesic" then
    local geodesic = require "dm.connection.geodesic"
    local_form, raw = geodesic.of(given, B, given.form and form_of(given, B))
  else
    options.callable(given, "form", WHERE, "x")
    if given.metric ~= nil then
      options.fail(WHERE, "option 'metric' goes with by = \"geodesic\"")
    end
    local_form, raw = exponential(given, B, by)
  end
  if given.form then check_form(given, B) end
  local A = connections.new(facts, B, local_form, raw)
  A.own.reference = given.form and by ~= "exp" and function()
    return connections.connection { group = given.group, base = given.base, form = given.form }
  end or nil
  return A
end

return M
