--- Discrete connections on a trivial bundle S x G (Leok 4.2-4.4): dm.connection from any of six
-- data that are one another, or from a continuous connection form (connection/computed.lua).
--
-- What stands behind a dm.connection A, its field `own`:
--   bundle         connection/bundle.lua
--   local_form(x0, x1)  A(x0, x1) = A_d((x0, e), (x1, e)), of checked points, numbers or symbols
--   value(q0, q1)  A_d itself; of a raw one not the same as g1 A g0^-1
--   second(q0, x1) the second point of the horizontal pair over (x0, x1) that begins at q0
--   with_step(h), reference()  what A:order compares (connection/order.lua), or nothing
local axioms = require "dm.connection.axioms"
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local complete = require "dm.connection.complete"
local core = require "dm.core"
local forms = require "dm.connection.forms"
local kits = require "dm.group.kit"
local options = require "dm.base.options"

local M = {}

local WHERE = "dm.connection"
local TOLERANCE = 1e-9  -- of an axiom at points of size 1

---- the class ----

local class = core.class({ __name = "dm.connection" }, [[
dm.connection: a discrete connection A_d on Q = base x group, made by dm.connection{group=, base=,
...}, Ld:connection{cyclic=} or system:mechanical_connection{group=, rule=, h=}; A(q0, q1) is A_d,
an element g. Points are lists { x, g } of a point of the base and an element of the group, which
acts on g from the left; of Ld:connection they are points of Q.
fields: group, base, given (which option it was made from), by, raw, completed (true where axiom
(iii) was mended), name.]])
M.class = class

function class.__tostring(A)
  local by = A.by and (", by %s%s"):format(A.by, A.raw and ", raw" or "")
    or A.completed and (", %s completed"):format(A.given) or ""
  return ("%s of %s over %s%s"):format(A.name and ("connection '%s'"):format(A.name)
    or "discrete connection", tostring(A.group), tostring(A.base), by)
end

--- Is x a dm.connection?
function M.is_connection(x) return type(x) == "table" and getmetatable(x) == class end

--- A connection of these facts (group, base, given, by, name ...) over a bundle with a local form
-- and, of raw ones, the one-form that stands for it.
function M.new(facts, bundle, local_form, raw)
  local B, kit = bundle, bundle.kit
  local own = { bundle = B, local_form = local_form }
  function own.value(q0, q1)
    if raw then return raw(q0, q1) end
    return kit.compose(kit.compose(q1[2], local_form(q0[1], q1[1])), kit.inverse(q0[2]))
  end
  function own.second(q0, x1)
    if not raw then
      return { x1, kit.compose(q0[2], kit.inverse(local_form(q0[1], x1))) }
    end
    local q1 = { x1, q0[2] }
    return bundles.move(B, kit.inverse(raw(q0, q1)), q1)
  end
  facts.own = own
  return setmetatable(facts, class)
end

---- dm.connection ----

local FROM_FORM = { "by", "raw", "metric", "log" }
local KNOWN = { "group", "base", "name", "complete", "form", "by", "raw", "metric", "log" }
for _, name in ipairs(forms.names) do KNOWN[#KNOWN + 1] = name end

-- which of the data is given
local function datum_of(given)
  local found
  for _, name in ipairs { "form", table.unpack(forms.names) } do
    if given[name] ~= nil then
      if found then options.fail(WHERE, "give '%s' or '%s', not both", found, name) end
      found = name
    end
  end
  if not found and given.by == "geodesic" then return "form" end
  if not found then
    options.fail(WHERE, "what is the connection? give one of %s, or form =, a continuous one",
      table.concat(forms.names, ", "))
  end
  for _, key in ipairs(FROM_FORM) do
    if found ~= "form" and given[key] ~= nil then
      options.fail(WHERE, "option '%s' goes with form =", key)
    end
  end
  return found
end

local function check_options(given)
  options.check(given, KNOWN, WHERE, "{ group =, base =, local_form = ... }")
  for key, such in pairs { group = "dm.SO(3)", base = "dm.R(2)" } do
    options.demand(kits.class_of(given[key]) == "dm.space", given, key, WHERE,
      "a space, for instance " .. such)
  end
  options.text(given, "name", WHERE)
  for _, key in ipairs { "complete", "raw" } do
    options.demand(given[key] == nil or type(given[key]) == "boolean", given, key, WHERE,
      "true or false")
  end
  local datum = datum_of(given)
  if datum == "form" and given.complete ~= nil then
    options.fail(WHERE, "option 'complete' goes with the data of a discrete connection; with "
      .. "form = it is raw = true that leaves it as it is")
  end
  return datum
end

local BROKEN = "the axiom of %s fails: %s; %s differ by %.3g%s"
local SIDES = { equivariance = "A_d(h q0, h q1) and h A_d(q0, q1) h^-1",
  splitting = "A_d(q, h q) and h", composition = "A_d(q0, h q1) and h A_d(q0, q1)" }

local function broken(datum, found, name, hint)
  options.fail(WHERE, "%s: " .. BROKEN, datum, name, tostring(found.at(name)), SIDES[name],
    found[name], hint)
end

-- the connection of one of the six data, whose axioms are tried; completed where it has (i), (ii)
-- but not (iii)
local function from_data(given, datum, B)
  options.callable(given, datum, WHERE)
  local f = given[datum]
  local F = forms.by[datum](B, datum == "horizontal_splitting" and f or core.one(f, datum))
  local function section(x0, x1)
    return F(bundles.at_section(B, x0), bundles.at_section(B, x1))
  end
  local facts = { group = given.group, base = given.base, given = datum, name = given.name }
  local found = axioms.check(B, F)
  for _, name in ipairs { "equivariance", "splitting" } do
    if found[name] > TOLERANCE then
      broken(datum, found, name, ", so that it is no discrete connection")
    end
  end
  if found.composition <= TOLERANCE then
    local A = M.new(facts, B, section)
    A.own.user = F
    return A
  end
  if given.complete == false then
    broken(datum, found, "composition", ": without complete = false it is completed, A_d(q0, q1) "
      .. "= g with F(q0, g^-1 q1) = e")
  end
  facts.completed = true
  return M.new(facts, B, complete.local_form(B, F))
end

-- points of the base that are whole turns apart are one point
local function check_turns(A, datum)
  local own = A.own
  local off, at = axioms.turns(own.bundle, own.local_form)
  if off <= TOLERANCE then return A end
  options.fail(WHERE, "%s: it has no single value on %s: where coordinate %d of x0 = %s and x1 "
    .. "= %s is a turn, 2 pi, on it differs by %.3g; take functions that have the period 2 pi, "
    .. "as cos and sin, or a base that is no circle, such as dm.R(%d)", datum, tostring(A.base),
    at.k, bundles.show(at.x0), bundles.show(at.x1), off, own.bundle.n)
end

M.connection = blame.caller(function(given)
  local datum = check_options(given)
  local B = bundles.of(given.group, given.base, WHERE)
  if datum == "form" then
    return check_turns(require "dm.connection.computed".of(given, B), datum)
  end
  return check_turns(from_data(given, datum, B), datum)
end)

core.docs[M.connection] = [[
dm.connection{group=, base=, local_form= | one_form= | ..., complete=, name=} -> dm.connection
dm.connection{group=, base=, form=, by=, raw=, metric=, log=} -> dm.connection
A discrete connection A_d(q0, q1) in G on Q = base x group (Leok 4.4), from one of
local_form(x0, x1) -> A = A_d((x0, e), (x1, e)), with A_d = g1 A g0^-1;
one_form(q0, q1) -> A_d;
horizontal(q0, q1) -> the second point of hor(q0, q1), A_d^-1 q1;
lift(x0, x1, q0) -> the second point of the lift from q0;
splitting(q0, q1) -> { q, g }, any representative of [q0, A_d];
horizontal_splitting(x0, x1) -> q0, q1, any representative.
Points are lists { x, g }; base is dm.R(n), dm.T(n) or a product of these. Tried at random points:
equivariance (i) and splitting (ii) must hold (else an error with sample and defect); without
composition (iii), A_d(q0, h q1) = h A_d(q0, q1), it is completed, A_d the g with F(q0, g^-1 q1) = e
(complete = false: refused). On dm.T(n) a turn of an angle of both points must change nothing.

form(x) -> dim G x dim S, a continuous connection g^-1 g' + form(x) x', is made discrete by "exp"
(default), "cayley", "pade(k)", A_d = g0 exp(form(x0) (x1 - x0) + log(g0^-1 g1)) g0^-1, or
"geodesic", by the geodesic of metric(x), a matrix in (x', g^-1 g') (then form left out is the
mechanical one). These break (iii), with slopes 2 and 3 in the distance, and are completed, for exp
to A = exp(form(x0) (x1 - x0)); raw = true leaves them. log = "group" takes log(q1 q0^-1) q0 of the
semidirect product of G and R^n, as SE(3) over R^3 for SO(3); or a function log(q0, q1) -> { x',
g^-1 g' }.]]

---- what it gives ----

local function method(name, f, doc) core.method("dm.connection", name, blame.caller(f), doc) end
M.method = method

--- A function of points q0, q1 (checked) of a connection, as a method.
local function of_pair(f)
  return function(A, q0, q1)
    local B = A.own.bundle
    return f(A.own, B, B.take(q0, "q0"), B.take(q1, "q1"))
  end
end

local value = of_pair(function(own, _, q0, q1) return own.value(q0, q1) end)
class.__call = blame.caller(value)

method("one_form", value, [[
A:one_form(q0, q1) -> g
The discrete connection one-form A_d, the same as A(q0, q1): in a trivialization g1 A(x0, x1)
g0^-1.]])

local function base_points(B, ...)
  local out = { ... }
  for i = 1, #out do out[i] = bundles.base_point(B, out[i], "x" .. i - 1) end
  return table.unpack(out)
end

method("local_form", function(A, x0, x1)
  return A.own.local_form(base_points(A.own.bundle, x0, x1))
end, [[
A:local_form(x0, x1) -> g
A(x0, x1) = A_d((x0, e), (x1, e)).]])

method("hor", of_pair(function(own, B, q0, q1)
  return B.give(bundles.move(B, B.kit.inverse(own.value(q0, q1)), q1))
end), [[
A:hor(q0, q1) -> point
The second point of the horizontal component (q0, A_d(q0, q1)^-1 q1), on the fibre of q1.]])

method("ver", of_pair(function(own, B, q0, q1)
  return B.give(bundles.move(B, own.value(q0, q1), q0))
end), [[
A:ver(q0, q1) -> point
The second point of the vertical component (q0, A_d(q0, q1) q0), on the fibre of q0. A:compose of
the vertical and the horizontal pair is (q0, q1).]])

method("lift", function(A, x0, x1, q0)
  local own, B = A.own, A.own.bundle
  x0, x1 = base_points(B, x0, x1)
  q0 = B.take(q0, "q0")
  bundles.same_fibre(B, q0[1], x0, "A:lift: q0 must lie over x0")
  return B.give(own.second({ x0, q0[2] }, x1)) -- x0 as it is given, angles may be turns apart
end, [[
A:lift(x0, x1, q0) -> point
The second point of the horizontal lift of (x0, x1) that begins at q0, which lies over x0: (x1, g0
A(x0, x1)^-1). Raises where q0 is of another fibre.]])

method("check", function(A)
  local own = A.own
  local found = axioms.check(own.bundle, own.user or own.value)
  return core.result { equivariance = found.equivariance, splitting = found.splitting,
    composition = found.composition, worst = found.worst, where = found.where }
end, [[
A:check() -> {equivariance, splitting, composition, worst, where}
The largest defects, at random near points that are always the same, of the axioms (i) A_d(h q0, h
q1) = h A_d(q0, q1) h^-1, (ii) A_d(q, h q) = h, (iii) A_d(q0, h q1) = h A_d(q0, q1); the largest of
all, and where that is, { axiom, q0, q1, h }. Raw connections break (iii), mechanical ones of a
momentum other than 0 break (ii).]])

-- the others find this module complete; where one of them fails, it is not loaded
package.loaded["dm.connection"] = M
local _ <close> = setmetatable({}, { __close = function(_, failure)
  if failure ~= nil then package.loaded["dm.connection"] = nil end
end })
require "dm.connection.classes"
require "dm.connection.groupoid"
require "dm.connection.limit"
require "dm.connection.holonomy"
require "dm.connection.order"

return M
