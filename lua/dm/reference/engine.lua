--- References: two unlike methods with unlike steps as long as their errors allow, which must not
-- jump over anything hidden in the forces, to smaller and smaller tolerances until they agree.
local blame = require "dm.base.blame"
local core = require "dm.core"
local first_order = require "dm.reference.first_order"
local forces = require "dm.reference.forces"
local plain = require("dm.base.lists").plain

local M = {}
M.__index = M

local max, min, huge = math.max, math.min, math.huge

-- Methods in the order of preference: the first that can step the system and is not measured; the
-- reference itself is that of the second list. Many coordinates that separate are stepped by
-- compositions.
local FIRST = { "rk8", "rk8pd", "lobatto(6)", "degenerate(3)" }
local FIRST_SEPARABLE = { "rk8", "kahan-li(8)", "rk8pd", "lobatto(6)" }
local SECOND = { "gauss(7)", "degenerate(4)", "gauss(6)" }
-- on groups: the lift and steps in charts, or steps in charts by unlike quadratures; where the
-- chart of exp is too long to trace, that of the Cayley map, or explicit rules by the lift; where
-- there is none either, an H without a Lagrangian has other Gauss points, or rkmk4
local FIRST_ON_GROUPS = { "gauss(5)", "gauss(6)", "lie(4, lobatto(5))", "lie(3, lobatto(4))" }
local SECOND_ON_GROUPS = { "lie(5)", "lie(4)", "lie(5, gauss(5), cayley)", "rk8", "rk8pd",
  "gauss(7)", "rkmk4" }
-- Steps of explicit rules are as short as stiff forces want them though nothing moves: where these
-- are too many, or take more than a part of the time, the first method is an implicit one.
local STIFF, EXPLICIT_TIME, IMPLICIT_TIME = "lobatto(6)", 0.5, 0.6
local MANY, FOR_MANY = 24, { "kahan-li(8)", "gauss(4)", "gauss(5)" }

-- of the error of a step; the second method takes another one, so that no step is like the other's
local TOLERANCES, UNLIKE = { 1e-9, 1e-11, 1e-13, 2e-15, 5e-17, 1e-18 }, 0.3
local LARGEST = { 1 / 24, 1 / 37 }  -- of the whole time: a step, of either method
-- Steps of the first method: where so many have seen all of the path and found nothing, the second
-- does not look, whose longer steps over a stiff oscillation are many times as dear to look at.
local SEEN = 4096

local REFUSALS = { "cannot step this system", "cannot step a system on", "too many to trace",
  "^this group has no ", "needs a regular Lagrangian", "^field 'rule'", "^field 'control'" }

--- Is it the rule that cannot, whatever the step?
function M.is_refusal(why)
  for _, words in ipairs(REFUSALS) do
    if why:find(words) then return true end
  end
  return false
end

--- The first line of a failure, without its place.
function M.words(failure)
  return (tostring(failure):match "^[^\n]*":gsub("^.-%.lua:%d+: ", ""))
end

---- one run ----

-- a solver for each rule, made once; the step is the first that is tried
local function solver_of(self, rule)
  local solver = self.solvers[rule]
  if not solver then
    solver = self.system:solver { rule = rule, h = self.T / 256 }
    self.solvers[rule] = solver
  end
  return solver
end

local function left(self) return self.deadline - core.cpu() end

-- which: { at = } or { t = }, seconds =; raises what the run raises
local function run(self, place, rule, tolerance, which)
  local options = { t0 = self.t0, at = which.at, t = which.t, watch = self.watch,
    gaps = self.watch and true,
    seconds = which.seconds or max(0.01, left(self)),
    control = { tolerance = tolerance, hidden = self.hidden,
      watched = self.hidden and self.watched or nil, largest = self.T * LARGEST[place],
      negligible = self.negligible, ends = self.ends, reach = self.t0 + self.T } }
  for key, value in pairs(self.start) do options[key] = value end
  return solver_of(self, rule):run(options)
end

local function is_over(failure)
  return type(failure) == "table" and failure.code == "out_of_time"
end

-- Runs that a reference takes, in those of its first method: both methods, both again with shorter
-- steps that agree. Where forces are looked at those are the dear ones.
local LOOKING, PLAIN = 3, 6

-- Seconds were over before a run was: how far it had come, and what a reference would take at that
-- rate; in words. The dearest one is kept.
local function note_late(self, failure, seconds)
  local way = failure.time - self.t0
  local whole = way > 0 and seconds * self.T / way or huge
  local late = { t = failure.time, seconds = whole * (self.hidden and LOOKING or PLAIN) }
  if not self.late or late.seconds > self.late.seconds then self.late = late end
  return ("it had come to t = %.6g of %.6g when its %.2g s were over"):format(failure.time,
    self.t0 + self.T, seconds)
end

-- the same in a part of the time that is left; path, or nil and why not
local function try(self, place, rule, tolerance, which)
  which.seconds = max(0.01, (which.part or 1) * left(self))
  local fine, path = blame.try(run, self, place, rule, tolerance, which)
  if fine then return path end
  return nil, is_over(path) and note_late(self, path, which.seconds) or M.words(path), path
end

---- two methods ----

-- one run of a rule, in a part of the time that is left; where long steps fail, as over a place
-- where L is not defined, shorter ones
local function first_try(self, place, rule, part)
  local path, words, failure
  for _, tolerance in ipairs(TOLERANCES) do
    path, words, failure = try(self, place, rule, tolerance, { t = self.T, part = part })
    if path or M.is_refusal(words) or is_over(failure) or left(self) <= 0 then break end
  end
  return path, words, failure
end

-- the same for a method of the first list or, where that takes too long, the implicit one: path or
-- nil, rule, why not
local function first_method(self, rule)
  local path, words, failure = first_try(self, 1, rule, EXPLICIT_TIME)
  if is_over(failure) and rule ~= STIFF and not self.except[STIFF] and not self.system.place then
    local other = first_try(self, 1, STIFF, IMPLICIT_TIME)
    if other then return other, STIFF end
  end
  return path, rule, words
end

local function second_method(self, rule)
  local path, words = first_try(self, 2, rule)
  return path, rule, words
end

-- the first rule of a list that can step the system; its times, or nil and why none can
local function pick(self, place, list)
  local why
  for _, rule in ipairs(list) do
    if not self.except[rule] and rule ~= self.first then
      local path, used, words = (place == 1 and first_method or second_method)(self, rule)
      if path then
        self.unseen = self.unseen or solver_of(self, used):report().unseen
        return used, plain(path.t)
      end
      if not M.is_refusal(words) then
        -- what a longer try may do better is no refusal
        return nil, ("%s: %s"):format(rule, words)
      end
      why = why or ("%s: %s"):format(rule, words)
    end
  end
  return nil, why or "no method is left that is not measured"
end

local function lists(self)
  if self.system.place then return FIRST_ON_GROUPS, SECOND_ON_GROUPS end
  local fine, s = blame.try(self.system.structure, self.system)
  local separable = fine and s.separable and s.constraints + s.rolling == 0
  local many = separable and self.system.Q.dimension > MANY
  return separable and FIRST_SEPARABLE or FIRST, many and FOR_MANY or SECOND
end

-- where steps are more than the times that are wanted, one time in so many of them is anywhere and
-- one is in the shortest of them: what is passed once, in a few short steps, is looked at too
local function add_sparse(t, every, seed, add)
  for k = 1, #t - 1, every do
    local last, shortest = min(k + every, #t), k
    for i = k + 1, last - 1 do
      if t[i + 1] - t[i] < t[shortest + 1] - t[shortest] then shortest = i end
    end
    local anywhere = t[k] + (t[last] - t[k]) * (1 - 0.9 * (k * seed % 1))
    local inside = t[shortest] + (t[shortest + 1] - t[shortest]) * (1 - 0.9 * (k * seed % 1))
    add(min(anywhere, inside))
    add(max(anywhere, inside))
  end
end

--- times between those of the steps of the first method: about `count` of them, in every step at
-- other places
function M:mesh(count, seed)
  local t, out, last = self.times, {}, self.t0
  local parts, every = max(1, min(256, count // max(1, #t - 1))), max(1, (#t - 1) // count)
  local function add(x)
    if x > last then out[#out + 1], last = x, x end
  end
  if every > 1 then
    add_sparse(t, 2 * every, seed, add)
  else
    for k = 1, #t - 1 do
      for j = 1, parts do
        add(t[k] + (t[k + 1] - t[k]) * (j - 0.9 * ((k * parts + j) * seed % 1)) / parts)
      end
    end
  end
  add(self.t0 + self.T)
  return out
end

-- the paths of both at these times, to the tolerance number k
local function pair(self, k, at)
  local path, other = {}, nil
  for place, rule in ipairs { self.first, self.rule } do
    path[place], other = try(self, place, rule, TOLERANCES[k] * (place == 1 and 1 or UNLIKE),
      { at = at })
    if not path[place] then return nil, ("%s: %s"):format(rule, other) end
  end
  return path
end

--- The reference of a job { system =, start =, t0 =, T =, watch =, goal =, seconds =,
-- tolerance = { column = }, distance = function(path, path) -> number, except = { rule = true } }:
-- distance <= goal or, where no more is had in the seconds, enough, with rule, distance, noise
-- (what shorter steps brought no nearer), text and path(times); or nil, why there is none, what it
-- may take where seconds ended it { t = how far a run had come, seconds = }, and at which distance
-- both stayed where they did. With tolerances nothing hidden in what is watched is jumped over
-- either.
function M.find(job)
  local self = setmetatable({ solvers = {}, except = job.except or {}, system = job.system,
    start = job.start, t0 = job.t0 or 0, T = job.T, watch = job.watch, ends = job.ends,
    negligible = job.negligible, deadline = core.cpu() + (job.seconds or 20) }, M)
  local form = first_order.of(self.system, self.start, self.t0, self.watch) or {}
  for key, value in pairs(form) do self[key] = value end
  self.hidden, self.watched = forces.of(self.system, job.tolerance
    and { watch = self.watch, tolerance = job.tolerance })
  local why
  local first, second = lists(self)
  self.first, why = pick(self, 1, first)
  if not self.first then return nil, why, self.late end
  self.times = why
  if not self.unseen and #self.times > SEEN then self.hidden = nil end
  self.rule, why = pick(self, 2, second)
  if not self.rule then return nil, why, self.late end
  -- what the longest steps do not jump over, shorter ones do not either
  if not self.unseen then self.hidden = nil end
  return M.refine(self, job)
end

-- smaller tolerances until both agree, or come no closer
function M:refine(job)
  local at = job.at or self:mesh(1024, 0.6180339887498949)
  self.distance = huge
  for k = 1, #TOLERANCES do
    local paths, why = pair(self, k, at)
    if paths then
      local distance, absolute = job.distance(paths[1], paths[2])
      if distance ~= distance then return nil, "it has no value at some of the samples" end
      if distance < self.distance then
        self.distance, self.absolute, self.tolerance = distance, absolute, TOLERANCES[k]
        self.paths, self.at, self.noise = paths, at, nil
      end
      -- the first that comes no closer: how near two of them are by chance of rounding
      if distance > self.distance then self.noise = self.noise or distance end
      if distance <= job.goal then break end
    elseif self.distance < huge then
      break
    elseif k == #TOLERANCES or left(self) <= 0 then -- shorter steps do not get through either
      return nil, why, self.late
    end
  end
  self.noise = self.noise or self.distance
  self.text = ("%s and %s with controlled steps (%d of the first)"):format(self.first, self.rule,
    #self.times - 1)
  if self.distance <= max(job.goal, job.enough or 0) or job.best then return self end
  return nil, ("%s and %s, with steps controlled to %.0e, are %.1e apart"):format(self.first,
    self.rule, self.tolerance or TOLERANCES[1], self.distance), self.late, self.distance
end

--- The path at other times, in so many seconds of CPU; without them in what is left, one at least.
function M:path(at, seconds)
  self.deadline = seconds and core.cpu() + seconds or max(self.deadline, core.cpu() + 1)
  return run(self, 2, self.rule, self.tolerance * UNLIKE, { at = at })
end

return M
