-- pictures.lua FOLDER IMAGES: work-precision charts with gnuplot, one for each problem, in dm's colours (dmlua runs it)
package.path = arg[0]:match "^(.*/)" .. "?.lua;" .. package.path
local results = require "results"
local folder, images = arg[1], arg[2]
os.execute(("mkdir -p '%s'"):format(images))
local all = results.searches(folder)

local TITLES = { ["P1-0.6"] = "Kepler, e = 0.6, 100 periods", ["P1-0.9"] = "Kepler, e = 0.9, 100 periods",
  P2 = "J2 satellite, 100 periods", P3 = "outer solar system, 200,000 days", P4 = "double spherical pendulum, T = 10",
  ["P5-body"] = "free rigid body, T = 100", ["P5-top"] = "heavy top, T = 100",
  ["P6-1e2"] = "stiff spring, k = 1e2, T = 16", ["P6-1e4"] = "stiff spring, k = 1e4, T = 16",
  ["P6-1e6"] = "stiff spring, k = 1e6, T = 16", ["P8-toda-1024"] = "Toda chain, N = 1024, T = 16",
  ["P8-fpu-1024"] = "FPU-beta chain, N = 1024, T = 16", ["P8-toda-32"] = "Toda chain, N = 32, T = 100",
  ["P8-fpu-32"] = "FPU-beta chain, N = 32, T = 100" }
local COLOURS = dm.palette "lines"
local SHARE = { bound = 3, dmlua = 6, peer = 3 }

local SWEPT = 2  -- rules with a fixed number of sweeps in a picture: the others solve their steps to round-off

-- the methods of a side that are cheapest at the targets, up to `count`, then the plain ones
local function chosen(key, side, count)
  local list, seen, swept = {}, {}, 0
  for place = 1, 40 do
    for _, target in ipairs(results.targets) do
      local row = (((all.targets[key] or {})[target] or {})[side] or {})[place]
      local has_sweeps = side == "dmlua" and row and row.method:find "^gauss%(%d+, "
      if row and not seen[row.method] and #list < count and not (has_sweeps and swept == SWEPT) then
        seen[row.method] = true
        swept = swept + (has_sweeps and 1 or 0)
        list[#list + 1] = row.method
      end
    end
  end
  for _, plain in ipairs { "verlet", "midpoint" } do
    if side == "dmlua" and #list < count + 1 and not seen[plain] and (all.curves[key][side] or {})[plain] then
      seen[plain] = true
      list[#list + 1] = plain
    end
  end
  return list
end

-- errors that fall with time: the points before round-off, below 1
local function points(curve)
  local out, least = {}, 3
  table.sort(curve, function(a, b) return a[1] < b[1] end)
  for _, p in ipairs(curve) do
    if p[2] < least then
      out[#out + 1] = ("%g %g"):format(p[1] * 1e-9, p[2])
      least = p[2]
    end
  end
  return out
end

-- names of rules for a narrow legend
local function short(name) return (name:gsub("log%-hamiltonian", "log-h"):gsub("sofroniou%-spaletta", "sofspa")) end

local function style(side, i)
  if side == "bound" then return ("lw 4 lc rgb '#%s' pt 0"):format(({ "202020", "707070", "a8a8a8" })[i] or "c8c8c8") end
  local colour = COLOURS[(i - 1) % #COLOURS + 1]
  if side == "peer" then return ("lw 1.5 dt 2 pt 4 ps 0.8 lc rgb '%s'"):format(({ "#7a0019", "#b8860b", "#4b0082" })[i]) end
  local shape = i <= #COLOURS and 7 or 9 -- the seventh line has the first one's colour, and triangles
  return ("lw 2 pt %d ps 0.8 lc rgb '%s'"):format(shape, colour)
end

local function draw(key)
  local plots, data = {}, {}
  for _, side in ipairs { "bound", "dmlua", "peer" } do
    for i, method in ipairs(chosen(key, side, SHARE[side])) do
      local name = (side == "bound" and "C: " or side == "dmlua" and "dmlua: " or "") .. short(method)
      plots[#plots + 1] = ("'-' with linespoints %s title \"%s\" noenhanced"):format(style(side, i), name)
      data[#data + 1] = table.concat(points(all.curves[key][side][method]), "\n") .. "\ne\n"
    end
  end
  if #plots == 0 then return end
  local file = ("%s/bench-%s.png"):format(images, key:gsub("%.", ""))
  local gnuplot = assert(io.popen("gnuplot", "w"))
  gnuplot:write(([[
set terminal pngcairo size 1000,640 font "sans,11"
set output "%s"
set title "%s"
set logscale xy
set format "10^{%%T}"
set xlabel "process CPU time (s)"
set ylabel "largest position error at 32 times"
set yrange [1e-12:3]
set grid xtics ytics lc rgb "#dddddd"
set key outside right top spacing 1.2 samplen 2.5 font ",10"
plot ]]):format(file, TITLES[key] or key), table.concat(plots, ", "), "\n", table.concat(data))
  gnuplot:close()
  print("picture  " .. file)
end

for _, key in ipairs(all.problems) do draw(key) end
