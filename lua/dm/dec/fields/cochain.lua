--- Cochains of a Lagrangian that is traced: forms whose values are symbols, known on the faces of
-- the cell that a sum is at. What stays inside of a cell can be written with them: d, products,
-- functions, weights; delta needs the cells around a face, and is refused.
local cell_of = require "dm.dec.fields.cell"
local core = require "dm.core"
local form = require "dm.dec.form"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"

local M = {}

local Cochain = { __name = "dm.cochain" }

-- its methods; an entry of it is asked for in vain
function Cochain.__index(_, key)
  if math.type(key) == "integer" then
    option.fail("form[i]", "a form in L is known cell by cell: K:sum(k, function(a, cell) ... end, "
      .. "A) has its values on the faces of each")
  end
  return rawget(Cochain, key)
end

function Cochain.__len()
  option.fail("#form", "a form in L is known cell by cell; K:count(k) says how many there are")
end

lacking.refuse(Cochain, { fellow = "dm.form", what = "form in L",
  why = "what needs more than one cell at a time is not had in symbols; K:sum(k, f, A) is a sum of "
    .. "any function of the values on a cell", reasons = { norm = "A:dot(A) is its square" } })

local fail, size, faces_of = option.fail, cell_of.size, cell_of.faces_of

-- at(cell, set) -> list of values on that face
local function new(like, degree, at, side)
  return setmetatable({ mesh = like.mesh, around = like.around or false, degree = degree, at = at,
    side = side or "primal" }, Cochain)
end

function M.is_cochain(x) return getmetatable(x) == Cochain end
local is_cochain = M.is_cochain

--- The unknown itself: entries of q (source 1) or of its rates (2), `values` for every cell.
-- around: what is traced, { n, held, q, v } with q, v where it is called with numbers.
function M.leaf(K, degree, values, source, around)
  local function at(cell, set) return cell_of.column(cell, source, values, 0, set) end
  local leaf = new({ mesh = K, around = around }, degree, at)
  leaf.source = source
  return leaf
end

-- a form of numbers beside a cochain
local function lifted(a, like, where)
  if is_cochain(a) then
    if not rawequal(a.mesh, like.mesh) then fail(where, "the forms are of two meshes") end
    return a
  end
  if not form.is_form(a) then
    fail(where, "a form is needed (got %s)", option.got(a))
  end
  if not rawequal(a.mesh, like.mesh) then fail(where, "the forms are of two meshes") end
  if a.side == "dual" then
    fail(where, "forms of numbers in L are primal ones (got a %s)", form.name(a))
  end
  return new(like, a.degree, function(cell, set)
    return cell_of.column(cell, a.values, 1, 0, set)
  end)
end
M.lifted = lifted

local function same(a, b, where)
  if a.degree ~= b.degree then
    fail(where, "the forms have different degrees, %d and %d", a.degree, b.degree)
  end
  if a.side ~= b.side then fail(where, "one form is %s, the other %s", a.side, b.side) end
end

-- entry by entry
local function combined(a, b, where, f)
  local like = is_cochain(a) and a.around and a or is_cochain(b) and b or a
  a, b = lifted(a, like, where), lifted(b, like, where)
  same(a, b, where)
  return new(like, a.degree, function(cell, set)
    local x, y, out = a.at(cell, set), b.at(cell, set), {}
    if #x ~= #y then fail(where, "one form has %d values a cell, the other %d", #x, #y) end
    for c = 1, #x do out[c] = f(x[c], y[c]) end
    return out
  end, a.side)
end

local function each(a, f)
  return new(a, a.degree, function(cell, set)
    local x, out = a.at(cell, set), {}
    for c = 1, #x do out[c] = f(x[c]) end
    return out
  end, a.side)
end

local function is_scalar(x)
  return type(x) == "number" or not is_cochain(x) and not form.is_form(x) and core.is_symbol(x)
end

-- a form of numbers times a symbol, or beside a cochain; of no unknown until it meets one
function form.lift(a, x)
  if not is_cochain(x) and not core.is_symbol(x) then return nil end
  return lifted(a, { mesh = a.mesh }, "form * x")
end

function Cochain.__add(a, b)
  return combined(a, b, "form + form", function(x, y) return x + y end)
end

function Cochain.__sub(a, b)
  return combined(a, b, "form - form", function(x, y) return x - y end)
end

function Cochain.__unm(a) return each(a, function(x) return -x end) end

function Cochain.__mul(a, b)
  if is_scalar(a) then a, b = b, a end
  if not is_scalar(b) then
    fail("form * x", "forms are multiplied by numbers; a:wedge(b) is the product of two, "
      .. "a:map(f) a function of one")
  end
  return each(a, function(x) return x * b end)
end

function Cochain.__div(a, b)
  if not is_scalar(b) then fail("form / x", "a form is divided by numbers") end
  return each(a, function(x) return x / b end)
end

function Cochain.__tostring(a)
  return ("%s %d-form of a Lagrangian, in symbols"):format(a.side, a.degree)
end

--- The exterior derivative on a face: faces of it, with alternating signs.
function Cochain.d(a)
  if a.side == "dual" then
    fail("form:d", "d of a dual form adds up over all cells around: put the sum on the larger "
      .. "cell, a:d():dot(b) in the place of a product with delta b")
  end
  if a.degree == a.mesh.dimension then
    fail("form:d", "a form of degree %d, that of the mesh, has no d", a.degree)
  end
  local out = new(a, a.degree + 1, function(cell, set)
    local sum, sign, rest = nil, 1, set
    while rest ~= 0 do
      local bit = rest & -rest
      local x = a.at(cell, set & ~bit)
      sum = sum or {}
      for c = 1, #x do
        sum[c] = sum[c] and (sign > 0 and sum[c] + x[c] or sum[c] - x[c]) or x[c]
      end
      rest, sign = rest & ~bit, -sign
    end
    return sum
  end)
  out.exact = a.source and a or nil
  return out
end

function Cochain.delta()
  fail("form:delta", "delta of a form adds up over all cells around a face, and a sum over cells "
    .. "sees one cell: put the sum on the larger cell, a:d():dot(b) for a:dot(b:delta())")
end

function Cochain.map(a, f)
  if type(f) ~= "function" then fail("form:map", "a function is needed (got %s)", option.got(f)) end
  return new(a, a.degree, function(cell, set)
    local x = a.at(cell, set)
    local y = f(#x == 1 and x[1] or core.vector(x))
    if type(y) == "number" or core.is_symbol(y) then return { y } end
    local out = {}
    for c = 1, #y do out[c] = y[c] end
    return out
  end, a.side)
end

--- The star: weights |*s| / |s|; the values stand on the same primal cells, as duals.
function Cochain.star(a)
  local n = a.mesh.dimension
  local k = a.side == "dual" and n - a.degree or a.degree
  if k == n and a.mesh:orientation() == nil then
    fail("form:star", "the mesh has no coherent orientation")
  end
  local sign = a.side == "dual" and k * (n - k) % 2 == 1 and -1 or 1
  return new(a, n - a.degree, function(cell, set)
    local x, out, star = a.at(cell, set), {}, cell_of.measure(cell, "star", set)
    for c = 1, #x do
      if a.side == "dual" then out[c] = sign * x[c] / star else out[c] = x[c] * star end
    end
    return out
  end, a.side == "dual" and "primal" or "dual")
end

---- products ----

-- the sign of sorting p behind (or before) the set s, by the vertices that it passes
local function passes(s, p, before)
  local count = 0
  while s ~= 0 do
    local bit = s & -s
    if (before and bit < p) or (not before and bit > p) then count = count + 1 end
    s = s & ~bit
  end
  return count
end

-- the sign of the order (S, p, T)
local function shuffle(S, p, T)
  local count, rest = passes(S, p, false), T
  while rest ~= 0 do
    local bit = rest & -rest
    count = count + passes(S, bit, false) + (bit < p and 1 or 0)
    rest = rest & ~bit
  end
  return count
end

local function factorial(n) return n < 2 and 1 or n * factorial(n - 1) end

-- vertices of a set, and its subsets of m of them
local function parts(set, m)
  local bits, out = {}, {}
  while set ~= 0 do bits[#bits + 1], set = set & -set, set & (set - 1) end
  for _, chosen in ipairs(m == 0 and { 0 } or faces_of(#bits - 1, m)) do
    local s = 0
    for j = 1, #bits do if chosen >> (j - 1) & 1 == 1 then s = s | bits[j] end end
    out[#out + 1] = s
  end
  return out
end

--- The natural product: the mean over all orders of vertices (Leok, Def 3.47).
function Cochain.wedge(a, b, options)
  options = option.check(options or {}, { "rule" }, "form:wedge")
  if options.rule ~= nil and options.rule ~= "natural" then
    fail("form:wedge", "in L the product is the natural one (got rule = %s)",
      option.got(options.rule))
  end
  b = lifted(b, a, "form:wedge")
  local k, l = a.degree, b.degree
  if a.side ~= "primal" or b.side ~= "primal" then
    fail("form:wedge", "in L both forms of a product are primal; a:dot(b) is that with a star")
  end
  if k + l > a.mesh.dimension then
    fail("form:wedge", "the degrees %d and %d add up to more than %d, that of the mesh", k, l,
      a.mesh.dimension)
  end
  local factor = factorial(k) * factorial(l) / factorial(k + l + 1)
  return new(a.around and a or b, k + l, function(cell, set)
    local sum
    local rest = set
    while rest ~= 0 do
      local p = rest & -rest
      for _, S in ipairs(parts(set & ~p, k)) do
        local T = set & ~p & ~S
        local sign = shuffle(S, p, T) + passes(S, p, false) + passes(T, p, true)
        local x, y = a.at(cell, S | p), b.at(cell, T | p)
        if #x ~= 1 and #y ~= 1 then
          fail("form:wedge", "one of both forms must have one value a cell")
        end
        sum = sum or {}
        for c = 1, math.max(#x, #y) do
          local term = x[#x == 1 and 1 or c] * y[#y == 1 and 1 or c]
          if sign % 2 == 1 then term = -term end
          sum[c] = sum[c] and sum[c] + term or term
        end
      end
      rest = rest & ~p
    end
    for c = 1, #sum do sum[c] = factor * sum[c] end
    return sum
  end)
end

--- Sum over the cells of degree k of term(cell).
function M.sum(K, k, around, data, term)
  if around.degrees then table.insert(around.degrees, k) end
  local function f(column) return term(cell_of.new(K, k, column, data)) end
  return core.cell_sum(K:count(k), around.n, f, around.held, around.q, around.v, around.sphere)
end

--- The L2 product, as of forms.
function Cochain.dot(a, b)
  b = lifted(b, a, "form:dot")
  same(a, b, "form:dot")
  local around, n = a.around or b.around, a.mesh.dimension
  if not around then fail("form:dot", "neither form depends on the unknown") end
  if around.seen then around.seen(a, b) end
  local dual = a.side == "dual"
  local k = dual and n - a.degree or a.degree
  return M.sum(a.mesh, k, around, nil, function(cell)
    local x, y, sum = a.at(cell, cell.all), b.at(cell, cell.all), 0
    if #x ~= #y then fail("form:dot", "one form has %d values a cell, the other %d", #x, #y) end
    for c = 1, #x do sum = sum + x[c] * y[c] end
    return dual and sum / cell.star or cell.star * sum
  end)
end

M.size = size
return M
