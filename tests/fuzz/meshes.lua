--[[ dmlua tests/fuzz/meshes.lua FORMAT SEED COUNT - spoilt mesh files of one format (obj, off, msh2,
msh4, mesh, node), one after another in the current folder: bytes, bits, numbers and lines changed,
left out, put in, cut off. Each must be read as a mesh whose numbers are finite, or refused by an
error that names its line, or the cell that can be no cell. The file under way is spoilt.*, its
number in last-call. Prints how many were read, then the other sentences that refused one. ]]
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local dm = require "dm"
local files = require "files"

local format, seed, most = arg[1], math.tointeger(arg[2]) or 1, math.tointeger(arg[3]) or 1000
math.randomseed(seed)
local random = math.random

---- right files: a few of every format ----

local M22 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
local M41 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
local RIGHT = {
  off = { "OFF # square\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\n3 0 1 2\n3 0 2 3 255 0 0\n",
    "OFF 4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n",
    "OFF\n3 2 0\n0 0 0.5\n1e0 0 0\n.5 -1 2\n2 0 1\n2 1 2\n" },
  obj = { "# a\no s\nv 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nvn 0 0 1\nf 1/1/1 2//1 3\nf -4 -2 -1\n",
    "v 0 0 0\nv 1 0 0\nv 0 1 1\nl 1 2\nl 2 3\n", "v 0 0 0 1\nv 1 0 0\nv 0 1 1\ng x\nf 1 2 3\n" },
  msh2 = { M22 .. "$PhysicalNames\n1\n2 1 \"a b\"\n$EndPhysicalNames\n$Nodes\n4\n11 0 0 0\n"
      .. "12 1 0 0\n13 1 1 0\n14 0 1 0\n$EndNodes\n$Elements\n4\n1 15 2 0 1 11\n2 1 2 0 1 11 12\n"
      .. "3 2 2 0 1 11 12 13\n4 2 2 0 1 11 13 14\n$EndElements\n",
    M22 .. "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n"
      .. "1 4 0 1 2 3 4\n$EndElements\n" },
  msh4 = { M41 .. "$Entities\n0 0 0 1\n$EndEntities\n$Nodes\n2 5 1 5\n0 1 0 1\n1\n0 0 0\n3 1 0 4\n"
      .. "2\n3\n4\n5\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n"
      .. "3 1 4 1\n2 1 2 3 4\n$EndElements\n",
    M41 .. "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n"
      .. "2 1 2 1\n1 1 2 3\n$EndElements\n" },
  mesh = { "MeshVersionFormatted 2\nDimension\n3\nVertices\n4\n0 0 0 1\n1 0 0 1\n1 1 0 1 0 1 0 1\n"
      .. "Corners 2 1 2\nEdges\n1\n1 2 5\nTriangles 2\n1 2 3 0\n1 3 4 0\nEnd\n",
    "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
      .. "Tetrahedra 1\n1 2 3 4 0\nEnd\n",
    "MeshVersionFormatted 1\nDimension 2\nVertices 3\n0 0 0\n1 0 0\n0 1 0\nTriangles 1\n1 2 3 0\n" },
  node = { { "# a\n4 2 1 1\n1 0 0 0.5 1\n2 1 0 0.5 1\n3 1 1 0.5 1\n4 0 1 0.5 1\n",
      "2 3 0\n1 1 2 3\n2 1 3 4\n" },
    { "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "1 4 0\n0 0 1 2 3\n" } },
}
local EXTENSION = { msh2 = "msh", msh4 = "msh", node = "ele" }

local function write_spoilt()
  local right = RIGHT[format][random(#RIGHT[format])]
  if format ~= "node" then
    files.write("spoilt." .. (EXTENSION[format] or format), files.spoilt(random, right))
    return
  end
  local which = random(3) -- the one, the other, or both
  files.write("spoilt.node", which ~= 1 and files.spoilt(random, right[1]) or right[1])
  files.write("spoilt.ele", which ~= 2 and files.spoilt(random, right[2]) or right[2])
end

---- what a mesh or a refusal must be ----

local function is_finite(x)
  local sum = 0
  for i = 1, #x do sum = sum + math.abs(x[i]) end
  return sum < math.huge -- and no NaN
end
local function check(K)
  local n = K.dimension
  assert(K:count(0) > 0 and K:count(n) > 0 and n <= 3, "DEFECT: an empty mesh")
  for k = 0, n do
    assert(is_finite(K:volume(k)), "DEFECT: a volume is not finite")
  end
  local cells = K:simplices(n)
  for _, cell in ipairs(cells) do
    for _, v in ipairs(cell) do assert(v >= 1 and v <= K:count(0), "DEFECT: no such vertex") end
  end
end
local others = {} -- sentences without a line -> how many
local function judge(i, why)
  why = tostring(why)
  if why:find "^[^\n]*dm%.mesh: spoilt%.%w+, line %d+: " and not why:find "attempt to"
    and #why < 1000 then return true end
  local kind = why:gsub("%-?%d[%d.e+-]*", "N"):sub(1, 200)
  if not others[kind] then others[kind] = { count = 0, first = i } end
  others[kind].count = others[kind].count + 1
  return not (why:find "DEFECT" or why:find "attempt to" or why:find "memory" or #why > 1000)
end

local log = assert(io.open("last-call", "w"))
log:setvbuf "no"
local name = "spoilt." .. (EXTENSION[format] or format)
local refused, wrong, slow, clock = 0, 0, 0, os.clock
for i = 1, most do
  write_spoilt()
  log:seek "set"
  log:write(i, "        \n")
  local began = clock()
  local fine, got = pcall(dm.mesh, name)
  if fine then fine, got = pcall(check, got) end
  slow = math.max(slow, clock() - began)
  if not fine then
    refused = refused + 1
    if not judge(i, got) then
      wrong = wrong + 1
      print(("seed %d file %d: %s"):format(seed, i, tostring(got):sub(1, 300)))
    end
  end
end
print(("%d files of %s: %d read, %d refused, %d wrong, the slowest took %.3f s"):format(most, format,
  most - refused, refused, wrong, slow))
for kind, other in pairs(others) do
  print(("without a line, %d, the first is %d: %s"):format(other.count, other.first, kind))
end
os.exit(wrong == 0, true)
