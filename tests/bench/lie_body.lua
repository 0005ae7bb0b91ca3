-- dmlua tests/bench/lie_body.lua: lie(1) on a free body and on a heavy top, ns a step, best of thirty runs; the same by hand in C stands in
-- c/by_hand/lie_body.c.
local dm = require "dm"
local G = dm.SO(3)
local free = dm.system { Q = G, L = function(_, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end }
local top = dm.system { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end }

local function race(name, system, rule, start)
  local solver, least, path = system:solver { rule = rule, h = 0.05 }, math.huge, nil
  start.steps, start.every = 20000, 20000
  for _ = 1, 30 do
    path = solver:run(start)
    least = math.min(least, path.ns_per_step)
  end
  local p = path.p[#path.p]
  print(("%s, %s: %.0f ns a step, %.2f iterations; ends at %.15f %.15f %.15f"):format(name, rule, least,
    solver:report().newton_per_step, p[1], p[2], p[3]))
end

for _, rule in ipairs { "lie(1)", "lie(1, gauss(1), cayley)" } do
  race("free body", free, rule, { q = G:identity(), p = { 0.3, 1, 3 } })
  race("heavy top", top, rule, { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } })
end
