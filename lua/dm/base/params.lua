--- Parameters of a system: which of them its functions read, and what `system.params` is.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

-- a metatable by which `params` are read, which notes the names; seen.all: they are enumerated
local function watching(params, seen)
  local function whole(f)
    return function()
      seen.all = true
      return f(params)
    end
  end
  return { __index = function(_, key)
    seen[key] = true
    return params[key]
  end, __pairs = whole(pairs), __len = whole(function(t) return #t end) }
end

-- does code of the function, or of one that it calls by an upvalue, have this text as a constant?
local function mentions(f, text, looked)
  if looked[f] then return false end
  looked[f] = true
  local fine, code = blame.try(string.dump, f, true)
  if not fine then return false end -- it is in C
  if code:find(string.char(#text + 1 | 0x80) .. text, 1, true) then return true end
  for k = 1, 255 do
    local name, value = debug.getupvalue(f, k)
    if not name then return false end
    if type(value) == "function" and mentions(value, text, looked) then return true end
  end
end

--- Can a function of the system read this parameter? It has the name in its code: a branch may be
-- taken later.
function M.may_read(system, name)
  if #name > 100 then return true end -- of a length in several bytes
  local looked = {}
  for _, f in pairs(system.given) do
    if type(f) == "function" and mentions(f, name, looked) then return true end
  end
  return false
end

--- Of the names those that no function of the system reads while it is traced with these params;
-- none where that cannot be told: they are enumerated, looked at by rawget or next, or not traced.
function M.unread(system, params, names)
  local seen, out = {}, {}
  if not blame.try(core.trace_with, system, watching(params, seen)) or seen.all then return out end
  for _, name in ipairs(names) do
    if not seen[name] then out[#out + 1] = name end
  end
  return out
end

--- Names of parameters, joined: those that are there.
function M.names(params)
  local names = {}
  for name in pairs(params) do names[#names + 1] = tostring(name) end
  table.sort(names)
  return #names > 0 and table.concat(names, ", ") or "none", names
end

-- a name that the system did not have is taken where something reads it
local function check(system, params, name, value)
  local copy = {}
  for key, own in pairs(params) do copy[key] = own end
  copy[name] = value
  if #M.unread(system, copy, { name }) == 0 or M.may_read(system, name) then return end
  local there, names = M.names(params)
  local near = core.nearest(name, names)
  error(("params.%s: no function of this system reads it; its parameters are %s%s"):format(name,
    there, near and ("; did you mean '%s'?"):format(near) or ""), 3)
end

local shown = setmetatable({}, { __mode = "k" })

--- What `system.params` is: the table that the system was made with, but that a name which nothing
-- reads is refused.
function M.shown(system, params)
  if shown[system] then return shown[system] end
  shown[system] = setmetatable({}, { __name = "dm.params", __index = params,
    __pairs = function() return pairs(params) end, __len = function() return #params end,
    __newindex = function(_, key, value)
      if type(key) == "string" and value ~= nil and params[key] == nil then
        check(system, params, key, value)
      end
      params[key] = value
    end })
  return shown[system]
end

return M
