-- pictures of maps for eyes that do not tell red from green: classes differ by 20 in CIELAB as a deuteranope sees them, or by pattern; letters without gnuplot
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local colours = (dm.stability and require "dm.stability.show").colours
local classes = require "dm.stability.classes".CLASSES

-- sRGB to linear light, through the matrix of deuteranopia of Machado, Oliveira & Fernandes 2009, to CIELAB (D65)
local function linear(c) c = c / 255 return c <= 0.04045 and c / 12.92 or ((c + 0.055) / 1.055) ^ 2.4 end
local SEEN = { { 0.367322, 0.860646, -0.227968 }, { 0.280085, 0.672501, 0.047413 }, { -0.011820, 0.042940, 0.968881 } }
local XYZ = { { 0.4124564, 0.3575761, 0.1804375 }, { 0.2126729, 0.7151522, 0.0721750 }, { 0.0193339, 0.1191920, 0.9503041 } }
local function times(M, x)
  local out = {}
  for i = 1, 3 do out[i] = M[i][1] * x[1] + M[i][2] * x[2] + M[i][3] * x[3] end
  return out
end
local function lab(text, seen)
  local r, g, b = text:match "#(%x%x)(%x%x)(%x%x)"
  local x = { linear(tonumber(r, 16)), linear(tonumber(g, 16)), linear(tonumber(b, 16)) }
  if seen then x = times(SEEN, x) end
  for i = 1, 3 do x[i] = math.max(0, math.min(1, x[i])) end
  local y = times(XYZ, x)
  local white, f = { 0.95047, 1, 1.08883 }, {}
  for i = 1, 3 do
    local t = y[i] / white[i]
    f[i] = t > (6 / 29) ^ 3 and t ^ (1 / 3) or t / (3 * (6 / 29) ^ 2) + 4 / 29
  end
  return { 116 * f[2] - 16, 500 * (f[1] - f[2]), 200 * (f[2] - f[3]) }
end
local function apart(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end
local red, green = lab("#ff0000", true), lab("#00ff00", true)
ok(apart(lab "#ff0000", lab "#00ff00") > 150 and math.abs(red[2]) < 25 and math.abs(green[2]) < 25, "the simulation takes red from green away")
for i, class in ipairs(classes) do
  ok(colours[class.name], "a colour for " .. class.name)
  for j = 1, i - 1 do
    local a, b = colours[class.name], colours[classes[j].name]
    for _, seen in ipairs { false, true } do
      local d = apart(lab(a[1], seen), lab(b[1], seen))
      ok(a[2] ~= b[2] or d >= 20, ("%s and %s%s"):format(class.name, classes[j].name, seen and " for a deuteranope" or ""), d)
    end
  end
end

-- the picture has patterns, the limit of what is right, the resonances; without gnuplot there are letters
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local map = oscillator:stability { q = { 1 }, v = { 0 }, rule = "verlet", h = { 0.02, 2.5, 20, "log" }, t = 60, chaos = false }
local lines, print_ = {}, print
_G.print = function(text) lines[#lines + 1] = text end
map:plot()
_G.print = print_
local text = table.concat(lines, "\n")
ok(text:find("w wrong", 1, true) and text:find("# blow-up", 1, true), "letters in the terminal", text)
local file = os.tmpname() .. ".svg"
local drawn = pcall(map.plot, map, { file = file })
if not drawn then
  ok(true, "# SKIP no picture: gnuplot is not in PATH")
else
  local f = io.open(file)
  local svg = f:read "a"
  f:close()
  os.remove(file)
  ok(svg:find ">wrong<" and svg:find ">resonances<" and svg:find ">limit of what is right<", "legend of a picture", #svg)
end
tap.done()
