--- Does a rule, or a solver, have a time of its own: is what a step covers of it known only when
-- it is taken? Runs of it end at given times (at=), not after so many steps, and what lies beside a
-- run, such as a tangent vector, has other times than the run. Of a rule by dm.step only its solver
-- knows.
local core = require "dm.core"

local names

local function by_name(rule)
  if not names then
    names = {}
    for _, row in ipairs(core.rules()) do names[row.name] = row.own_time end
  end
  return names[tostring(rule):match "^%s*([%w-]*)"] or false
end

return function(x)
  local meta = debug.getmetatable(x)
  if meta and meta.__name == "dm.solver" then return x.own_time end
  return by_name(x)
end
