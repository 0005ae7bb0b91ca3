--- base64 (RFC 4648).
local M = {}

local DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
local pair = {}  -- 12 bits -> two digits
for i = 0, 4095 do
  local a, b = i >> 6, i & 63
  pair[i] = DIGITS:sub(a + 1, a + 1) .. DIGITS:sub(b + 1, b + 1)
end

--- Bytes as text.
function M.encode(text)
  local out, whole = {}, #text - #text % 3
  for i = 1, whole, 3 do
    local a, b, c = text:byte(i, i + 2)
    local bits = a << 16 | b << 8 | c
    out[#out + 1] = pair[bits >> 12]
    out[#out + 1] = pair[bits & 4095]
  end
  local rest = #text - whole
  if rest > 0 then
    local a, b = text:byte(whole + 1, #text)
    local bits = a << 16 | (b or 0) << 8
    out[#out + 1] = pair[bits >> 12]
    out[#out + 1] = rest == 2 and pair[bits & 4095]:sub(1, 1) .. "=" or "=="
  end
  return table.concat(out)
end

return M
