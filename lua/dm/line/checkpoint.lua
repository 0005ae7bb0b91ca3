--- Where runs on lines ended, of fields and of boxes, as kinds of dm.data.checkpoint. An ending is
-- { u, p, from, t0, ... }; from is what strip:run tells: numbers, and the two levels before in
-- from.old.
local core = require "dm.core"
local sample = require "dm.line.sample"
local state_file = require "dm.data.state_file"

local M = {}

local fingerprint = state_file.fingerprint

---- endings of strips ----

local NUMBERS = { "t", "before", "h", "energy", "target", "scale", "most" }

-- the lines of an ending behind those of its run, and its vectors: levels, then `more`
local function written(own, ending, more)
  local from = ending.from
  own[#own + 1], own[#own + 2] = { "t0", ending.t0 * 1.0 }, { "done", from.done }
  for _, key in ipairs(NUMBERS) do own[#own + 1] = { "ending" .. key, from[key] } end
  return own, { ending.u, ending.p or {}, from.old[1], from.old[2], more }
end

-- that ending; the vector behind the levels is left to the caller
local function ending_of(read, vectors)
  local from = { done = read:count "done", old = core.matrix { vectors[3], vectors[4] } }
  for _, key in ipairs(NUMBERS) do from[key] = read:number("ending" .. key) end
  return { t0 = read:number "t0", u = vectors[1],
    p = #vectors[2] > 0 and vectors[2] or nil, from = from }
end

---- fields ----

local function sides(given)
  return ("%s, %s"):format(state_file.written(given.left or false),
    state_file.written(given.right or false))
end

-- numbers of a level
local function level_of(field, moves) return field.nodes * (field.values + (moves and 1 or 0)) end

-- "t", "x", "tx" as an option
local function free_of(text)
  local free = {}
  for name in text:gmatch "[tx]" do free[#free + 1] = text ~= "none" and name or nil end
  return #free > 0 and free or nil
end

M.field = {
  head = "dmlua line 2", what = "a run on a line", where = "field:resume", name = "the field",
  run = "dm.line_run", of = "field",

  same = function(field, run)
    return { { "from", field.from * 1.0 }, { "to", field.to * 1.0 }, { "cells", field.cells },
      { "periodic", field.periodic }, { "values", field.values }, { "fixed", sides(field.fixed) },
      { "absorbing", sides(field.absorbing) },
      { "L", run and run.level.law or sample.of_L(field) } }
  end,

  ending = function(run)
    if not run.ending then return nil, "a run of at least one slab is needed" end
    local own = { { "rule", run.rule }, { "step", run.solver.h * 1.0 },
      { "free", run.solver.free or "none" } }
    return written(own, run.ending, run.ending.frozen or {})
  end,

  sizes = function(field, read)
    local moves = read:text "free":find "x" ~= nil
    local n = level_of(field, moves)
    return { n, n, n, n, moves and field.nodes or 0 }
  end,

  solver = function(field, read, vectors)
    local solver = field:solver { rule = read:text "rule", h = read:positive "step",
      free = free_of(read:text "free") }
    solver.ending = ending_of(read, vectors)
    solver.ending.frozen = #vectors[5] > 0 and vectors[5] or nil
    return solver
  end,
}

---- boxes ----

-- a matrix as one number
local function of_matrix(A)
  local out = {}
  for i = 1, #A do for j = 1, #A do out[#out + 1] = A[i][j] end end
  return fingerprint(out)
end

M.boxes = {
  head = "dmlua boxes 2", what = "a run of boxes", where = "boxes:resume", name = "the boxes",
  run = "dm.box_run", of = "boxes",

  same = function(boxes, run)
    local gain = {}
    for c, name in ipairs(boxes.names) do if boxes.gain[c] then gain[#gain + 1] = name end end
    return { { "from", boxes.from * 1.0 }, { "to", boxes.to * 1.0 }, { "cells", boxes.cells },
      { "names", table.concat(boxes.names, ",") }, { "gain", table.concat(gain, ",") .. "." },
      { "M", of_matrix(boxes.M) }, { "K", of_matrix(boxes.K) },
      { "S", run and run.level.law or sample.of_S(boxes) } }
  end,

  ending = function(run)
    if not run.ending then return nil, "a run of at least one step is needed" end
    local slopes = core.zeros(run.boxes.d)
    for c, slope in pairs(run.ending.slope) do slopes[c] = slope end
    return written({ { "step", run.h * 1.0 } }, run.ending, slopes)
  end,

  sizes = function(boxes)
    local n = boxes.cells * boxes.d
    return { n, 0, n, n, boxes.d }
  end,

  solver = function(boxes, read, vectors)
    local solver = boxes:solver { h = read:positive "step" }
    solver.ending = ending_of(read, vectors)
    solver.ending.slope = {}
    for c in pairs(boxes.gain) do solver.ending.slope[c] = vectors[5][c] end
    return solver
  end,
}

return M
