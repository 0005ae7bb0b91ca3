--- Text into a file, whole or told why not: a full disk raises, too.
local core = require "dm.core"

local function open(file, mode, what)
  if type(file) ~= "string" then
    error(("%s: a file name is needed (got %s)"):format(what, type(file)), 0)
  end
  -- of many ranks one writes
  local handle, why = io.open(core.is_silent() and mode:find "w" and "/dev/null" or file, mode)
  if not handle then error(("%s: cannot open %s"):format(what, why), 0) end
  return handle
end

-- everything that `pieces` yields
local function write_all(handle, file, pieces)
  for piece in pieces do
    local fine, why = handle:write(piece)
    if not fine then
      handle:close()
      error(("cannot write %s: %s"):format(file, why), 0)
    end
  end
  local fine, why = handle:close()
  if not fine then error(("cannot write %s: %s"):format(file, why), 0) end
end

-- the text itself where file is nil, else the name of the file
local function write(file, text, what)
  if file == nil then return text end
  local rest = text
  write_all(open(file, "w", what), file, function()
    local piece = rest
    rest = nil
    return piece
  end)
  return file
end

return { open = open, write_all = write_all, write = write }
