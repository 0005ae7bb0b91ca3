--- Where a run of a wave ended, as a text of `key value` lines: all numbers with their bits, the
-- state one number a line, and at the end a checksum of the lines before.
local core = require "dm.core"
local option = require "dm.base.options"
local text_file = require "dm.base.text_file"

local M = {}

local HEAD = "dmlua wave 1"
local WHERE = "wave:resume"
local fail = option.failing(WHERE)

-- what must be the same in the wave that goes on
local SAME = { "kind", "from", "to", "N", "hbar", "m", "g" }

-- Fowler, Noll and Vo, 64 bits
local function checksum(text)
  local sum = 0xcbf29ce484222325 | 0
  for i = 1, #text do sum = (sum ~ text:byte(i)) * 0x100000001b3 end
  return ("%016x"):format(sum)
end

-- numbers with all bits, texts as they are
local function written(x)
  if math.type(x) == "float" then return ("%a"):format(x) end
  return tostring(x)
end

-- V as one number: of its bits
local function fingerprint(V)
  local parts = {}
  for j = 1, #V do parts[j] = ("%a"):format(V[j]) end
  return checksum(table.concat(parts, " "))
end

function M.write(path, file)
  local wave, ending, lines = path.wave, path.ending, { HEAD }
  local function add(key, value) lines[#lines + 1] = key .. " " .. written(value) end
  for _, key in ipairs(SAME) do add(key, wave[key]) end
  add("V", fingerprint(wave.V))
  add("rule", path.rule)
  add("h", path.h)
  add("norm", path.solver.norm and 1 or 0)
  if path.solver.wisdom then add("wisdom", path.solver.wisdom) end
  add("t0", ending.t0)
  add("step", ending.step)
  add("state", #ending.state)
  for i = 1, #ending.state do lines[#lines + 1] = ("%a"):format(ending.state[i]) end
  local text = table.concat(lines, "\n") .. "\n"
  if type(file) ~= "string" then
    option.fail("path:checkpoint", "a file name is needed (got %s)", option.got(file))
  end
  local made, why = core.new_file(file)
  if not made then option.fail("path:checkpoint", "cannot write %s: %s", file, why) end
  text_file.write(made, text .. "end " .. checksum(text) .. "\n", "path:checkpoint")
  local fine
  fine, why = core.end_file(made, file)
  if not fine then option.fail("path:checkpoint", "cannot write %s: %s", file, why) end
  return file
end

---- reading ----

-- the fields of a file, its state among them
local function read(file)
  local handle, why = io.open(file, "r")
  if not handle then fail("cannot open %s", why) end
  local text = handle:read "a" or ""
  handle:close()
  local body, sum = text:match "^(.*\n)end (%x+)\n$"
  if not body or text:sub(1, #HEAD + 1) ~= HEAD .. "\n" then
    fail("%s is no checkpoint of a wave", file)
  end
  if checksum(body) ~= sum then
    fail("%s: its lines do not have the checksum that it ends with: it was changed", file)
  end
  local fields, state = {}, {}
  for line in body:gmatch "[^\n]+" do
    local key, value = line:match "^(%a[%w]*) (.*)$"
    if key then fields[key] = value else state[#state + 1] = tonumber(line) end
  end
  if #state ~= tonumber(fields.state) then fail("%s: numbers of the state are missing", file) end
  fields.state = core.vector(state)
  return fields
end

local function check_same(wave, fields)
  for _, key in ipairs(SAME) do
    if fields[key] ~= written(wave[key]) then
      fail("the wave is not the one of the checkpoint: its %s was %s and is %s", key,
        fields[key], written(wave[key]))
    end
  end
  if fields.V ~= fingerprint(wave.V) then
    fail "the wave is not the one of the checkpoint: V is another one"
  end
end

local function solver_of(wave, from)
  local solver = wave:solver { rule = from.rule, h = from.h, norm = from.norm,
    unstable = from.rule == "two-step" or nil, wisdom = from.wisdom,
    plan = from.wisdom and "measure" or nil }
  solver.from = { state = from.state, t0 = from.t0, step = from.step }
  return solver
end

--- The solver that goes on from a path or a file.
function M.resume(wave, from)
  if option.got(from) == "dm.wave_path" then
    if not rawequal(from.wave, wave) then fail "the path is one of another wave" end
    return solver_of(wave, { rule = from.rule, h = from.h, norm = from.solver.norm,
      wisdom = from.solver.wisdom, state = from.ending.state, t0 = from.ending.t0,
      step = from.ending.step })
  end
  if type(from) ~= "string" then
    fail("a path or the name of a file is needed (got %s)", option.got(from))
  end
  local fields = read(from)
  check_same(wave, fields)
  return solver_of(wave, { rule = fields.rule, h = tonumber(fields.h),
    norm = fields.norm == "1" or nil, wisdom = fields.wisdom,
    state = fields.state, t0 = tonumber(fields.t0),
    step = math.tointeger(tonumber(fields.step)) })
end

return M
