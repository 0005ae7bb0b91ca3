--- Linear theory beside a map: the oscillations of a system along the orbit of a cell, and where a
-- rule loses them.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local fields = require "dm.stability.fields"
local lines = require "dm.stability.lines"
local modes = require "dm.stability.modes"
local orbits = require "dm.stability.orbit"
local rules = require "dm.stability.linear"

local M = {}

local abs, sqrt, max, min, huge = math.abs, math.sqrt, math.max, math.min, math.huge

-- does a rule take any linear system apart into its oscillations, as Runge-Kutta methods do?
local function takes_all_apart(rule)
  local name = tostring(rule)
  if name:find "^galerkin" or name:find "^sprk" then return false end
  for _, pattern in ipairs { "^gauss%(", "^midpoint$", "^rk%d", "^rkf45", ",%s*midpoint%s*%)$",
    ",%s*gauss%(1%)%s*%)$" } do
    if name:find(pattern) then return true end
  end
  return false
end

-- has a system linearised forces that are linear in v (Coriolis, magnetic, friction)? Rules that
-- treat q and v differently do not take these apart
local function is_coupled(matrix)
  local n, size = matrix.rows // 2, 0
  for i = n + 1, 2 * n do
    local row = matrix[i]
    for j = 1, n do size = max(size, sqrt(abs(row[j]))) end
  end
  for i = n + 1, 2 * n do
    local row = matrix[i]
    for j = n + 1, 2 * n do
      if abs(row[j]) > 1e-9 * size then return true end
    end
  end
  return false
end

---- along an orbit ----

local MANY = 512   -- states of an orbit at most
local FEW = 1e-4   -- growth of the fastest frequency by twice as many that ends it
-- peaks of the frequency that are looked at between states, how fast beside the first, at one of so
-- many places; and those of these that are looked at everywhere
local PEAKS, NEARLY, SOME, FASTEST = 16, 0.15, 4, 3
local PLACES = 32  -- states that are looked at; as many where steps are short; about the fastest

-- largest difference of two matrices, in parts of the largest entry
local function differ(a, b)
  local worst, size = 0, 0
  for i = 1, a.rows do
    local x, y = a[i], b[i]
    for k = 1, a.columns do
      worst, size = max(worst, abs(x[k] - y[k])), max(size, abs(x[k]))
    end
  end
  return worst > 1e-12 * size
end

-- the frequencies above 0, the largest first
local function oscillations(linear)
  local out = {}
  for _, w in ipairs(linear.frequencies) do
    if w > 1e-9 * linear.fastest then out[#out + 1] = w end
  end
  table.sort(out, function(a, b) return a > b end)
  return out
end

-- notes what a system linearised at a state has: its frequencies and the time; nil and why where
-- that cannot be
local function note(out, system, state)
  local linearize = require "dm.measure.linearize".frozen
  local fine, its = blame.try(linearize, system,
    { q = state.q, v = state.v, p = state.p, t = state.t }, out.traced)
  if not fine then return nil, (tostring(its):gsub("^[^\n]-lua:%d+: ", "")) end
  local first = out.matrices[1]
  out.constant = out.constant and not (first and differ(its.matrix, first))
  out.matrices[#out.matrices + 1] = its.matrix
  out.coupled = out.coupled or is_coupled(its.matrix)
  out.fastest = max(out.fastest, its.fastest)
  local seen = oscillations(its)
  seen.t = state.t
  for k, w in ipairs(seen) do
    local mode = out.ranges[k] or { least = huge, most = 0, count = 0 }
    mode.least, mode.most, mode.count = min(mode.least, w), max(mode.most, w), mode.count + 1
    out.ranges[k] = mode
  end
  return seen
end

local LARGEST = 100  -- coordinates, beyond which it is not asked

-- second derivatives of L by (q, v) as a function of (q, v, t)
local function second_derivatives(system)
  local given, n = system.given, system.Q.dimension
  local L = bound(given.L, given.params)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local second = core.derivative(core.trace(function(q, v, t) return slope(q, v, t) end, n, n,
    "number"), n, n, "number")
  return core.trace(function(q, v, t)
    local H, out = second(q, v, t), {}
    for i = 1, 2 * n do
      for k = 1, 2 * n do out[#out + 1] = H[i][k] end
    end
    return core.vector(out)
  end, n, n, "number")
end

-- Is L of second degree in (q, v), with constants? Then one state tells all.
local function is_quadratic(system)
  if system.place or not system.given.L or system.Q.dimension > LARGEST then return false end
  local fine, f = blame.try(second_derivatives, system)
  for _, argument in ipairs(fine and f:depends() or {}) do
    for _, some in ipairs(argument) do fine = fine and not some end
  end
  return fine
end

-- notes a state of the orbit, once
local function note_state(linear, k)
  local noted = linear.noted
  if noted[k] == nil then noted[k] = note(linear, linear.system, linear.states[k]) or false end
  return noted[k]
end

-- states along the orbit, more and more of them until none is faster
local function look_along(linear)
  local count, before = PLACES, nil
  repeat
    before = linear.fastest
    for _, k in ipairs(orbits.places(linear, count)) do note_state(linear, k) end
    count = 2 * count
  until linear.constant or count > MANY or #linear.states < count
    or count > 2 * PLACES and linear.fastest <= (1 + FEW) * before
end

-- the largest frequency of state k that was noted, or 0
local function fastest_of(linear, k)
  local seen = linear.noted[k]
  return seen and seen[1] or 0
end

-- states that are faster than those beside them, and nearly as fast as any: their numbers
local function peaks(linear)
  local noted, out, fastest = {}, {}, 0
  for k = 1, #linear.states do
    if linear.noted[k] then noted[#noted + 1] = k end
    fastest = max(fastest, fastest_of(linear, k))
  end
  for i, k in ipairs(noted) do
    local here = fastest_of(linear, k)
    if here >= max(fastest_of(linear, noted[i - 1] or 0), fastest_of(linear, noted[i + 1] or 0),
      (1 - NEARLY) * fastest) then
      out[#out + 1] = k
    end
  end
  return out
end

-- notes every so many of the states between those before and after that of this number; the largest
-- frequency there
local function look_about(linear, near, i, every, project)
  local states, most = linear.states, fastest_of(linear, i)
  local from, to = states[max(1, i - 1)], states[min(#states, i + 1)]
  local between = near[i] or orbits.states(linear.system, from, to.t - from.t, 0, project)
  near[i] = between
  for k = 1, #between, every do
    local seen = note(linear, linear.system, between[k])
    most = max(most, seen and seen[1] or 0)
  end
  return most
end

-- the peaks that are left when each was looked at, in the order of their frequencies
local function fastest_peaks(linear, list, most, look)
  local found = {}
  for _, k in ipairs(list) do found[k] = look(k) end
  table.sort(list, function(i, k) return found[i] > found[k] or found[i] == found[k] and i < k end)
  return table.move(list, 1, most, 1, {})
end

-- the frequency may be larger still between states: some of all peaks, then more of the fastest
local function look_closer(linear, project)
  local near = {}
  local list = fastest_peaks(linear, peaks(linear), PEAKS, function(k)
    return fastest_of(linear, k)
  end)
  list = fastest_peaks(linear, list, FASTEST, function(k)
    return look_about(linear, near, k, SOME, project)
  end)
  for _, k in ipairs(list) do look_about(linear, near, k, 1, project) end
end

---- of a cell ----

-- The system linearised along the orbit of a cell: { fastest, matrices, coupled, ranges of its
-- frequencies, constant, states, T = the time that was looked at, where it is less than all }; nil
-- and why. Where states have unlike matrices it is looked at again about the fastest
-- one.
local function along_orbit(map, cell)
  local system, options = map.system_of(cell), map.options
  if system.field then return fields.along_orbit(map, cell, system) end
  local start = { q = map.start.q(cell), v = map.start.v and map.start.v(cell),
    p = map.start.p and map.start.p(cell), t = options.t0 or 0 }
  local T = options.t or options.steps * map.h[1]
  local out = { fastest = 0, matrices = {}, ranges = {}, constant = true, system = system,
    traced = {} }
  local first, why = note(out, system, start)
  if not first then return nil, why end
  local states, done = { start }, T
  if not is_quadratic(system) then
    states, done = orbits.states(system, start, T, out.fastest, options.project)
  end
  out.first, out.states, out.noted, out.project = first, states, {}, options.project
  look_along(out)
  if not out.constant then look_closer(out, options.project) end
  if not (out.fastest > 0) then return nil, "nothing oscillates along the orbit" end
  out.T = done < T and done or nil
  return out
end

-- the same, found once for all rules of the same system and start
local function found_once(map, cell)
  map.orbits = map.orbits or {}
  local key = {}
  for name, value in pairs(cell.values) do key[#key + 1] = ("%s=%a"):format(name, value) end
  table.sort(key)
  key = table.concat(key, " ")
  map.orbits[key] = map.orbits[key] or table.pack(along_orbit(map, cell))
  return table.unpack(map.orbits[key], 1, 2)
end

-- what linear theory says of rule number i of a map, found once: its limit, and what it tells; nil
-- and why
local function limit_of(map, i)
  map.limits = map.limits or {}
  map.limits[i] = map.limits[i] or table.pack(blame.try(rules.stability_limit, map.rule_list[i]))
  local fine, z, told = table.unpack(map.limits[i], 1, 3)
  if not fine then return nil, (tostring(z):gsub("^[^\n]-lua:%d+: ", "")) end
  return z, told
end

-- the system linearised along the orbit of a cell, and what the rule does; nil and why
local function theory_of(map, cell)
  local z, told = limit_of(map, cell.rule)
  if not z then return nil, told end
  local linear, why = found_once(map, cell)
  if not linear then return nil, why end
  if linear.coupled and not takes_all_apart(map.rule_list[cell.rule]) then
    local what = linear.system.place and "the turn of the motion (its frame is that of the body)"
      or "a force linear in v (magnetic, Coriolis, friction)"
    return nil, what .. " couples the oscillations, and this rule does not step each by itself"
  end
  return linear, z, told
end

--- The step at which a frequency along the orbit of a cell meets the first window of growth of the
-- rule; nil where there is none; and a sentence.
function M.limit_along_orbit(map, cell)
  local system = map.system_of(cell)
  if system.line then return lines.limit(map, cell, system) end
  local linear, z, told = theory_of(map, cell)
  if not linear then return nil, z end
  local why = ("%s; omega = %.6g%s"):format(told.cause, linear.fastest,
    linear.constant and "" or " is the largest along the orbit")
  if linear.T then why = why .. (", seen up to t0 + %.4g"):format(linear.T) end
  if z > 0 and told.gaps[1] and told.gaps[1][2] < huge then
    why = why .. ("; it grows up to h omega = %.6g"):format(told.gaps[1][2])
  end
  return z / linear.fastest, why
end

-- the frequencies of all oscillations, for resonances, and which of them are means alone
local function all_modes(linear)
  if not linear.modes then
    linear.modes, linear.means = modes.frequencies(linear, note_state)
  end
  return linear.modes, linear.means
end

--- Windows of growth of the rule in steps h, { from, to } for each oscillation of a cell; nil
-- and why.
function M.windows(map, cell)
  if map.system_of(cell).line then return nil, "they are not looked for on lines" end
  local linear, why, told = theory_of(map, cell)
  if not linear then return nil, why end
  local out, last = {}, nil
  for _, omega in ipairs(all_modes(linear)) do
    for _, gap in ipairs(last and abs(omega - last) <= 1e-6 * last and {} or told.gaps) do
      if gap[2] < huge then out[#out + 1] = { gap[1] / omega, gap[2] / omega } end
    end
    last = omega
  end
  return out
end

--- Steps on the axis that turn an oscillation of a cell by 2 pi / n: a list of { n, h, omega, mean
-- }; nil and why.
function M.resonances(map, cell, axis)
  if map.system_of(cell).line then return nil, "they are not looked for on lines" end
  local linear, why, told = theory_of(map, cell)
  if not linear then return nil, why end
  local out, last = {}, nil
  local frequencies, means = all_modes(linear)
  for _, omega in ipairs(frequencies) do
    if not last or abs(omega - last) > 1e-6 * last then
      for _, r in ipairs(told.resonances) do
        local h = r.z / omega
        if h >= axis[1] and h <= axis[#axis] then
          out[#out + 1] = core.result { n = r.n, h = h, omega = omega, mean = means[omega] }
        end
      end
    end
    last = omega
  end
  table.sort(out, function(a, b) return a.h < b.h end)
  return out
end

return M
