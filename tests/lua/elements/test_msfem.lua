-- multiscale elements: exact at the nodes on any mesh, against closed forms; what is refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, pi, exp, log = math.sin, math.cos, math.pi, math.exp, math.log

local function one() return 1 end
local mesh = { 0, 0.13, 0.4, 0.55, 0.9, 1 }
local function worst(s, u)
  local off = 0
  for i = 1, #s.u do off = math.max(off, math.abs(s.u[i] - u(s.x[i]))) end
  return off
end

-- a = exp(x), f = 1: u = A - (x + 1 + c) exp(-x)
local c = (2 * exp(-1) - 1) / (1 - exp(-1))
local function u(x) return 1 + c - (x + 1 + c) * exp(-x) end
local s = dm.msfem { a = exp, f = one, x = mesh }
ok(worst(s, u) < 1e-14, "a = exp(x): exact at the nodes", worst(s, u))
near(s:exact(0.7), u(0.7), 1e-14, "  the exact solution between them")
ok(worst(dm.msfem { a = exp, f = one, x = mesh, shape = "linear" }, u) > 1e-4, "  hats are not")
ok(worst(dm.msfem { a = exp, f = one, x = mesh, antiderivative = function(x) return -exp(-x) end }, u) < 1e-14,
  "  with the antiderivative of 1/a")

-- constant a: both are the same, and exact
for _, shape in ipairs { "multiscale", "linear" } do
  local flat = dm.msfem { a = function() return 2 end, f = sin, x = { -1, 0.2, 0.3, 2 }, shape = shape }
  local b = (sin(2) + sin(1)) / 3
  local function exact(x) return (-sin(x) + b * (x + 1) - sin(1)) / 2 end
  ok(worst(flat, exact) < 1e-14, "constant a, " .. shape, worst(flat, exact))
end

-- Leok's figure 5.5: a = 10/(1 + 0.95 sin(2 pi x/eps)), f = x^2
local eps, nodes = 0.025, {}
for i = 0, 8 do nodes[i + 1] = i / 8 end
local rod = dm.msfem { a = function(x) return 10 / (1 + 0.95 * sin(2 * pi * x / eps)) end, f = function(x) return x ^ 2 end,
  x = nodes, period = eps }
near(rod:exact(0.62677), -0.00388885, 5e-9, "figure 5.5: its least value")
ok(worst(rod, function(x) return rod:exact(x) end) < 1e-15, "  at the nodes")
ok(rod:shape(3, 0.25) == 1 and rod:shape(3, 0.375) == 0 and rod:shape(3, 0.6) == 0, "shape functions are 1 and 0 at nodes")
near(rod:shape(3, 0.2) + rod:shape(2, 0.2), 1, 1e-15, "  and add up to 1")
ok(math.abs(rod:shape(2, 0.13) - 0.96) > 1e-3, "  but are no hats", rod:shape(2, 0.13))
ok(#dm.msfem { a = one, f = one, x = { 0, 1 } }.u == 2, "one element has two zeros")

-- what is narrow: a load, a barrier and a crack at 0.3371, in long elements and in short ones; many periods
local at = 0.3371
local function bump(x, w) return exp(-((x - at) / w) ^ 2) / (w * math.sqrt(pi)) end
for _, w in ipairs { 1e-2, 1e-3, 1e-4, 1e-5 } do
  for _, x in ipairs { { 0, 0.5, 1 }, { 0, 0.336, 0.338, 0.5, 1 } } do
    local load = dm.msfem { a = one, f = function(y) return -bump(y, w) end, x = x }
    near(load:value(0.5), at / 2, 1e-13, ("a load of width %g, %d nodes"):format(w, #x))
    for _, size in ipairs { 0.3, -w } do -- of the integral of 1/a; F = y
      local G, F = { 0.5 + size, 1 + size }, { 0.125 + size * at, 0.5 + size * at }
      local bent = dm.msfem { a = function(y) return 1 / (1 + size * bump(y, w)) end, f = one, x = x }
      near(bent:value(0.5), F[1] - F[2] / G[2] * G[1], 1e-13, ("1/a with %g more, of width %g, %d nodes"):format(size, w, #x))
    end
  end
end
near(dm.msfem({ a = function(x) return 10 / (1 + 0.95 * sin(2000 * pi * x)) end, f = one, x = { 0, 0.5, 1 }, period = 1e-3 }):value(0.5),
  -0.0125, 1e-13, "a thousand periods")
raises("positive", dm.msfem, { a = function(x) return x - 0.5 end, f = one, x = mesh })
raises("positive", dm.msfem, { a = log, f = one, x = mesh })
raises("grow", dm.msfem, { a = one, f = one, x = { 0, 0.5, 0.5, 1 } })
raises("two nodes", dm.msfem, { a = one, f = one, x = { 0 } })
raises("settle", dm.msfem, { a = function(x) return x < 0.3111 and 1 or 2 end, f = one, x = mesh })
raises("antiderivative", dm.msfem, { a = function() return 2 end, f = one, x = mesh, antiderivative = function(x) return x end })
raises("finite", dm.msfem, { a = one, f = function(x) return 1 / (x - x) end, x = mesh })
raises("missing", dm.msfem, { f = one, x = mesh })
raises("shape", dm.msfem, { a = one, f = one, x = mesh, shape = "quadratic" })
raises("from 0 to 1", function() return rod:value(1.5) end)
raises("whole number", function() return rod:shape(0, 0.5) end)
ok(cos(0) == 1 and tostring(rod):find "9 nodes", "a line of text", tostring(rod))
for _, shape in ipairs { "multiscale", "linear" } do
  raises("take other units", dm.msfem, { a = function() return 1 end, f = function() return 1 end,
    x = { 0, 1, 1e300 }, shape = shape })
end
tap.done()
