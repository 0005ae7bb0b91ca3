--- Which rows of a run a chart looks at.
local M = {}

local min, max, ceil = math.min, math.max, math.ceil

local SAMPLES = 32
-- numbers that the rows of a run may have, where what changes along it is looked at after each step
local MOST = 2 ^ 22

-- dense: rows from which the motion between them can be told, as often as the finest step
local DENSE = 4096

--- Times of the samples.
function M.times(options, dense, by_steps)
  local count, t0, out = options.samples or by_steps and DENSE or SAMPLES, options.t0 or 0, {}
  local finest = min(table.unpack(options.h))
  if dense then count = min(DENSE, max(256, ceil(options.t / finest))) end
  if not dense then out[1] = t0 end -- changes are from the start
  for i = 1, count do out[#out + 1] = t0 + options.t * i / count end
  return out
end

--- The rows of a run, as options of solver:run: at the times of the reference, where there is one,
-- or at those asked for; else after each step, or as many as there is room for, since at few times
-- some rules show too little.
function M.of(chart, own, steps)
  local every = chart.dense and max(1, steps // DENSE)
    or chart.by_steps and ceil(steps * (2 * chart.system.Q.dimension + 2) / MOST)
  local gaps = chart.watch and true
  if own or not every then return { at = chart.times, watch = chart.watch, gaps = gaps } end
  return { steps = steps, every = every, watch = chart.watch, gaps = gaps }
end

return M
