-- ns per leapfrog step of one Kepler orbit in a plain loop; for lua5.4 and luajit alike
local name, count = arg[1], tonumber(arg[2])
local sqrt = math.sqrt

local function run(steps)
  local x, y, u, v, h = 0.4, 0.0, 0.0, 2.0, 0.01
  local r2 = x * x + y * y
  local w = 0.5 * h / (r2 * sqrt(r2))
  u, v = u - w * x, v - w * y
  for _ = 1, steps do
    x, y = x + h * u, y + h * v
    r2 = x * x + y * y
    w = h / (r2 * sqrt(r2))
    u, v = u - w * x, v - w * y
  end
  return x + y + u + v
end

local best = math.huge
for _ = 1, 7 do
  local t = os.clock()
  run(count)
  best = math.min(best, os.clock() - t)
end
print(("step\tpeer\tleapfrog, one Kepler orbit\t%s\t%.2f\t0"):format(name, best / count * 1e9))
