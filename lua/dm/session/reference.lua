--- The reference page, made from the docs that help() prints: docs/reference.md is its text.
local core = require "dm.core"

local M = {}

local function sorted(t)
  local keys = {}
  for key in pairs(t) do keys[#keys + 1] = key end
  table.sort(keys)
  return keys
end

local function load_all(dm)
  local lazy = getmetatable(dm)
  if lazy and lazy.load_all then lazy.load_all() end
end

--- Classes that are registered: name -> table of methods; also those of modules not loaded yet.
function M.classes()
  load_all(require "dm")
  local registry, classes = debug.getregistry(), {}
  for name in pairs(core.docs) do
    local class = type(name) == "string" and registry[name]
    if type(class) == "table" and class.methods then classes[name] = class.methods end
  end
  return classes
end

--- Functions of the table `dm` and its subtables by their full names, also those not loaded yet.
function M.functions(dm)
  local found, seen = {}, {}
  load_all(dm)
  local function walk(prefix, t)
    if seen[t] then return end
    seen[t] = true
    for key, value in pairs(t) do
      local name = prefix .. "." .. tostring(key)
      if type(value) == "function" then found[name] = value end
      if type(value) == "table" and value ~= core.docs and value ~= core then walk(name, value) end
    end
  end
  walk("dm", dm)
  return found
end

--- Functions of the core that stand for modules alone: dm does not show them.
function M.for_modules()
  local found = {}
  for f, doc in pairs(core.docs) do
    local name = type(f) == "function" and doc:match "^core%.[%w_]+"
    if name then found[name] = f end
  end
  return found
end

-- "signature\ntext" as a heading and a paragraph, and the example of its name; lines of the text
-- keep their breaks
local function entry(out, level, name, doc)
  local signature, text = doc:match "^([^\n]*)\n?(.*)$"
  out[#out + 1] = ("%s `%s`\n"):format(level, name)
  out[#out + 1] = ("    %s\n"):format(signature)
  if text ~= "" then out[#out + 1] = (text:gsub("%s+$", ""):gsub("\n", "  \n")) .. "\n" end
  local example = require "dm.session.transcripts"[name:gsub(":", ".")]
  if example then out[#out + 1] = ("```text\n%s\n```\n"):format(example:gsub("\n+$", "")) end
end

--- The page as one string.
function M.text(dm)
  local out = {
    "# Reference\n",
    "Made by `make docs` from the docs that `help(x)` prints in the interpreter.\n",
    "## Functions\n",
  }
  local functions, classes, hidden = M.functions(dm), M.classes(), M.for_modules()
  for _, name in ipairs(sorted(functions)) do
    entry(out, "###", name, core.docs[functions[name]] or name)
  end
  out[#out + 1] = "## Classes\n"
  for _, class in ipairs(sorted(classes)) do
    entry(out, "###", class, core.docs[class])
    for _, name in ipairs(sorted(classes[class])) do
      entry(out, "####", class:match "[^.]+$" .. ":" .. name, core.docs[classes[class][name]]
        or name)
    end
  end
  out[#out + 1] = '## For modules\n\nOf `require "dm.core"`; not in `dm`.\n'
  for _, name in ipairs(sorted(hidden)) do entry(out, "###", name, core.docs[hidden[name]]) end
  return table.concat(out, "\n")
end

return M
