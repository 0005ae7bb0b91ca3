--- Invariant problems with both ends given: the sum of L over all windows is stationary in the
-- points between, all at once.
--
-- The sum is the same in the points as in the invariants, so that nothing is lost; constraints come
-- with a multiplier for each window. Ends that are left free have the natural conditions of the
-- sum.
local core = require "dm.core"
local curves = require "dm.frame.invariant_curve"
local frames = require "dm.frame"
local options = require "dm.base.options"

local M = {}

local function check(o)
  options.check(o, { "first", "last", "n", "guess" }, "problem:boundary",
    "{ first =, last =, n = }")
  options.need(o, "n", "problem:boundary", "the number of points")
  options.whole(o, "n", "problem:boundary", 3)
  options.callable(o, "guess", "problem:boundary", "the number of a point")
end

-- the options with both ends as lists of vectors
local function ends_of(p, o)
  check(o)
  local out = { n = o.n, guess = core.one(o.guess, "guess") }
  for _, key in ipairs { "first", "last" } do
    out[key] = frames.list(o[key], p.d,
      "problem:boundary: 'first' and 'last' must be lists of the points given at both ends")
  end
  return out
end

-- points by number: given, or guessed: on the line between the ends where nothing is said
local function points_of(p, o)
  local n, out = o.n, {}
  for i, z in ipairs(o.first) do out[i] = z end
  local ends = #o.last
  for i, z in ipairs(o.last) do out[n - ends + i] = z end
  if #o.first + ends >= n then error("problem:boundary: all points are given", 0) end
  local a, b = out[#o.first], out[n - ends + 1]
  if not (o.guess or a and b) then
    error("problem:boundary: without points at both ends give a 'guess'", 0)
  end
  for i = #o.first + 1, n - ends do
    if o.guess then
      out[i] = frames.point(o.guess(i), p.d, "guessed point " .. i)
    else
      local s = (i - #o.first) / (n - ends + 1 - #o.first)
      out[i] = a * (1 - s) + b * s
    end
  end
  return out
end

-- L - mu . phi of a window whose sites hold (u, mu)
local function term(p)
  local b = p.d + p.constraints
  return function(w)
    local list, mu = {}, {}
    for j = 1, p.N do
      local z = {}
      for a = 1, p.d do z[a] = w[(j - 1) * b + a] end
      list[j] = core.vector(z)
    end
    for c = 1, p.constraints do mu[c] = w[p.d + c] end
    local sum = p.lagrangian(list)
    if p.constraints > 0 then
      local phi = p.phi(list)
      for c = 1, p.constraints do sum = sum - mu[c] * phi[c] end
    end
    return sum
  end
end

-- the numbers of all sites, and which of them stay
local function sites(p, o, points)
  local x, given, n = {}, {}, o.n
  local function is_given(i) return i <= #o.first or i > n - #o.last end
  for i = 1, n do
    for a = 1, p.d do
      x[#x + 1], given[#given + 1] = points[i][a], is_given(i)
    end
    -- a constraint acts where its window has a free point
    local free = false
    for j = i, math.min(i + math.max(p.reach, 1) - 1, n) do free = free or not is_given(j) end
    for _ = 1, p.constraints do
      x[#x + 1], given[#given + 1] = 0, i > n - p.N + 1 or not free
    end
  end
  return x, given
end

-- y: blocks of b numbers, a point and the multipliers there
local function curve_of(p, y, b)
  local rows, mu = {}, {}
  for i = 1, #y // b do
    rows[i], mu[i] = {}, {}
    for a = 1, p.d do rows[i][a] = y[(i - 1) * b + a] end
    for c = 1, p.constraints do mu[i][c] = y[(i - 1) * b + p.d + c] end
  end
  return setmetatable({ points = core.matrix(rows),
    multiplier = p.constraints > 0 and core.matrix(mu) or nil }, curves.Curve)
end

M.doc = [[
problem:boundary{first=, last=, n=, guess=} -> curve
The sequence of n points with the given first and last ones (lists of points: N - 1 at an end fix
all of it, fewer leave the natural conditions of the sum) that makes the sum of L stationary:
Newton's method on all points at once, from guess(i) or the line between the ends. curve: points
(dm.matrix), multiplier, iterations, residual. Raises a dm.failure with the points it had where it
does not converge.]]

function M.solve(p, options)
  local o = ends_of(p, options)
  local points = points_of(p, o)
  if o.n < p.N then error(("problem:boundary: n must be at least %d"):format(p.N), 0) end
  local x, given = sites(p, o, points)
  local b = p.d + p.constraints
  local y, report = curves.run(core.stationary, { term = term(p), sites = o.n, block = b,
    window = p.N, x = x, given = given }, function(y) return curve_of(p, y, b) end)
  local curve = curve_of(p, y, b)
  curve.iterations, curve.residual = report.iterations, report.residual
  if report.code ~= "ok" then
    error(setmetatable({ code = report.code, step = 0, residual = report.residual,
      iterations = report.iterations, path = curve,
      message = ("problem:boundary: %s (residual %.3g after %d iterations): give a better "
      .. "'guess', or go there from a solved problem in small steps; failure.path has the points "
      .. "it had")
        :format(report.text, report.residual, report.iterations) }, curves.Failure), 0)
  end
  return curve
end

return M
