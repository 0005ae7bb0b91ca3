--- What runs cost on one machine: measured once for each model, rule and number of steps, kept, saved, read again.
local core = require "dm.core"
local pilot = require "dm.scene.pilot"

local M = {}
M.__index = M
M.__name = "dm.scene_profile"

local min, max, huge = math.min, math.max, math.huge

local function fail(...) error("dm.scene: " .. (...):format(select(2, ...)), 0) end

--- An empty profile, which measures what it is asked for.
function M.new() return setmetatable({ rows = {}, few = {}, measures = true }, M) end

local LONG_ENOUGH, LONGEST = 4e-3, 60  -- s of CPU spent on one figure; repeats

-- ns of a step, without set-up, over so many of the N steps: the best of several; and the report of the run
local function measure(model, rule, N, steps, enough)
  local solver, start = pilot.solver(model, rule, N), pilot.options_of(model, { steps = steps, every = steps })
  local best, report = huge, nil
  local began = core.cpu()
  for _ = 1, LONGEST do
    local before = core.cpu()
    solver:run(start)
    report = solver:report()
    best = min(best, report.ns_per_step, 1e9 * (core.cpu() - before) / steps)  -- the latter where others had the processor
    local spent = core.cpu() - began
    if (spent > enough and spent > 4e-9 * best * steps) or spent > 50 * enough then break end
  end
  return max(best, 1e-3), report
end

local function key_of(model, rule) return model:fingerprint() .. " " .. rule end

-- operations of a run, as far as counters tell: of the kernels, and what surrounds them
local function work_of(report, n) return max(report.evaluations, report.steps) * (report.operations + 8 * n) end

-- ns by the rates of what was measured: for the same rule, or for all
local function estimate(self, model, rule, N)
  local same, all = {}, {}
  for key, row in pairs(self.rows) do
    for _, entry in pairs(row) do
      all[#all + 1] = entry.ns / entry.work
      if key:match "^%x+ (.*)$" == rule then same[#same + 1] = all[#all] end
    end
  end
  if #all == 0 then fail("the profile that was given holds no figure: save one from a scene that has run, scene.profile:save(file)") end
  local rates = #same > 0 and same or all
  table.sort(rates)
  local solver = pilot.solver(model, rule, N)
  local steps = min(N, 64)
  solver:run(pilot.options_of(model, { steps = steps, every = steps }))
  local n = model.system.Q.dimension
  local work = work_of(solver:report(), n) * N / steps
  return { ns = work * rates[(#rates + 1) // 2], work = work }
end

--- ns of N steps. What is not known is measured, or, in a profile that was given, estimated from its rates.
function M:cost(model, rule, N)
  local key = key_of(model, rule)
  local row = self.rows[key] or {}
  if row[N] then return row[N].ns end
  local entry
  if self.measures then
    local ns, report = measure(model, rule, N, N, LONG_ENOUGH)
    entry = { ns = ns * N, work = work_of(report, model.system.Q.dimension) }
  else
    self.guessed = self.guessed or {}
    local known = self.guessed[key .. N] or estimate(self, model, rule, N)
    self.guessed[key .. N] = known
    return known.ns
  end
  row[N], self.rows[key] = entry, row
  return entry.ns
end

--- Time some runs once more, in turn, so that what else the machine does meets all of them alike; runs: list of { model, rule, N }.
function M:again(runs, rounds, seconds)
  local began = core.cpu()
  for _ = 1, self.measures and rounds or 0 do
    for _, c in ipairs(runs) do
      local entry = self.rows[key_of(c.model, c.rule)][c.N]
      entry.ns = min(entry.ns, measure(c.model, c.rule, c.N, c.N, 0) * c.N)
    end
    if core.cpu() - began > seconds then break end
  end
end

local FEW = 256  -- steps of a run that tells about what more of them cost

--- About what N steps cost: from a figure for a number of steps that is not far, or from a few of them.
function M:about(model, rule, N)
  local key, nearest, distance = key_of(model, rule), nil, nil
  for other, entry in pairs(self.rows[key] or {}) do
    local d = other > N and other / N or N / other
    if d < 1.15 and (not distance or d < distance or (d == distance and other > N)) then nearest, distance = entry.ns * N / other, d end
  end
  if nearest or not self.measures then return nearest or self:cost(model, rule, N) end
  local row = self.few[key] or {}
  self.few[key] = row
  row[N] = row[N] or measure(model, rule, N, min(N, FEW), LONG_ENOUGH / 5)
  return row[N] * N
end

local doc_save = [[
profile:save(file) -> file name
Write the measured costs, a line each: model, steps, ns of CPU, operations, rule. dm.scene{profile = file} then chooses by these
figures, without a clock, and so always the same.]]

function M:save(file)
  local lines = {}
  for key, row in pairs(self.rows) do
    local print, rule = key:match "^(%x+) (.*)$"
    for N, entry in pairs(row) do lines[#lines + 1] = ("%s %d %.17g %.17g %s"):format(print, N, entry.ns, entry.work, rule) end
  end
  table.sort(lines)
  local handle, why = io.open(file, "w")
  if not handle then fail("cannot write the profile: %s", why) end
  handle:write("dmlua scene profile 1\n", table.concat(lines, "\n"), "\n")
  handle:close()
  return file
end

--- The profile in a file, which no longer measures.
function M.read(file)
  local handle, why = io.open(file)
  if not handle then fail("option 'profile': %s", why) end
  local text = handle:read "a"
  handle:close()
  local first, rest = text:match "^([^\n]*)\n(.*)$"
  if first ~= "dmlua scene profile 1" then fail("option 'profile': %s is not a profile that scene.profile:save wrote", file) end
  local out = setmetatable({ rows = {}, measures = false }, M)
  for line in rest:gmatch "[^\n]+" do
    local print, N, ns, work, rule = line:match "^(%x+) (%d+) (%S+) (%S+) (.*)$"
    ns, work = tonumber(ns), tonumber(work)
    if not (rule and ns and work and ns > 0 and work > 0) then fail("option 'profile': %s has a line that does not read: %s", file, line) end
    local key = print .. " " .. rule
    out.rows[key] = out.rows[key] or {}
    out.rows[key][math.tointeger(tonumber(N))] = { ns = ns, work = work }
  end
  return out
end

function M:__tostring()
  local count = 0
  for _, row in pairs(self.rows) do
    for _ in pairs(row) do count = count + 1 end
  end
  return ("costs of %d runs%s"):format(count, self.measures and ", measured as they are needed" or ", as given")
end

core.docs[M.save] = doc_save

return M
