--- What a scene tells: the ladder of models and rules, with figures and the reason why each was
-- kept or dropped.
local blame = require "dm.base.blame"

local M = {}

local UNITS = { { 1e3, 1, "ns" }, { 1e6, 1e3, "us" }, { 1e9, 1e6, "ms" }, { math.huge, 1e9, "s" } }

--- 1.2e6 -> "1.2 ms"
function M.time(ns)
  for _, unit in ipairs(UNITS) do
    if ns < unit[1] then return ("%.3g %s"):format(ns / unit[2], unit[3]) end
  end
end

-- errors are kept in tolerances; where all columns have one tolerance they are told in its units
local function error_text(scene, err)
  if err == math.huge then return "-" end
  if scene.unit then return ("%.1e"):format(err * scene.unit) end
  return ("%.2g tol"):format(err)
end
M.error = error_text

local function model_line(scene, row)
  local fine, n, operations = blame.try(row.model.size, row.model)
  return ("  %s: dimension %s, %s operations, error %s: %s, %s")
    :format(row.model:words(), fine and n or "?", fine and operations or "?",
    error_text(scene, row.error), row.kept and "kept" or "dropped", row.verdict)
end

-- counted operations, or time
local function cost_text(scene, c)
  if scene.options.frame then
    return c.worst_step and ("%.2g s a frame"):format(c.worst_step) or ""
  end
  if not scene.profile.counts then return M.time(c.cost) end
  return ("%.3g operations"):format(c.cost)
end

local function candidate_line(scene, c, last)
  return ("  %-24s h = %-9.4g %8d steps %9s  error %-8s %s")
    :format(c.rule, c.h, c.N, c.cost and c.cost < math.huge and cost_text(scene, c) or "",
    error_text(scene, c.error), last)
end

local MOST_LINES, NEAREST = 12, 6  -- rules on one model: those that do, the nearest that do not

-- rules on one model: those that reach the tolerance, cheapest first, then the nearest of those
-- that do not
local function rule_lines(scene, model, lines)
  local kept, dropped = {}, {}
  for _, c in ipairs(scene.search.candidates) do
    if c.model == model then table.insert(c.kept and kept or dropped, c) end
  end
  if #kept + #dropped == 0 then return end
  table.sort(kept, function(a, b) return a.cost < b.cost end)
  table.sort(dropped, function(a, b) return a.error < b.error end)
  lines[#lines + 1] = ("rules on the model: %s"):format(model:words())
  for at, c in ipairs(kept) do
    local verdict = c == scene.best and "chosen" or c.cost == math.huge and c.why
      or ("%.2f times the cost of the choice"):format(c.cost / scene.best.cost)
    if at <= MOST_LINES then lines[#lines + 1] = candidate_line(scene, c, c.failed or verdict) end
  end
  for at, c in ipairs(dropped) do
    if at <= NEAREST then lines[#lines + 1] = candidate_line(scene, c, "dropped: " .. c.why) end
  end
  local more = math.max(0, #kept - MOST_LINES) + math.max(0, #dropped - NEAREST)
  if more > 0 then lines[#lines + 1] = ("  and %d more, in scene.candidates"):format(more) end
end

-- rules that cannot step a model, by reason
local function refused_lines(scene, lines)
  local by_reason, order = {}, {}
  for _, r in ipairs(scene.search.refused) do
    local key = r.why
    if not by_reason[key] then order[#order + 1], by_reason[key] = key, {} end
    if not by_reason[key][r.rule] then
      by_reason[key][r.rule] = true
      table.insert(by_reason[key], r.rule)
    end
  end
  for _, key in ipairs(order) do
    lines[#lines + 1] = ("left out: %s: %s"):format(table.concat(by_reason[key], ", "), key)
  end
end

local function models_lines(scene, lines)
  lines[#lines + 1] = "models"
  for _, row in ipairs(scene.search.models) do lines[#lines + 1] = model_line(scene, row) end
  if scene.search.whole then lines[#lines + 1] = "  no other: " .. scene.search.whole end
end

--- The choice in a line.
function M.choice(scene)
  local b, next_best = scene.best, nil
  for _, c in ipairs(scene.finalists) do
    if c ~= b and not c.failed and not next_best then next_best = c end
  end
  local how = b.model.is_solved and b.rule or ("%s with h = %.4g (%d steps)")
    :format(b.rule, b.h, b.N)
  return ("%s, %s: %s%s")
    :format(b.model:words(), how, cost_text(scene, b),
    next_best and ("; next %s on %s, %s"):format(next_best.rule, next_best.model == b.model
      and "the same model" or next_best.model:words(),
      cost_text(scene, next_best)) or "")
end

-- the model of fewest coordinates that keeps the tolerance, where another one is cheaper
local function least_line(scene)
  local least, n = nil, scene.best.model:size()
  for _, row in ipairs(scene.search.models) do
    local fine, size = blame.try(row.model.size, row.model)
    if row.kept and fine and size < n then least, n = row.model, size end
  end
  if not least then return nil end
  local by
  for _, c in ipairs(scene.search.candidates) do
    if c.model == least and c.kept and (not by or c.cost < by.cost) then by = c end
  end
  return ("least model that keeps the tolerance: dimension %d, %s: %s"):format(n, least:words(),
    by and ("%s, %.3g times the cost of the choice"):format(by.rule, by.cost / scene.best.cost)
    or "no rule on it costs less than the choice")
end

--- The whole ladder as a text.
function M.why(scene)
  local lines = { scene.sentence, "reference: " .. scene.reference_text, "choice: "
    .. M.choice(scene), scene.check_text }
  lines[#lines + 1] = least_line(scene)
  lines[#lines + 1] = scene.rows_text
  if #scene.left_out > 0 then
    lines[#lines + 1] = ("left out, as they follow from the others (system:independent): "
      .. "constraints %s"):format(table.concat(scene.left_out, ", "))
  end
  models_lines(scene, lines)
  for _, row in ipairs(scene.search.models) do rule_lines(scene, row.model, lines) end
  refused_lines(scene, lines)
  if scene.cut then lines[#lines + 1] = scene.cut end
  lines[#lines + 1] = ("%d pilot runs, %.2g s of CPU"):format(scene.search.pilots, scene.seconds)
  return table.concat(lines, "\n")
end

return M
