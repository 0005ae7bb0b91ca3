--- What is called: all functions of dm, of its core and of its classes, operators, the functions of
-- math, and the rows of templates.lua.
local dm = require "dm"
local reference = require "dm.session.reference"
local signature = require "signature"
local templates = require "templates"
local docs = require("dm.core").docs

local M = {}

-- left out, and why
local SKIPPED = {
  ["dm.core"] = "a table of what follows by name", ["dm.time"] = "measures for seconds by design",
  ["dm.demo"] = "waits for a key", ["core.end_file"] = "renames a file of new_file alone",
  ["core.class"] = "internal: changes classes", ["core.method"] = "internal: changes classes",
  ["core.end_process"] = "ends the process", ["core.nap"] = "sleeps",
  ["core.worker"] = "forks", ["core.wait"] = "waits for what forks", ["core.own_group"] = "signals",
  ["dm.sweep"] = "forks", ["core.result"] = "internal: marks tables", ["core.within"] = "ends what shard.lua calls",
}
local MATH = { "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "max",
  "min", "floor", "ceil", "fmod", "tointeger", "modf" }

local function metamethods(add, class)
  for name, f in pairs(debug.getregistry()[class]) do
    -- collecting twice by hand is a broken promise of the script that has debug.getregistry
    if type(f) == "function" and name ~= "__gc" and name ~= "__close" then
      add { name = class .. "." .. name, f = f, class = class }
    end
  end
end

--- A list of { name =, f =, class = of self, ways = of signature.lua, given = of a template }, in
-- the same order every time.
function M.list()
  local calls = {}
  local function add(call)
    if SKIPPED[call.name] or type(call.f) ~= "function" then return end
    if call.name:find "^core%.ranks" or call.class == "dm.worker" then return end -- processes
    call.ways = signature.ways(docs[call.f])
    calls[#calls + 1] = call
  end
  for name, f in pairs(reference.functions(dm)) do add { name = name, f = f } end
  for name, f in pairs(reference.for_modules()) do add { name = name, f = f } end
  for class, methods in pairs(reference.classes()) do
    for name, f in pairs(methods) do add { name = class .. ":" .. name, f = f, class = class } end
    metamethods(add, class)
  end
  for _, name in ipairs(MATH) do add { name = "math." .. name, f = math[name] } end
  for _, row in ipairs(templates.rows()) do
    calls[#calls + 1] = { name = "with " .. row[1], f = row[2], given = row[3], ways = {} }
  end
  table.sort(calls, function(a, b) return a.name < b.name end)
  return calls
end

return M
