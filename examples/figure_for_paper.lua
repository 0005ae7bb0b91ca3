-- A figure for a column of a paper, 8.5 cm wide: (a) Kepler's ellipse by Verlet's rule, (b) the order
-- of three rules, with triangles of the slopes that theory says. Are the measured slopes those?
local dm = require "dm"
local folder = arg and arg[1]

local kepler = dm.system { Q = dm.R(2), coordinates = { "x", "y" }, L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
local start = { q = { 1, 0 }, v = { 0, 1.2 } } -- a = 1/0.56, e = 0.44
local a = 1/(2 - 1.2^2)
local period = 2*math.pi*a^1.5

-- distance from the start after one period
local function error_of(rule, n)
  local path = kepler:solver { rule = rule, h = period/n }:run { q = start.q, v = start.v, steps = n, every = n }
  return (path.q[2] - dm.vector(start.q)):norm()
end
local rules, counts = { "verlet", "gauss(2)", "gauss(3)" }, { 40, 57, 80, 113, 160, 226, 320 }
local h, errors, slopes = {}, {}, {}
for i, n in ipairs(counts) do h[i] = period/n end
for k, rule in ipairs(rules) do
  errors[k] = {}
  for i, n in ipairs(counts) do errors[k][i] = error_of(rule, n) end
  local last = #counts
  slopes[k] = math.log(errors[k][last - 2]/errors[k][last])/math.log(h[last - 2]/h[last])
  print(("%-9s order %.3f"):format(rule, slopes[k]))
  assert(math.abs(slopes[k] - 2*k) < 0.1, rule)
end

local orbit = kepler:solver { rule = "verlet", h = period/100 }:run { q = start.q, v = start.v, steps = 1000 }
local panels = {
  { orbit:series("x", "y"), title = "(a) Verlet, ten periods", equal = true, marks = { { 0, 0, "sun" } } },
  { title = "(b) error after one period", log = "xy", slopes = { 2, 4, 6 }, minor = true, xlabel = "h", ylabel = "|Delta q|" },
}
for k, rule in ipairs(rules) do panels[2][k] = { x = h, y = errors[k], name = rule, style = "linespoints" } end
if folder then -- .pdf in place of .png is what a paper takes
  dm.figure { panels[1], panels[2], file = folder .. "/figure_for_paper.png", columns = 1, size = { 8.5, 12, "cm" }, fontsize = 8,
    linewidth = 0.8 }
end
