-- pictures of maps: letters without gnuplot (what eyes see of their colours: tests/lua/show/test_palette.lua)
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

-- the picture has the limit of what is right, the resonances; without gnuplot there are letters
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
