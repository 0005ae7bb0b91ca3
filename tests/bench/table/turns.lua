-- dmlua tests/bench/table/turns.lua TURNS BEFORE NOW SCRIPT [ARGUMENT ...] - a script of tests/bench by
-- two builds in turns: the least of every number of its table, and the ratio of the second build's
-- to the first's. Rows are told by their words, rows of the same words by their order.
local turns, before, now = tonumber(arg[1]), arg[2], arg[3]
local script = table.concat(arg, " ", 4)

local function split(line)
  local words, numbers = {}, {}
  for text in line:gmatch "[^%s|,;]+" do
    local list = tonumber(text) and numbers or words
    list[#list + 1] = tonumber(text) or text
  end
  return table.concat(words, " "), numbers
end

local order, least = {}, {}
local function read(side, program)
  local seen = {}
  local pipe <close> = assert(io.popen(("%s %s 2>/dev/null"):format(program, script)))
  for line in pipe:lines() do
    local words, numbers = split(line)
    seen[words] = (seen[words] or 0) + 1
    local name = words .. (seen[words] > 1 and " #" .. seen[words] or "")
    if not least[name] then order[#order + 1], least[name] = name, { {}, {} } end
    local best = least[name][side]
    for k, x in ipairs(numbers) do best[k] = math.min(best[k] or x, x) end
  end
end

for i = 1, turns do -- the first of a pair is now this build, now that
  for side = 1, 2 do
    local which = i % 2 == 0 and 3 - side or side
    read(which, which == 1 and before or now)
  end
end
for _, name in ipairs(order) do
  local out, a, b = {}, least[name][1], least[name][2]
  for k = 1, math.min(#a, #b) do
    out[k] = a[k] == b[k] and ("%g"):format(a[k]) or ("%g, %g (%.3f)"):format(a[k], b[k], b[k] / a[k])
  end
  if #out > 0 then print(("%-44s %s"):format(name, table.concat(out, "; "))) end
end
