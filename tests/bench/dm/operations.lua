-- What the slopes dL/dq, dL/dv of every benchmark model cost, counted in the C text of their kernel.
--   build/dmlua tests/bench/dm/operations.lua
local models = dofile "tests/bench/dm/models.lua"

-- how often each kind of operation stands in the text of `slope`
local function count(text)
  local body = text:match "void slope%b()%s*(%b{})"
  local found = { add = 0, mul = 0, div = 0, sqrt = 0, root = 0, call = 0 }
  for line in body:gmatch "= ([^\n]*);" do
    local kind = line:find "^reciprocal_root" and "root" or line:find "^sqrt" and "sqrt" or line:find "^%l+%(" and "call"
      or line:find " %* " and "mul" or line:find " / " and "div" or line:find " [+-] " and "add" or line:find "?" and "add" or line:find "^%-t" and "add"
    if kind then found[kind] = found[kind] + 1 end
  end
  return found
end

print(("%-14s %4s %4s %4s %5s %10s %6s"):format("slopes of", "+ -", "*", "/", "sqrt", "1/sqrt", "calls"))
local seen = {}
for _, m in ipairs(models) do
  if not m.long and not seen[m.system] then
    seen[m.system] = true
    local ok, text = pcall(m.system.emit_c, m.system)
    local n = ok and count(text)
    print(n and ("%-14s %4d %4d %4d %5d %10d %6d"):format(m.key, n.add, n.mul, n.div, n.sqrt, n.root, n.call) or m.key .. "  " .. text)
  end
end
