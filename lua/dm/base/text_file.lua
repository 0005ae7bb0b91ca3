--- Text into a file, whole or told why not: a full disk raises, too.
local core = require "dm.core"

local function check_name(file, what)
  if type(file) ~= "string" then
    error(("%s: a file name is needed (got %s)"):format(what, type(file)), 0)
  end
end

local function open(file, mode, what)
  check_name(file, what)
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

-- everything that `pieces` yields, in place of an old file, which stays until the new one is whole;
-- links, pipes and devices are written through, but links that `links` says to replace, too
local function replace(file, pieces, what, links)
  check_name(file, what)
  local made, why = core.new_file(file, not links)
  if not made then error(("%s: cannot open %s"):format(what, why), 0) end
  local fine, message = pcall(function() write_all(open(made, "wb", what), file, pieces) end)
  if not fine then
    if made ~= file then os.remove(made) end
    error(message, 0)
  end
  fine, why = core.end_file(made, file)
  if not fine then error(("cannot write %s"):format(why), 0) end
end

-- the text itself where file is nil, else the name of the file
local function write(file, text, what, links)
  if file == nil then return text end
  local rest = text
  replace(file, function()
    local piece = rest
    rest = nil
    return piece
  end, what, links)
  return file
end

return { open = open, replace = replace, write = write }
