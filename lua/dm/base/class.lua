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

---- methods and functions of the core that modules wrap, once they are loaded ----

-- stand-in -> { get, put (of the place where it stands), plain, module, f (what the module puts
-- there, once it is loaded), doc, is_loaded }; a stand-in stays in its place until its module is
-- loaded whole, so that a load which fails can be tried again
local wrapping = {}

-- what the module has put in the place of a stand-in; where somebody else has wrapped this one, he
-- stays
local function wrapped_now(stand_in)
  local row = wrapping[stand_in]
  if row.is_loaded then return row.f end
  require(row.module)
  row.is_loaded = true
  if row.get() == stand_in then row.put(row.f, row.doc) end
  return row.f
end

local by_place = {} -- module -> place -> stand-in

local function wrap_later(place, get, put, module)
  local plain, stand_in = get(), nil
  function stand_in(...) return wrapped_now(stand_in)(...) end
  wrapping[stand_in] = { get = get, put = put, plain = plain, module = module }
  by_place[module] = by_place[module] or {}
  by_place[module][place] = stand_in
  put(stand_in, "")
  core.docs[stand_in] = nil
end

--- The method `name` of a class, or its metamethod, is wrapped by `module`, which is loaded when it
-- is first called or its doc is read; the module asks M.wraps for it.
function M.wrapped_later(class, name, module)
  local meta = debug.getregistry()[class]
  local is_method = name:sub(1, 2) ~= "__"
  local at = is_method and meta.methods or meta
  wrap_later(class .. ":" .. name, function() return at[name] end, function(f, doc)
    if is_method then core.method(class, name, f, doc) else at[name] = f end
  end, module)
end

--- The same of a function of the core.
function M.function_later(name, module)
  wrap_later(name, function() return core[name] end,
    function(f, doc) core[name], core.docs[f] = f, doc end, module)
end

--- For the module that wraps it: the function in a place ("dm.solver:run", or "semidirect" of the
-- core) without the wrapper of this module, and its doc; and put(f [, doc]), which says what
-- stands there when the module is loaded.
function M.wraps(module, place)
  local stand_in = by_place[module][place]
  local row = wrapping[stand_in]
  local plain = wrapping[row.plain] and wrapped_now(row.plain) or row.plain
  return plain, core.docs[plain], function(f, doc)
    row.f, row.doc = f, doc
    core.docs[f] = doc
  end
end

setmetatable(core.docs, { __index = function(docs, f)
  if unloaded[f] then return docs[loaded(f)] end
  if wrapping[f] then return docs[wrapped_now(f)] end
end })

return M
