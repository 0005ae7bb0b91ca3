--- Where runs ended that Lua keeps, in memory or as a file of their state (dm.data.state_file), and
-- solvers that go on from there with the bits of a run that never stopped. Each kind of run is told
-- by a table:
--   head, what         first line of its files; "a run on a line"
--   where, name        "field:resume"; "the field": who goes on, in messages
--   run, of            class of its runs, and their field that holds what they are runs of
--   same(model, run)   list of { key, value }: what must be the same where a run goes on; of what
--                      the run was made with, or without a run of what the model is now
--   ending(run)        list of { key, value }, list of vectors; nil, why: nothing goes on from it
--   sizes(model, read) lengths of these vectors
--   solver(model, read, vectors, options) -> a solver; read: the values, dm.data.checkpoint.Read
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local written = state_file.written

---- what was written, which nobody believes ----

local Read = {}
Read.__index = Read

local function bad(read, key, what)
  option.fail(read.where, "%s: '%s' must be %s (it is %s)", read.from, key, what,
    tostring(read.fields[key]))
end

--- The text of a line.
function Read:text(key)
  return self.fields[key] or bad(self, key, "there")
end

--- A finite number.
function Read:number(key)
  local x = tonumber(self.fields[key])
  return x and x - x == 0 and x + 0.0 or bad(self, key, "a finite number")
end

--- A finite number > 0.
function Read:positive(key)
  local x = self:number(key)
  return x > 0 and x or bad(self, key, "a number > 0")
end

--- A whole number from 0 to 2^53.
function Read:count(key)
  local x = math.tointeger(tonumber(self.fields[key]))
  return x and x >= 0 and x <= 1 << 53 and x or bad(self, key, "a whole number >= 0")
end

---- writing ----

-- lines as texts by key, a list of them in their order, vectors; raises where there is no end
local function end_of(kind, run, where)
  local own, vectors = kind.ending(run)
  if not own then option.fail(where, "%s", vectors) end
  local fields, list = {}, {}
  for _, some in ipairs { kind.same(run[kind.of], run), own } do
    for _, entry in ipairs(some) do
      list[#list + 1], fields[entry[1]] = entry, written(entry[2])
    end
  end
  return fields, list, vectors
end

--- Writes the end of a run.
function M.write(kind, run, file)
  local where = "run:checkpoint"
  local _, list, vectors = end_of(kind, run, where)
  local state = {}
  for _, part in ipairs(vectors) do
    for i = 1, #part do state[#state + 1] = part[i] end
  end
  return state_file.write(file, kind.head, list, state, where)
end

---- going on ----

-- Raises where the model is not the one of the lines.
local function check_same(kind, model, fields)
  for _, entry in ipairs(kind.same(model)) do
    if fields[entry[1]] ~= written(entry[2]) then
      option.fail(kind.where, "not %s of the checkpoint: its %s was %s and is %s",
        kind.name, entry[1], tostring(fields[entry[1]]), written(entry[2]))
    end
  end
end

-- the state of a file as vectors of these lengths
local function parts(read, state, sizes)
  local out, at = {}, 0
  for k, size in ipairs(sizes) do
    out[k] = at + size <= #state and lists.part(state, at, size) or nil
    at = at + size
  end
  if at ~= #state then
    option.fail(read.where, "%s: numbers of the state are missing, or too many: %d in place of %d",
      read.from, #state, at)
  end
  return out
end

local function from_file(kind, model, file, options)
  local fields = state_file.read(file, kind.head, kind.what, kind.where)
  check_same(kind, model, fields)
  local read = setmetatable({ fields = fields, from = file, where = kind.where }, Read)
  local solver = kind.solver(model, read, parts(read, fields.state, kind.sizes(model, read)),
    options)
  return solver, fields
end

local function from_run(kind, model, run, options)
  if not rawequal(run[kind.of], model) then
    option.fail(kind.where, "the run is not one of %s", kind.name)
  end
  local fields, _, vectors = end_of(kind, run, kind.where)
  check_same(kind, model, fields)
  local copies = {}
  for k, part in ipairs(vectors) do copies[k] = core.vector(part) end
  local read = setmetatable({ fields = fields, from = "the run", where = kind.where }, Read)
  return kind.solver(model, read, copies, options), fields
end

local made = setmetatable({}, { __mode = "k" }) -- by solver: lines of what it goes on from

--- The solver that goes on from a run or a file.
function M.resume(kind, model, from, options)
  local is_run = option.got(from) == kind.run
  if not is_run and type(from) ~= "string" then
    option.fail(kind.where, "a run or the name of a file is needed (got %s)", option.got(from))
  end
  local solver, fields = (is_run and from_run or from_file)(kind, model, from, options)
  made[solver] = {}
  for _, entry in ipairs(kind.same(model)) do made[solver][entry[1]] = fields[entry[1]] end
  return solver
end

--- Raises where the model is another one by now than that of the run that a solver goes on from.
function M.check_still(kind, model, solver)
  if made[solver] then check_same(kind, model, made[solver]) end
end

--- Raises where options of a run tell a start although it goes on from another one.
function M.check_options(options, keys)
  for _, key in ipairs(keys) do
    if options[key] ~= nil then
      option.fail("solver:run", "option '%s': this solver goes on from a run, which has its own "
        .. "state and time", key)
    end
  end
end

return M
