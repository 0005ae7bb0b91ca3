--- Where pictures without a file go: to the terminal, or, in a notebook, into the page. A notebook
-- sets `show`.
local M = {}

--- show(type, content): "image/svg+xml", "image/png" (bytes) or "text/html"; nil in a terminal.
M.show = nil

local TYPES = { svg = "image/svg+xml", png = "image/png", html = "text/html" }

-- whole content of a file, which goes
local function taken(name)
  local file = assert(io.open(name, "rb"))
  local content = file:read "a"
  file:close()
  os.remove(name)
  return content
end

--- Have write(file) draw to a new file of that ending, and show what it holds.
function M.file(ending, write)
  local plain = os.tmpname()
  local name = plain .. "." .. ending
  local fine, why = pcall(write, name)
  os.remove(plain)
  if not fine then
    os.remove(name)
    error(why, 0)
  end
  M.show(TYPES[ending], taken(name))
end

return M
