--- The start of a run as a caller gives it: the number of an only coordinate becomes a list of one.
local M = {}

--- A copy of the options with q, v, p (and tangent vectors u, dp) as lists.
function M.lists(options)
  if type(options) ~= "table" then return options end
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  for _, key in ipairs { "q", "v", "p", "u", "dp" } do
    if type(out[key]) == "number" then out[key] = { out[key] } end
  end
  return out
end

return M
