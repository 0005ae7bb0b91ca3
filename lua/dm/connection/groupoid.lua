--- The pair groupoid with its vertical pairs, and the isomorphism Q^(k+1)/G = S^(k+1) x G~ x ... of
-- a connection (Leok 4.4.8, 4.5.1, 4.5.3). In a trivialization, with the group element on the left
-- [E4],
--   qbar_(l+1) = (x_(l+1), g0 (A(x_l, x_(l+1)) ... A(x_0, x_1))^-1)
--   q_l = g_(l-1) ... g_0 qbar_l
local bundles = require "dm.connection.bundle"
local classes = require "dm.connection.classes"
local connections = require "dm.connection"
local core = require "dm.core"
local lists = require "dm.base.lists"
local circle = require "dm.group.so2"

local M = {}

local method = connections.method

-- a list of at least `least` points, checked
local function points_of(B, list, least, what)
  if type(list) ~= "table" or #list < least then
    error(("%s takes a list of at least %d points (got %s)")
      :format(what, least, type(list) == "table" and #list or type(list)), 0)
  end
  local out = {}
  for i = 1, #list do out[i] = B.take(list[i], ("%s: point %d"):format(what, i)) end
  return out
end

--- A list of points of the base, vectors.
function M.shapes(B, list, least, what)
  local count = lists.count(list)
  if not count or count < least then
    error(("%s takes a list of at least %d points of the base (got %s)")
      :format(what, least, count or type(list)), 0)
  end
  local out = {}
  for i = 1, count do
    out[i] = bundles.base_point(B, list[i], ("%s: point %d"):format(what, i))
  end
  return out
end

--- The lift from q through all shapes x[1], x[2], ..., q over x[1], up to whole turns of angles.
function M.multi_lift(own, x, q)
  local out = { { x[1], q[2] } }
  for l = 1, #x - 1 do out[l + 1] = own.second(out[l], x[l + 1]) end
  return out
end

method("split", function(A, list)
  local own, B = A.own, A.own.bundle
  local q, x, g = points_of(B, list, 1, "A:split"), {}, {}
  for l = 1, #q do
    x[l] = q[l][1]
    if l < #q then g[l] = own.value(q[l], q[l + 1]) end
  end
  return classes.chain(B, x, g, q[1])
end, [[
A:split{q0, ..., qk} -> { x, g, q }
The isomorphism alpha of Q^(k+1)/G [E5]: the shapes x = {x0, ..., xk} and the classes [q0, A_d(q_l,
q_(l+1))], g = their k elements at q = q0. class:at(q) gives them at another point of the fibre;
A:join takes them back.]])

method("join", function(A, parts)
  local own, B = A.own, A.own.bundle
  if type(parts) ~= "table" or not lists.count(parts.x) or type(parts.g) ~= "table" then
    error("A:join takes what A:split gives, { x, g, q }", 0)
  end
  local x = M.shapes(B, parts.x, 1, "A:join: x")
  if #parts.g ~= #x - 1 then
    error(("A:join: %d shapes need %d elements g (got %d)"):format(#x, #x - 1, #parts.g), 0)
  end
  local q0 = B.take(parts.q, "q")
  bundles.same_fibre(B, q0[1], x[1], "A:join: q must lie over x[1]")
  local lifted, h, out = M.multi_lift(own, x, q0), B.kit.identity(), core.result {}
  for l, q in ipairs(lifted) do
    out[l] = B.give(bundles.move(B, h, q))
    if l < #lifted then
      h = B.kit.compose(bundles.element(B, parts.g[l], ("A:join: g[%d]"):format(l)), h)
    end
  end
  return out
end, [[
A:join{x=, g=, q=} -> {q0, ..., qk}
The inverse of A:split: q_l = g_(l-1) ... g_0 qbar_l, where qbar is the lift of the shapes from
q.]])

method("multi_lift", function(A, xs, q0)
  local own, B = A.own, A.own.bundle
  local x, out = M.shapes(B, xs, 1, "A:multi_lift"), core.result {}
  q0 = B.take(q0, "q0")
  bundles.same_fibre(B, q0[1], x[1], "A:multi_lift: q0 must lie over the first shape")
  for l, q in ipairs(M.multi_lift(own, x, q0)) do out[l] = B.give(q) end
  return out
end, [[
A:multi_lift({x0, ..., xk}, q0) -> {qbar0, ..., qbark}
The lift of a chain of shapes from q0 on: every pair of neighbours is horizontal.]])

method("compose", function(A, first, second)
  local B = A.own.bundle
  local q, r = points_of(B, first, 2, "A:compose"), points_of(B, second, 2, "A:compose")
  if #q ~= 2 or #r ~= 2 then error("A:compose takes two pairs of points", 0) end
  bundles.same_fibre(B, q[2][1], r[1][1], "A:compose: (q0, q1) (r0, r1) needs q1 and r0 on one "
    .. "fibre, so that q1 = k r0")
  local k = bundles.between(B, r[1], q[2])
  return core.result { B.give(q[1]), B.give(bundles.move(B, k, r[2])) }
end, [[
A:compose({q0, q1}, {r0, r1}) -> {q0, k r1}
The extended composition of pairs whose inner points are on one fibre, q1 = k r0 (Leok 4.5.1): that
of the pair groupoid where q1 = r0; vertical composition, (q0, g q0) (q0, q1) = (q0, g q1). It is
the same for all connections. Raises where the fibres do not match.]])

---- control and formations (4.7.2) ----

-- x1 - x0; of angles the shortest way
local function difference(B, x0, x1)
  local out = {}
  for i = 1, B.n do
    out[i] = x1[i] - x0[i]
    if B.angles[i] then out[i] = circle.principal(out[i]) end
  end
  return core.vector(out)
end

method("relative", function(A, q0, q1)
  local B = A.own.bundle
  q0, q1 = B.take(q0, "q0"), B.take(q1, "q1")
  return difference(B, q0[1], q1[1]), A.own.value(q0, q1)
end, [[
A:relative(q0, q1) -> dx, g
What leads from q0 to q1: the command of shape, x1 - x0 (of angles the shortest way), and that of
the group, A_d(q0, q1), which is the identity where the connection takes the group along with the
shape (Leok 4.7.2).]])

method("formation", function(A, list)
  local B, out = A.own.bundle, core.result {}
  local q = points_of(B, list, 1, "A:formation")
  for i = 1, #q do
    out[i] = { dx = difference(B, q[1][1], q[i][1]), g = A.own.value(q[1], q[i]) }
  end
  return out
end, [[
A:formation{q1, ...} -> list of { dx, g }
Where each body stands relative to the first, itself included: A:relative(q1, qi). A formation is
locked as long as these stay what they are.]])

return M
