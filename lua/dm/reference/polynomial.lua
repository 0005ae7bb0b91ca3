--- Traced functions that have nothing narrow.
local M = {}

-- operations that make no narrow feature of smooth motion: sums, products, powers of low degree
local SMOOTH = { ["+"] = true, ["-"] = true, ["*"] = true, fma = true }

--- Is every node of the function a polynomial?
function M.is(f)
  for line in f:graph():gmatch "[^\n]+" do
    local text = (line:match "= (.*)$" or ""):gsub("%^[2-6]%f[%D]", "")
    for word in text:gmatch "%a[%w_]*" do
      if not word:find "^[tx]%d+$" and not SMOOTH[word] then return false end
    end
    if text:find "[/^]" then return false end
  end
  return true
end

return M
