--- Classes of the cells of a stability map, and how they are told apart by what summaries of their
-- rows say.
local M = {}

local abs, max, sqrt, huge = math.abs, math.max, math.sqrt, math.huge

local FEWEST = 8                -- steps that show anything
-- energy error of the last quarter over that of the first: it grows without bound
local GROWTH = 1e3
local JUMP = 10                 -- the same where it has only gone elsewhere
local STILL = 0.02              -- change of the energy, in parts of its error, of what flew off
local SIGMA = 5                 -- standard errors of a slope that is one
local ROUND_OFF = 1e-9          -- of the energy: less is no error, whatever is moving at the rows
local AT_REST = 1e-12           -- the same of the kinetic energy
local BROKEN = 1e-6             -- |g| of a constraint that is lost

--- Classes: name, whether the motion is lost, what it says.
M.CLASSES = {
  { name = "bounded", text = "the energy error stays in its band" },
  { name = "wrong", text = "bounded, but further from the resolved flow than the accuracy allows" },
  { name = "drifting", text = "the energy error grows steadily" },
  { name = "chaotic", text = "neighbouring orbits separate exponentially" },
  { name = "off", lost = true,
    text = "the energy has gone far elsewhere, and stays there: another motion" },
  { name = "blow-up", lost = true, text = "the energy error grows without bound" },
  { name = "no value", lost = true, text = "what is watched is no number on the way" },
  { name = "left", lost = true, text = "the state left the region that was given as inside" },
  { name = "no convergence", lost = true, text = "the step equation could not be solved" },
  { name = "constraint lost", lost = true, text = "the constraints lost rank or are not kept" },
  { name = "no start", lost = true, text = "L has no value at the start" },
  { name = "not run", text = "stopped before" },
}
local NUMBER = {}
for i, class in ipairs(M.CLASSES) do NUMBER[class.name] = i end

local FAILED = { not_finite = "blow-up", blow_up = "blow-up", no_convergence = "no convergence",
  singular = "no convergence", stopped = "not run", no_start = "no start" }

--- The class of a cell whose run ended with this code.
function M.of_failure(code, constrained)
  if code == "singular" and constrained then return "constraint lost" end
  return FAILED[code] or "no convergence"
end

-- of the kinetic energy: an error below it is one of motion that grows by itself, off the top of a
-- hill
local SHARE = 0.2

-- the energy error of the last quarter is no small part of the kinetic energy then
local function is_much(s, K, i) return not (K and s.late[i] < SHARE * K.late[i]) end

-- growth of the error of y, which only an instability has: from the first to the last quarter
local function is_growing(s, i, kinetic, free)
  local early, late = s.early[i], s.late[i]
  if late ~= late or s.largest[i] == huge then return true end
  if free then return late > GROWTH ^ 2 * max(early, abs(s.first[i])) and late > 0 end
  return late > GROWTH * early and late > kinetic and late > 1e-7 * abs(s.first[i])
end

-- the energy has gone elsewhere in the middle of the run, and stays there
local function has_jumped(s, i, kinetic)
  return kinetic > 0 and s.late[i] > JUMP * s.early[i] and s.late[i] > kinetic
    and s.late[i] > 1e-6 * abs(s.first[i])
end

-- the same from early on: at no row of the second half is the energy near its start, and nearly all
-- of the motion is that error
local function left_at_once(s, i, K)
  local error = max(s.largest[i] - s.first[i], s.first[i] - s.least[i])
  local nearest = s.nearest[i]
  if not (error > ROUND_OFF * abs(s.first[i])) then return false end
  if not K or not (2 * error > abs(K.first[i])) or not (nearest < huge) then return false end
  -- it flew off: nothing acts on it any more, and the energy does not change
  if nearest > 0.9 * error and s.span[i] < STILL * error then return true end
  return error > abs(K.first[i]) and 2 * error > K.largest[i] and 2 * nearest > error
end

local function is_drifting(map, s, i, kinetic, T)
  local slope = abs(s.slope[i])
  return slope > SIGMA * s.error[i] and slope * T > map.drift * max(kinetic, 1e-6 * abs(s.first[i]))
end

--- x where it is a number.
local function finite(x) return x == x and abs(x) < huge and x or nil end

--- The class by what the rows show; sums: summaries by column
function M.look(map, cell, sums, i, name)
  local s, K = sums[name], sums.K
  local kinetic = K and abs(K.first[i]) + K.early[i] or 0
  cell.kinetic = finite(K and max(abs(K.least[i]), K.largest[i]) or 0)
  -- rows in step with the motion may all show it at rest: it tells nothing then
  if cell.kinetic and not (cell.kinetic > AT_REST * abs(s.first[i])) then cell.kinetic = 0 end
  cell.error = finite(max(s.largest[i] - s.first[i], s.first[i] - s.least[i]))
  cell.slope, cell.slope_error = finite(s.slope[i]), finite(s.error[i])
  cell.sized = name == "_size" or nil -- there is no energy to tell by
  if sums.inside and not (sums.inside.least[i] > 0) then return "left" end
  if sums.constraint and not (sqrt(sums.constraint.largest[i]) < BROKEN) then
    return "constraint lost"
  end
  if name == "_y" and cell.code == "ok" and not finite(s.first[i] + s.late[i] + s.early[i]) then
    return "no value"
  end
  if cell.steps < FEWEST then return "bounded" end
  if is_growing(s, i, kinetic, name == "_size") and (name ~= "energy" or is_much(s, K, i)) then
    if s.early[i] > 0 then
      cell.growth = finite((s.late[i] / s.early[i]) ^ (1 / (0.75 * max(cell.steps, 1))))
    end
    return "blow-up"
  end
  if name == "_size" then return "bounded" end
  if is_drifting(map, s, i, kinetic, cell.steps * cell.h) then return "drifting" end
  if name == "energy" and (has_jumped(s, i, kinetic) and is_much(s, K, i)
    or left_at_once(s, i, K)) then
    return "off"
  end
  return "bounded"
end

-- of the change of K: an error below it is no drift before the motion has turned
local EARLY = 0.01

--- The motion has not turned yet: K goes one way, from the one end of what it takes to the other,
-- farther and farther, and by much more than the error of y; so early that says nothing.
function M.is_early(s, K, i)
  if not K or K.early[i] > 0.5 * K.late[i] then return false end
  if not (max(s.largest[i] - s.first[i], s.first[i] - s.least[i]) < EARLY * K.late[i]) then
    return false
  end
  return K.first[i] == K.least[i] and K.last[i] == K.largest[i] or K.first[i] == K.largest[i]
    and K.last[i] == K.least[i]
end

local FAR = 1e3  -- energy error over the kinetic energy of the same motion with a smaller step

--- A growth that ended early, where a nonlinear force holds it, shows beside a bounded cell of
-- smaller step: its energy error is far above the kinetic energy there, which grows with the
-- duration squared at most.
function M.compare(cell, smaller)
  local class = M.CLASSES[cell.class].name
  if M.CLASSES[cell.class].lost or class == "not run"
    or not (cell.error and smaller.kinetic and smaller.kinetic > 0) then
    return
  end
  local ratio = max(1, cell.steps * cell.h / (max(smaller.steps, 1) * smaller.h))
  if cell.error > FAR * smaller.kinetic * ratio ^ 2 then cell.class = NUMBER.off end
end

M.NUMBER, M.finite = NUMBER, finite

return M
