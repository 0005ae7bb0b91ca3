--- Where a run of a wave ended, as a file of its state (dm.data.state_file).
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local HEAD = "dmlua wave 1"
local WHERE = "wave:resume"
local fail = option.failing(WHERE)

-- what must be the same in the wave that goes on
local SAME = { "kind", "from", "to", "N", "hbar", "m", "g" }

local written = state_file.written

function M.write(path, file)
  local wave, ending, fields = path.wave, path.ending, {}
  local function add(key, value) fields[#fields + 1] = { key, value } end
  for _, key in ipairs(SAME) do add(key, wave[key]) end
  add("V", state_file.fingerprint(wave.V))
  add("rule", path.rule)
  add("h", path.h)
  add("norm", path.solver.norm and 1 or 0)
  if path.solver.wisdom then add("wisdom", path.solver.wisdom) end
  add("t0", ending.t0)
  add("step", ending.step)
  return state_file.write(file, HEAD, fields, ending.state, "path:checkpoint")
end

---- reading ----

local function check_same(wave, fields)
  for _, key in ipairs(SAME) do
    if fields[key] ~= written(wave[key]) then
      fail("the wave is not the one of the checkpoint: its %s was %s and is %s", key,
        fields[key], written(wave[key]))
    end
  end
  if fields.V ~= state_file.fingerprint(wave.V) then
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
  local fields = state_file.read(from, HEAD, "a wave", WHERE)
  check_same(wave, fields)
  return solver_of(wave, { rule = fields.rule, h = tonumber(fields.h),
    norm = fields.norm == "1" or nil, wisdom = fields.wisdom,
    state = fields.state, t0 = tonumber(fields.t0),
    step = math.tointeger(tonumber(fields.step)) })
end

return M
