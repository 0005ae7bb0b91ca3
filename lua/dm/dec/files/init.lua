--- Mesh files by their extensions.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local FORMATS = { obj = "obj", off = "off", msh = "gmsh", mesh = "medit", node = "tetgen",
  ele = "tetgen" }

-- what dm.complex takes, and the line of every simplex
local function read(file)
  local extension = file:match "%.(%w+)$"
  local format = FORMATS[(extension or ""):lower()]
  if not format then
    option.fail("dm.mesh", "%s: a mesh file ends in .obj, .off, .msh, .mesh, .node or .ele", file)
  end
  local given, lines = require("dm.dec.files." .. format).read(file)
  if #given.simplices == 0 then option.fail("dm.mesh", "%s: there are no simplices", file) end
  return given, lines
end

-- does the list have all of the vertices?
local function has_all(list, vertices)
  local is_there = {}
  for _, v in ipairs(list) do is_there[v] = true end
  for _, v in ipairs(vertices) do
    if not is_there[v] then return false end
  end
  return true
end

-- the line of the simplex that the message is about, or nil
local function line_of(given, lines, message)
  local number = math.tointeger(tonumber(message:match "simplex (%d+)"))
  if number then return lines[number] end
  local vertices = {}
  for v in (message:match "{([%d, ]+)}" or ""):gmatch "%d+" do
    vertices[#vertices + 1] = math.tointeger(tonumber(v))
  end
  for i, list in ipairs(#vertices > 0 and given.simplices or {}) do
    if has_all(list, vertices) then return lines[i] end
  end
end

--- The mesh in the file: what is wrong with a simplex is told with its line.
function M.mesh(file)
  local given, lines = read(file)
  local fine, K = blame.try(core.complex, given)
  if fine then return K end
  if type(K) ~= "string" then error(K, 0) end
  local line = line_of(given, lines, K)
  file = file:gsub("%.node$", ".ele") -- where the simplices are
  return option.fail("dm.mesh", "%s%s: %s", file, line and (", line %d"):format(line) or "",
    (K:gsub("^dm%.mesh: ", "")))
end

return M
