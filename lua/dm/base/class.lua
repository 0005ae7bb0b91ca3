--- Classes whose objects are Lua tables, as help(), completion and the reference know those of the core: by name, methods and a doc.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

--- Make a class known; methods: the names of those functions of its metatable that have docs.
function M.register(metatable, methods, doc)
  local list = {}
  for _, name in ipairs(methods) do
    local f = metatable[name]
    if not blame.is_caller(f) then  -- errors name the caller of every method
      metatable[name] = blame.caller(f)
      core.docs[metatable[name]] = core.docs[f]
    end
    list[name] = metatable[name]
  end
  debug.getregistry()[metatable.__name] = { methods = list }
  core.docs[metatable.__name] = doc
end

return M
