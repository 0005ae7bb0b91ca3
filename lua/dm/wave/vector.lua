--- dm.complex_vector: the values of a wave at its points, with the product of its space: <v, w> is
-- the integral of conj(v) w by the weights of the points.
local class = require "dm.base.class"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local Vector = core.class({ __name = "dm.complex_vector" }, [[
dm.complex_vector: complex numbers at points, as path.psi[i] of a wave
fields: re, im (dm.vectors), x (points), weight (of integrals); #v; + - and * / by numbers]])

local fail = option.fail

--- From re, im, points and weights, all dm.vectors of one length.
function M.new(re, im, x, weight)
  return setmetatable({ re = re, im = im, x = x, weight = weight }, Vector)
end
local new = M.new

function M.is(v) return getmetatable(v) == Vector end

local function match(v, w, where)
  for _, x in ipairs { v, w } do
    if getmetatable(x) ~= Vector then
      fail(where, "a dm.complex_vector is needed (got %s)", option.got(x))
    end
  end
  if w == nil then fail(where, "a dm.complex_vector is needed (got nil)") end
  if #w.re ~= #v.re then fail(where, "the vectors have %d and %d entries", #v.re, #w.re) end
end

---- arithmetic ----

local function like(v, re, im) return new(re, im, v.x, v.weight) end

function Vector.__add(v, w)
  match(v, w, "v + w")
  return like(v, v.re + w.re, v.im + w.im)
end

function Vector.__sub(v, w)
  match(v, w, "v - w")
  return like(v, v.re - w.re, v.im - w.im)
end

function Vector.__unm(v) return like(v, -v.re, -v.im) end

function Vector.__mul(a, b)
  if type(a) == "number" then return like(b, a * b.re, a * b.im) end
  if type(b) == "number" then return like(a, b * a.re, b * a.im) end
  fail("v * a", "complex vectors are multiplied by real numbers; v:times(re, im) by complex ones, "
    .. "v:dot(w) is a product of two")
end

function Vector.__div(v, a)
  if type(a) ~= "number" then fail("v / a", "complex vectors are divided by real numbers") end
  return like(v, v.re / a, v.im / a)
end

function Vector.__len(v) return #v.re end

function Vector.__eq(v, w) return v.re == w.re and v.im == w.im end

function Vector.__tostring(v)
  return ("complex vector of %d: re %s, im %s"):format(#v.re, tostring(v.re), tostring(v.im))
end

---- methods ----

-- one number an entry
local function mapped(v, f)
  local out = core.zeros(#v.re)
  for j = 1, #v.re do out[j] = f(v.re[j], v.im[j]) end
  return out
end

local methods = {}

methods.abs2 = { function(v)
  return mapped(v, function(a, b) return a * a + b * b end)
end, [[
v:abs2() -> dm.vector
|v|^2, entry by entry: the density of a wave.]] }

methods.arg = { function(v)
  return mapped(v, function(a, b) return math.atan(b, a) end)
end, [[
v:arg() -> dm.vector
The phase of the entries, from -pi to pi; 0 where an entry is 0.]] }

methods.dot = { function(v, w)
  match(v, w, "v:dot")
  local re, im = 0, 0
  for j = 1, #v.re do
    local a, b, c, d, weight = v.re[j], v.im[j], w.re[j], w.im[j], v.weight[j]
    re, im = re + weight * (a * c + b * d), im + weight * (a * d - b * c)
  end
  return re, im
end, [[
v:dot(w) -> re, im
<v, w>, the integral of conj(v) w by the weights of the points: linear in w. Raises for another
length.]] }

methods.norm = { function(v) return math.sqrt((v:dot(v))) end, [[
v:norm() -> number
The root of <v, v>: 1 for a normalized wave. On a ring the integral is exact for what the points
can show.]] }

methods.times = { function(v, re, im)
  im = im or 0
  if type(re) ~= "number" or type(im) ~= "number" then
    fail("v:times", "two numbers are needed, re and im")
  end
  return like(v, re * v.re - im * v.im, im * v.re + re * v.im)
end, [[
v:times(re, im) -> dm.complex_vector
(re + i im) v.]] }

for name, row in pairs(methods) do class.method("dm.complex_vector", name, row[1], row[2]) end

return M
