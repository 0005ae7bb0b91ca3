-- At which steps does a symplectic rule lose a nonlinear oscillation? Verlet on q'' = -q - q^2, a well of depth 1/6
-- whose rim is at q = -1: linear theory allows any h < 2, but where a step turns the oscillation by a third or a quarter of a
-- circle it meets a resonance with itself, and the amplitude that survives shrinks, at h = sqrt 3 to nothing.
local dm = require "dm"
local sqrt, abs = math.sqrt, math.abs
local picture = (arg and arg[1] or ".") .. "/resonance_tongues.png"

local well = dm.system { name = "oscillator with a rim", Q = dm.R(1),
  L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 - q[1] ^ 3 / 3 end }
local map = well:stability { rule = "verlet", h = { 1.2, 2, 161, "linear" }, amplitude = { 0.01, 0.6, 80, "linear" },
  q = function(amplitude) return { -amplitude } end, v = { 0 }, steps = 5000, refine = false }
print(map)

-- an orbit of three steps a, a, b with b = c - a: (3 - h^2)/h^2 = c, h^2 a^2 + (h^2 - 2) a + c = 0; at b it is at rest
local function third(h)
  local c, d = (3 - h * h) / (h * h), h * h - 2
  return c - (-d + sqrt(d * d - 4 * h * h * c)) / (2 * h * h)
end

-- largest amplitude that is kept at a step: the cells up to it are all bounded or chaotic
local function kept(j)
  local last = 0
  for i, amplitude in ipairs(map.amplitude) do
    local class = map:at(i, j).class
    if class ~= "bounded" and class ~= "chaotic" and class ~= "drifting" then break end
    last = amplitude
  end
  return last
end
local checked = 0
for j, h in ipairs(map.h) do
  if h > sqrt(3) + 0.01 and h < 1.82 then
    assert(abs(kept(j) + third(h)) < 0.02, ("h = %g: %g is kept, the orbit of three steps is at %g"):format(h, kept(j), third(h)))
    checked = checked + 1
  end
end
assert(checked >= 15)
local _, told = dm.stability_limit "verlet"
print(("the tongue at h = sqrt 3 ends where the orbit of three steps is, at all %d steps that were compared"):format(checked))
for _, r in ipairs(told.resonances) do print(("a step turns by 2 pi/%d at h omega = %.4f"):format(r.n, r.z)) end
assert(abs(told.resonances[1].z - sqrt(3)) < 1e-9 and abs(told.resonances[2].z - sqrt(2)) < 1e-9)
print("picture  " .. map:plot { file = picture, title = "Verlet on q″ = -q - q², from rest at -amplitude, 5000 steps" })
