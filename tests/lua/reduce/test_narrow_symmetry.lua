-- what breaks a symmetry in a place narrower than the samples are apart is found by bounds
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function bump(x, c, w) return dm.exp(-((x - c) / w) ^ 2) end
local function free(q, v) return (v[1] ^ 2 * (1 + q[2] ^ 2) + v[2] ^ 2) / 2 - q[2] ^ 2 / 2 end
local function reduced(L) return dm.system({ Q = dm.R(2), L = L }):routh { cyclic = "q1", mu = 0.5 } end
local function formula(extra)
  return dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(a, b, h)
    local m = (a + b) / 2
    return h * (free(m, (b - a) / h) - extra(a, m))
  end }
end

local shape = reduced(free)
for _, w in ipairs { 0.1, 1e-2, 1e-3 } do
  for _, at in ipairs { 1.7, -23.4 } do
    raises("L is not invariant", reduced, function(q, v) return free(q, v) - 0.1 * bump(q[1], at, w) end)
    raises("L is not invariant", reduced, function(q, v)
      return free(q, v) - 0.1 * bump(q[1], at, w) * bump(q[2], -0.6, w)
    end)
    raises("this Ld is not invariant", shape.discrete, shape, formula(function(_, m)
      return 0.1 * bump(m[1], at, w)
    end))
    raises("this Ld is not invariant", shape.discrete, shape, formula(function(a, m)
      return 0.1 * bump(a[1], at, w) * bump(m[2], 0.4, w)
    end))
  end
  ok(reduced(function(q, v) return free(q, v) - 0.1 * bump(q[2], 0.4, w) end):discrete(
    formula(function(_, m) return 0.1 * bump(m[2], 0.4, w) end)), "a bump of the shape is none")
end
tap.done()
