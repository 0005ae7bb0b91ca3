--- dm.example: what is typed and answered for a function, a method or a class.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

M.example = blame.caller(function(name)
  if type(name) ~= "string" then
    option.fail("dm.example", "a name is needed, as \"path.drift\" (got %s)", option.got(name))
  end
  local known = require "dm.session.transcripts"
  local plain = name:gsub(":", ".")
  return known[plain] or known["dm." .. plain] or nil
end)

core.docs[M.example] = [[
dm.example(name) -> string or nil
What is typed at a prompt and answered for a function, a method or a class by its name in help:
dm.example "path.drift"; nil where there is no example yet.]]

return M
