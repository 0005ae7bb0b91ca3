--- Modules as Lua compiles them, in one file for the interpreter, which reads them in a fifth of
-- the time of their texts (src/cli/compiled.c). `make` writes it.
local M = {}

-- a field of src/cli/compiled.c's head
local MAGIC = "dmlua modules"

local NUMBER, ROW = "=T", "=TTTT"

-- the folder that has dm, as this program names it
local function own_home()
  return debug.getinfo(1, "S").source:match "^@(.*)/dm/session/compiled%.lua$"
end

local function text_of(name)
  local file = assert(io.open(name, "rb"))
  local text = file:read "a"
  file:close()
  return text
end

--- Writes the file `out`: the modules `names`, a text of words like "lua/dm/init.lua", for a
-- program that finds them in the folder `home` (nil: this one). Errors name the places there, as
-- they do where the texts are read.
function M.write(out, names, home)
  local own = own_home()
  local rows, blobs, n = {}, {}, select(2, names:gsub("%S+", ""))
  local head = string.pack("zz" .. NUMBER, MAGIC, require "dm.manual".lua, n)
  local at = #head + n * string.packsize(ROW)
  for name in names:gmatch "%S+" do
    name = name:gsub("^lua/", "/")
    local place, text = (home or own) .. name, text_of(own .. name)
    local code = string.dump(assert(load(text, "@" .. place, "t")))
    rows[#rows + 1] = ROW:pack(at, at + #place, at + #place + #text, at + #place + #text + #code)
    blobs[#blobs + 1] = place .. text .. code
    at = at + #blobs[#blobs]
  end
  local part = out .. ".new" -- processes that run have the old file mapped: it is not written to
  local file = assert(io.open(part, "wb"))
  assert(file:write(head, table.concat(rows), table.concat(blobs)))
  assert(file:close())
  assert(os.rename(part, out))
end

return M
