-- Water seeps through sand round an impermeable post: how far is the flow off from that of two-dimensional potential theory?
-- div(k grad p) = 0, no flow into the post r = 1; far away the slope of p is 1: p = (r + 1/r) cos phi (Leok, chapter 3: Darcy's equation)
local dm = require "dm"
local max, abs, log = math.max, math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/porous_hole.png"

local function exact(x, y) return x + x / (x * x + y * y) end
local function sand(rings) return dm.mesh { annulus = { rings, 8 * rings }, ratio = 4 } end

-- pressure given on the outer circle, nothing flows through the inner one, where `pressure` gives nil
local function seep(K)
  return K:darcy { pressure = function(x, y) if x * x + y * y > 4 then return exact(x, y) end end }
end

local errors = {}
for i, rings in ipairs { 6, 12, 24 } do
  local K = sand(rings)
  local flow, at = seep(K), K:circumcentres(2)
  local worst = 0
  for c = 1, K:count(2) do worst = max(worst, abs(flow.pressure[c] - exact(at[c][1], at[c][2]))) end
  errors[i] = worst
  -- what flows in flows out of every cell, to round-off: the flux is closed where there are no sources
  assert(flow.flux:d():max() < 1e-11, "no water is lost in any triangle")
end
for i = 2, 3 do assert(abs(log(errors[i - 1] / errors[i], 2) - 2) < 0.5, "the pressure is of order 2") end
print(("pressure off by %.1e, %.1e, %.1e with 6, 12, 24 rings: order %.2f"):format(errors[1], errors[2], errors[3], log(errors[2] / errors[3], 2)))

-- sand that is ten times as tight on the left lets less through
local K = sand(12)
local total = {}
for k, permeability in ipairs { 1, function(x) return x < 0 and 0.1 or 1 end } do
  local flow = K:darcy { permeability = permeability, pressure = function(x, y) if x * x + y * y > 4 then return x end end }
  local through = 0 -- of the radii that point along x = 0, y > 0: the flux across a chain from hole to rim
  for i, e in ipairs(K:simplices(1)) do
    local p, q = K:points()[e[1]], K:points()[e[2]]
    if p[2] > 0 and q[2] > 0 and (p[1] < 0) ~= (q[1] < 0) then through = through + abs(flow.flux[i]) end
  end
  total[k] = through
end
assert(total[2] < 0.5 * total[1], "tight sand holds the water back")
print(("through the upper half: %.3f in even sand, %.3f where the left is ten times as tight"):format(total[1], total[2]))
print("picture  " .. seep(sand(8)).pressure:plot { file = picture, title = "Seepage round a post: pressure", label = "p" })
