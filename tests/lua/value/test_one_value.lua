-- A second value of a function that must return one is not lost in silence: fields, waves, elements, spaces
local tap = require "tap"
local dm = require "dm"
local raises = tap.raises

local function two(f) return function(...) return f(...), 1 end end
local function wave(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function one() return 1 end
local ring = { 0, 1, 8, periodic = true }
local K = dm.mesh { triangle = 2 }
local rows = {
  ["dm.field L"] = function() dm.field { x = ring, L = two(wave) } end,
  ["line u"] = function()
    dm.field { x = ring, L = wave }:solver { rule = "cell(gauss(2))", h = 0.05 }:run { u = two(one), ut = one, steps = 1 }
  end,
  ["line ut"] = function()
    dm.field { x = ring, L = wave }:solver { rule = "cell(gauss(2))", h = 0.05 }:run { u = one, ut = two(one), steps = 1 }
  end,
  ["K:field L"] = function() K:field { form = 0, L = two(function(u, v) return v:dot(v) / 2 - u:dot(u) / 2 end) } end,
  ["K:sum"] = function()
    K:field { form = 0, L = function(u, v) return v:dot(v) / 2 - K:sum(0, two(function(a) return a ^ 2 end), u) end }
  end,
  ["dm.adapt W"] = function() dm.adapt { W = two(function(s) return s ^ 2 / 2 end), x = { 0, 1, 4 }, ends = { 0, 1 } } end,
  ["dm.adapt f"] = function()
    dm.adapt { W = function(s) return s ^ 2 / 2 end, f = two(one), x = { 0, 1, 4 }, ends = { 0, 1 } }
  end,
  ["dm.schroedinger V"] = function() dm.schroedinger { x = { -5, 5, 16 }, V = two(one) } end,
  ["dm.msfem a"] = function() dm.msfem { a = two(one), f = one, x = { 0, 0.5, 1 } } end,
  ["dm.msfem f"] = function() dm.msfem { a = one, f = two(one), x = { 0, 0.5, 1 } } end,
  ["dm.galerkin functions"] = function()
    dm.galerkin { functions = two(function(t) return { 1, t } end), quadrature = "gauss(2)" }
  end,
  ["dm.lagrange_poincare l"] = function()
    dm.lagrange_poincare { group = dm.SO(3), h = 0.1, l = two(function(f) return -f[1][1] end) }
  end,
}
local names = {}
for name in pairs(rows) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
  print("# " .. name)
  raises("must return one value", rows[name])
end
raises("psi must return two numbers", function()
  dm.schroedinger { x = { -5, 5, 16 } }:solver { rule = "strang", h = 0.1 }:run { psi = function() return 1, 0, 3 end, steps = 1 }
end)

tap.done()
