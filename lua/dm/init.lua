--- require "dm": the C core, and the Lua modules, each loaded when first used.
local core = require "dm.core"

-- name in dm -> module whose field of that name it is
local lazy = {
  plot = "dm.plot",
  figure = "dm.plot",
  load = "dm.load",
  time = "dm.time",
  chart = "dm.chart",
  scaling = "dm.scaling",
  scene = "dm.scene",
  stability = "dm.stability",
  amplification = "dm.linear_stability",
  stability_limit = "dm.linear_stability",
  polynomial_roots = "dm.recurrence",
  recurrence = "dm.recurrence",
  animate = "dm.animate",
  demo = "dm.demo",
  action = "dm.action",
  moving_frame = "dm.frame",
  invariant_problem = "dm.invariant",
  compare = "dm.compare",
  commute = "dm.commute",
  help = "dm.help",
  apropos = "dm.help",
  who = "dm.help",
  pretty = "dm.pretty",
}

-- modules that add methods to classes of the core
local extensions = { "dm.missed", "dm.multipliers", "dm.path", "dm.animate", "dm.export", "dm.tangent", "dm.shadow", "dm.chart", "dm.order",
  "dm.routh_methods", "dm.stability_methods", "dm.group",
}

-- modules of classes that methods give, loaded when one is first made
local late_classes = { "dm.section", "dm.routh_discrete", "dm.routh_branch" }

local dm = {}

local M = { __name = "dm", lazy = lazy }

function M.__index(t, name)
  local module = lazy[name]
  if not module then
    core.miss("dm", name)
    return nil
  end
  local value = require(module)[name]
  rawset(t, name, value)
  return value
end

function M.__tostring() return "dm: discrete mechanics; help(dm) lists what it has" end

-- every name of dm and every class, loaded, so that help, completion and the reference see them
function M.load_all()
  for name in pairs(lazy) do local _ = dm[name] end
  for _, module in ipairs(late_classes) do require(module) end
  return dm
end

for _, module in ipairs(extensions) do require(module) end
for name, value in pairs(core) do dm[name] = value end
setmetatable(dm, M)

-- Lua names a function in messages and tracebacks by the module in whose table it finds it: dm.R, not dm.core.R
package.loaded["dm.core"] = setmetatable({}, { __index = core })

return dm
