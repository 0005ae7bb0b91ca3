--- Classes whose objects are Lua tables, as help(), completion and the reference know those of the
-- core: by name, methods and a doc.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

--- Make a class known; methods: the names of those functions of its metatable that have docs.
function M.register(metatable, methods, doc)
  core.class({ __name = metatable.__name }, doc)
  for _, name in ipairs(methods) do
    local f = metatable[name]
    local doc_of_f = core.docs[f]
    if not blame.is_caller(f) then metatable[name] = blame.caller(f) end  -- errors name the caller of every method
    core.method(metatable.__name, name, metatable[name], doc_of_f)
  end
end

return M
