-- numbers, vectors, matrices as a script sees them: closed forms, the same code on three kinds, every misuse
package.path = (arg[0]:match("^(.*/)") or "./") .. "?.lua;" .. package.path
local tap, dm = require "tap", require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local V, M = dm.vector, dm.matrix

local seed = 12345
local function random() -- in [-1, 1)
  seed = (seed * 1103515245 + 12345) % 2147483648
  return seed / 1073741824 - 1
end
local function random_matrix(n, k)
  local m = M(n, k or n)
  for i = 1, n do for j = 1, k or n do m[i][j] = random() end end
  return m
end
local function gap(a, b) -- largest difference of two matrices or vectors
  local worst = 0
  for i = 1, #a do
    worst = math.max(worst, type(a[i]) == "number" and math.abs(a[i] - b[i]) or gap(a[i], b[i]))
  end
  return worst
end

-- vectors
local v, w = V { 1, 2, 3 }, V { -2, 0.5, 4 }
ok(v + w == V { -1, 2.5, 7 } and v - w == V { 3, 1.5, -1 }, "sum and difference")
ok(2 * v == V { 2, 4, 6 } and v * 2 == 2 * v and v / 2 == V { 0.5, 1, 1.5 } and -v == V { -1, -2, -3 }, "multiples")
ok(v + 1 == V { 2, 3, 4 } and 1 - v == V { 0, -1, -2 } and 6 / v == V { 6, 3, 2 }, "a number meets every entry")
ok(v + { 1, 1, 1 } == { 2, 3, 4 } + V(3) and ({ 1, 2, 3 }) - v == V(3), "tables are taken as vectors")
ok(v:dot(w) == 11 and v:dot { -2, 0.5, 4 } == 11 and v:sum() == 6, "dot and sum")
near(v:norm() ^ 2, 14, 1e-14, "norm")
near(V { 3e200, 4e200 }:norm() / 5e200, 1, 1e-15, "norm without overflow")
near(V { 3e-200, 4e-200 }:norm() / 5e-200, 1, 1e-15, "norm without underflow")
ok(v:cross(w) == V { 6.5, -10, 4.5 } and v:cross(w):dot(v) == 0, "cross product of three entries")
ok(V { 1, 2 }:cross { 3, 4 } == -2, "cross product of two entries")
ok(v:outer(w) * w == v * w:dot(w), "outer product times a vector")
ok(v:map(function(x, i) return x * i end) == V { 1, 4, 9 }, "map gets entry and index")
ok(v:slice(2, 3) == V { 2, 3 } and v:slice(2) == v:slice(2, 3) and #v:slice(2, 1) == 0, "slices")
local copy = v:copy()
copy[1] = 10
ok(v[1] == 1 and copy[1] == 10 and V(v) == v and v ~= copy, "a copy is independent")
ok(select("#", table.unpack(v)) == 3 and table.concat(v:totable(), " ") == "1.0 2.0 3.0", "unpack and totable")
local seen = {}
for i, x in ipairs(v) do seen[i] = x end
ok(#seen == 3 and seen[3] == 3 and v[4] == nil, "ipairs stops at the end")
ok(V(3) == dm.zeros(3) and #V(0) == 0 and V {}:norm() == 0, "zeros and the empty vector")
ok(v ~= V { 1, 2 } and v ~= 1 and V { 0 / 0 } ~= V { 0 / 0 }, "inequality by shape, kind and NaN")

-- printing
ok(tostring(v) == "[1, 2, 3]" and tostring(V {}) == "[]", "a vector prints its entries")
local long = V(100)
for i = 1, 100 do long[i] = i / 10 end
ok(tostring(long) == "[0.1, 0.2, 0.3, ... , 10] (100)", "a long vector prints its shape", tostring(long))
ok(tostring(M { { 1, 2 }, { 30, 4 } }) == "[[ 1,  2],\n [30,  4]]", "a matrix prints in rows", tostring(M { { 1, 2 }, { 30, 4 } }))
ok(tostring(dm.zeros(20, 30)):find("(20 x 30)", 1, true), "a large matrix prints its shape")

-- matrices
local A, B, C = random_matrix(3, 4), random_matrix(4, 2), random_matrix(2, 5)
ok(gap((A * B) * C, A * (B * C)) < 1e-14, "products associate")
ok((A * B):transpose() == B:transpose() * A:transpose(), "transpose of a product")
ok(A.rows == 3 and A.columns == 4 and #A == 3 and #A[1] == 4 and A[4] == nil, "shape")
ok(A:row(2) == A[2] and A:column(3)[2] == A[2][3], "rows and columns")
local D = A:copy()
D[2][3] = 7
D[1] = { 1, 2, 3, 4 }
ok(D[2][3] == 7 and D[1] == V { 1, 2, 3, 4 } and A[2][3] ~= 7, "rows are views that can be assigned to")
local row = D[3]
row[1] = 99
ok(D[3][1] == 99, "a view writes to its matrix")
ok(M { V { 1, 2 }, { 3, 4 } } == M { { 1, 2 }, { 3, 4 } } and M(M { { 1 } }) == M { { 1 } }, "rows may be vectors")
ok(A + A == 2 * A and A - A == dm.zeros(3, 4) and -A == A * -1 and (A / 2) * 2 == A, "matrix sums and multiples")
ok(dm.identity(4) * B == B and dm.identity(3):trace() == 3, "identity")
ok(M(M { { 1, 2 }, { 3, 4 } }:totable()) == M { { 1, 2 }, { 3, 4 } }, "totable and back")

-- determinant by the sum over permutations, an independent road
local function det_by_permutations(m)
  local n, total = #m, 0
  local function walk(i, used, sign, product)
    if i > n then total = total + sign * product return end
    for j = 1, n do
      if not used[j] then
        local inversions = 0
        for k = j + 1, n do if used[k] then inversions = inversions + 1 end end
        used[j] = true
        walk(i + 1, used, inversions % 2 == 0 and sign or -sign, product * m[i][j])
        used[j] = nil
      end
    end
  end
  walk(1, {}, 1, 1)
  return total
end
for n = 1, 6 do
  local m, b = random_matrix(n), random_matrix(n, 1):column(1)
  near(m:det(), det_by_permutations(m), 1e-13, n .. " x " .. n .. ": determinant")
  ok(gap(m * m:solve(b), b) < 1e-12 and gap(m * m:inverse(), dm.identity(n)) < 1e-12, n .. " x " .. n .. ": solve, inverse")
  -- the same code on symbols and on hyper-dual numbers
  local function flat(f)
    return function(x)
      local s = M(n, n)
      for i = 1, n do for j = 1, n do s[i][j] = x[(i - 1) * n + j] end end
      return f(s)
    end
  end
  local x = V(n * n)
  for i = 1, n do for j = 1, n do x[(i - 1) * n + j] = m[i][j] end end
  local det, solve = dm.trace(flat(function(s) return s:det() end), n * n), dm.trace(flat(function(s) return s:solve(b) end), n * n)
  near(det(x), m:det(), 1e-12, n .. " x " .. n .. ": traced determinant")
  ok(gap(solve(x), m:solve(b)) < 1e-9, n .. " x " .. n .. ": traced solve", gap(solve(x), m:solve(b)))
  local cofactors = m:inverse():transpose() * m:det() -- Jacobi: d det / d m_ij = cofactor_ij
  local gradient = det:gradient(x)
  local worst, worst_hyper = 0, 0
  for i = 1, n do
    for j = 1, n do
      local h = m:copy()
      h[i][j] = dm.hyperdual(m[i][j], 1)
      worst = math.max(worst, math.abs(gradient[(i - 1) * n + j] - cofactors[i][j]))
      worst_hyper = math.max(worst_hyper, math.abs(h:det().a - cofactors[i][j]))
    end
  end
  ok(worst < 1e-11 and worst_hyper < 1e-11, n .. " x " .. n .. ": derivatives of the determinant are the cofactors", worst + worst_hyper)
end
local swap = dm.trace(function(x) return M { { x[1], 1 }, { 1, x[1] } }:solve { 1, 2 } end, 1)
ok(swap { 0 } == V { 2, 1 }, "a traced 2 x 2 solve needs no pivot")
-- a large unknown that no entry joins to two small ones leaves their derivatives alone: those of w.A^-1 w of these by hand
for name, make in pairs {
  ["on the diagonal"] = function(a, b, c) return M { { a, 0, 0 }, { 0, b, c }, { 0, c, 2 } }, { 1e11, 0.5, 0.3 } end,
  ["beside it"] = function(a, b, c) return M { { 0, b, c }, { a, 0, 0 }, { 0, c, 2 } }, { 0.5, 1e11, 0.3 } end,
} do
  local form = dm.trace(function(x)
    local A, w = make(x[1], x[2], x[3])
    return A:solve(w):dot { 1e11, 0.5, 0.3 }
  end, 3)
  local b, c = 0.7, 0.9
  local slope, u, v = form:gradient { 0.3, b, c }, (0.5 * 2 - 0.3 * c) / (2 * b - c ^ 2), (0.3 * b - 0.5 * c) / (2 * b - c ^ 2)
  ok(math.abs(slope[2] + u ^ 2) < 1e-13 and math.abs(slope[3] + 2 * u * v) < 1e-13, "a traced solve goes block by block: " .. name, slope)
end

-- where the determinant is 0 whatever the symbols are, as it is of numbers
for _, make in ipairs {
  function(a, b) return M { { a, b }, { 0, 0 } } end,
  function(a, b) return M { { a, b, 0 }, { a, b, 0 }, { 0, 0, a } } end,
  function(a, b) return M { { a, b, 0 }, { 0, 0, a }, { 0, 0, b } } end,
} do
  raises("singular", dm.trace, function(x)
    local A = make(x[1], x[2])
    return A:solve(V(A.rows))
  end, 2)
end

-- eigenvalues
local re, im = M { { 2, 1 }, { 1, 2 } }:eigenvalues()
ok(gap(re, V { 1, 3 }) < 1e-14 and im == V(2), "eigenvalues of a symmetric matrix")
re, im = M { { 0, -3 }, { 3, 0 } }:eigenvalues()
ok(gap(re, V(2)) < 1e-14 and gap(im, V { -3, 3 }) < 1e-14, "eigenvalues of a rotation")
local R = random_matrix(7)
re, im = R:eigenvalues()
near(re:sum(), R:trace(), 1e-13, "sum of eigenvalues is the trace")
near(im:sum(), 0, 1e-13, "eigenvalues come in conjugate pairs")

-- misuse of vectors and matrices
raises("a:dot(b)", function() return v * w end)
raises("transpose", function() return v * A end)
raises("cannot divide by a vector", function() return v / w end)
raises("ambiguous", function() return v ^ 2 end)
raises("shapes differ", function() return v + V { 1, 2 } end)
raises("dm.identity", function() return A + 1 end)
raises("a matrix of 3 x 4", function() return A * C end)
raises("out of range", function() return v[0] end)
raises("out of range", function() return v[5] end)
raises("out of range", function() v[4] = 1 end)
raises("whole number", function() return v[1.5] end)
raises("got string", function() v[1] = "x" end)
raises("entry 2 must be a number, got boolean", V, { 1, true })
raises("a surplus argument: dm.vector{", V, 1, 2)
raises("length from 0", V, -1)
raises("row 2 has 1 entries", M, { { 1, 2 }, { 3 } })
raises("row 2 has 3 entries, but the matrix has 2 columns", M, { { 1, 2 }, { 3, 4, 5 } })
raises("row 1 must be", M, { 1, 2 })
raises("expected", M, {})
raises("slice(0, 2)", v.slice, v, 0, 2)
raises("3 and 2 entries", v.dot, v, { 1, 2 })
raises("2 or 3 entries", function() return V(4):cross(V(4)) end)
raises("must return a number", v.map, v, function() end)
raises("square", A.det, A)
raises("square", A.trace, A)
raises("singular", function() return M { { 1, 2 }, { 2, 4 } }:solve { 1, 1 } end)
raises("condition", function() return M { { 1, 2, 3 }, { 4, 5, 6 }, { 7, 8, 9.0000000000000018 } }:inverse() end)
raises("right-hand side", function() return dm.identity(2):solve { 1, 2, 3 } end)
raises("NaN, not a finite", function() return M { { 0 / 0 } }:solve { 1 } end)
raises("infinite, not a finite", function() return M { { 1 / 0, 1 }, { 1, 1 } }:eigenvalues() end)
raises("dm.vector expected", v.dot, {}, v)
raises("row 7 is out of range", function() return A[7] end)
raises("at least one row", function() return V {}:outer { 1 } end)
raises("too many", M, 1 << 24, 1 << 24)

-- math.* is Lua's own on numbers: same values, same messages
local calls = { "abs", "ceil", "floor", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "tointeger", "modf" }
local same, messages = true, true
for _, name in ipairs(calls) do
  local own = debug.getregistry().dm_math[name]
  for _, x in ipairs { 0, 1, -1, 0.5, -2.75, 1e300, math.huge, math.mininteger } do
    local a, b = { math[name](x) }, { own(x) }
    for i = 1, math.max(#a, #b) do
      same = same and (a[i] == b[i] or a[i] ~= a[i] and b[i] ~= b[i]) and math.type(a[i]) == math.type(b[i])
    end
  end
  local _, message = pcall(load("local x = math." .. name .. "({})", "=chunk"))
  messages = messages and (name == "tointeger" or message == "chunk:1: bad argument #1 to '" .. name .. "' (number expected, got table)")
end
local plain = true
for name, f in pairs(math) do
  local own = name:find "^random" or type(f) ~= "function" -- these have their state there
  plain = plain and (own or debug.getinfo(f, "u").nups == 0)
end
ok(plain and debug.getupvalue(math.sin, 1) == nil, "functions of math have no upvalues, as in Lua")
-- arguments that Lua converts, compares or refuses in ways of its own (lmathlib.c of 5.4)
local odd = {
  { 'math.max("10", "9")', "9" }, { 'math.max("a", "b")', "b" }, { "math.max(nil)", "nil" },
  { "math.max(1, 1.0)", "1" }, { "math.min(2^53, math.maxinteger)", "9.007199254741e+15" },
  { "math.max(-0.0, 0.0)", "-0.0" }, { 'math.floor("3.7")', "3" }, { "math.floor(-3.5)", "-4" },
  { "math.ceil(2^53 + 2)", "9007199254740994" }, { "math.floor(1e300)", "1e+300" },
  { "math.abs(math.mininteger)", "-9223372036854775808" }, { 'math.abs("-4")', "4.0" },
  { "math.fmod(-7, 3)", "-1" }, { "math.log(8, 2)", "3.0" }, { "math.log(1000, 10)", "3.0" },
  { "math.atan(1, nil) == math.atan(1)", "true" },
}
for _, case in ipairs(odd) do
  local got = tostring(load("return " .. case[1])())
  ok(got == case[2], case[1] .. " is " .. case[2], got)
end
raises("attempt to compare", math.max, "10", 5)
raises("bad argument #2 to 'math.fmod' (zero)", math.fmod, 1, 0)
-- max and min see a symbol or hyper-dual number behind any number of plain ones
local third = dm.derivative(function(x) return math.max(1, 2, x[1], 0.5) + math.min(x[1], 9, 8) end, 1)
ok(third { 3 }[1] == 2 and third { 1.5 }[1] == 1, "the derivatives of max and min of several")
local h = math.max(1, dm.hyperdual(3, 1, 1), 2)
ok(h.f == 3 and h.a == 1 and math.min(h, 1) == 1 or math.min(h, 1).f == 1, "max of hyper-dual numbers")
raises("the comparison < or > met a symbol", dm.trace, function(x) return x[1] < 2 and 1 or 2 end, 1)

ok(same, "math.* gives what Lua's own functions give")
ok(messages, "math.* raises what Lua's own functions raise")
ok(math.max(1, 2.5, -3) == 2.5 and math.type(math.max(1, 2)) == "integer" and math.fmod(7, -3) == 1, "max, fmod on numbers")
raises("bad argument #1 to 'max' (value expected)", function() local x = math.max() return x end)
raises("number expected, got dm.vector", math.sin, v)
ok(dm.sin(0.5) == math.sin(0.5) and dm.where(1, 2, 3) == 2 and dm.where(0, 2, 3) == 3 and dm.sign(-4) == -1, "dm has the same functions")
near(dm.sinh(1), (math.exp(1) - math.exp(-1)) / 2, 1e-15, "dm.sinh")
near(dm.tanh(0.3), dm.sinh(0.3) / dm.cosh(0.3), 1e-16, "dm.tanh")

-- what Lua does not look at is left out of traces and of hyper-dual numbers, too
for name, f in pairs { atan = function(x) return math.atan(x, nil) end, log = function(x) return math.log(x, nil) end,
  sin = function(x) return math.sin(x, nil) end, exp = function(x) return math.exp(x, "a text") end, abs = function(x) return math.abs(x, {}) end } do
  local x, h = 0.3, 1e-4
  local slope = (f(x + h) - f(x - h)) / (2 * h)
  near(dm.trace(f):gradient(x)[1], slope, 1e-6, name .. " of a symbol and what Lua does not look at")
  near(f(dm.hyperdual(x, 1)).a, slope, 1e-6, "and of a hyper-dual number")
end
raises("fmod' (number expected, got nil)", math.fmod, dm.hyperdual(1), nil)

-- hyper-dual numbers against traced derivatives: two independent roads for every function
local h = dm.hyperdual
local one = {
  sin = math.sin, cos = math.cos, tan = math.tan, asin = math.asin, acos = math.acos, atan = math.atan, exp = math.exp,
  log = math.log, sqrt = math.sqrt, abs = math.abs, sinh = dm.sinh, cosh = dm.cosh, tanh = dm.tanh, sign = dm.sign,
  negative = function(x) return -x end, inverse = function(x) return 1 / x end, cube = function(x) return x ^ 3 end,
  root = function(x) return x ^ 0.5 end, power = function(x) return 2 ^ x end, self = function(x) return x ^ x end,
  log2 = function(x) return math.log(x, 2) end, angle = function(x) return math.atan(x, 1 - x) end,
  larger = function(x) return math.max(x * x, 0.1, x) end, smaller = function(x) return math.min(x, 2, x / 2) end,
  chosen = function(x) return dm.where(x - 0.3, x ^ 2, x ^ 4) end,
}
for name, f in pairs(one) do
  local worst, g = 0, dm.trace(f)
  for _, x in ipairs { 0.11, 0.37, 0.86 } do
    local y, slope, curve = f(h(x, 1, 1, 0)), g:gradient(x)[1], g:hessian(x)[1][1]
    worst = math.max(worst, math.abs(y.f - f(x)), math.abs(y.a - slope) / (1 + math.abs(slope)),
      math.abs(y.ab - curve) / (1 + math.abs(curve)), math.abs(y.a - y.b))
  end
  ok(worst < 2e-14, "hyper-dual " .. name .. " has the traced derivatives", worst)
end
local function two(x) return x[1] ^ x[2] * math.atan(x[1], x[2]) / (x[1] - 3 * x[2]) end
local mixed = two(V { h(0.7, 1, 0), h(0.4, 0, 1) })
local traced = dm.trace(two, 2)
near(mixed.ab, traced:hessian { 0.7, 0.4 }[1][2], 1e-11, "mixed second derivative")
near(mixed.b, traced:gradient { 0.7, 0.4 }[2], 1e-12, "derivative along the second direction")
ok(h(2) < 3 and h(2) <= h(2) and h(2) == h(2, 1) and not (h(2) > 2), "comparisons work on the value")
ok(math.floor(h(2.7, 1)) == 2 and math.ceil(h(2.2)) == 3 and h(7.5) // 2 == 3, "floor, ceil, // on the value")
ok((h(7.5, 1) % 2).f == 1.5 and (h(7.5, 1) % 2).a == 1 and math.fmod(h(-7.5, 1), 2).f == -1.5, "% and fmod keep the slope")
ok((h(0, 1, 1) ^ 2).ab == 2 and (h(0, 1, 1) ^ 1).ab == 0 and (h(0, 1) ^ 2).a == 0, "powers at zero")
ok(h(4, 1).f == 4 and h(4).zz == nil and tostring(h(1, 2)):find("1 + 2 e1", 1, true), "fields and text")
raises("numbers only", function() return h(1) < "x" end)
raises("cannot compute", function() return h(1) + "x" end)

-- options and their messages
raises("did you mean 'derivatives'", dm.system, { Q = dm.R(1), L = print, derivative = "exact" })
-- singular matrices have the determinant 0; what overflows on the way is told; eigenvalues in any units
for _, rows in ipairs { { { 0, 1 }, { 0, 2 } }, { { 0, 0 }, { 0, 0 } }, { { 1, 2 }, { 2, 4 } }, { { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } },
  { { 1, 0, 2 }, { 3, 0, 4 }, { 5, 0, 6 } }, { { 1, 2, 3, 4 }, { 2, 4, 6, 8 }, { 0, 0, 1, 1 }, { 1, 0, 0, 1 } } } do
  ok(dm.matrix(rows):det() == 0, #rows .. " x " .. #rows .. ": a determinant that is 0", dm.matrix(rows):det())
end
raises("overflows", function() return dm.matrix { { 1e308, 1e308 }, { 1e308, -1e308 } }:inverse() end)
raises("overflows", function() return dm.matrix { { 1e308, 1e308, 0 }, { 1e308, -1e308, 1 }, { 1, 1, 0 } }:det() end)
for _, s in ipairs { 1, 1e-200, 1e-160, 1e160, 1e300 } do
  local re, im = dm.matrix { { s, 2 * s }, { -s, s } }:eigenvalues()
  ok(math.abs(re[1] / s - 1) + math.abs(im[2] / s - math.sqrt(2)) < 1e-15, "eigenvalues of entries of size " .. s, im[2] / s)
  re = dm.matrix { { s, s }, { s, -s } }:eigenvalues()
  ok(math.abs(re[2] / s - math.sqrt(2)) < 1e-15, "  of a symmetric matrix", re[2] / s)
end
ok(dm.matrix({ { 1e200, 0 }, { 0, 1e-200 } }):eigenvalues()[1] == 1e-200, "small ones beside large ones stay")

tap.done()
