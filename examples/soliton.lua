-- Do two solitons survive their collision? i psi_t = -psi_xx/2 - |psi|^2 psi is integrable: they pass through each
-- other with their shapes and speeds, and only their places jump (Zakharov & Shabat 1972).
local dm = require "dm"
local exp, cos, sin, log, abs = math.exp, math.cos, math.sin, math.log, math.abs
local folder = arg and arg[1] or "."

local L, v = 60, math.pi / 3 -- v L/(2 pi) is whole: the phases close on the ring
local wave = dm.schroedinger { x = { -L / 2, L / 2, 512 }, g = -1 }
local function sech(x) return 2 / (exp(x) + exp(-x)) end
-- one from the left at speed v, one from the right at -v, both of height 1
local function two(x)
  local a, b = sech(x + 10), sech(x - 10)
  return a * cos(v * x) + b * cos(v * x), a * sin(v * x) - b * sin(v * x)
end

local path = wave:solver({ rule = "yoshida(4)", h = 0.005 }):run { psi = two, t = 20, every = 40 }
print(path)

-- at the end each is where it would be alone, but for a jump forward by log((1 + v^2)/v^2): two of height 1 that meet
-- at speeds v and -v
local density = path.psi[#path]:abs2()
local function top(from, to) -- by a parabola through the largest point
  local best = from
  for j = from, to do if density[j] > density[best] then best = j end end
  local a, b, c = density[best - 1], density[best], density[best + 1]
  return path.psi[1].x[best] + (a - c) / (a - 2 * b + c) / 2 * L / 512, b
end
local left, height = top(2, 256)
local right = top(257, 511)
local jump = right - (v * 20 - 10)
local expected = log((1 + v ^ 2) / v ^ 2)
print(("heights %.6f, jump %.5f, by the formula %.5f"):format(height, jump, expected))
assert(abs(height - 1) < 2e-3, "they have their height again")
assert(abs(jump - expected) < 2e-3 and abs(left + right) < 1e-3, "and have jumped forward")

-- norm and energy stay
assert(path:drift("norm").largest < 1e-11 and path:drift("energy").largest < 1e-6)

path:spacetime { file = folder .. "/soliton.png", title = "Two solitons pass through each other" }
print("picture  " .. folder .. "/soliton.png")
