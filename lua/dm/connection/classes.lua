--- Classes under the group: a pair [q0, q1] of (Q x Q)/G, an element [q, g] of the bundle G~ = (Q x
-- G)/G in which G acts by conjugation, a chain of these. Each is known by one representative and
-- gives every other one.
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local core = require "dm.core"

local M = {}

---- { q, g }, and { x, g = { ... }, q } ----

local class = core.class({ __name = "dm.bundle_class" }, [[
dm.bundle_class: a class of (Q x G)/G or of a chain of pairs, made by A:splitting and A:split
fields: of A:splitting [1] = q, [2] = g, a representative of [q, g]; of A:split x, g, q.]])

function class.__tostring(c)
  if c.q then return ("class of %d points, first %s"):format(#c.x, bundles.show(c.q)) end
  return ("class [%s, %s]"):format(bundles.show(c[1]), bundles.show(c[2]))
end

local function made(fields, bundle)
  fields.own = bundle
  return setmetatable(fields, class)
end

--- [q, g]; q a point as the bundle has it.
function M.element(B, q, g) return made({ B.give(q), g }, B) end

--- The chain of shapes x[k + 1] and elements g[k], the classes [q, g_l].
function M.chain(B, x, g, q) return made({ x = x, g = g, q = B.give(q) }, B) end

core.method("dm.bundle_class", "at", blame.caller(function(c, q)
  local B = c.own
  q = B.take(q, "q")
  local old = B.take(c.q or c[1], "the representative")
  bundles.same_fibre(B, q[1], old[1], "class:at(q)")
  local k = bundles.between(B, old, q)
  if not c.q then return M.element(B, q, bundles.conjugate(B, k, c[2])) end
  local g = {}
  for i, h in ipairs(c.g) do g[i] = bundles.conjugate(B, k, h) end
  return M.chain(B, c.x, g, q)
end), [[
class:at(q) -> dm.bundle_class
The same class by its representative at q, a point of the same fibre: [q', g] = [h q', h g h^-1]
with h q' = q. Raises where q is of another fibre.]])

---- of a connection ----

connections.method("splitting", function(A, q0, q1)
  local B = A.own.bundle
  q0, q1 = B.take(q0, "q0"), B.take(q1, "q1")
  return M.element(B, q0, A.own.value(q0, q1))
end, [[
A:splitting(q0, q1) -> { q0, g }
The splitting phi([q0, q1]) = [q0, A_d(q0, q1)] of the discrete Atiyah sequence G~ -> (Q x Q)/G -> S
x S, by its representative at q0; class:at(q) gives the one at another point of the fibre.]])

connections.method("horizontal_splitting", function(A, x0, x1)
  local own, B = A.own, A.own.bundle
  x0, x1 = bundles.base_point(B, x0, "x0"), bundles.base_point(B, x1, "x1")
  local q0 = bundles.at_section(B, x0)
  return B.give(q0), B.give(own.second(q0, x1))
end, [[
A:horizontal_splitting(x0, x1) -> q0, q1
A representative of the class of (Q x Q)/G of horizontal pairs over (x0, x1): the one with q0 = (x0,
e).]])

connections.method("representative", function(A, points, q)
  local B, out = A.own.bundle, core.result {}
  if type(points) ~= "table" or #points == 0 then
    error("A:representative takes a list of points { q0, ..., qk } and a point of the fibre of q0",
      0)
  end
  local first = B.take(points[1], "q0")
  q = B.take(q, "q")
  bundles.same_fibre(B, q[1], first[1], "A:representative: q and q0")
  local k = bundles.between(B, first, q)
  for i, point in ipairs(points) do
    out[i] = B.give(bundles.move(B, k, B.take(point, ("q%d"):format(i - 1))))
  end
  return out
end, [[
A:representative({q0, ..., qk}, q) -> list of points
The class [q0, ..., qk] of points that are moved together, by the representative whose first point
is q, of the fibre of q0.]])

return M
