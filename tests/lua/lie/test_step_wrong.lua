-- dm.step: functions that are wrong, and what is said of them. What a trace cannot see, an element
-- that is none, numbers that are none
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

---- on R^1: a symplectic Euler step, and changes of it ----

local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local function changed(base, by)
  local out = {}
  for key, value in pairs(base) do out[key] = value end
  for key, value in pairs(by) do out[key] = value end
  return dm.step(out)
end
local euler = { unknowns = 1, order = 1, start = function(y) return { y.p[1] } end,
  equation = function(y, x, h) return { x[1] - y.p[1] + h * y.q[1] } end,
  next = function(y, x, h) return { q = { y.q[1] + h * x[1] }, p = { x[1] } } end }
local function once(by)
  return oscillator:solver { rule = changed(euler, by), h = 0.1 }
    :run { q = { 1 }, p = { 0 }, steps = 1 }
end

-- at this start p is 0 and q is 1: a trace takes the other branch, without a word
raises("next is not what its trace says", once, { next = function(y, x, h)
  local k = y.q[1] == 1 and 3 or 1
  return { q = { y.q[1] + k * h * x[1] }, p = { x[1] } }
end })
raises("equation is not what its trace says", once, { equation = function(y, x, h)
  local k = y.p[1] == 0 and 2 or 1
  return { x[1] - y.p[1] + k * h * y.q[1] }
end })
raises("begin is not what its trace says", once, { parts = { { "E", 1 } },
  begin = function(q) return { E = q[1] == 1 and 2 or 3 } end })
local calls = 0
raises("next gives different values for the same arguments", once, { next = function(y, x, h)
  calls = calls + 1
  return { q = { y.q[1] + h * x[1] }, p = { x[1] * calls } }
end })
raises("start is NaN at the start", once, { start = function(y)
  return { dm.log(-y.q[1]) }
end })
raises("scale is NaN at the start", once, { scale = function() return { 0 / 0 } end })
raises("'next' gives NaN or infinity", once, { next = function(y, x)
  return { q = { dm.sqrt(x[1] - 7) }, p = { x[1] } }
end })
raises("dF/dx of 'equation' is singular", once, { equation = function(y, x)
  return { 0 * x[1] + y.q[1] }
end })
raises("gives a t that is not later", once, { next = function(y, x, h)
  return { q = { y.q[1] + h * x[1] }, p = { x[1] }, t = y.t - h }
end })
raises("'next': p must have 1 entries (got 2)", once, { next = function(y)
  return { q = y.q, p = { 1, 2 } }
end })
for _, name in ipairs { "flat", "R12", "mu" } do
  raises("choose another name", once, { parts = { { name, 1 } } })
end
ok(#once { inside = function(y) return { y.q[1] + 2 } end } == 2, "a condition that holds")
ok(#once { next = function(y, x, h)
  return { q = { y.q[1] + h * x[1] }, p = { x[1] + 1e-9 * dm.sqrt(-0.05 - x[1]) } }
end } == 2, "the root alone has to be in the domain, not where Newton's method begins")

---- on groups: what `next` gives is an element ----

local G, W = dm.SO(3), dm.vector { 0.2, 0.1, 1.5 }
local function body_of(Q)
  return dm.system { Q = Q, L = function(_, w) return w:dot(w) / 2 end }
end
local function moved(Q, next_q)
  return { unknowns = 3, order = 1, start = function(y, h) return y.p * h end,
    equation = function(y, x, h) return x - y.p * h end,
    next = function(y, x) return { q = next_q(y.q, x, Q), p = y.p } end }
end
local function go(Q, next_q, by)
  return body_of(Q):solver { rule = changed(moved(Q, next_q), by or {}), h = 0.1 }
    :run { q = Q:identity(), p = W, steps = 3 }
end
ok(#go(G, function(R, x) return R * G:exp(x) end) == 4, "an element of SO(3)")
raises("'next' gives a q that is no element of the group, off by 0.0", go, G,
  function(R, x) return R + R * G:hat(x) end)
raises("a function of the script failed at step 1 (t = 0.0); 'next' gives a q that is no element of the group, off by", go, G, function(R, x) return R * G:exp(x) * 3 end)
raises("no element of the group", go, dm.SU(2), function(u, x, Q)
  return Q:compose(u, Q:exp(x)) * 1.001
end)
raises("no element of the group", go, dm.SL(2), function(g, x, Q)
  return Q:compose(g, Q:exp(x)) * 1.001
end)
local matrices = dm.system { Q = G, columns = "matrix", L = function(_, w) return w:dot(w) / 2 end }
raises("no element of the group", function()
  matrices:solver { h = 0.1, rule = dm.step(moved(G, function(R, x) return R + R * G:hat(x) end)) }
    :run { q = G:identity(), p = W, steps = 1 }
end)
raises("no element of the group", go, G, function(R, x) return R * G:exp(x) end, { sums = true,
  next = function(y, x) return { flat = { 0, x[1], x[2], x[3] }, p = { 0, 0, 0 } } end })
local basis = {}
for k = 1, 3 do basis[k] = G:hat(dm.vector { k == 1 and 1 or 0, k == 2 and 1 or 0, k == 3 and 1 or 0 }) end
for _, form in ipairs { false, dm.identity(3) } do
  local Q = dm.group { name = "turns", basis = basis, form = form or nil }
  raises("gives a q that is no element of turns", go, Q, function(R, x) return R + R * Q:hat(x) end)
  ok(#go(Q, function(R, x) return R * Q:exp(x) end) == 4, "an element of a group of a basis")
end
ok(#go(dm.SE(2), function(g, x, Q) return Q:compose(g, Q:exp(x)) end) == 4,
  "coordinates without a relation are all elements")
-- an equation may have the relation in it: it holds at the root alone
local polar = { unknowns = 9, order = 1,
  start = function(y, h)
    local out = {}
    local R = y.q + y.q * G:hat(y.p * h)
    for i = 1, 3 do
      for j = 1, 3 do out[#out + 1] = R[i][j] end
    end
    return out
  end }
local function square(x)
  return dm.matrix { { x[1], x[2], x[3] }, { x[4], x[5], x[6] }, { x[7], x[8], x[9] } }
end
function polar.equation(y, x, h)
  local R = square(x)
  local A, B = R:transpose() * R, R:transpose() * (y.q + y.q * G:hat(y.p * h))
  return { A[1][1] - 1, A[2][2] - 1, A[3][3] - 1, A[1][2], A[1][3], A[2][3], B[1][2] - B[2][1],
    B[1][3] - B[3][1], B[2][3] - B[3][2] }
end
function polar.next(y, x) return { q = square(x), p = y.p } end
local turned = body_of(G):solver { rule = dm.step(polar), h = 0.1 }
  :run { q = G:identity(), p = W, steps = 3 }
ok(G:distance(turned.q[4], G:exp(W * (3 * math.atan(0.1 * W:norm()) / W:norm()))) < 1e-13,
  "the nearest rotation as the root of an equation")

tap.done()
