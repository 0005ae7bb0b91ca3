--- The levels of a run, recorded in memory or, as they come, in a file of rows. Fields and boxes
-- have a writer of their own: fields = names and widths of the rows, write(outcome, first, write) =
-- the rows of an outcome from row `first` on.
local core = require "dm.core"
local grids = require "dm.line.grid"
local moving = require "dm.line.moving"
local npy = require "dm.data.npy"

local M = {}

local AT_ONCE = 1 << 20 -- numbers of u between two pieces of a file

-- slabs from `at` = { u, p, guess, from }; a run of none takes one, to know the energy
local function go(solver, level, plan, at, steps)
  return level.strip:run { u = at.u, p = at.p, guess = at.guess, from = at.from, t0 = plan.t0,
    h = solver.h, steps = math.max(steps, 1), every = plan.every, free = solver.stretches }
end

-- two rows of a matrix as one
local function both(first, last)
  local out = core.zeros(2, #first)
  for k = 1, #first do out[1][k], out[2][k] = first[k], last[k] end
  return out
end

local function fields_of(solver)
  local field = solver.field
  local n = field.nodes * field.values
  local out = { { "t", 0 }, { "energy", 0 }, { "u", n }, { "p", n } }
  if solver.moves then out[5] = { "x", field.nodes } end
  return out
end

local function write_rows(solver, o, first, write)
  local field, u, p, y = solver.field, o.u, o.p, nil
  if solver.moves then
    u, y = moving.apart(o.u, field.nodes, field.values)
    p = moving.apart(o.p, field.nodes, field.values)
  end
  for i = first, #o.t do
    local row = { t = o.t[i], energy = o.energy[i], u = u[i], p = p[i] }
    if y then
      row.x = core.zeros(field.nodes)
      for k = 1, field.nodes do row.x[k] = grids.x(field.grid, k) + y[i][k] end
    end
    write(row)
  end
end

--- The writer of a field on a line.
function M.of_field(solver)
  return { fields = fields_of(solver), write = function(o, first, write)
    write_rows(solver, o, first, write)
  end }
end

-- pieces of the run one after the other, each from where the last one ended
local function pieces(solver, level, plan, writer, write)
  local most = math.max(1, AT_ONCE // #level.u) * plan.every
  local at, done, first, o = level, 0, nil, nil
  repeat
    local steps = math.min(most, plan.steps - done)
    o = go(solver, level, plan, at, steps)
    writer.write(plan.steps == 0 and { t = { o.t[1] }, u = o.u, p = o.p, energy = o.energy }
      or o, first and 2 or 1, write)
    first = first or o
    done = done + o.done
    at = { u = o.u[#o.u], p = o.p and o.p[#o.p], from = o.ending }
  until o.code ~= "ok" or done >= plan.steps
  return first, o, done
end

--- What core.strip's run tells of all slabs; with plan.file the rows are there, and the first and
-- the last one here.
function M.go(solver, level, plan, writer)
  if not plan.file then return go(solver, level, plan, level, plan.steps) end
  local out
  npy.stream(plan.file, writer.fields, "solver:run", function(write)
    local first, last, done = pieces(solver, level, plan, writer, write)
    out = last
    out.done = done
    for _, key in ipairs { "u", "p" } do
      out[key] = first[key] and both(first[key][1], last[key][#last.t])
    end
    out.energy = first.energy and core.vector { first.energy[1], last.energy[#last.energy] }
    out.t = core.vector { first.t[1], last.t[#last.t] }
  end, level.from and level.from.t)
  return out
end

return M
