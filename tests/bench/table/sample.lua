-- sample.lua WHOLE SAMPLE: the long double reference of a long chain agrees with the particles
-- (every 64th) that are kept from quad precision
local function rows(name)
  local out = {}
  for line in io.lines(name) do
    if line:sub(1, 1) ~= "#" then
      local row = {}
      for number in line:gmatch "%S+" do row[#row + 1] = tonumber(number) end
      out[#out + 1] = row
    end
  end
  return out
end

local whole, sample, worst = rows(arg[1]), rows(arg[2]), 0
for i, row in ipairs(sample) do
  for k, x in ipairs(row) do worst = math.max(worst, math.abs(whole[i][64 * (k - 1) + 1] - x)) end
end
local close = worst < 1e-14 -- false for NaN
if #sample ~= 32 or #whole ~= 32 or not close then
  io.stderr:write(("bench: %s differs from %s by %.1e: remove it and run again\n"):format(arg[1], arg[2], worst))
  os.exit(1)
end
