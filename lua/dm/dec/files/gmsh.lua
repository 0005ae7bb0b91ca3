--- Gmsh's .msh, versions 2.2 and 4.1, as text: the elements of the highest dimension.
local reader = require "dm.dec.files.reader"

local M = {}

-- vertices of the types of elements that are simplices; others are named
local SIZES = { [15] = 1, [1] = 2, [2] = 3, [4] = 4 }
local NAMES = { [3] = "quadrangle", [5] = "hexahedron", [6] = "prism", [7] = "pyramid",
  [8] = "curved line", [9] = "curved triangle", [11] = "curved tetrahedron" }

-- points, their places by number, elements
local function note_point(m, tag, p)
  local r = m.reader
  if m.place[tag] then r:fail("node %d stands there twice", tag) end
  m.points[#m.points + 1] = p
  m.place[tag] = #m.points
end

local function note_element(m, kind, words, first)
  local r, size, out = m.reader, SIZES[kind], {}
  if not size then
    r:fail("elements of type %d (%s) are no simplices", kind, NAMES[kind] or "unknown")
  end
  for j = 1, size do
    local tag = r:whole(words[first + j - 1], "a node", 0)
    out[j] = m.place[tag] or r:fail("there is no node %d", tag)
  end
  r:add(m.simplices, out)
end

---- version 2.2 ----

local function nodes_2(m)
  local r = m.reader
  local count = r:whole(r:need "the count of nodes"[1], "the count of nodes", 0)
  for i = 1, count do
    local words = r:need("nodes", i, count)
    note_point(m, r:whole(words[1], "the number of a node", 0), r:point(2, 4, "a coordinate"))
  end
  r:ends("nodes", count, "$EndNodes")
end

local function elements_2(m)
  local r = m.reader
  local count = r:whole(r:need "the count of elements"[1], "the count of elements", 0)
  for i = 1, count do
    local words = r:need("elements", i, count)
    local tags = r:whole(words[3], "the count of tags", 0, #words)
    note_element(m, r:whole(words[2], "the type of an element", 0), words, 4 + tags)
  end
  r:ends("elements", count, "$EndElements")
end

---- version 4.1: blocks ----

local function blocks(m, what, closing, read)
  local r = m.reader
  local count = r:whole(r:need("the count of blocks of " .. what)[1], "the count of blocks", 0)
  for i = 1, count do
    local words = r:need("blocks of " .. what, i, count)
    read(words[3], r:whole(words[4], "the count of " .. what, 0))
  end
  r:ends("blocks of " .. what, count, closing)
end

local function nodes_4(m)
  local r = m.reader
  blocks(m, "nodes", "$EndNodes", function(_, n)
    local tags = {}
    for i = 1, n do
      tags[i] = r:whole(r:need("numbers of nodes", i, n)[1], "the number of a node", 0)
    end
    for i = 1, n do
      r:need("nodes", i, n)
      note_point(m, tags[i], r:point(1, 3, "a coordinate"))
    end
  end)
end

local function elements_4(m)
  local r = m.reader
  blocks(m, "elements", "$EndElements", function(kind, n)
    kind = r:whole(kind, "the type of elements", 0)
    for i = 1, n do note_element(m, kind, r:need("elements", i, n), 2) end
  end)
end

---- the file ----

local function format_of(m)
  local r = m.reader
  local words = r:need "the version"
  if words[2] ~= "0" then r:fail("a binary .msh file: save it as text") end
  if words[1] == "2.2" then return { Nodes = nodes_2, Elements = elements_2 } end
  if words[1] == "4.1" then return { Nodes = nodes_4, Elements = elements_4 } end
  return r:fail("version %s is not read: save it as 2.2 or 4.1", words[1])
end

local function skip_to(r, name)
  while r:need("$End" .. name)[1] ~= "$End" .. name do end
end

function M.read(file)
  local r = reader.open(file)
  local m, sections = { reader = r, points = {}, place = {}, simplices = {} }, nil
  for words in function() return r:next() end do
    local name = words[1]:match "^%$(%a+)$"
    if not name then r:fail("a section, $Name, should stand here (got %s)", words[1]:sub(1, 40)) end
    if name == "MeshFormat" then sections = format_of(m)
    elseif not sections then r:fail("$MeshFormat must come first")
    elseif sections[name] then sections[name](m) end -- to the end of the section
    if not sections[name] then skip_to(r, name) end
  end
  if not sections then r:fail("the file is empty") end
  r:close()
  return reader.top(m.points, m.simplices)
end

return M
