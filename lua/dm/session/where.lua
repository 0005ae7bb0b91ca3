--- dmlua --where NAME: folders that came with dmlua, for editors, Python and who wants to read.
local blame = require "dm.base.blame"
local option = require "dm.base.options"

local M = {}

local fail = option.failing "--where"

-- the folder that has dm, without ".." in its name
local function home()
  local file = debug.getinfo(1, "S").source:match "^@(.*)/dm/session/where%.lua$"
  if not file then fail "dmlua does not know where its files are" end
  local parts = {}
  for part in file:gmatch "[^/]+" do
    if part == ".." and #parts > 0 and parts[#parts] ~= ".." then
      parts[#parts] = nil
    elseif part ~= "." then
      parts[#parts + 1] = part
    end
  end
  return (file:sub(1, 1) == "/" and "/" or "") .. table.concat(parts, "/")
end

-- behind the folder that has lua: in the source, where it is installed
local FOLDERS = { meta = { "docs/meta", "meta" }, lua = { "lua" }, python = { "lua/python" },
  examples = { "examples" } }

-- a file of each, by which one sees that it is there
local FILES = { meta = "dm.lua", lua = "dm/init.lua", python = "dmlua.py", examples = "kepler.lua" }

--- The folder of that name; raises where there is none of it.
function M.folder(name)
  if not FOLDERS[name] then
    fail("write meta, lua, python or examples (got %s)", option.got(name))
  end
  local root = home():gsub("/[^/]*$", "")
  for _, folder in ipairs(FOLDERS[name]) do
    local there = io.open(("%s/%s/%s"):format(root, folder, FILES[name]))
    if there then
      there:close()
      return root .. "/" .. folder
    end
  end
  fail("%s did not come with this dmlua", name)
end

--- `dmlua --where name`: prints the folder, or what is wrong and ends with 1.
function M.command(name)
  local fine, folder = blame.try(M.folder, name)
  if fine then return print(folder) end
  io.stderr:write("dmlua: ", tostring(folder), "\n")
  os.exit(1, true)
end

return M
