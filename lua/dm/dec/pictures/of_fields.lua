--- Methods of paths that fields on meshes have in their own way. What draws meshes is loaded when
-- one of them is called for a field.
local blame = require "dm.base.blame"
local core = require "dm.core"
require "dm.data.export"
require "dm.show.animate"
require "dm.show.path"

local M = {}

local function motion() return require "dm.dec.pictures.motion" end

-- own(before, path, ...) for fields
local function of_fields(name, own, doc)
  local before = core.method("dm.path", name)
  local general = core.docs[before]
  core.method("dm.path", name, blame.caller(function(path, ...)
    if not path.watched and path.system.field then return own(before, path, ...) end
    return before(path, ...)
  end), general .. "\n" .. doc)
end

of_fields("animate", function(_, ...) return motion().animate(...) end, [[
Of a field on a mesh: options {of = "q" | "p", title=, seconds=}; the mesh is coloured row by row,
and where its values are points of its own space (an elastic body) it moves.]])

of_fields("npy", function(_, ...) return motion().npy(...) end, [[
Of a field on a mesh: fields t, q, p, where a row of q is an array of all values.]])

of_fields("plot", function(before, path, ...)
  local file, other = motion().plot(path, ...)
  if other then return before(path, ...) end
  if file then return file end  -- in the terminal a prompt has nothing to print behind the picture
end, [[
Of a field on a mesh: path:plot("q" | "p", {row=, file=, title=, azimuth=, height=}) draws a row,
the last by default, as form:plot does; columns such as "energy" as above.]])

return M
