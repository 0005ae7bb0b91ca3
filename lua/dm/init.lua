--- require "dm": the C core, and the Lua modules, each loaded when first used.
local core = require "dm.core"

-- name in dm -> module whose field of that name it is
local lazy = {
  plot = "dm.show.plot",
  figure = "dm.show.plot",
  load = "dm.data.load",
  time = "dm.measure.time",
  chart = "dm.chart",
  scaling = "dm.measure.scaling",
  scene = "dm.scene",
  stability = "dm.stability",
  amplification = "dm.stability.linear",
  stability_limit = "dm.stability.linear",
  polynomial_roots = "dm.measure.recurrence",
  recurrence = "dm.measure.recurrence",
  animate = "dm.show.animate",
  demo = "dm.session.demo",
  action = "dm.action",
  moving_frame = "dm.frame",
  invariant_problem = "dm.frame.invariant",
  compare = "dm.data.compare",
  commute = "dm.reduce.commute",
  help = "dm.session.help",
  apropos = "dm.session.help",
  who = "dm.session.help",
  pretty = "dm.session.pretty",
}

-- modules that add methods to classes of the core
local extensions = { "dm.session.missing", "dm.measure.multipliers", "dm.show.path", "dm.show.animate", "dm.data.export", "dm.measure.tangent", "dm.measure.modified_energy", "dm.chart", "dm.measure.order",
  "dm.reduce.methods", "dm.stability.methods", "dm.group",
}

-- modules of classes that methods give, loaded when one is first made
local late_classes = { "dm.measure.poincare", "dm.reduce.discrete", "dm.reduce.equilibria.branch" }

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
