--- dm.example: what is typed and answered for a function, a method or a class; of_doc finds it by
-- the text that help prints.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local by_doc  -- doc -> example, made when the first one is asked for

-- a doc that several classes share has the example of the class that it is written for
local function note(doc, name, transcripts)
  local own = doc and transcripts[name]
  if own and (not by_doc[doc] or doc:sub(1, #name) == name:gsub("%.", ":")) then
    by_doc[doc] = own
  end
end

local function collect()
  by_doc = {}
  local reference, transcripts = require "dm.session.reference", require "dm.session.transcripts"
  for name, f in pairs(reference.functions(require "dm")) do
    note(core.docs[f], name, transcripts)
  end
  for name, f in pairs(reference.for_modules()) do note(core.docs[f], name, transcripts) end
  for class, methods in pairs(reference.classes()) do
    note(core.docs[class], class, transcripts)
    for name, f in pairs(methods) do
      note(core.docs[f], class:match "[^.]+$" .. "." .. name, transcripts)
    end
  end
end

--- The example of the function, method or class that has this doc, or nil; name: by which it was
-- asked for, of several classes that share the doc.
function M.of_doc(doc, name)
  local own = name and require "dm.session.transcripts"[(name:gsub(":", "."))]
  if own then return own end
  if not by_doc then collect() end
  return by_doc[doc]
end

M.example = blame.caller(function(name)
  if type(name) ~= "string" then
    option.fail("dm.example", "a name is needed, as \"path.drift\" (got %s)", option.got(name))
  end
  local known = require "dm.session.transcripts"
  local plain = name:gsub(":", ".")
  local own = known[plain] or known["dm." .. plain]
  if own then return own end
  local doc = require "dm.session.apropos".as_written(name)
  return doc and M.of_doc(doc)
end)

core.docs[M.example] = [[
dm.example(name) -> string or nil
What is typed at a prompt and answered for a function, a method or a class by its name in help:
dm.example "path.drift"; nil of a name that help does not know.]]

return M
