--- The curve of a space, as C traces it for a system: q of (t, phase, h, z), and the first guess of
-- z. Spaces of functions are looked at in numbers first: do the functions depend on each other, can
-- the curve meet both ends, does the quadrature tell its velocities apart?
local core = require "dm.core"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local cos, pi = math.cos, math.pi

local GALERKIN, MULTISCALE = "dm.galerkin", "dm.multiscale"
local ROUND = 1e-9            -- a column that is less beside the others depends on them
local FEW_NODES, FEW_PHASES = 6, 15  -- with fewer the phase must turn by RESOLVED radians a step
local RESOLVED, LEAST = 3, 0.5

---- functions in numbers ----

-- values of all functions at t
local function values(f, t, h, count)
  local list = f(t, h)
  if type(list) ~= "table" or #list ~= count then
    options.fail(GALERKIN, "'functions' returned %d functions at first and %s at t = %g", count,
      type(list) == "table" and #list or type(list), t)
  end
  for a = 1, count do
    if type(list[a]) ~= "number" or list[a] - list[a] ~= 0 then
      options.fail(GALERKIN, "function %d of the space is %s at t = %g, h = %g: it must be finite "
        .. "from 0 to h", a, options.got(list[a]), t, h)
    end
  end
  return list
end

-- the column that depends on those before it, of rows of numbers, by Gram and Schmidt; nil: none
local function dependent(rows, count)
  local columns = {}
  for a = 1, count do
    local x, size = {}, 0
    for i = 1, #rows do x[i] = rows[i][a] end
    local column = core.vector(x)
    size = column:norm()
    if size == 0 then return a end
    column = column / size
    for _ = 1, 2 do
      for b = 1, a - 1 do column = column - columns[b]:dot(column) * columns[b] end
    end
    if column:norm() < ROUND then return a end
    columns[a] = column / column:norm()
  end
end

-- rows of values over the step
local function sampled(f, h, count)
  local rows, N = {}, 4 * count + 9
  for i = 0, N do rows[i + 1] = values(f, h * (1 - cos(pi * i / N)) / 2, h, count) end
  return rows
end

local function check_ends(f, h, count)
  local a, b = core.vector(values(f, 0, h, count)), core.vector(values(f, h, h, count))
  local x, y = a:norm(), b:norm()
  local inner = x > 0 and y > 0 and a:dot(b) / (x * y) or 1
  if x == 0 or y == 0 or (a / x - inner * (b / y)):norm() < ROUND then
    options.fail(GALERKIN, "curves of this space cannot meet both ends of a step of h = %g: what "
      .. "the functions are at 0 and at h must be independent", h)
  end
end

-- velocities at the nodes, and the functions at 0, which are given: their rank is the step's
local function check_quadrature(given, f, slopes, h, count)
  local nodes = core.quadrature(given)
  local rows, pieces = { values(f, 0, h, count) }, given.pieces or 1
  for piece = 0, pieces - 1 do
    for i = 1, #nodes do rows[#rows + 1] = slopes((piece + nodes[i]) * h / pieces) end
  end
  if dependent(rows, count) then
    options.fail(GALERKIN, "quadrature '%s' is too coarse for %d functions: some curve of the "
      .. "space has no velocity at its nodes, and the step is not determined; take more nodes",
      given.text:match "functions, (.*)%) %(own%)" or "own", count)
  end
end

-- t -> derivatives of the functions by t
local function slopes_of(f, h, count)
  local J
  return function(t)
    J = J or core.derivative(function(x) return core.vector(f(x[1], h)) end, 1)
    local matrix, out = J { t }, {}
    for a = 1, count do out[a] = matrix[a][1] end
    return out
  end
end

local function check_functions(given, f, h, count)
  local a = dependent(sampled(f, h, count), count)
  if a then
    options.fail(GALERKIN, "the functions depend on each other: number %d is a combination of "
      .. "those before it from 0 to h = %g", a, h)
  end
  check_ends(f, h, count)
  check_quadrature(given, f, slopes_of(f, h, count), h, count)
end

---- curves ----

local curves = {}

-- one space for all coordinates, or one for each
function curves.functions(given, n, h)
  local functions, counts = given.functions, given.counts
  if not given.same and #functions ~= n then
    options.fail(GALERKIN, "'functions' is a list of %d spaces, and the system has %d coordinates",
      #functions, n)
  end
  for i, f in ipairs(functions) do check_functions(given, f, h, counts[i]) end
  return function(t, _, step, z)
    local out, first = {}, 0
    for i = 1, n do
      local k = given.same and 1 or i
      local list, sum = functions[k](t, step), 0
      for a = 1, counts[k] do sum = sum + z[first + a] * list[a] end
      out[i], first = sum, first + counts[k]
    end
    return out
  end
end

-- any curve of a script
function curves.curve(given, n)
  local function start(q, v, h)
    return lists.numbers("'start'", given.start(q, v, h), given.parameters,
      "%s must return the %d parameter%s of the curve (got %s)")
  end
  return function(t, _, h, z)
    local q = given.curve(t, z, h)
    if n == 1 and type(q) == "userdata" and not lists.count(q) then q = { q } end
    if type(q) == "number" or lists.count(q) ~= n then
      options.fail(GALERKIN, "'curve' must return the %d coordinates of the system (got %s)", n,
        tostring(lists.got(q)))
    end
    return q
  end, start
end

-- number i of a list, or the number for all
local function entry(x, i) return type(x) == "table" and x[i] or x end

local function check_multiscale(given, n, h)
  for _, key in ipairs { "degrees", "oscillating" } do
    if type(given[key]) == "table" and #given[key] ~= n then
      options.fail(MULTISCALE, "'%s' is a list of %d numbers, and the system has %d coordinates",
        key, #given[key], n)
    end
  end
  local turn = h * given.frequency
  if turn < LEAST then
    options.fail(MULTISCALE, "a step of h = %g is %.3g radians of the fast motion, which "
      .. "polynomials follow: take a larger h, or another rule, gauss(3)", h, turn)
  end
  if turn < RESOLVED and (given.nodes < FEW_NODES or given.phases < FEW_PHASES) then
    options.fail(MULTISCALE, "a step of h = %g is %.3g radians of the fast motion; below %d take "
      .. "nodes = %d and phases = %d at least, a larger h, or another rule", h, turn, RESOLVED,
      FEW_NODES, FEW_PHASES)
  end
end

-- sum_j z_(first + j) x^j, j = 0 .. degree
local function polynomial(z, first, degree, x)
  local sum, power = z[first + 1], 1
  for j = 1, degree do
    power = power * x
    sum = sum + z[first + 1 + j] * power
  end
  return sum, first + degree + 1
end

-- (t, phase, h, z) -> coordinate i and what of z is behind it, polynomials in t/h
local function two_scales(given, i)
  local degree, oscillating = entry(given.degrees, i), entry(given.oscillating, i)
  return function(x, s, c, z, first)
    local slow, at = polynomial(z, first, degree, x)
    if given.product then return slow * (1 + z[at + 1] * s + z[at + 2] * c), at + 2 end
    local by_sine, by_cosine
    by_sine, at = polynomial(z, at, oscillating, x)
    by_cosine, at = polynomial(z, at, oscillating, x)
    return slow + by_sine * s + by_cosine * c, at
  end
end

-- the straight line, without vibration
local function product_start(given, n)
  return function(q, v, h)
    local out = {}
    for i = 1, n do
      local degree = entry(given.degrees, i)
      out[#out + 1], out[#out + 2] = q[i], h * v[i]
      for _ = 2, degree + 2 do out[#out + 1] = 0 end
    end
    return out
  end
end

function curves.multiscale(given, n, h)
  check_multiscale(given, n, h)
  local parts = {}
  for i = 1, n do parts[i] = two_scales(given, i) end
  return function(t, phase, step, z)
    local out, first, s, c = {}, 0, core.sin(phase), core.cos(phase)
    for i = 1, n do out[i], first = parts[i](t / step, s, c, z, first) end
    return out
  end, given.product and product_start(given, n) or nil
end

--- The curve of the options of core.trial_rule on a system with steps of h, and `start` or nil.
function M.curve(given, system, h)
  local curve, start = curves[given.kind](given, system.Q.dimension, h)
  return curve, start
end

return M
