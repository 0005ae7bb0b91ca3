--- Mesh files by their extensions.
local option = require "dm.base.options"

local M = {}

local FORMATS = { obj = "obj", off = "off", msh = "gmsh", mesh = "medit", node = "tetgen",
  ele = "tetgen" }

--- What dm.complex takes, from a file.
function M.read(file)
  local extension = file:match "%.(%w+)$"
  local format = FORMATS[(extension or ""):lower()]
  if not format then
    option.fail("dm.mesh", "%s: a mesh file ends in .obj, .off, .msh, .mesh, .node or .ele", file)
  end
  local given = require("dm.dec.files." .. format).read(file)
  if #given.simplices == 0 then option.fail("dm.mesh", "%s: there are no simplices", file) end
  return given
end

return M
