--- Where a run of a flow ended, as a kind of dm.data.checkpoint.
local state_file = require "dm.data.state_file"

local fingerprint = state_file.fingerprint

-- corners of all triangles, one after the other
local function corners(K)
  local out = {}
  for _, cell in ipairs(K:simplices(2)) do table.move(cell, 1, 3, #out + 1, out) end
  return out
end

return {
  head = "dmlua flow 1", what = "a run of a flow", where = "euler:resume", name = "the flow",
  run = "dm.flow", of = "euler",

  same = function(euler)
    local K, system = euler.mesh, euler.system
    local same = { { "vertices", K:count(0) }, { "triangles", fingerprint(corners(K)) },
      { "lengths", fingerprint(K:volume(1)) }, { "weights", fingerprint(K:dual_volume(0)) },
      { "faces", fingerprint(system.sign) } }
    if system.handles.count > 0 then
      same[#same + 1] = { "handles", fingerprint(system.handles.on_triangles) }
    end
    return same
  end,

  ending = function(run)
    local e = run.ending
    return { { "rule", run.rule }, { "h", run.h }, { "t0", e.t0 * 1.0 }, { "step", e.step } },
      { e.w, e.low, e.circulations, e.around }
  end,

  sizes = function(euler)
    local n, system = euler.mesh:count(0), euler.system
    return { n, n + system.handles.count, system.holes.count, system.handles.count }
  end,

  solver = function(euler, read, vectors)
    local solver = euler:solver { rule = read:text "rule", h = read:positive "h" }
    solver.ending = { w = vectors[1], low = vectors[2],
      circulations = vectors[3], around = vectors[4], t0 = read:number "t0",
      step = read:count "step" }
    return solver
  end,
}
