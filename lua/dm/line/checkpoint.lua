--- Where a run on a line ended, and solvers that go on from there with the bits of a run that never
-- stopped.
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local HEAD = "dmlua line 1"
local WHERE = "field:resume"
local fail = option.failing(WHERE)

local written = state_file.written

-- numbers of an ending (strip:run)
local ENDING = { "t", "before", "h", "energy", "target", "scale", "most" }

---- what must be the same ----

-- L at some numbers, and its params, as one number
local function fingerprint(field)
  local random, n, out = core.random(17), field.values, {}
  for row = 1, 4 do
    local function sample(which)
      local w = core.zeros(n)
      for k = 1, n do w[k] = 0.1 + 0.8 * random:uniform(row, 3 * k + which) end
      return n == 1 and w[1] or w
    end
    local u, ut, ux = sample(1), sample(2), sample(3)
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
  local fields, from = identity(run.field), ending.from
  local function add(key, value) fields[#fields + 1] = { key, value } end
  add("rule", run.rule)
  add("step", run.solver.h * 1.0)
  add("free", run.solver.free or "none")
  add("t0", run.t0 * 1.0)
  add("done", from.done)
  for _, key in ipairs(ENDING) do add("ending" .. key, from[key]) end
  local state = {}
  for _, part in ipairs { ending.u, ending.p, from.old[1], from.old[2], ending.frozen or {} } do
    for i = 1, #part do state[#state + 1] = part[i] end
  end
  return state_file.write(file, HEAD, fields, state, where)
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
  local fields = state_file.read(file, HEAD, "a run on a line", WHERE)
  for _, entry in ipairs(identity(field)) do
    if fields[entry[1]] ~= written(entry[2]) then
      fail("the field is not the one of the checkpoint: its %s was %s and is %s", entry[1],
        tostring(fields[entry[1]]), written(entry[2]))
    end
  end
  local moves = fields.free:find "x" ~= nil
  local n = field.nodes * (field.values + (moves and 1 or 0))
  if #fields.state ~= 4 * n + (moves and field.nodes or 0) then
    fail("%s: numbers of the state are missing", file)
  end
  local function part(k) return lists.part(fields.state, k * n, n) end
  local from = { done = math.tointeger(tonumber(fields.done)), old = core.matrix { part(2),
    part(3) } }
  for _, key in ipairs(ENDING) do from[key] = tonumber(fields["ending" .. key]) end
  return solver_of(field, { rule = fields.rule, h = tonumber(fields.step), free = fields.free },
    { u = part(0), p = part(1), from = from, t0 = tonumber(fields.t0),
      frozen = moves and lists.part(fields.state, 4 * n, field.nodes) or nil })
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
