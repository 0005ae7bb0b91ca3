-- make bench: what math.* costs in a loop, ns a call beside lua5.4, best of alternating runs (src/bind/value/bind_math.c).
local LOOP = [[
  local f, best = math.%s, math.huge
  for _ = 1, 5 do
    local from, sum = os.clock(), 0
    for i = 1, 2000000 do sum = sum + f(i * 0.37, %s) end
    best = math.min(best, os.clock() - from)
  end
  print(best / 2e6 * 1e9)]]
local CALLS = { { "sin", "nil" }, { "sqrt", "nil" }, { "floor", "nil" }, { "max", "5.5" } }

local function time(program, loop)
  local pipe = io.popen(("%s -e '%s'"):format(program, loop))
  local ns = pipe:read "n"
  pipe:close()
  return ns or math.huge
end

print(("%-8s %8s %8s %7s   ns a call in a loop"):format("", "dmlua", "lua5.4", "ratio"))
for _, call in ipairs(CALLS) do
  local loop, own, theirs = LOOP:format(call[1], call[2]), math.huge, math.huge
  for _ = 1, 3 do
    own, theirs = math.min(own, time(arg[-1], loop)), math.min(theirs, time("lua5.4", loop))
  end
  print(("%-8s %8.1f %8.1f %7.2f"):format(call[1], own, theirs, own / theirs))
end
