-- A ball on a rope gets a push at the bottom: how hard does it pull, where does the rope go slack, and when does it tighten again?
-- Tension m (g cos theta + v^2 / l) with v^2 = v0^2 - 2 g l (1 - cos theta): zero at cos theta = -(v0^2 - 2 g l) / 3 g l, if v0^2 is between 2 g l and 5 g l.
local dm = require "dm"
local abs, max, log = math.abs, math.max, math.log
local picture = (arg and arg[1] or ".") .. "/slack_rope.png"

local m, g, l = 0.5, 9.81, 1.2
local function fall(q, v) return m * (v:dot(v) / 2 - g * q[2]) end
local rope = dm.system { name = "ball on a rope", Q = dm.R(2), coordinates = { "x", "y" }, L = fall, constraint = function(q) return q:norm() - l end }
local free = dm.system { name = "ball", Q = dm.R(2), coordinates = { "x", "y" }, L = fall }

-- the force of the constraint is lambda along the rope, outwards: the tension is -lambda
local function slack(q, v) return -rope:multipliers(q, v)[1] end
local function tension(y, v0) return m / l * (v0 ^ 2 - 2 * g * l - 3 * g * y) end
local function swing(v0, rule, h, options)
  options.q, options.v, options.t = { 0, -l }, { v0, 0 }, options.t or 2
  return rope:solver { rule = rule, h = h }:run(options)
end

local flights, pulls = { equal = true, xlabel = "x", ylabel = "y", title = "path, to where it is taut again" }, { xlabel = "t", ylabel = "tension", title = "tension" }
for _, v0 in ipairs { 8, 7.2, 6.5, 4.2 } do
  local path = swing(v0, "gauss(3)", 0.01, { record = { "lambda" }, t = 1.2, events = { slack = { g = slack, direction = "down", stop = true } } })
  local pull, worst, x, y = {}, 0, {}, {}
  for i = 1, #path do
    pull[i], x[i], y[i] = -path.lambda[i][1], path.q[i][1], path.q[i][2]
    worst = max(worst, abs(pull[i] - tension(path.q[i][2], v0)))
  end
  assert(worst < 1e-7, "the tension is known in closed form")
  local event = path.events[1]
  local stays = v0 ^ 2 > 5 * g * l or v0 ^ 2 < 2 * g * l
  assert((event == nil) == stays, "it goes slack between two speeds")
  if event then  -- thrown: a parabola, until it is l from the middle again
    assert(abs(event.q[2] - (v0 ^ 2 - 2 * g * l) / (3 * g)) < 1e-8, "where it goes slack")
    local thrown = free:solver { rule = "verlet", h = 0.001 }:run { q = event.q, p = event.p, t = 1.5,
      events = { taut = { g = function(q) return q:norm() - l * (1 - 1e-9) end, direction = "up", stop = true } } }
    for i = 2, #thrown do x[#x + 1], y[#y + 1] = thrown.q[i][1], thrown.q[i][2] end
    print(("v0 = %g m/s: slack at t = %.4f s, height %.4f m; taut again at t = %.4f s"):format(v0, event.t, event.q[2], event.t + thrown.t[#thrown]))
  end
  flights[#flights + 1] = { x = x, y = y, name = ("v0 = %g"):format(v0) }
  pulls[#pulls + 1] = { x = path:column "t", y = pull, name = ("v0 = %g"):format(v0) }
end

-- the multiplier at a state has the order of the rule; what a step puts at a node, over h, has order 2
local errors, hs = { log = "xy", style = "linespoints", xlabel = "h", ylabel = "error of the tension", title = "rules" }, { 0.04, 0.02, 0.01 }
for _, row in ipairs { { "rattle", "impulse", 2 }, { "rattle", "lambda", 2 }, { "gauss(2)", "lambda", 4 }, { "gauss(3)", "lambda", 6 } } do
  local rule, what, order = table.unpack(row)
  local line = {}
  for k, h in ipairs(hs) do
    local path = swing(8, rule, h, { record = { "lambda", "impulses" }, t = 0.44 })
    local i, exact = math.floor(0.4 / h + 0.5) + 1, swing(8, "gauss(6)", 0.01, { t = 0.4 })
    line[k] = abs(-path:column(what)[i] / (what == "impulse" and h or 1) - tension(exact.q[#exact][2], 8))
  end
  assert(abs(log(line[1] / line[2], 2) - order) < 0.3, rule .. " should have order " .. order)
  errors[#errors + 1] = { x = hs, y = line, name = rule .. (what == "impulse" and ", impulse / h" or "") }
end
print("picture  " .. dm.figure { title = "Ball on a rope", file = picture, flights, pulls, errors, columns = 3 })
