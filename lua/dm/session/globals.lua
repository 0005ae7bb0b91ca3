--- The globals of a session and of -e: help, apropos, who, demo. A name that is taken stays.
local M = {}

local MODULES = { help = "dm.session.help", apropos = "dm.session.help", who = "dm.session.help",
  demo = "dm.session.demo", format = "dm.session.pretty" }

local stand_ins = {}

local function set(name, f)
  local there = rawget(_G, name)
  if there == nil or stand_ins[there] then rawset(_G, name, f) end
end

--- For -e: functions whose modules are loaded when one is called.
function M.later()
  for name, module in pairs(MODULES) do
    local function f(...) return require(module)[name](...) end
    set(name, f)
    stand_ins[f] = true
  end
end

--- For a session: the functions themselves, whose docs help and completion know.
function M.open()
  for name, module in pairs(MODULES) do set(name, require(module)[name]) end
end

return M
