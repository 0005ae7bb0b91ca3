--- Colours of lines, of classes of maps, of fans and of pages. They were searched for near those of
-- P. Tol so that eyes of four kinds (normal, protan, deutan, tritan; Machado, Oliveira & Fernandes
-- 2009, severity 1) see them apart: CIE76 distances are at least 24 between lines, 32 between the
-- five main classes, 16 between all of them. tests/lua/show/test_palette.lua measures it.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

M.LINES = { "#3647ab", "#ee6b75", "#0e7b22", "#cfab30", "#57bee9", "#882763" }

-- what is right is blue, what is wrong or on its way there yellow to red, what is lost grey
M.CLASSES = { bounded = "#2877df", wrong = "#df8f47", drifting = "#f3bf45", chaotic = "#8c1304",
  off = "#b9bea9", ["blow-up"] = "#645d60", ["no convergence"] = "#110706", left = "#956ca7",
  ["constraint lost"] = "#2915b3", ["no value"] = "#9721b3", ["no start"] = "#ccdff7",
  ["not run"] = "#ffffff" }

M.GREY = "#bbbbbb" -- what does not count: a member that failed

--- The colour a part x (0 to 1) of the way from the first line's to the second's.
function M.between(x)
  local out = "#"
  for k = 2, 6, 2 do
    local a, b = tonumber(M.LINES[1]:sub(k, k + 1), 16), tonumber(M.LINES[2]:sub(k, k + 1), 16)
    out = out .. ("%02x"):format(math.floor(a + x * (b - a) + 0.5))
  end
  return out
end

local doc = [[
dm.palette("lines" | "classes") -> table
The colours of all pictures, as "#rrggbb": "lines" the list of six that lines take in turn,
"classes" those of the classes of stability maps by their names. Colour-blind eyes tell them apart:
CIE76 distances, as seen by normal, protan, deutan and tritan eyes, are at least 24 and 16.]]

M.palette = blame.caller(function(what)
  local options = { palette = what }
  option.need(options, "palette", "dm.palette", '"lines" or "classes"')
  option.one_of(options, "palette", "dm.palette", { "lines", "classes" })
  local out = {}
  for key, colour in pairs(what == "lines" and M.LINES or M.CLASSES) do out[key] = colour end
  return core.result(out)
end)

core.docs[M.palette] = doc

return M
