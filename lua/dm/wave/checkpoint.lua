--- Where a run of a wave ended, as a kind of dm.data.checkpoint.
local state_file = require "dm.data.state_file"

-- what must be the same in the wave that goes on
local SAME = { "kind", "from", "to", "N", "hbar", "m", "g" }

return {
  head = "dmlua wave 1", what = "a wave", where = "wave:resume", name = "the wave",
  run = "dm.wave_path", of = "wave",

  same = function(wave)
    local out = {}
    for i, key in ipairs(SAME) do out[i] = { key, wave[key] } end
    out[#out + 1] = { "V", state_file.fingerprint(wave.V) }
    return out
  end,

  ending = function(path)
    local ending, solver = path.ending, path.solver
    local own = { { "rule", path.rule }, { "h", path.h }, { "norm", solver.norm and 1 or 0 } }
    if solver.wisdom then own[#own + 1] = { "wisdom", solver.wisdom } end
    own[#own + 1], own[#own + 2] = { "t0", ending.t0 }, { "step", ending.step }
    return own, { ending.state }
  end,

  sizes = function(_, read) return { #read.fields.state } end,

  solver = function(wave, read, vectors)
    local rule, wisdom = read:text "rule", read.fields.wisdom
    local solver = wave:solver { rule = rule, h = read:positive "h",
      norm = read:text "norm" == "1" or nil, unstable = rule == "two-step" or nil,
      wisdom = wisdom, plan = wisdom and "measure" or nil }
    solver.from = { state = vectors[1], t0 = read:number "t0", step = read:count "step" }
    return solver
  end,
}
