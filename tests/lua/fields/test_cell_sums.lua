-- sums over cells: values against forms, gradients against differences, symmetric Hessians
local tap = require "tap"
local action = require "dm.dec.fields.action"
local core = require "dm.core"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local K = dm.mesh { triangle = 3 }
local u = K:form(0, function(x, y) return x + y ^ 2 end)
near(K:sum(1, function(a, cell) return (a[2] - a[1]) ^ 2 * cell.star end, u), u:d():dot(u:d()), 1e-14,
  "a sum over edges is the product of differentials")
near(K:sum(2, function(cell_of_u, cell) return cell.volume * cell_of_u:sum() / 3 end, u),
  K:sum(2, function(a, t, cell) return t * cell.volume * (a[1] + a[2] + a[3]) end, u, 1 / 3), 1e-15, "scalars are passed on")
near(K:sum(1, function(_, cell) local p = cell.points return cell.volume - (p[2] - p[1]):norm() end, u), 0, 1e-14, "points and volumes")
near(K:sum(2, function(_, cell) return cell.lengths:sum() end, u), K:count(2), 1e-13, "lengths")

-- the largest errors of gradient and Hessian against differences, and the asymmetry
local function errors(a, n)
  local x, held = core.constant(n, 0), 2
  for i = 1, n do x[i] = math.sin(3 * i) + 0.3 end
  local g, D, e = a:gradient(x), a:hessian(x):dense(), 1e-5
  local first, second, skew, largest = 0, 0, 0, 1
  for i = 1, n do
    local up, down = 1 * x, 1 * x
    up[i], down[i] = x[i] + e, x[i] - e
    local by_difference = i == held and 0 or (a:value(up) - a:value(down)) / (2 * e)
    first, largest = math.max(first, math.abs(by_difference - g[i])), math.max(largest, math.abs(g[i]))
    local row = (a:gradient(up) - a:gradient(down)) / (2 * e)
    for j = 1, n do
      if i ~= held then second = math.max(second, math.abs(row[j] - D[j][i])) end
      skew = math.max(skew, math.abs(D[i][j] - D[j][i]))
    end
  end
  return first / largest, second / largest, skew
end

local function try(what, M, degree, values, term)
  local n = values * M:count(degree)
  local held = core.constant(n, 0)
  held[2] = 1
  local first, second, skew = errors(action.new(M, degree, values, term, held), n)
  ok(first < 1e-7, what .. ": gradient against differences", first)
  ok(second < 1e-7, what .. ": Hessian against differences", second)
  ok(skew == 0, what .. ": the Hessian is symmetric", skew)
end

local box, line = dm.mesh { cube_tiling = 2 }, dm.mesh { points = { { 0 }, { 0.3 }, { 1 } }, simplices = { { 1, 2 }, { 2, 3 } } }
try("0-form, nonlinear", K, 0, 1, function(a)
  return a:d():dot(a:d()) / 2 + K:sum(0, function(x, cell) return cell.star * (1 - math.cos(x)) end, a) end)
try("1-form, a product and a function", K, 1, 1, function(a)
  return a:wedge(a:map(function(x) return x ^ 2 end)):dot(a:d()) + 0.5 * a:dot(a) end)
try("two values, points", K, 0, 2, function(a)
  return K:sum(2, function(x, cell) local p = cell.points
    return cell.volume * (x[2] - x[1]):dot(x[3] - x[1]) ^ 2 * (p[2] - p[1]):norm() end, a) end)
try("three values in space", box, 0, 3, function(a) return a:d():dot(a:d()) / 2 end)
try("1-form in space", box, 1, 1, function(a)
  return a:d():dot(a:d()) / 2 + box:sum(3, function(x, cell) return cell.volume * x:dot(x) ^ 2 + cell.lengths[2] * x[3] end, a) end)
try("2-form in space", box, 2, 1, function(a) return a:d():dot(a:d()) - a:dot(a:map(math.sin)) end)
try("line", line, 0, 1, function(a) return a:d():dot(a:d()) + line:sum(1, function(x, cell) return cell.star * x[1] ^ 4 end, a) end)

-- the local calculus is that of forms of numbers
local a, b = K:form(1, function(x, y) return { x * y, y } end), K:form(1, function(x) return { 1, x } end)
local function symbolic(f) return action.new(K, 1, 1, f):value(a.values) end
near(symbolic(function(A) return A:wedge(b):dot(A:d()) end), a:wedge(b):dot(a:d()), 1e-14, "natural product, d")
near(symbolic(function(A) return (2 * A - b / 3 + b):dot(-A) end), (2 * a - b / 3 + b):dot(-a), 1e-14, "arithmetic with forms")
local f = K:form(0, function(x, y) return x * y end)
near(action.new(K, 0, 1, function(F) return F:wedge(b):dot(b) end):value(f.values), f:wedge(b):dot(b), 1e-14, "function times form")

raises("larger cell", function() symbolic(function(A) return A:delta():dot(A:delta()) end) end)
raises("no such face", function() symbolic(function(A) return K:sum(0, function(x) return x end, A) end) end)
raises("that of the mesh", function() symbolic(function(A) return A:d():d():dot(b) end) end)
raises("different degrees", function() symbolic(function(A) return A:dot(f) end) end)
raises("two meshes", function() symbolic(function(A) return A:dot(box:form(1, function() return { 1, 1, 1 } end)) end) end)
raises("inside of the function of another", function()
  symbolic(function(A) return K:sum(1, function(x) return x * A:dot(A) end, A) end) end)
raises("must return a number", function() symbolic(function(A) return K:sum(1, function() end, A) end) end)
raises("a cell has no 'colour'", function() symbolic(function(A) return K:sum(1, function(x, cell) return x * cell.colour end, A) end) end)
raises("a degree from 0 to 2", function() K:sum(3, function() return 1 end, u) end)
raises("a form is needed", function() K:sum(1, function() return 1 end) end)
raises("a function (a, ..., cell)", function() K:sum(1, 3, u) end)

-- forms of numbers stand on either side of a product; what is no sum over cells is refused and not left out
do
  local K = dm.mesh { triangle = 3 }
  local B = K:form(1, function(x, y) return { 1 + y, x } end)
  local core = require "dm.core"
  local q = core.zeros(K:count(1))
  for i = 1, #q do q[i] = math.sin(3 * i) end
  local function force(term) return core.field_force(K:field { form = 1, L = function(A, V) return V:dot(V) / 2 - term(A) end }, q, 0) end
  local function square(w) return w:dot(w) / 2 end
  local left, right = force(function(A) return square(B:wedge(A)) end), force(function(A) return square(A:wedge(B)) end)
  tap.ok((left - right):norm() < 1e-15 and left:norm() > 0.01, "B ^ A is - A ^ B")
  tap.ok((force(function(A) return B:dot(A) end) + B.values:map(function(x, i) return x * K:star_weights(1)[i] end)):norm() < 1e-15, "B . A")
  local function refused(words, term) tap.raises(words, force, term) end
  refused("in L the product is the natural one", function(A) return A:wedge(B, { rule = "metric" }):dot(K:form(2, function() return 1 end)) end)
  refused("unknown option", function(A) return A:wedge(B, { ruel = "natural" }):dot(K:form(2, function() return 1 end)) end)
  refused("K:sum(k, function(a, cell)", function(A) return A[1] ^ 2 end)
  refused("K:count(k)", function(A) return #A end)
  refused("A:dot(A) is its square", function(A) return A:norm() end)
  refused("a form in L has no 'contract'", function(A) return A:contract(1) end)
end
tap.done()
