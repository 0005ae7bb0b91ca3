--- What help writes, through $PAGER where it is longer than the screen, as git and man do it.
local core = require "dm.core"
local layout = require "dm.session.text"

local M = {}

local function is_there(program)
  return os.execute(("command -v %s >/dev/null 2>&1"):format(program)) == true
end

-- the command, or nothing where texts are to be printed; without PAGER less, which ends by itself
-- at the end of what fits, where it is installed
local function command()
  local own = os.getenv "PAGER"
  if own then return own:find "%S" and own ~= "cat" and own or nil end
  return is_there "less" and "less -FRX" or nil
end

-- is somebody there to turn pages, and is the text longer than the screen?
local function is_longer(text)
  local screen = core.terminal()
  if not screen.tty or not core.terminal("stdin").tty or os.getenv "TERM" == "dumb" then
    return false
  end
  local lines = 0
  for line in (text .. "\n"):gmatch "([^\n]*)\n" do
    lines = lines + math.max(1, math.ceil(utf8.len(line) and utf8.len(line) / screen.width or 1))
  end
  return lines >= screen.height
end

-- the pages come from a file, not a pipe: one that the pager leaves early would end this process
local function turn(pager, text)
  local name = os.tmpname()
  local file = io.open(name, "w")
  if not file then return false end
  file:write(text, "\n")
  file:close()
  io.stdout:flush()
  local fine, _, status = os.execute(("%s < '%s'"):format(pager, name))
  os.remove(name)
  return fine or status ~= 126 and status ~= 127  -- 126, 127: it could not be started
end

--- f, all that it writes shown when it returns.
function M.paged(f)
  return function(...)
    local results = table.pack(layout.collected(f, ...))
    local text = results[1]
    local pager = text ~= "" and is_longer(text) and command()
    if text ~= "" and not (pager and turn(pager, text)) then layout.write(text) end
    return table.unpack(results, 2, results.n)
  end
end

return M
