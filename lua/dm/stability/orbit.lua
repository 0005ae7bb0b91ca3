--- The orbit of a cell, whatever its rule does: states along it by steps as long as their error
-- allows, and how often its coordinates turn.
local blame = require "dm.base.blame"
local lists = require "dm.base.lists"

local M = {}

local max, min, pi = math.max, math.min, math.pi

local RULES, TOLERANCE = { "rk8", "gauss(4)", "lie(4)" }, 1e-8
local PIECES = 32       -- steps of the whole orbit at least
local ROWS = 2 ^ 15     -- after so many no other piece of the orbit is begun
local NEAR, ROUND_OFF = 1e-9, 1e-15 -- of the time, of its numbers: that is its end
local FIRST = 100       -- rad of the fastest oscillation at the start: the first piece

-- the path of a piece of length T from a state, by the first rule that makes it
local function piece(system, state, T, largest, project)
  for _, rule in ipairs(RULES) do
    local fine, path = blame.try(function()
      return system:solver({ rule = rule, h = T }):run { q = state.q, v = state.v, p = state.p,
        t0 = state.t, t = T, project = project, control = { tolerance = TOLERANCE,
        largest = largest } }
    end)
    if fine then return path end
  end
end

-- a state is a row of a path, whose q and p are read when they are asked for: most are not
local State = {}
function State.__index(state, key)
  if key ~= "q" and key ~= "p" then return nil end
  state[key] = state.path[key][state.row]
  return state[key]
end

--- A list of { q, p, t } along the orbit of a start { q, v | p, t } over a time T, and the time
-- that it goes to: T, or less where that takes too many steps. Pieces of it grow from that of the
-- fastest oscillation on; none is longer than what is left of the steps, at the mean of the last
-- one, has room for.
function M.states(system, start, T, fastest, project)
  local out, t0, at, done = {}, start.t, start, 0
  local long = fastest > 0 and min(T, FIRST / fastest) or T
  while done < T and #out < ROWS do
    local path = piece(system, at, min(long, T - done), T / PIECES, project)
    if not path then break end
    local t = lists.plain(path.t)
    local mean = (t[#path] - t[1]) / (#path - 1)
    for i = #out == 0 and 1 or 2, #path do
      out[#out + 1] = setmetatable({ path = path, row = i, t = t[i] }, State)
    end
    at = out[#out]
    long = min(2 * long, max(1, ROWS - #out) * mean)
    done = at.t - t0
    if T - done <= NEAR * T + ROUND_OFF * max(math.abs(t0), math.abs(at.t)) then done = T end
  end
  return out, done
end

-- the steps before the states of an orbit, from the second one on, and the same sorted
local function steps_of(states)
  local out = {}
  for i = 2, #states do out[i - 1] = states[i].t - states[i - 1].t end
  local sorted = table.move(out, 1, #out, 1, {})
  table.sort(sorted)
  return out, sorted
end

--- Numbers of `count` states of an orbit { states = } that are evenly far apart in it, and of as
-- many that have the shortest steps before them, where most happens; its steps are kept.
function M.places(orbit, count)
  local states, taken, equal, out = orbit.states, {}, {}, {}
  if not orbit.steps then orbit.steps, orbit.sorted = steps_of(states) end
  for x = 1, #states, max(1, (#states - 1) / count) do taken[math.floor(x + 0.5)] = true end
  local longest, left = orbit.sorted[min(count, #orbit.sorted)], count
  for i, step in ipairs(orbit.steps) do
    if step < longest then
      taken[i + 1], left = true, left - 1
    elseif step == longest then
      equal[#equal + 1] = i + 1
    end
  end
  for k = 1, min(left, #equal) do taken[equal[k]] = true end
  for i = 1, #states do if taken[i] then out[#out + 1] = i end end
  return out
end

---- how often a coordinate turns ----

local BAND = 0.1  -- of its range, on either side of the middle: less is no turn
local LEAST = 3   -- times up through the middle that must be seen

-- times at which a coordinate comes up through the middle of its range
local function rises(states, i)
  local lo, hi = math.huge, -math.huge
  for _, s in ipairs(states) do lo, hi = min(lo, s.q[i]), max(hi, s.q[i]) end
  local middle, band, out, below, last = (lo + hi) / 2, BAND * (hi - lo), {}, false, nil
  if not (hi - lo > 1e-9 * max(math.abs(lo), math.abs(hi))) then return out end
  for k, s in ipairs(states) do
    local x, before = s.q[i] - middle, states[k - 1]
    if x < -band then below = true end
    if before and x > 0 and before.q[i] <= middle then
      local y = before.q[i] - middle
      last = before.t + (s.t - before.t) * y / (y - x)
    end
    if below and x > band then out[#out + 1], below = last, false end
  end
  return out
end

-- near a whole number of times a slower one, by so much of it or of a turn in the whole time: no
-- frequency of its own
local MULTIPLE, OF_TURN = 1e-3, 0.1

-- is it a multiple of one of these? So y = -cos(theta) turns twice while theta turns once
local function is_multiple(omega, slower, T)
  local near = max(MULTIPLE * omega, OF_TURN * 2 * pi / T)
  for _, w in ipairs(slower) do
    local times = math.floor(omega / w + 0.5)
    if math.abs(omega - times * w) <= near then return true end
  end
  return false
end

-- of a sorted list what is no multiple of what is before it
local function without_multiples(list, T)
  local out = {}
  for _, omega in ipairs(list) do
    if not is_multiple(omega, out, T) then out[#out + 1] = omega end
  end
  return out
end

--- Frequencies of the coordinates of R^n along an orbit, the smallest first: 2 pi over the mean
-- time of a turn or, where a coordinate turns with several at once, its lines (lines[i], of
-- dm.stability.spectrum). More lines than there are oscillations, `count`, are those of one whose
-- frequency changes, and turns tell its mean. Those that do not turn three times have none.
function M.frequencies(states, n, lines, count)
  local all, T = {}, states[#states].t - states[1].t
  for i = 1, n do
    local list = rises(states, i)
    local own = #list >= LEAST and lines and without_multiples(lines[i], T) or {}
    if #own > 1 and #own <= count then
      table.move(own, 1, #own, #all + 1, all)
    elseif #list >= LEAST then
      all[#all + 1] = 2 * pi * (#list - 1) / (list[#list] - list[1])
    end
  end
  table.sort(all)
  return without_multiples(all, T)
end

return M
