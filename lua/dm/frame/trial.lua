--- What is tried when a frame is made: at points spread over the space, and where large elements h
-- of the group move them, it must bring points to the section and its branch, by an element of the
-- group, and be equivariant, rho(h z) = rho(z) h^-1. What both sides do to points is compared, so
-- that elements which move nothing make no difference. Points where the frame has no finite value
-- or an ill-conditioned one tell nothing.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local found = require "dm.frame.found"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local reach = require "dm.frame.reach"
local steady = class.module(function() return require "dm.frame.steady" end)
local tangent = require "dm.frame.tangent"
local text = require "dm.frame.text"

local M = {}

local abs, huge, max, min = math.abs, math.huge, math.max, math.min

-- how many samples by dim G, so that a frame is made in a few milliseconds
local FORMULAS, ROOTS = { 36, 36, 24, 20, 20, 14, 12, 8 }, { 20, 14, 8, 7, 5, 2, 2, 1 }
local LOST = 6           -- samples' worth of time to find that there is no root,
local RARE = 12          -- samples at least while less than a third of those wanted have one
local OUTSIDE = 1 / 16   -- that the points are outside of the domain
local ON_SECTION = 6     -- samples of which one must lead to the section
local CELLS = 2          -- samples from whose points cells of a formula are looked for
local LARGE = 60         -- times a point of the section, and back to it: orbits that reach far
local TANGENTIAL = 3     -- samples with a singular root that are enough, if there are no others
-- pushes, by dim G, of every sample that has a root: an orbit that cuts the section twice is seen
-- where Newton's method finds the other cut, for SL(2) and -1 behind one of six
local AGAIN = { 3, 2, 3, 3, 3, 3, 4, 6 }
-- lists of points far away for a frame that is solved for, by dim G, and pushes of each
local FAR_ROOTS, FAR_AGAIN = { 2, 3, 3, 3, 3, 1, 1, 1 }, 2
local TURNS = 3          -- of samples far away every third is pushed
-- a condition beyond which a root tells nothing; what it makes of rounding
local WORST, ROUNDING = 1e9, 1e-13 -- for a condition of 1, relative
local SAME = 1e-7        -- relative distance of points that are one
local ONE = 1e-9         -- of entries of elements that are one
local DIGITS = 1e-9      -- of the points that a formula need not give
local MEASURED = 6       -- samples that tell the scale of Z,
local ON = 1e-10         -- of which this much is surely on the section

local condition_of, element_of, moved = found.condition, found.element, found.moved
local fail, refuse = found.fail, found.refuse

-- is the inverse of g what would bring the points to the section? what to try then, or false
local function hint(trial, g, list)
  local frame = trial.frame
  local there = moved(frame, groups.kit(frame.group).inverse(g), list)
  local fine, off = blame.try(tangent.distance, frame, there, there and trial.section(frame, there))
  return fine and off < found.VALID and "; its inverse is: solution gives the element that moves "
    .. "the points to the section"
end

-- |Z| far below what it was where the distance from the section was measured
local function is_surely_on(trial, size)
  return trial.measured >= MEASURED and size <= ON * trial.scale
end

-- Is the distance `off` of the points there from the section more than rounding makes?
local function is_told(trial, list, a, off)
  local frame = trial.frame
  if frame.solution then
    return off > DIGITS * found.size_of(list) and steady.is_own(frame, list, off, function(nudged)
      local b = found.plain(frame, nudged)
      return b and (tangent.distance(frame, b.there, trial.section(frame, b.there)))
    end)
  end
  local worst = condition_of(frame, list, a)
  return worst <= WORST and off > tangent.allowed(worst)
end

-- Are the points there on the section? Nothing: it cannot be told.
local function is_on(trial, list, a)
  local frame = trial.frame
  local fine, Z = blame.try(trial.section, frame, a.there)
  local size = fine and core.largest(Z)
  if not size then return nil end
  if is_surely_on(trial, size) then return true end
  local told, off, condition, unit = blame.try(tangent.distance, frame, a.there, Z)
  if not told then fail("the cross-section has no derivative: %s", blame.bare(off)) end
  a.condition = condition
  if not (condition < tangent.CONDITION and off < huge) then return nil end
  if off <= tangent.allowed(condition) then
    trial.measured, trial.scale = trial.measured + 1, min(trial.scale, 1 / unit)
    return true
  end
  if not is_told(trial, list, a, off) then return nil end
  return false, off
end

-- what the branch gives at the points there, a list
local function branch_values(frame, a)
  return frame.branch and points.entries(frame.branch(table.unpack(a.there))) or {}
end

-- Does rounding leave no doubt that the branch does not hold at the points there?
local function is_outside(frame, list, a)
  if not frame.solution then return condition_of(frame, list, a) < WORST end
  return steady.is_own(frame, list, 1, function(nudged)
    local b, least = found.plain(frame, nudged), huge
    for _, value in ipairs(b and branch_values(frame, b) or {}) do least = min(least, value) end
    return least <= 0 and 1
  end)
end

local function check_branch(frame, list, a)
  for _, b in ipairs(branch_values(frame, a)) do
    if type(b) ~= "number" then
      fail("the branch must return a number that is > 0 where it holds, or several (got %s)",
        kits.class_of(b))
    end
    if b <= 0 and is_outside(frame, list, a) then
      refuse("at z = %s the solution brings the points to %s on the cross-section, where the "
        .. "branch condition does not hold (it is %.3g)", text.points(list), text.points(a.there),
        b)
    end
  end
end

-- the frame of the list: its element g and the points there; nothing where nothing is told, and
-- what the formula raises
local function frame_of(trial, list)
  local frame = trial.frame
  local g, why = element_of(frame, list)
  local there = g and moved(frame, g, list)
  if not there then return nil, why end
  local a = { g = g, there = there }
  local on, off = is_on(trial, list, a)
  if on == false then
    if frame.root then found.by_root(frame, list, true) end
    refuse("at z = %s the solution is not on the cross-section (off by %.3g)%s", text.points(list),
      off, hint(trial, g, list) or found.advice(list))
  end
  if on then check_branch(frame, list, a) end
  return on and a or nil
end

-- largest distance of points of two lists, beside their size
local function apart(frame, a, b)
  local worst, apart_one, size = 0, places.apart, places.size
  for i = 1, #a do
    local one = apart_one(frame.action, a[i], b[i]) / (1 + size(a[i]))
    if one > worst then worst = one end
  end
  return worst
end

local function cut_twice(frame, list, a, b, distance)
  refuse("the orbit of z = %s cuts the cross-section more than once, at %s and at %s (%.3g apart): "
    .. "%s",
    text.points(list), text.points(a.there), text.points(b.there), distance,
    frame.branch and "branch holds at both"
      or "give branch, a condition that is > 0 at one of them only")
end

local function not_free(frame, list, h, distance)
  refuse("rho(h z) is not rho(z) h^-1 at z = %s, h = %s: they move other points to places %.3g "
    .. "apart, since the action is not free at z; take more points (points = %d), or partial = "
    .. "true: a frame up to isotropy, whose invariants of its own points stay along orbits",
    text.points(list), places.show(h), distance, frame.k + 1)
end

-- are rho(z) = a and rho(h z) h, b after h, one element, to rounding? Then they move points alike.
local function are_one(frame, a, b, h)
  local kit = groups.kit(frame.group)
  local both = frame.action.side == "right" and kit.compose(h, b) or kit.compose(b, h)
  local one, other, worst = kit.flat(a), kit.flat(both), 0
  for i = 1, #one do
    local d = one[i] - other[i]
    d = kit.angles[i] and 2 * math.sin(d / 2) or d / (1 + abs(one[i]))
    if not (abs(d) <= worst) then worst = abs(d) end
  end
  return worst <= ONE
end

-- how far apart the frames a, of z, and b, of h z, move other points
local function probes_apart(frame, h, a, b, seed)
  local probe = points.sample(frame, seed + 1000, 2)
  local once, moved_probe = moved(frame, a.g, probe), moved(frame, h, probe)
  local twice = moved_probe and moved(frame, b.g, moved_probe)
  return once and twice and apart(frame, once, twice) or 0
end

-- is the distance, measure(a, b), more than rounding makes?
local function is_apart(frame, h, list, pushed, a, b, distance, measure)
  if frame.solution then
    return steady.is_own(frame, list, distance, function(nudged)
      local x, there = found.plain(frame, nudged), moved(frame, h, nudged)
      local y = there and found.plain(frame, there)
      return x and y and measure(x, y)
    end)
  end
  local worst = max(condition_of(frame, list, a), condition_of(frame, pushed, b))
  return distance >= worst * ROUNDING
end

-- is rho(h z) h what rho(z) is? list: z, pushed: h z; a and b: the frame at both
local function check_equivariance(frame, h, list, pushed, a, b, seed)
  local distance = apart(frame, a.there, b.there)
  local one = distance <= SAME
  if one and (frame.basis or are_one(frame, a.g, b.g, h)) then return end
  local function measure(x, y)
    return one and probes_apart(frame, h, x, y, seed) or not one and apart(frame, x.there, y.there)
  end
  distance = measure(a, b)
  if distance <= SAME or not is_apart(frame, h, list, pushed, a, b, distance, measure) then
    return
  end
  if not one then cut_twice(frame, list, a, b, distance) end
  if not frame.partial then not_free(frame, list, h, distance) end
  frame.discrete = true
end

-- the frame a of the list beside that of what h makes of it; nothing where nothing is told
local function compare(trial, h, list, a, seed)
  local pushed = moved(trial.frame, h, list)
  local b = pushed and frame_of(trial, pushed)
  if b then check_equivariance(trial.frame, h, list, pushed, a, b, seed) end
end

-- The frame at sample `seed` and where large elements move it; nothing where nothing is told, and
-- why: what the formula raises, or why there is no root; true: the sample is outside of the domain
local function try(trial, seed)
  local frame = trial.frame
  local list = reach.sample(frame, seed)
  if not list then return nil, nil, true end
  local a, why = frame_of(trial, list)
  if not a then return nil, why end
  trial.on[#trial.on + 1], trial.of[#trial.of + 1] = a.there, list
  for again = 1, not frame.solution and AGAIN[min(frame.r, #AGAIN)] or 1 do
    compare(trial, reach.push(frame, trial.pushes, seed, again), list, a, seed)
  end
  for _, h in ipairs(frame.root and reach.far_elements(frame, trial.axes, seed) or {}) do
    compare(trial, h, list, a, seed)
  end
  return a
end

-- a formula is tried at points far away, too
local function try_far(trial, seed)
  local frame = trial.frame
  local list = reach.far_sample(frame, seed)
  local a = list and frame_of(trial, list)
  if not a or seed % TURNS > 0 then return end
  compare(trial, reach.push(frame, trial.pushes, seed, 1), list, a, seed)
end

-- orbits beside folds of the section
local function look_for_folds(trial)
  local frame = trial.frame
  require("dm.frame.folds").search(frame, trial.on, function(list, elements)
    local a = frame_of(trial, list)
    for _, h in ipairs(a and elements or {}) do compare(trial, h, list, a, 1) end
  end)
end

-- every cell of a formula
local function look_into_cells(trial)
  local frame = trial.frame
  require("dm.frame.cells").search(frame, table.move(trial.of, 1, CELLS, 1, {}), function(list)
    local a = frame_of(trial, list)
    if a then compare(trial, reach.push(frame, trial.pushes, 1, 1), list, a, 1) end
    return a
  end)
end

-- pieces of the section that only orbits of points far away reach, where there are several orbits
local function look_far(trial)
  local frame = trial.frame
  local _, dimension = tangent.level(frame)
  for seed = 1, dimension > 0 and FAR_ROOTS[min(frame.r, #FAR_ROOTS)] or 0 do
    local list = reach.far_sample(frame, seed)
    local a = list and frame_of(trial, list)
    if list and not a then return end -- which costs as much as several that have a root
    for again = 1, a and FAR_AGAIN or 0 do
      compare(trial, reach.push(frame, trial.pushes, seed, again), list, a, seed)
    end
  end
end

-- points of the section: those of a sample, and what is near those of the next, many times their
-- size
local function on_the_section(trial)
  local frame, out = trial.frame, { trial.on[1] }
  local level, dimension = tangent.level(frame)
  if dimension == 0 then return out end
  local x = points.flat(trial.on[min(2, #trial.on)]) * LARGE
  local fine, at = blame.try(level.node, level, x, x:norm())
  if fine and at then out[2] = points.split(at, frame.k, frame.m) end
  return out
end

-- does the branch hold at the points h moves?
local function holds(frame, h, list)
  local there = moved(frame, h, list)
  local least = 1
  for _, b in ipairs(there and branch_values(frame, { there = there }) or {}) do
    least = min(least, b)
  end
  return there and least > 0
end

-- other points of the section on the orbits of these, which the branch does not tell apart
local function look_for_others(trial)
  local frame = trial.frame
  for seed, there in ipairs(on_the_section(trial)) do
    local a
    for _, h in ipairs(require("dm.frame.deflated").others(frame, there, seed)) do
      local differs = holds(frame, h, there)
      a = a or differs and frame_of(trial, there)
      if a and differs then compare(trial, h, there, a, seed) end
    end
  end
end

-- was a root refused because the section is tangent to the orbit there?
local function is_singular(why) return why and tostring(why):find("is singular", 1, true) ~= nil end

--- Raises where the frame is none. section(frame, list): Z at the points, as a list.
function M.check(frame, section)
  local trial = { frame = frame, section = section, measured = 0, scale = huge, on = {}, of = {},
    pushes = {}, axes = {} }
  local left = (frame.solution and FORMULAS or ROOTS)[min(frame.r, #ROOTS)]
  local few, told, first, tangential, seed = left / 3, 0, nil, 0, 0
  local function is_rare() return not frame.solution and first and tangential < seed end
  while left > 0 or told == 0 and tangential == seed and seed < TANGENTIAL
      or told < few and seed < RARE and is_rare() do
    seed = seed + 1
    local a, why, outside = try(trial, seed)
    if frame.solution then try_far(trial, seed) end
    local cost = (a or frame.solution) and 1 or LOST
    left = left - (outside and OUTSIDE or cost)
    told, first = told + (a and 1 or 0), first or why
    tangential = tangential + (not frame.solution and is_singular(why) and 1 or 0)
  end
  if told > 0 then
    if frame.root then
      look_for_others(trial)
      look_far(trial)
    else
      look_into_cells(trial)
    end
    return look_for_folds(trial)
  end
  if not first then
    refuse("no point tried was finite: %d samples of numbers up to 10 %s, and nothing is known of "
      .. "the frame. Take units and an origin in which such points are inside the domain of %s, or "
      .. "say where points are by the action's domain(z) > 0", seed,
      frame.action.domain and "in the domain of the action" or "on the space of the action",
      frame.solution and "section and solution" or "the section")
  end
  if frame.solution then fail("the solution fails at random points: %s", blame.bare(first)) end
  found.by_root(frame, points.sample(frame, 1), true) -- does the trace alone have no root?
  if tangential == seed then text.refuse(frame, frame.r) end
  refuse("there was none at %d samples of points of size 0.1 to 10 (where points that have one are "
    .. "rare, say where they are by the action's domain(z) > 0): %s", seed, blame.bare(first))
end

--- Points on the section, from one of the first samples that have a frame; nothing where none has.
function M.on_section(frame)
  for seed = 1, ON_SECTION do
    local list = reach.sample(frame, seed)
    local g = list and element_of(frame, list)
    local there = g and moved(frame, g, list)
    if there then return there end
  end
end

return M
