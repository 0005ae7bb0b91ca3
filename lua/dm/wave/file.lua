--- Runs of waves whose rows go to a file as they come: NumPy records of the columns and of psi. The
-- path keeps the columns of all rows and psi of the last one.
local core = require "dm.core"
local npy = require "dm.data.npy"

local M = {}

local AT_ONCE = 2 ^ 18   -- numbers of rows between two looks at the file

-- rows i of a block as records, and their columns, the hidden ones too
local function take(block, i, names, seen)
  local row, columns, last = {}, {}, block[i]
  for c, name in ipairs(names) do row[name] = last[c] end
  for c = 1, #names + 2 do columns[c] = last[c] end
  row.re, row.im = core.wave_values(block, i)
  seen[#seen + 1] = columns
  return row
end

--- As stepper:run, with plan = { t0, first, steps, every, seconds, from = the time at which the run
-- goes on, or nil }, and names of the columns: rows without psi, done, code, CPU time, and a block
-- that ends with the last row.
function M.run(stepper, file, where, names, plan, N)
  local fields = {}
  for i, name in ipairs(names) do fields[i] = { name, 0 } end
  fields[#fields + 1], fields[#fields + 2] = { "re", N }, { "im", N }
  local whole = plan.every * math.max(1, AT_ONCE // (2 * N + #names))
  local seen, done, took, code, block = {}, 0, 0, "ok", nil
  npy.stream(file, fields, where, function(write)
    repeat
      local left = plan.seconds and math.max(plan.seconds - took, 1e-9)
      local rows, made, outcome, seconds = stepper:run(plan.t0, plan.first + done,
        math.min(whole, plan.steps - done), plan.every, left)
      for i = done == 0 and 1 or 2, #rows do write(take(rows, i, names, seen)) end
      done, took, code, block = done + made, took + seconds, outcome, rows
    until code ~= "ok" or done >= plan.steps
  end, plan.from)
  return core.matrix(seen), done, code, took, block
end

return M
