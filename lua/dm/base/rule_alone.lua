--- What is known of a rule before it is known whether it steps a system, as a map or a chart has
-- it: each tells in its place which rules do not fit.
local core = require "dm.core"

local free

--- A solver by this rule, of a free particle where the system is a dm.system. Raises where the rule
-- is misspelled.
return function(system, rule)
  if debug.getmetatable(system).__name ~= "dm.system" then
    return system:solver { rule = rule, h = 1 }
  end
  free = free or core.system { Q = core.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
  return free:solver { rule = rule, h = 1 }
end
