--- Work that a rank does for itself: sweeps that are begun in it are not shared out, since no other
-- rank comes to meet them.
local M = {}

local depth = 0

--- Is this rank at such work?
function M.is_here() return depth > 0 end

--- f(...), as such work.
function M.run(f, ...)
  depth = depth + 1
  local results = table.pack(pcall(f, ...))
  depth = depth - 1
  if not results[1] then error(results[2], 0) end
  return table.unpack(results, 2, results.n)
end

return M
