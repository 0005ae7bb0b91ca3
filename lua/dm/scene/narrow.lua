--- What is short beside the steps of a rule, as a pulse of the force that long steps may leave
-- out. Rows between two steps are made by a step of a length of its own, and at some times one of
-- its stages meets the pulse and takes it for the whole step: an error that lasts as short as the
-- pulse, and which times that are chosen without knowing of it do not show. Where the pulses are
-- tell the steps of the reference, which are as short as what they resolve.
local forces = require "dm.reference.forces"

local M = {}

local min, max, ceil, huge = math.min, math.max, math.ceil, math.huge

local UNEVEN = 8     -- times that steps of the reference inside of a step may differ
local FINER = 0.25   -- of the shortest one: what times must be apart to show what it resolves
local MOST = 8000    -- times more than those of the check
local LONGEST = 2 ^ 15

--- Can anything narrow be in the forces of a model?
function M.present(model)
  if model.hides == nil then model.hides = forces.of(model:ready().system) ~= nil end
  return model.hides
end

-- the shortest and the longest step of the reference that has a part in [a, b], from number k on,
-- the time at which the shortest begins, and the number of the last
local function within(steps, k, a, b)
  local least, most, at = huge, 0, a
  while k < #steps and steps[k + 1] <= a do k = k + 1 end
  while k < #steps and steps[k] < b do
    local h = steps[k + 1] - steps[k]
    if h < least then least, at = h, steps[k] end
    most, k = max(most, h), k + 1
  end
  return least, most, at, max(1, k - 1)
end

-- times in [a, b] after `from` that are missing so that no two are further apart than `apart`
local function fill(out, known, k, a, b, from, apart)
  while k < #known and known[k] <= a do k = k + 1 end
  local last = max(a, from)
  while last < b do
    while k <= #known and known[k] <= last do k = k + 1 end
    local next = min(b, known[k] or b)
    local parts = ceil((next - last) / apart)
    if #out + parts > MOST then return nil end
    for j = 1, parts - 1 do out[#out + 1] = last + (next - last) * j / parts end
    last = next
  end
  return k
end

--- Times, beside those that are known, at which a rule must be looked at whose steps end at
-- ends(0), ends(1) ... ends(N): growing, none where no step has anything short in it. nil: more
-- than can be looked at.
function M.times(steps, known, ends, N)
  local out, k, at = {}, 1, 1
  for i = 1, N do
    local a, b = ends(i - 1), ends(i)
    local least, most, from, last = within(steps, k, a, b)
    k = last
    if most > UNEVEN * least then
      at = fill(out, known, at, a, b, from, FINER * least)
      if not at then return nil end
    end
  end
  return out
end

--- The ends of N steps of one length.
function M.even(problem, N)
  return function(i) return problem.t0 + problem.T * i / N end
end

--- Can N even steps be looked at? More than it is worth to look for, as where a force jumps, are
-- left to the check.
function M.can_look(problem, steps, known, N)
  return N > LONGEST or M.times(steps, known, M.even(problem, N), N) ~= nil
end

return M
