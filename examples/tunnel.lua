-- How much of a wave gets through a hill that a ball of its energy cannot climb? V = V0/cosh^2 x has a closed form
-- for every wave number: T(k) = sinh^2(pi k)/(sinh^2(pi k) + cosh^2(pi/2 sqrt(8 V0 - 1))) (Landau & Lifshitz III, 25).
local dm = require "dm"
local pi, exp, cos, sin, cosh2 = math.pi, math.exp, math.cos, math.sin, function(x) return ((math.exp(x) + math.exp(-x)) / 2) ^ 2 end
local folder = arg and arg[1] or "."

local V0, k0, width, from = 4, 2.5, 3, -25 -- mean energy 3.2, below the top
local wave = dm.schroedinger { x = { -80, 80, 1024 }, V = function(x) return V0 / cosh2(x) end }
local function packet(x)
  local a = (2 * pi * width ^ 2) ^ -0.25 * exp(-(x - from) ^ 2 / (4 * width ^ 2))
  return a * cos(k0 * x), a * sin(k0 * x)
end
local path = wave:solver({ rule = "blanes-moan(4)", h = 0.02 }):run { psi = packet, t = 20, every = 10 }

-- what is behind the hill at the end
local function behind(v)
  local sum = 0
  for j = 1, #v do
    if v.x[j] > 0 then sum = sum + v.weight[j] * (v.re[j] ^ 2 + v.im[j] ^ 2) end
  end
  return sum
end
local through = behind(path.psi[#path])

-- the closed form, averaged over the wave numbers of the packet, a Gaussian of width 1/(2 width)
local function T(k)
  local s = ((exp(pi * k) - exp(-pi * k)) / 2) ^ 2
  return s / (s + cosh2(pi / 2 * math.sqrt(8 * V0 - 1)))
end
local expected, N = 0, 2000
for i = 1, N do
  local k = k0 + (i - (N + 1) / 2) / N * 8 / width
  expected = expected + T(k) * exp(-2 * width ^ 2 * (k - k0) ^ 2)
end
expected = expected * 8 / width / N * width * math.sqrt(2 / pi)
print(("%.5f gets through, %.5f by the closed form; a ball would turn back"):format(through, expected))
assert(math.abs(through - expected) < 1e-4, "transmission of the packet")

-- nothing is lost, and the current through the top carries what arrives
assert(path:drift("norm").largest < 1e-12 and path:drift("energy").largest < 1e-7)
local carried, middle = 0, 513 -- x = 0
for i = 1, #path do
  carried = carried + wave:current(path.psi[i])[middle] * 0.2 * (i > 1 and i < #path and 1 or 0.5)
end
assert(math.abs(carried - through) < 1e-3, "the current adds up to it")
assert(#path.notes == 0, "points and interval are enough")

path:spacetime { file = folder .. "/tunnel.png", title = "A wave meets a hill higher than its energy" }
path:animate(folder .. "/tunnel.html", { title = "A wave meets a hill higher than its energy" })
print("picture  " .. folder .. "/tunnel.png, page " .. folder .. "/tunnel.html")
