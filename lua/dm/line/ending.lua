--- Where a run on a line ended, as a file of its state (dm.data.state_file): what fields and boxes
-- have in common. From an ending { u, p, from, t0, ... } a run goes on with the bits of one that
-- never stopped; from is what strip:run tells: numbers, and the two levels before in from.old.
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local written = state_file.written

-- numbers of an ending (strip:run)
local NUMBERS = { "t", "before", "h", "energy", "target", "scale", "most" }

--- Writes an ending. kind: { head = first line, what = "a run of ..." }; same, own: lists of
-- { key, value }, of what must be the same in what goes on, and of the run; more: numbers behind
-- the levels, or nil.
function M.write(file, kind, same, own, ending, more, where)
  local fields, from, state = {}, ending.from, {}
  for _, list in ipairs { same, own, { { "t0", ending.t0 * 1.0 }, { "done", from.done } } } do
    table.move(list, 1, #list, #fields + 1, fields)
  end
  for _, key in ipairs(NUMBERS) do fields[#fields + 1] = { "ending" .. key, from[key] } end
  for _, part in ipairs { ending.u, ending.p or {}, from.old[1], from.old[2], more or {} } do
    for i = 1, #part do state[#state + 1] = part[i] end
  end
  return state_file.write(file, kind.head, fields, state, where)
end

--- The fields of a file as texts, once those of `same` are what they were; what: the beginning of
-- the sentence that tells where they are not.
function M.read(file, kind, same, what, where)
  local fields = state_file.read(file, kind.head, kind.what, where)
  for _, entry in ipairs(same) do
    if fields[entry[1]] ~= written(entry[2]) then
      option.fail(where, "%s of the checkpoint: its %s was %s and is %s", what, entry[1],
        tostring(fields[entry[1]]), written(entry[2]))
    end
  end
  return fields
end

--- The ending in such fields, levels of n numbers, momenta among them or not, and `more` numbers
-- behind them, as a vector.
function M.of(file, fields, n, has_momenta, more, where)
  local levels, at = has_momenta and 4 or 3, 0
  if #fields.state ~= levels * n + more then
    option.fail(where, "%s: numbers of the state are missing", file)
  end
  local function part(count)
    at = at + count
    return lists.part(fields.state, at - count, count)
  end
  local ending = { t0 = tonumber(fields.t0), u = part(n), p = has_momenta and part(n) or nil,
    from = { done = math.tointeger(tonumber(fields.done)) } }
  ending.from.old = core.matrix { part(n), part(n) }
  for _, key in ipairs(NUMBERS) do ending.from[key] = tonumber(fields["ending" .. key]) end
  return ending, more > 0 and part(more) or nil
end

--- Raises where options of a run tell a start although it goes on from another one.
function M.check_options(options, keys)
  for _, key in ipairs(keys) do
    if options[key] ~= nil then
      option.fail("solver:run", "option '%s': this solver goes on from a run, which has its own "
        .. "levels and time", key)
    end
  end
end

return M
