--- The characters of pictures in a terminal: Unicode where the locale says UTF-8, else ASCII.
local M = {}

-- how a locale is chosen (POSIX): the first of these that is set and not empty
local function is_utf8()
  for _, name in ipairs { "LC_ALL", "LC_CTYPE", "LANG" } do
    local locale = os.getenv(name)
    if locale and locale ~= "" then return locale:lower():find "utf%-?8" ~= nil end
  end
  return false
end

-- bits of the dots of a braille cell (Unicode block 2800): its upper and its lower half
local UPPER, LOWER = 0x01 | 0x02 | 0x08 | 0x10, 0x04 | 0x40 | 0x20 | 0x80

local function ascii_cell(bits)
  if bits & UPPER == 0 then return "." end
  return bits & LOWER == 0 and "'" or ":"
end

local SIGNS = { ["⁻"] = "-", ["⁰"] = "0", ["¹"] = "1", ["²"] = "2", ["³"] = "3", ["⁴"] = "4",
  ["⁵"] = "5", ["⁶"] = "6", ["⁷"] = "7", ["⁸"] = "8", ["⁹"] = "9" }

-- "2·10⁻⁹ m²" as "2*10^-9 m^2"; what ASCII has no sign for as "?"
local function ascii_text(text)
  local out, raised = {}, false
  for sign in text:gmatch "[\0-\x7F\xC2-\xFD]?[\x80-\xBF]*" do
    local digit = SIGNS[sign]
    out[#out + 1] = (digit and not raised and "^" or "")
      .. (digit or sign == "·" and "*" or sign:find "^[\0-\x7F]*$" and sign or "?")
    raised = digit ~= nil
  end
  return table.concat(out)
end

local UNICODE = { line = "─", tick_below = "┬", bar = "│", tick_left = "┤", corner = "└",
  bullet = "•", stroke = "⠒⠒", point = "·",
  cell = function(bits) return utf8.char(0x2800 + bits) end, text = function(text) return text end }

local ASCII = { line = "-", tick_below = "+", bar = "|", tick_left = "+", corner = "+",
  bullet = "o", stroke = "--", point = ".", cell = ascii_cell, text = ascii_text }

--- The characters for the locale of this process, or (plain) ASCII: line, tick_below, bar,
-- tick_left, corner of axes; bullet (a point by itself), stroke (of a legend), point (a small one);
-- cell(bits) of 2 x 4 dots; text(s) of a caption.
function M.here(plain) return not plain and is_utf8() and UNICODE or ASCII end

return M
