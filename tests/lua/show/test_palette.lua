-- colours that everybody tells apart: CIE76 distances as seen by normal, protan, deutan and tritan eyes, by the matrices of
-- Machado, Oliveira & Fernandes 2009 (severity 1); figures for print: sizes, slopes, marks, texts
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local EYES = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
  { { 0.152286, 1.052583, -0.204868 }, { 0.114503, 0.786281, 0.099216 }, { -0.003882, -0.048116, 1.051998 } },
  { { 0.367322, 0.860646, -0.227968 }, { 0.280085, 0.672501, 0.047413 }, { -0.011820, 0.042940, 0.968881 } },
  { { 1.255528, -0.076749, -0.178779 }, { -0.078411, 0.930809, 0.147602 }, { 0.004733, 0.691367, 0.303900 } } }
local XYZ = { { 0.4124564, 0.3575761, 0.1804375 }, { 0.2126729, 0.7151522, 0.0721750 }, { 0.0193339, 0.1191920, 0.9503041 } }
local WHITE = { 0.95047, 1, 1.08883 }
local function times(M, x)
  local out = {}
  for i = 1, 3 do out[i] = M[i][1] * x[1] + M[i][2] * x[2] + M[i][3] * x[3] end
  return out
end
local function linear(c) c = c / 255 return c <= 0.04045 and c / 12.92 or ((c + 0.055) / 1.055) ^ 2.4 end
local function lab(colour, eye)
  local r, g, b = colour:match "^#(%x%x)(%x%x)(%x%x)$"
  local x = times(eye, { linear(tonumber(r, 16)), linear(tonumber(g, 16)), linear(tonumber(b, 16)) })
  for i = 1, 3 do x[i] = math.max(0, math.min(1, x[i])) end
  local y, f = times(XYZ, x), {}
  for i = 1, 3 do
    local t = y[i] / WHITE[i]
    f[i] = t > 216 / 24389 and t ^ (1 / 3) or (24389 / 27 * t + 16) / 116
  end
  return { 116 * f[2] - 16, 500 * (f[1] - f[2]), 200 * (f[2] - f[3]) }
end
local function apart(colours)
  local least = math.huge
  for _, eye in ipairs(EYES) do
    for i = 1, #colours do
      for j = 1, i - 1 do
        local a, b = lab(colours[i], eye), lab(colours[j], eye)
        least = math.min(least, math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2))
      end
    end
  end
  return least
end
ok(apart { "#ff0000", "#00ff00" } < 80 and apart { "#000000", "#ffffff" } > 99, "the simulation brings red near to green, not black to white")
local lines, classes, all = dm.palette "lines", dm.palette "classes", {}
ok(#lines >= 6 and apart(lines) >= 24, "lines", apart(lines))
local main = {}
for i, name in ipairs { "bounded", "drifting", "chaotic", "off", "blow-up" } do main[i] = classes[name] end
ok(#main == 5 and apart(main) >= 30, "the main classes of maps", apart(main))
for _, class in ipairs(require "dm.stability.classes".CLASSES) do all[#all + 1] = classes[class.name] end
ok(#all == 12 and apart(all) >= 15, "all classes", apart(all))
lines[1] = "#000000"
ok(dm.palette "lines"[1] ~= "#000000", "a list of one's own")
raises("\"lines\" or \"classes\"", dm.palette, "lins")
raises("palette", dm.palette)

---- labels ----

local label = require "dm.show.label"
for text, wanted in pairs {
  ["q_1"] = "q_{1}", ["p_theta"] = "p_{θ}", ["10^{-3}"] = "10^{-3}", ["theta"] = "θ", ["Omega t"] = "Ω t", ["theta1"] = "θ1",
  ["my_value"] = "my\\134_value", ["x_{ab}^n"] = "x_{ab}^{n}", ["m^2"] = "m²", ["a & b~"] = "a \\134& b\\134~", ["thetas"] = "thetas",
  ["^2"] = "²", ["_"] = "\\134_", ["q_"] = "q\\134_", ["{x"] = "\\134{x", ["`id`"] = "\\140id\\140", ['"'] = "\\042", ["@x"] = "\\134@x",
} do
  local got = label.caption(text)
  ok(got == '"' .. wanted:gsub("\\\\", "\\") .. '"', "label " .. text, got)
end
ok(label.caption("q_1 theta", true) == '"q\\134_1 theta"', "as it stands", label.caption("q_1 theta", true))

---- options ----

local u = { 1, 2, 3 }
for _, wrong in ipairs { { "cm", size = { 8, 6, "furlong" } }, { "half an inch", size = { 1, 1, "mm" } }, { "dpi", dpi = 1 }, { "fontsize", fontsize = "x" },
  { "font", font = "a'; system 'x" }, { "linewidth", linewidth = 0 }, { "slopes", slopes = { 2 } }, { "slopes", slopes = { 0 }, log = "xy" },
  { "slopes", slopes = {}, log = "xy" }, { "marks", marks = { { 1 } } }, { "marks", marks = 3 }, { "marks", marks = { { 1, 2, 3 } } }, { "minor", minor = 3 },
  { "ascii", ascii = "yes" }, { "text", text = "fancy" } } do
  local word = wrong[1]
  wrong[1] = nil
  wrong.file = "none.png"
  raises(word, dm.plot, u, u, wrong)
end
raises("share", dm.figure, { { u, u }, { u, u }, share = "z", file = "none.png" })
raises("logarithmic", dm.figure, { { u, u, log = "x" }, { u, u }, share = "x", file = "none.png" })
raises("belongs to the figure", dm.figure, { { u, u, dpi = 300 }, file = "none.png" })

---- scripts that gnuplot gets ----

local gnuplot, kept = require "dm.show.gnuplot", nil
local write = gnuplot.write
gnuplot.write = function(figure, file) kept = gnuplot.script(figure, file) end
dm.plot(u, u, { file = "a.png", size = { 8.5, 6, "cm" } })
ok(kept:find("size 1004,709", 1, true), "8.5 x 6 cm at 300 dots per inch", kept:sub(1, 200))
dm.plot(u, u, { file = "a.png", size = { 100, 50, "mm" }, dpi = 254 })
ok(kept:find("size 1000,500", 1, true), "millimetres and dots")
dm.plot(u, u, { file = "a.pdf", size = { 2, 1, "in" } })
ok(kept:find("size 2.0000,1.0000", 1, true), "inches of a PDF")
dm.plot(u, u, { file = "a.png" })
ok(kept:find("size 800,480", 1, true), "pixels where nothing is asked for")
-- the triangle of a slope has that slope
dm.plot({ 1e-3, 1e-1 }, { 1e-9, 1e-1 }, { file = "a.png", log = "xy", slopes = { 4, -1 } })
local found = {}
for block in kept:gmatch "%$slope_1_%d << EOD\n(.-)EOD" do
  local x, y = {}, {}
  for a, b in block:gmatch "(%S+) (%S+)\n" do x[#x + 1], y[#y + 1] = tonumber(a), tonumber(b) end
  found[#found + 1] = math.log(y[3] / y[1]) / math.log(x[3] / x[1])
  for k = 1, 4 do ok(x[k] > 1e-3 and x[k] < 1e-1 and y[k] > 1e-10 and y[k] < 1, "inside of the panel", x[k] .. " " .. y[k]) end
end
ok(#found == 2 and math.abs(found[1] - 4) < 1e-6 and math.abs(found[2] + 1) < 1e-6, "triangles of their slopes", table.concat(found, " "))
dm.plot({ 1e-3, 1e-1 }, { 1e-9, 1e-5 }, { file = "a.png", log = "xy", slopes = { 2, 4 } })
local ends = {}
for block in kept:gmatch "%$slope_1_%d << EOD\n(.-)EOD" do
  local x = {}
  for a in block:gmatch "(%S+) %S+\n" do x[#x + 1] = tonumber(a) end
  ends[#ends + 1] = { math.min(table.unpack(x)), math.max(table.unpack(x)) }
end
ok(ends[1][2] < ends[2][1] or ends[2][2] < ends[1][1], "two triangles at one line stand beside each other")
-- panels in line
dm.figure { { u, { 1, 1e9, 2 } }, { u, u, title = "t" }, { u, u }, { u, u }, columns = 2, file = "a.png", letters = true, share = "x" }
local edges = {}
for edge in kept:gmatch "set lmargin at screen (%S+)" do edges[#edges + 1] = edge end
ok(#edges == 4 and edges[1] == edges[3] and edges[2] == edges[4] and edges[1] ~= edges[2], "panels of a column have one left edge")
ok(kept:find '"%(d%)"' and not kept:find '"%(e%)"', "letters")
ok(select(2, kept:gsub('set xtics %(""', "")) == 2, "texts of the shared axis stand below alone")
-- minor ticks: four between two, none of them major
dm.plot({ 0, 10 }, { 0, 1 }, { file = "a.png", minor = true })
local minor = select(2, kept:match "set xtics ([^\n]*)":gsub(" 1[,)]", ""))
ok(minor > 7, "minor ticks", kept:match "set xtics ([^\n]*)")
gnuplot.write = write
tap.done()
