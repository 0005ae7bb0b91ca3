--- Methods in Lua of classes of the core and of those that core.class began: their errors name the
-- line of the caller, and their modules are loaded when they are first used.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

--- The method `name` of a class ("dm.path"); doc as for core.method.
function M.method(class, name, f, doc)
  core.method(class, name, blame.is_caller(f) and f or blame.caller(f), doc)
end

---- modules that are read when something of them is needed ----

--- Stands for the module that load() requires, which is read when it is first asked for an entry:
-- for what messages and rarer calls need. An action and its first frame take 40 million
-- instructions so, not 53 (SO(2) on the plane; `build/dmlua tests/bench/frames.lua first`).
function M.module(load)
  return setmetatable({}, { __index = function(stand_in, name)
    local value = load()[name]
    rawset(stand_in, name, value)
    return value
  end })
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

---- methods and functions of the core that a module wraps, once it is loaded ----

-- stand-in -> { get, put (of the place where it stands), plain, doc, module, f (once loaded) }
local wrapping = {}

local unwrapped = {} -- modules that have begun to wrap

-- what the module has put in the place of a stand-in; where somebody else has wrapped this one, he
-- stays
local function wrapped_now(stand_in)
  local row = wrapping[stand_in]
  if row.f then return row.f end
  local outer, is_loaded = row.get(), package.loaded[row.module]
  if unwrapped[row.module] and not is_loaded then return row.plain end -- while it is loaded
  local outer_doc = outer ~= stand_in and rawget(core.docs, outer)
  if outer ~= stand_in and not is_loaded then row.put(row.plain, row.doc) end
  require(row.module)
  row.f = row.get()
  if outer ~= stand_in and not is_loaded then row.put(outer, outer_doc) end
  return row.f
end

local function wrap_later(get, put, module)
  local plain, stand_in = get(), nil
  function stand_in(...) return wrapped_now(stand_in)(...) end
  wrapping[stand_in] = { get = get, put = put, plain = plain,
    doc = rawget(core.docs, plain), module = module }
  put(stand_in, "")
  core.docs[stand_in] = nil
end

--- The method `name` of a class is wrapped by `module`, which is loaded when the method is first
-- called or its doc is read; the module begins with M.unwrap.
function M.wrapped_later(class, name, module)
  local methods = debug.getregistry()[class].methods
  wrap_later(function() return methods[name] end,
    function(f, doc) core.method(class, name, f, doc) end, module)
end

--- The same of a function of the core.
function M.function_later(name, module)
  wrap_later(function() return core[name] end,
    function(f, doc) core[name], core.docs[f] = f, doc end, module)
end

--- What stands in the places that `module` wraps is plain again.
function M.unwrap(module)
  unwrapped[module] = true
  for stand_in, row in pairs(wrapping) do
    if row.module == module and row.get() == stand_in then row.put(row.plain, row.doc) end
  end
end

setmetatable(core.docs, { __index = function(docs, f)
  if unloaded[f] then return docs[loaded(f)] end
  if wrapping[f] then return docs[wrapped_now(f)] end
end })

return M
