--- What runs cost on one machine: measured once for each model, rule and number of steps, kept,
-- saved, read again.
local core = require "dm.core"
local pilot = require "dm.scene.pilot"
local weights = require "dm.scene.weights"

local M = {}
M.__index = M
M.__name = "dm.scene_profile"

local min, max, huge = math.min, math.max, math.huge

local fail = require "dm.base.options".failing "dm.scene"

--- An empty profile, which finds what it is asked for: by counting operations, or "clock": by the
-- clock, in ns.
function M.new(costs)
  return setmetatable({ rows = {}, few = {}, guessed = {}, measures = true,
    counts = costs ~= "clock" }, M)
end

--- Are all of its figures counted? So are those of a file where a scene saved counted ones.
function M:is_counted()
  if self.counts or self.measures then return self.counts end
  for _, row in pairs(self.rows) do
    for _, entry in pairs(row) do
      if entry.ns ~= entry.work then return false end
    end
  end
  return true
end

local LONG_ENOUGH, LONGEST = 4e-3, 60  -- s of CPU spent on one figure; repeats

-- ns of a step, without set-up, over so many of the N steps: the best of several; and the report of
-- the run
local function measure(model, rule, N, steps, enough)
  local best, report = huge, nil
  local began = core.cpu()
  for _ = 1, LONGEST do
    local before, _ = core.cpu(), nil
    _, report = pilot.go(model, rule, N, { steps = steps })
    -- a run whose steps choose their lengths is a whole one, of as many as they were; the latter
    -- time counts where others had the processor
    local even = pilot.is_even(rule)
    local own = even and report.ns_per_step or report.ns_per_step * report.steps / N
    best = min(best, own, 1e9 * (core.cpu() - before) / (even and steps or N))
    local spent = core.cpu() - began
    if (spent > enough and spent > 4e-9 * best * steps) or spent > 50 * enough then break end
  end
  return max(best, 1e-3), report
end

--- ns of a run by the clock, set-up apart.
function M.time(model, rule, N) return (measure(model, rule, N, N, LONG_ENOUGH)) * N end

-- work of a step, over so many of the N steps; the same in every run
local function count(model, rule, N, steps)
  local _, report = pilot.go(model, rule, N, { steps = steps })
  local all = pilot.is_even(rule) and steps or N
  return weights.work(report, model, rule) / all, report
end

local function key_of(model, rule) return model:fingerprint() .. " " .. rule end

-- ns by the rates of what was measured: for the same rule, or for all
local function estimate(self, model, rule, N)
  local same, all = {}, {}
  for key, row in pairs(self.rows) do
    for _, entry in pairs(row) do
      all[#all + 1] = entry.ns / entry.work
      if key:match "^%x+ (.*)$" == rule then same[#same + 1] = all[#all] end
    end
  end
  if #all == 0 then
    fail("the profile that was given holds no figure: save one from a scene that has run, "
      .. "scene.profile:save(file)")
  end
  local rates = #same > 0 and same or all
  table.sort(rates)
  return count(model, rule, N, min(N, 64)) * N * rates[(#rates + 1) // 2]
end

--- Cost of N steps: work, or ns. What is not known is measured, or, in a profile that was given,
-- estimated from its rates.
function M:cost(model, rule, N)
  local key = key_of(model, rule)
  local row = self.rows[key] or {}
  if row[N] then return row[N].ns end
  if not self.measures then
    local place = key .. " " .. N
    self.guessed[place] = self.guessed[place] or estimate(self, model, rule, N)
    return self.guessed[place]
  end
  local ns, report = (self.counts and count or measure)(model, rule, N, N, LONG_ENOUGH)
  row[N] = { ns = ns * N, least = ns * N, work = weights.work(report, model, rule) }
  self.rows[key] = row
  return ns * N
end

--- The least that N steps cost in all measurements.
function M:least(model, rule, N)
  local entry = (self.rows[key_of(model, rule)] or {})[N]
  return entry and entry.least or self:cost(model, rule, N)
end

--- Time some runs once more, in turn, so that what else the machine does meets all of them alike;
-- runs: list of { model, rule, N }.
function M:again(runs, rounds, seconds)
  local began = core.cpu()
  for _ = 1, self.measures and not self.counts and rounds or 0 do
    for _, c in ipairs(runs) do
      local entry = self.rows[key_of(c.model, c.rule)][c.N]
      entry.least = min(entry.least, measure(c.model, c.rule, c.N, c.N, 0) * c.N)
    end
    if core.cpu() - began > seconds then break end
  end
end

local FEW = 256  -- steps of a run that tells about what more of them cost

--- About what N steps cost, from a few of them. What was told once is told again, whatever has been
-- measured since, so that a profile that was saved leads to the same choice.
function M:about(model, rule, N)
  local key = key_of(model, rule)
  local few, row = self.few[key] or {}, self.rows[key] or {}
  if not few[N] and (row[N] or not self.measures) then return self:cost(model, rule, N) end
  self.few[key] = few
  few[N] = few[N] or (self.counts and count or measure)(model, rule, N, min(N, FEW),
    LONG_ENOUGH / 5)
  return few[N] * N
end

--- What a run of some of N steps tells about all of them, where operations are counted.
function M:told(model, rule, N, report, steps)
  if not (self.measures and self.counts) then return end
  local key = key_of(model, rule)
  self.few[key] = self.few[key] or {}
  self.few[key][N] = self.few[key][N] or weights.work(report, model, rule) / steps
end

local doc_save = [[
profile:save(file) -> file name
Write the measured costs, a line each: model, steps, ns, least ns, operations, rule.
dm.scene{profile = file} then chooses by these figures, without a clock, and so always the same.]]

local HEAD = "dmlua scene profile 1"

-- a line each: runs with their operations, short runs with none
local function lines_of(self)
  local lines = {}
  local function add(key, N, ns, least, work)
    local print, rule = key:match "^(%x+) (.*)$"
    lines[#lines + 1] = ("%s %d %.17g %.17g %.17g %s"):format(print, N, ns, least, work, rule)
  end
  for key, row in pairs(self.rows) do
    for N, entry in pairs(row) do add(key, N, entry.ns, entry.least, entry.work) end
  end
  for key, row in pairs(self.few) do
    for N, ns in pairs(row) do add(key, N, ns, ns, 0) end
  end
  table.sort(lines)
  return lines
end

function M:save(file)
  local handle, why = io.open(file, "w")
  if not handle then fail("cannot write the profile: %s", why) end
  handle:write(HEAD, "\n", table.concat(lines_of(self), "\n"), "\n")
  handle:close()
  return file
end

local function positive(text)
  local x = tonumber(text)
  return x and x > 0 and x < huge and x or nil
end

-- one line of a profile into it; false where it does not read
local function read_line(self, line)
  local print, N, ns, least, work, rule = line:match "^(%x+) (%d+) (%S+) (%S+) (%S+) (.*)$"
  N, ns, least, work = math.tointeger(positive(N)), positive(ns), positive(least), tonumber(work)
  if not (rule and N and ns and least and work and work >= 0 and work < huge) then return false end
  local key = print .. " " .. rule
  local rows = work > 0 and self.rows or self.few
  rows[key] = rows[key] or {}
  rows[key][N] = work > 0 and { ns = ns, least = least, work = work } or ns
  return true
end

--- The profile in a file, which no longer measures.
function M.read(file)
  local handle, why = core.open_file(file)
  if not handle then fail("option 'profile': %s", why) end
  local text = handle:read "a"
  handle:close()
  local first, rest = (text or ""):match "^([^\n]*)\n(.*)$"
  if first ~= HEAD then
    fail("option 'profile': %s is not a profile that scene.profile:save wrote", file)
  end
  local out = M.new "clock"
  out.measures = false
  for line in rest:gmatch "[^\n]+" do
    if not read_line(out, line) then
      fail("option 'profile': %s has a line that does not read: %s", file, line)
    end
  end
  return out
end

function M:__tostring()
  local count = 0
  for _, row in pairs(self.rows) do
    for _ in pairs(row) do count = count + 1 end
  end
  return ("costs of %d runs%s"):format(count, self.measures and ", measured as they are needed"
    or ", as given")
end

core.docs[M.save] = doc_save

return M
