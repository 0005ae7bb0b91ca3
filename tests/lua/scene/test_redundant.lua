-- constraints that follow from the others: a scene leaves them out and says so; those that do so at the start only are refused
local tap = require "tap"
local dm = require "dm"

local function circle(q) return q:dot(q) - 1 end
-- a plane pendulum without a weight, at speed w: q = (cos w t, sin w t)
local function free(_, v) return v:dot(v) / 2 end
local W = 0.7
local function scene(constraint, L, q, v)
  return dm.scene { dm.system { Q = dm.R(2), L = L or free, constraint = constraint }, q = q or { 1, 0 }, v = v or { 0, W },
    watch = { "q1", "q2" }, tolerance = 1e-6, until_t = 4, seconds = 2 }
end

for name, constraint in pairs {
  doubled = function(q) return { circle(q), circle(q) } end,
  multiple = function(q) return { circle(q), 2 * circle(q) } end,
  product = function(q) return { circle(q), circle(q) * (2 + q[1]) } end,
} do
  local one = scene(constraint)
  local run = one:run { at = { 1, 4 } }
  for i, t in ipairs { 1, 4 } do
    tap.near(run:column "q1"[i], math.cos(W * t), 1e-6, name .. ": q1")
    tap.near(run:column "q2"[i], math.sin(W * t), 1e-6, name .. ": q2")
  end
  tap.ok(one:why():find("left out, as they follow from the others (system:independent): constraints 2", 1, true), name .. ": said", one:why())
end

-- with a weight: as the scene without the constraint that is left out
do
  local function weight(_, v) return v:dot(v) / 2 end
  local function heavy(q, v) return weight(q, v) - q[2] end
  local start, rest = { 0.6, -0.8 }, { 0, 0 }
  local whole = scene(function(q) return { circle(q), 3 * circle(q) } end, heavy, start, rest):run { at = { 4 } }
  local alone_scene = scene(circle, heavy, start, rest)
  tap.near(whole:column "q1"[1], alone_scene:run { at = { 4 } }:column "q1"[1], 2e-6, "as without it")
  tap.ok(not alone_scene:why():find("follow from the others", 1, true), "nothing is said where nothing is left out")
end

-- a square has no gradient where it holds: it follows too
do
  local run = scene(function(q) return { circle(q), circle(q) ^ 2 } end):run { at = { 4 } }
  tap.near(run:column "q1"[1], math.cos(W * 4), 1e-6, "a square")
end

-- a circle whose radius 1 + t/10 grows, twice: the angle is 10 W (1 - 1/(1 + t/10)), for r^2 times its rate is kept
do
  local function growing(q, _, t) return q:norm() - 1 - (t or 0) / 10 end
  local function twice(q, t) return { growing(q, nil, t), 3 * growing(q, nil, t) } end
  local one = scene(twice, nil, { 1, 0 }, { 0.1, W })
  local angle = 10 * W * (1 - 1 / 1.4)
  tap.near(one:run { at = { 4 } }:column "q1"[1], 1.4 * math.cos(angle), 1e-6, "one that depends on t")
  tap.ok(one:why():find("constraints 2", 1, true), "is left out, too")
end

-- what was left out is looked at along a run of the whole time, and what that finds is raised
do
  local independent = require "dm.measure.independent"
  local look, seen = independent.look, nil
  independent.look = function(_, path) seen = path error("constraint 2 holds no more", 0) end
  local one = scene(function(q) return { circle(q), 2 * circle(q) } end)
  tap.raises("holds no more", one.run, one, { at = { 1 } })
  independent.look = look
  tap.ok(seen and seen.t[#seen] == 4, "along the whole time", seen and seen.t[#seen])
end

-- a line that touches the circle at the start only
tap.raises("constraint 2 depends on those before it at this q only", function()
  scene(function(q) return { circle(q), q[1] - 1 } end, nil, { 1, 0 }, { 0, 0 })
end)
tap.done()
