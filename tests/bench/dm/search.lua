-- dmlua tests/bench/dm/search.lua FOLDER [KEY]
-- Every rule of dm.rules() on every problem: the steps that just reach an error, and the CPU time.
-- The same search and the same lines as tests/bench/c/search.c.
package.path = arg[0]:match "^(.*/)" .. "?.lua;" .. package.path
local dm = require "dm"
local models = require "models"
local OUTPUTS, TARGETS, LONGEST = 32, { 1e-4, 1e-8, 1e-10 }, 6e7
local folder, only = arg[1], arg[2] or ""

-- the good ones first: they shorten the search for the others. A second argument of gauss is a number of sweeps,
-- as the bound has it: looser than round-off by name
local RULES = { "gauss(8, 6)", "gauss(8, 8)", "gauss(8, 7)", "gauss(8, 5)", "gauss(8, 4)", "gauss(7, 6)", "gauss(7, 5)", "gauss(6, 6)",
  "gauss(6, 4)", "gauss(4, 3)", "gauss(8)", "gauss(7)", "gauss(6)", "gauss(5)", "gauss(4)", "gauss(3)", "gauss(2)", "rk8pd", "rk8",
  "sofroniou-spaletta(10)", "kahan-li(8)", "suzuki-umeno(8)", "kahan-li(6)", "blanes-moan(6, 14)",
  "blanes-moan(6, 11)", "blanes-moan(4)", "suzuki(4)", "mclachlan(4)", "yoshida(6)", "yoshida(4)",
  "log-hamiltonian(sofroniou-spaletta(10))", "log-hamiltonian(kahan-li(8))", "log-hamiltonian(verlet)",
  "verlet", "midpoint" }
local RULES_ON_GROUPS = { "gauss(8)", "gauss(7)", "gauss(6)", "gauss(5)", "gauss(4)", "gauss(3)", "gauss(8, 6)", "gauss(8, 8)",
  "gauss(8, 10)", "gauss(8, 12)", "gauss(8, 13)", "gauss(8, 14)", "lie(4)", "lie(3)", "lie(2)", "lie(1)", "rotations(8)",
  "rotations(6)", "rotations(4)", "rotations(2)", "rkmk4" }

-- and for chains of 1024, where an implicit step would have a matrix of 1024 x 1024; sums of the bound are plain there
local LONG_RULES, LONGEST_LONG =
  { "blanes-moan(6, 11)", "blanes-moan(6, 14)", "blanes-moan(6, 11), plain sums", "blanes-moan(6, 14), plain sums" }, 5e9

local known = {}
for _, rule in ipairs(dm.rules()) do known[rule.name] = true end
for _, rule in ipairs(RULES) do
  if not known[rule:match "^[%w_-]+"] then io.stderr:write("skipped  rule ", rule, ": not in dm.rules()\n") end
end

local function read_reference(key)
  local rows = {}
  for line in assert(io.open(folder .. "/" .. key .. ".txt")):lines() do
    if line:sub(1, 1) ~= "#" then
      local row = {}
      for number in line:gmatch "%S+" do row[#row + 1] = tonumber(number) end
      rows[#rows + 1] = row
    end
  end
  return rows
end

local function solver_of(model, rule, m)
  local bare = rule:match "^(.*), plain sums$"
  return model.system:solver { rule = bare or rule, sums = bare and "plain", h = model.T / OUTPUTS / m }
end

-- solver and run, as a script has them; rules with a time of their own give the states at given times
local function run(model, rule, m)
  local solver = solver_of(model, rule, m)
  if not rule:find "^log" then
    return solver:run { q = model.q, v = model.v, p = model.p, steps = OUTPUTS * m, every = m }, solver
  end
  local at = {}
  for i = 1, OUTPUTS do at[i] = model.T / OUTPUTS * i end
  return solver:run { q = model.q, v = model.v, p = model.p, at = at }, solver
end

-- max norm over the 32 outputs (the first row may be the start)
local function error_of(model, rule, m)
  local fine, path = pcall(run, model, rule, m)
  if not fine then return math.huge, path end
  if #path < OUTPUTS then return math.huge end
  local worst, first = 0, #path - OUTPUTS
  for i, row in ipairs(model.reference) do
    local q = path.q[first + i]
    if model.positions then q = model.positions(q) end
    for k, x in ipairs(row) do
      local d = math.abs(q[k] - x)
      if d ~= d or d > worst then worst = d == d and d or math.huge end
    end
  end
  return worst
end

local function once(model, rule, m)
  local t = os.clock()
  pcall(run, model, rule, m)
  return (os.clock() - t) * 1e9
end

-- median of batches, each the best of many
local function time_of(model, rule, m)
  local best, all = {}, 0
  for i = 1, 5 do
    if all > 2e9 then break end
    local spent, k = 0, 0
    best[i] = math.huge
    while k < 3 or (spent < 3e6 and k < 1000) do
      local ns = once(model, rule, m)
      best[i], spent, k = math.min(best[i], ns), spent + ns, k + 1
    end
    all = all + spent
  end
  table.sort(best)
  return best[(#best + 1) // 2]
end

-- what a run of no steps costs (trace and compilation are part of every run): the best of a few, ns
local function setup_of(model, rule, m)
  local least = math.huge
  for _ = 1, 7 do
    local t = os.clock()
    solver_of(model, rule, m):run { q = model.q, v = model.v, p = model.p, steps = 0 }
    least = math.min(least, (os.clock() - t) * 1e9)
  end
  return least
end

local function line(kind, model, rule, m, err, ns, ...)
  print(table.concat({ kind, "dmlua", model.key, rule, OUTPUTS * m, ("%.3e"):format(err), ("%.1f"):format(ns), ... }, "\t"))
end

-- steps and errors until round-off or the longest run
local function curve(model, rule)
  local points, best, at = {}, math.huge, 1
  while #points < 64 do
    local m = math.floor(at + 0.5)
    at = at * 1.35
    if #points == 0 or m ~= points[#points].m then
      local err, why = error_of(model, rule, m)
      local ns = math.min(once(model, rule, m), once(model, rule, m))
      points[#points + 1] = { m = m, err = err, why = why }
      if err < 1e3 then line("point", model, rule, m, err, ns) end
      -- implicit rules may take longer for a few steps, so far apart that Newton's method is needed, than for more
      local too_long = ns > model.longest and #points > 6
      if err < 2e-11 or too_long or (err < math.huge and err > 30 * best and best < 1e-7) then break end
      if #points == 12 and why and best == math.huge then break end
      best = math.min(best, err)
    end
  end
  return points
end

local function smallest(model, rule, low, high, target)
  while high - low > 1 do
    local middle = (low + high) // 2
    if error_of(model, rule, middle) <= target then high = middle else low = middle end
  end
  return high
end

local function search(model, rule)
  local points = curve(model, rule)
  for _, target in ipairs(TARGETS) do
    for i, point in ipairs(points) do
      if point.err <= target then
        local m = smallest(model, rule, i > 1 and points[i - 1].m or 0, point.m, target)
        local ns = time_of(model, rule, m)
        line("target", model, rule, m, error_of(model, rule, m), ns, ("%g"):format(target),
          ("%.0f"):format(setup_of(model, rule, m)))
        if target == TARGETS[#TARGETS] then model.longest = math.min(model.longest, math.max(30 * ns, 2e6)) end
        break
      end
    end
  end
  io.stdout:flush()
end

for _, model in ipairs(models) do
  if model.key:sub(1, #only) == only then
    model.reference, model.longest = read_reference(model.key), model.long and LONGEST_LONG or LONGEST
    for _, rule in ipairs(model.long and LONG_RULES or model.on_group and RULES_ON_GROUPS or RULES) do
      if known[rule:match "^[%w_-]+"] and (model.attracting or not rule:find "^log") then
        -- one step tells whether the rule fits the problem at all
        local fine, why = pcall(run, model, rule, 1)
        if fine or type(why) ~= "string" or not why:find "rule" then
          search(model, rule)
        else
          io.stderr:write("skipped  ", rule, " on ", model.key, ": ", (why:gsub("\n.*", "")), "\n")
        end
      end
    end
  end
end
