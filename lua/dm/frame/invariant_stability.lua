--- Linear stability of invariant schemes: the recurrence y -> y' of an invariant problem,
-- linearized about a solution, exact from the graph, its characteristic roots, and how much its
-- powers grow.
--
-- With R(y, x) = 0 and y' = next(y, x):  dy' = (next_y - next_x R_x^-1 R_y) dy, restricted to
-- windows that stay on the cross-section. A root 1 that is there k times over in one Jordan block
-- lets one error grow like n^(k-1), and the errors of n steps like n^k, although no root is larger
-- than 1 (Bogfjellmo 6.1: k = 3).
local core = require "dm.core"
local equations = require "dm.frame.invariant_equations"
local frames = require "dm.frame"
local option = require "dm.base.options"
local tangent = require "dm.frame.tangent"
local windows = require "dm.frame.invariant_windows"
local starts = require "dm.frame.invariant_start"

local M = {}

local abs, max, sqrt, log = math.abs, math.max, math.sqrt, math.log

---- the linear map ----

-- orthonormal vectors that the rows of A annihilate, in R^n: Gram-Schmidt of unit vectors
local function kernel(A, rows, n)
  local taken, out = {}, {}
  local function reduced(v)
    for _ = 1, 2 do
      for _, u in ipairs(taken) do
        local c = 0
        for i = 1, n do c = c + u[i] * v[i] end
        for i = 1, n do v[i] = v[i] - c * u[i] end
      end
    end
    local size = 0
    for i = 1, n do size = size + v[i] * v[i] end
    return sqrt(size)
  end
  local function take(v, least, list)
    local size = reduced(v)
    if size <= least then return end
    for i = 1, n do v[i] = v[i] / size end
    taken[#taken + 1] = v
    if list then list[#list + 1] = v end
  end
  for i = 1, rows do
    local v = {}
    for j = 1, n do v[j] = A[i][j] end
    take(v, 1e-12 * (1 + reduced { table.unpack(v) }))
  end
  for j = 1, n do
    local v = {}
    for i = 1, n do v[i] = i == j and 1 or 0 end
    take(v, 1e-6, out)
  end
  return out
end

-- places in y of what the map acts on
local function core_places(form)
  local out = {}
  for _, name in ipairs(form.core) do
    local part = form.layout.parts[name]
    for i = 1, part[2] do out[#out + 1] = part[1] + i end
  end
  return out
end

-- directions of the core that keep the window on the section
local function tangents(p, form, y, places)
  local window = windows.blocks(form.layout:get(y, "U"), p.window, p.d)
  local J = tangent.section_slope(p.frame, windows.for_frame(p, window))
  local given, out = {}, {}
  -- the section looks at its first points only
  for i = 1, p.r do
    given[i] = {}
    for j = 1, p.window * p.d do given[i][j] = j <= p.k * p.d and J[i][j] or 0 end
  end
  for _, v in ipairs(kernel(given, p.r, p.window * p.d)) do
    local w = {}
    for i = 1, #places do w[i] = v[i] or 0 end
    out[#out + 1] = w
  end
  for i = p.window * p.d + 1, #places do
    local w = {}
    for j = 1, #places do w[j] = i == j and 1 or 0 end
    out[#out + 1] = w
  end
  return out
end

-- the derivative of f(a, b); what cancels is compared with its trace beside 1
local function slope_of(f, y, x)
  local function shifted(a, b) return core.vector(f(a, b)):map(function(w) return 1 + w end) end
  return core.derivative(shifted, #y, #x)(y, x)
end

-- d y'/d y on the core, as rows
local function slope(form, y, x, places)
  local n, m = #y, #x
  local R, S = slope_of(form.equation, y, x), slope_of(form.next, y, x)
  local Rx, Ry, Sx = {}, {}, {}
  for i = 1, m do
    Rx[i], Ry[i] = {}, {}
    for j = 1, m do Rx[i][j] = R[i][n + j] end
    for j, at in ipairs(places) do Ry[i][j] = R[i][at] end
  end
  for i, at in ipairs(places) do
    Sx[i] = {}
    for j = 1, m do Sx[i][j] = S[at][n + j] end
  end
  local through = core.matrix(Sx) * core.matrix(Rx):solve(core.matrix(Ry))
  local out = {}
  for i, at in ipairs(places) do
    out[i] = {}
    for j, from in ipairs(places) do out[i][j] = S[at][from] - through[i][j] end
  end
  return core.matrix(out)
end

-- B^T A B with the vectors of B as columns
local function restricted(A, B)
  local rows = core.matrix(B)
  return rows * A * rows:transpose()
end

---- what it says ----

local function largest_entry(A)
  local worst = 0
  for i = 1, #A do
    for j = 1, #A do worst = max(worst, abs(A[i][j])) end
  end
  return worst
end

-- largest entry of A^n, and the exponent of its growth between n/2 and n
local function growth(A, n)
  local power, half, k = A, nil, 1
  while 2 * k <= n do
    half, power, k = power, power * power, 2 * k
  end
  local a, b = half and largest_entry(half) or 1, largest_entry(power)
  return b, half and log(b / a, 2) or 0, k
end

-- roots within a distance of 1
local NEAR = 0.3
local function near_one(re, im)
  local count, spread = 0, 0
  for i = 1, #re do
    local d = sqrt((re[i] - 1) ^ 2 + im[i] ^ 2)
    if d < NEAR then count, spread = count + 1, max(spread, d) end
  end
  return count, spread
end

-- largest entry of A - 1
local function from_one(A)
  local B = A:copy()
  for i = 1, #B do B[i][i] = B[i][i] - 1 end
  return largest_entry(B)
end

-- |A - 1| of a step that is not near the identity, and |A^16| beside 16^(k - 1) where the root 1 is
-- k times in a Jordan block
local FAR, EARLY, BLOCK = 0.5, 16, 0.05
local function in_a_block(A, out)
  local early = growth(A, EARLY)
  return out.multiplicity > 1 and out.distance > FAR
    and early > BLOCK * EARLY ^ (out.multiplicity - 1)
end

local function words(form, out)
  local text = ("%s: "):format(form)
  if out.multiplicity > 1 then
    text = text .. ("1 is a root %d times (to %.1g)"):format(out.multiplicity, out.spread)
  else
    text = text .. ("largest root %.9g"):format(out.largest)
  end
  text = text .. ("; %d steps multiply an error by %.3g"):format(out.steps, out.growth)
  if out.largest > 1.05 and out.growth > 1e6 then
    return text .. (": the root %.6g runs away, it cannot be run as an initial value problem; "
      .. "give both ends (problem:boundary)"):format(out.largest)
  elseif out.jordan then
    local k = out.multiplicity
    return text .. (": the matrix is not near 1 (by %.2g), so these roots stand in a Jordan "
      .. "block: an error grows like n^%d, those of n steps like n^%d, and with a smaller h "
      .. "round-off wins")
      :format(out.distance, k - 1, k)
  end
  local near = out.distance < FAR and ("its matrix is 1 to %.2g"):format(out.distance)
    or "no Jordan block of the root 1 lasts"
  return ("%s (%s): errors grow as those of a differential equation do"):format(text, near)
end

local function of_form(p, name, o)
  local list = frames.list(o.points, p.d, "problem:stability: 'points' must be a list of points")
  p.window = name == "points" and max(2 * p.N - 2, p.k) or max(p.N - 1, p.k)
  local values = starts.from_points(p, name, list, o.multiplier)
  local form = equations[name .. "_form"](p)
  local y = form.layout:pack(values)
  local rows, report = core.sequence {
    equation = form.equation, next = form.next, start = form.start, scale = form.scale, y = y,
    unknowns = p.d + p.constraints, steps = 1, check = false }
  if report.code ~= "ok" then
    error("problem:stability: the step from these points fails: " .. report.text, 0)
  end
  local x, places = core.vector(form.layout:get(rows[2], "x1")), core_places(form)
  local moved = 0
  for _, at in ipairs(places) do moved = max(moved, abs(rows[2][at] - y[at]) / (1 + abs(y[at]))) end
  local A = restricted(slope(form, y, x, places), tangents(p, form, y, places))
  local re, im = A:eigenvalues()
  local out = { form = name, re = re, im = im, matrix = A, moved = moved, largest = 0 }
  for i = 1, #re do out.largest = max(out.largest, sqrt(re[i] ^ 2 + im[i] ^ 2)) end
  out.multiplicity, out.spread = near_one(re, im)
  out.distance = from_one(A)
  out.jordan = in_a_block(A, out)
  out.growth, out.exponent, out.steps = growth(A, o.steps or 128)
  out.why = words(name, out)
  return out
end

M.doc = [[
problem:stability{points=, multiplier=, steps=} -> {points, momentum, why, constant}
The recurrence of the invariants linearized about the solution through these points (2 N - 2; one
more with a constraint), for both forms of problem:solve. Of each form: re, im (its characteristic
roots), largest (modulus), multiplicity (roots within 0.3 of 1) and spread, distance (the largest
entry of the matrix - 1), growth (the largest entry of the matrix to the power `steps`, a power of
two, default 128), exponent (that growth goes like n^exponent), jordan (does 1 stand in a Jordan
block, so that errors grow by powers of n whatever h is?), why, in words. constant: do the
invariants stay as they are from step to step, so that the roots belong to the whole run (else to
this place of it)?]]

local Report = { __name = "dm.frame.invariant_stability",
  __tostring = function(s) return s.why end }

function M.stability(p, o)
  local where = "problem:stability"
  option.check(o, { "points", "multiplier", "steps" }, where, "{ points = }")
  option.need(o, "points", where, "the first points of a solution")
  option.whole(o, "steps", where, 2, 2 ^ 20)
  local out = { points = of_form(p, "points", o), momentum = of_form(p, "momentum", o) }
  out.constant = out.points.moved < 1e-6
  out.why = out.points.why .. "\n" .. out.momentum.why
  if not out.constant then
    out.why = out.why .. "\nthe invariants are not constant here: roots of this place of the "
      .. "solution"
  end
  return setmetatable(out, Report)
end

return M
