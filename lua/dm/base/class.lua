--- Methods in Lua of classes of the core and of those that core.class began: their errors name the
-- line of the caller, and their modules are loaded when they are first used.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

--- The method `name` of a class ("dm.path"); doc as for core.method.
function M.method(class, name, f, doc)
  core.method(class, name, blame.is_caller(f) and f or blame.caller(f), doc)
end

---- methods whose modules are not loaded yet ----

local unloaded = setmetatable({}, { __mode = "k" })  -- stand-in -> class, name and module

-- the method that a stand-in stands for, which its module has put in its place
local function loaded(stand_in)
  local row = unloaded[stand_in]
  require(row.module)
  local f = core.method(row.class, row.name)
  assert(f ~= stand_in, row.module .. " does not define " .. row.class .. ":" .. row.name)
  return f
end

--- The method `name` of a class is one that `module` defines by M.method. It is loaded when the
-- method is first called or its doc is read.
function M.later(class, name, module)
  local stand_in
  function stand_in(...) return loaded(stand_in)(...) end
  unloaded[stand_in] = { class = class, name = name, module = module }
  core.method(class, name, stand_in, "")
  core.docs[stand_in] = nil
end

setmetatable(core.docs, { __index = function(docs, f)
  if unloaded[f] then return docs[loaded(f)] end
end })

return M
