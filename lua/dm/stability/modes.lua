--- The frequency of each oscillation along an orbit, for resonances: a mean over the time, or how
-- often the orbit turns.
local orbits = require "dm.stability.orbit"
local spectrum = require "dm.stability.spectrum"

local M = {}

local abs = math.abs

local PLACES, MANY = 32, 512 -- states for a mean: at first, at most
local SAME = 1e-2  -- a frequency that changes less is one
local CALM = 0.25  -- one that changes less has its mean, where nothing turns with it
local CLOSE = 2e-3 -- means of twice as many states that are this near are settled
local MOST_MIXED = 12 -- coordinates whose spectra are looked at
local FASTER = 2   -- times the turns of the orbit: the mean of a frequency that changes is one

-- mean over the time of oscillation k of what was seen along an orbit; 0 where it is not there
local function mean_of(seen, k)
  local first, last, sum = seen[1], seen[#seen], 0
  if not (last.t > first.t) then return first[k] or 0 end
  for i = 2, #seen do
    sum = sum + ((seen[i - 1][k] or 0) + (seen[i][k] or 0)) / 2 * (seen[i].t - seen[i - 1].t)
  end
  return sum / (last.t - first.t)
end

-- the means of all oscillations, by more and more states until they stay
local function means_of(linear, look)
  local means, count, settled = nil, PLACES, false
  repeat
    local seen, before = {}, means
    for _, i in ipairs(orbits.places(linear, count)) do
      seen[#seen + 1] = look(linear, i) or nil
    end
    if #seen == 0 then seen[1] = linear.first end
    means, settled = {}, before ~= nil or linear.constant
    for k in ipairs(linear.ranges) do
      means[k] = mean_of(seen, k)
      local change = abs(means[k] - (before and before[k] or 0))
      settled = settled and (linear.constant or change <= CLOSE * means[k])
    end
    count = 2 * count
  until settled or count > MANY or #seen == #linear.states
  return means
end

-- the mean in a list that is the nearest to omega, by their ratio
local function nearest(means, omega)
  local best
  for _, mean in ipairs(means) do
    if mean > 0 and (not best or abs(math.log(mean / omega)) < abs(math.log(best / omega))) then
      best = mean
    end
  end
  return best
end

-- is omega one with a frequency of the list?
local function is_one_of(omega, list)
  for _, other in ipairs(list) do
    if abs(omega - other) <= SAME * omega then return true end
  end
  return false
end

-- turns of coordinates that are the nearest to a mean of the first list, not to one of `steady`
local function turns_of(left, steady, turns)
  local all, out = table.move(steady, 1, #steady, #left + 1, { table.unpack(left) }), {}
  for _, omega in ipairs(turns) do
    local mean = nearest(all, omega)
    for _, one in ipairs(left) do
      if one == mean then out[#out + 1] = omega break end
    end
  end
  return out
end

-- { mean = turn }: pairs of a turn and a mean, the nearest by their ratio first, each once; a turn
-- that is one with another stands for no second mean
local function paired(left, turns)
  local list, own, taken = {}, {}, {}
  for _, mean in ipairs(left) do
    for _, omega in ipairs(turns) do
      list[#list + 1] = { mean = mean, omega = omega, far = abs(math.log(mean / omega)) }
    end
  end
  table.sort(list, function(x, y)
    return x.far < y.far or x.far == y.far and x.omega < y.omega
  end)
  for _, x in ipairs(list) do
    if not own[x.mean] and not is_one_of(x.omega, taken) then
      own[x.mean], taken[#taken + 1] = x.omega, x.omega
    end
  end
  return own
end

-- In the place of means that change the turns of coordinates that are the nearest to them:
-- coordinates turn with what they have of all oscillations, the steady ones too. Where none is, the
-- means of those that change little.
local function turns_for(left, steady, turns, is_calm)
  local own, out = paired(left, turns_of(left, steady, turns)), {}
  for _, omega in pairs(own) do out[#out + 1] = omega end
  for _, mean in ipairs(left) do
    local alone = not own[mean] and (is_calm[mean] or #turns == 0)
    if alone and not is_one_of(mean, out) then out[#out + 1] = mean end
  end
  return out
end

-- does the frequency of a mode, which is there all along the orbit, change by less than this part?
local function changes_less(linear, mode, part)
  return mode.count == #linear.matrices and mode.most - mode.least <= part * mode.most
end

-- do several coordinates turn, and not with one steady frequency each?
local function may_mix(linear)
  local n, changing = linear.system.Q.dimension, false
  for _, mode in ipairs(linear.ranges) do
    changing = changing or not changes_less(linear, mode, SAME)
  end
  return changing and n > 1 and n <= MOST_MIXED
end

-- how often the orbit turns, by its spectrum where coordinates may turn with several oscillations
local function turns_along(linear)
  local states = linear.states
  local T = states[#states].t - states[1].t
  local lines = T > 0 and may_mix(linear)
    and spectrum.lines(linear.system, states[1], T, linear.fastest, linear.project)
  return orbits.frequencies(states, linear.system.Q.dimension, lines or nil, #linear.ranges)
end

--- Frequencies of the oscillations, the largest first: of those that hardly change, or are fast
-- beside the orbit, the mean; the others are the turns of the orbit itself, where it has some.
-- look(linear, k): the frequencies at state k of the orbit, the largest first, and t; or false.
-- Behind them { omega = true }: which are means, though they change, as nothing of the orbit turns
-- with them.
function M.frequencies(linear, look)
  local turns = (linear.constant or linear.system.place) and {} or turns_along(linear)
  local modes, left, is_calm, means = {}, {}, {}, {}
  for k, mean in ipairs(means_of(linear, look)) do
    local mode = linear.ranges[k]
    local steady = changes_less(linear, mode, SAME)
    local list = (steady or mean > FASTER * (turns[#turns] or 0)) and modes or left
    list[#list + 1] = mean
    is_calm[mean] = changes_less(linear, mode, CALM)
    means[mean] = not steady or nil
  end
  for _, omega in ipairs(turns_for(left, modes, turns, is_calm)) do
    modes[#modes + 1] = omega
  end
  table.sort(modes, function(a, b) return a > b end)
  return modes, means
end

return M
