--- Where a run on a line ended, and solvers that go on from there with the bits of a run that never
-- stopped.
local core = require "dm.core"
local endings = require "dm.line.ending"
local option = require "dm.base.options"
local sample = require "dm.line.sample"
local state_file = require "dm.data.state_file"

local M = {}

local KIND = { head = "dmlua line 1", what = "a run on a line" }
local WHERE = "field:resume"
local fail = option.failing(WHERE)

local written = state_file.written

---- what must be the same ----

-- L at some numbers, and its params, as one number
local function fingerprint(field)
  local random, n, out = core.random(17), field.values, {}
  for row = 1, 4 do
    local u, ut, ux = sample.of(random, row, n)
    local x = field.from + (field.to - field.from) * random:uniform(row, 0)
    local fine, value = pcall(field.L, u, ut, ux, x, 0.3 * row)
    out[row] = fine and type(value) == "number" and value or 0 / 0
  end
  return state_file.fingerprint(out)
end

local function sides(given)
  return ("%s, %s"):format(written(given.left or false), written(given.right or false))
end

-- a list of { key, value }
local function identity(field)
  return { { "from", field.from * 1.0 }, { "to", field.to * 1.0 }, { "cells", field.cells },
    { "periodic", field.periodic }, { "values", field.values }, { "fixed", sides(field.fixed) },
    { "absorbing", sides(field.absorbing) }, { "L", fingerprint(field) } }
end

---- writing ----

--- run:checkpoint(file)
function M.write(run, file)
  local where, ending = "run:checkpoint", run.ending
  if not ending then option.fail(where, "a run of at least one slab is needed") end
  local own = { { "rule", run.rule }, { "step", run.solver.h * 1.0 },
    { "free", run.solver.free or "none" } }
  return endings.write(file, KIND, identity(run.field), own, ending, ending.frozen, where)
end

---- reading ----

-- a solver whose run goes on from an ending { u, p, from, frozen, t0 }
local function solver_of(field, given, ending)
  local free
  for _, name in ipairs { "t", "x" } do
    if given.free:find(name, 1, true) and given.free ~= "none" then
      free = free or {}
      free[#free + 1] = name
    end
  end
  local solver = field:solver { rule = given.rule, h = given.h, free = free }
  solver.ending = ending
  return solver
end

local function read(field, file)
  local fields = endings.read(file, KIND, identity(field), "the field is not the one", WHERE)
  local moves = fields.free:find "x" ~= nil
  local n = field.nodes * (field.values + (moves and 1 or 0))
  local ending, frozen = endings.of(file, fields, n, true, moves and field.nodes or 0, WHERE)
  ending.frozen = frozen
  return solver_of(field, { rule = fields.rule, h = tonumber(fields.step), free = fields.free },
    ending)
end

--- field:resume(file | run)
function M.resume(field, from)
  if option.got(from) == "dm.line_run" then
    if not rawequal(from.field, field) then fail "the run is one of another field" end
    if not from.ending then fail "a run of at least one slab is needed" end
    return solver_of(field, { rule = from.rule, h = from.solver.h, free = from.solver.free
      or "none" }, from.ending)
  end
  if type(from) ~= "string" then
    fail("a run or the name of a file is needed (got %s)", option.got(from))
  end
  return read(field, from)
end

return M
