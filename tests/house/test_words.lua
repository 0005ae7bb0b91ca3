-- Words that mark unfinished work, and paths of somebody's machine, stay out of what is kept.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

-- spelt in pieces, so that this file does not find itself
local words = { "TO" .. "DO", "FIX" .. "ME", "XX" .. "X", "HA" .. "CK", "place" .. "holder", "for n" .. "ow",
  "not yet impl" .. "emented", "simplified ver" .. "sion" }
local paths = { "/ho" .. "me/%w", "/Us" .. "ers/%w", "/ro" .. "ot/" }
local here = house.lines("pwd")[1]:match "^(/.+)/[^/]+$"
if here then paths[#paths + 1] = here:gsub("%p", "%%%0") .. "/" end

-- lines are looked at where the whole has one of these
local function is_clean(text)
  for _, word in ipairs(words) do
    if text:find(word, 1, true) then return false end
  end
  for _, path in ipairs(paths) do
    if text:find(path) then return false end
  end
  return not (text:find(" \n", 1, true) or text:find("\t\n", 1, true) or text:find "[ \t]$")
end

local unfinished, placed, tabs = {}, {}, {}
local function look_at_lines(file, text)
  local binary, n = text:find "\0", 0
  for line in text:gmatch "[^\n]+" do
    n = n + 1
    local at = ("%s:%d: %s"):format(file, n, line:sub(1, 80))
    if not binary then
      for _, word in ipairs(words) do
        if line:find("%f[%w]" .. word .. "%f[%W]") then unfinished[#unfinished + 1] = at end
      end
      if line:find "[ \t]$" and not file:find "%.md$" then tabs[#tabs + 1] = at end
    end
    for _, path in ipairs(paths) do
      if line:find(path) then placed[#placed + 1] = at end
    end
  end
end
for _, file in ipairs(house.files "^[^L]") do
  local text = house.read(file)
  if not is_clean(text) then look_at_lines(file, text) end
end
house.check("no word marks unfinished work", unfinished)
house.check("no path of one machine", placed)
house.check("no line ends in blanks", tabs)
house.finish()
