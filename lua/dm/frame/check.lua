--- Is a moving frame one? Its defining properties at random points.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local groups = require "dm.group"
local options = require "dm.base.options"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local derivatives = require "dm.frame.derivatives"
local tangent = require "dm.frame.tangent"

local M = {}


local abs = math.abs

-- condition number of J psi, or of an element, beyond which round-off is all that would be measured
local ILL = 50

-- an element near the identity
local function element_near(frame, next_number)
  local xi = {}
  for i = 1, frame.group.dimension do xi[i] = 0.3 * next_number() end
  return frame.group:exp(core.vector(xi))
end

-- the larger one; a NaN stays
local function larger(a, b) return (b <= a or a ~= a) and a or b end

-- largest distance between lists of points, relative to their size; angles by the circle
local function defect(frame, a, b)
  local worst, angles = 0, frame.action.angles
  for i = 1, #a do
    for j = 1, #a[i] do
      local d = a[i][j] - b[i][j]
      worst = larger(worst, angles[j] and 2 * abs(math.sin(d / 2)) or abs(d) / (1 + abs(a[i][j])))
    end
  end
  return worst
end

-- a function of n points that is not invariant, and has no symmetry of its own
local function test_function(list)
  local sum = 0
  for i = 1, #list do
    for j = 1, #list[i] do
      sum = sum + (0.3 * i + 0.7 / j) * list[i][j] + 0.1 * i * j * list[i][j] ^ 2
    end
  end
  return sum
end

-- by how much an element and its inverse may magnify
local function reach(frame, g)
  local kit = groups.kit(frame.group)
  local there, back = core.vector(kit.entries(g)), core.vector(kit.entries(kit.inverse(g)))
  return places.size(there) * places.size(back)
end

-- moderate points, moved by a moderate frame
local function is_tame(frame, list)
  local F = require "dm.frame"
  local g = F.element(frame, list)
  if reach(frame, g) > ILL then return end
  local there = F.moved(frame, g, list)
  local _, condition = tangent.transversality(frame, there)
  for _, z in ipairs(there) do
    for j = 1, #z do
      if not (abs(z[j]) < 20) then return end
    end
  end
  return condition < ILL and g, there, condition
end

-- the defects of one sample of k + 1 points; nothing where there is no frame, or an ill one
local function sample(frame, seed)
  local F = require "dm.frame"
  local list, next_number = points.sample(frame, seed, frame.k + 1), points.stream(seed + 1000)
  local g, there, condition = is_tame(frame, list)
  if not g then return end
  local h = element_near(frame, next_number)
  local others = F.moved(frame, h, list)
  local g2, there2 = is_tame(frame, others)
  local _, P = blame.try(is_tame, frame, { table.unpack(there, 2) })
  if not g2 then return end
  local probe = points.sample(frame, seed + 500, 2)
  local out, loose = { condition = condition }, frame.basis or frame.discrete
  -- rho(h z) h = rho(z), seen by what they do to points
  local once, twice = F.moved(frame, g, probe), F.moved(frame, g2, F.moved(frame, h, probe))
  out.equivariance = not loose and defect(frame, once, twice) or nil
  -- of a frame up to isotropy only its own points
  local own = loose and { table.unpack(there, 1, frame.k) } or there
  out.invariance = defect(frame, own, there2)
  -- an invariant function is its own invariantization
  local f = test_function(own)
  local again = test_function(F.moved(frame, F.element(frame, own), own))
  out.replacement = abs(f - again) / (1 + abs(f))
  if P and type(P) ~= "string" and not loose then
    local velocities = points.sample(frame, seed + 700, #list)
    local fine, s = blame.try(derivatives.syzygies, frame, list, velocities)
    if fine then out.shift, out.derivative = s.shift / 20, s.derivative / 20 end
  end
  return out
end

M.doc = [[
rho:check{samples=} -> number, table
The worst defect at random points (default 8): equivariance rho(h z) = rho(z) h^-1, invariance and
replacement, the corrections of shifts and of derivatives (against the graph), relative to the size
of what is compared; and a table with each, with the worst condition number of J psi. Points that
have no frame, or an ill-conditioned one, are passed over; an error says when that is all of them.]]

function M.run(frame, o)
  o = options.check(o or {}, { "samples" }, "rho:check", "{ samples = }")
  local wanted = options.whole(o, "samples", "rho:check", 1, nil, 8)
  local worst, found, last = {}, 0, nil
  for seed = 1, 30 * wanted do
    local fine, got = blame.try(sample, frame, seed)
    if not fine then last = got end
    if fine and got then
      found = found + 1
      for key, value in pairs(got) do worst[key] = larger(worst[key] or 0, value) end
    end
    if found == wanted then break end
  end
  if found == 0 then
    options.fail("rho:check", "no moving frame was found at random points%s",
      last and ("; the last error: " .. tostring(last)) or "")
  end
  local largest = 0
  for key, value in pairs(worst) do
    if key ~= "condition" then largest = larger(largest, value) end
  end
  worst.samples = found
  return largest, worst
end

class.method("dm.frame", "check", M.run, M.doc)

return M
