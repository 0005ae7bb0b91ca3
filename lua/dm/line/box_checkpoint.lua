--- Where a run of boxes ended, and solvers that go on from there with the bits of a run that never
-- stopped.
local core = require "dm.core"
local endings = require "dm.line.ending"
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local KIND = { head = "dmlua boxes 1", what = "a run of boxes" }
local WHERE = "boxes:resume"
local fail = option.failing(WHERE)

-- M, K and S, which is looked at at some numbers, as one number each
local function of_matrix(A)
  local out = {}
  for i = 1, #A do for j = 1, #A do out[#out + 1] = A[i][j] end end
  return state_file.fingerprint(out)
end

local function of_S(boxes)
  local random, out = core.random(17), {}
  for row = 1, 4 do
    local z = core.zeros(boxes.d)
    for c = 1, boxes.d do z[c] = 0.1 + 0.8 * random:uniform(row, c) end
    local fine, value = pcall(boxes.S, z)
    out[row] = fine and type(value) == "number" and value or 0 / 0
  end
  return state_file.fingerprint(out)
end

-- a list of { key, value }
local function identity(boxes)
  local gain = {}
  for c, name in ipairs(boxes.names) do if boxes.gain[c] then gain[#gain + 1] = name end end
  return { { "from", boxes.from * 1.0 }, { "to", boxes.to * 1.0 }, { "cells", boxes.cells },
    { "names", table.concat(boxes.names, ",") }, { "gain", table.concat(gain, ",") .. "." },
    { "M", of_matrix(boxes.M) }, { "K", of_matrix(boxes.K) }, { "S", of_S(boxes) } }
end

--- run:checkpoint(file)
function M.write(run, file)
  local where, ending = "run:checkpoint", run.ending
  if not ending then option.fail(where, "a run of at least one step is needed") end
  local slopes = core.zeros(run.boxes.d)
  for c, slope in pairs(ending.slope) do slopes[c] = slope end
  return endings.write(file, KIND, identity(run.boxes), { { "step", run.h * 1.0 } }, ending, slopes,
    where)
end

-- a solver whose run goes on from an ending { u, from, slope, t0 }
local function solver_of(boxes, h, ending)
  local solver = boxes:solver { h = h }
  solver.ending = ending
  return solver
end

local function read(boxes, file)
  local fields = endings.read(file, KIND, identity(boxes), "the system is not the one", WHERE)
  local ending, slopes = endings.of(file, fields, boxes.cells * boxes.d, false, boxes.d, WHERE)
  ending.slope = {}
  for c in pairs(boxes.gain) do ending.slope[c] = slopes[c] end
  return solver_of(boxes, tonumber(fields.step), ending)
end

--- boxes:resume(file | run)
function M.resume(boxes, from)
  if option.got(from) == "dm.box_run" then
    if not rawequal(from.boxes, boxes) then fail "the run is one of other boxes" end
    if not from.ending then fail "a run of at least one step is needed" end
    return solver_of(boxes, from.h, from.ending)
  end
  if type(from) ~= "string" then
    fail("a run or the name of a file is needed (got %s)", option.got(from))
  end
  return read(boxes, from)
end

return M
