-- make bench: P9, a Strang step of a wave (V = x^2/2) beside a hand-written loop over FFTW with the same plans
-- (tests/bench/c/by_hand/waves.c, built by tests/bench/run), taking turns; beside them the loop with plans that
-- FFTW chose by timing, and the step with GSL's transforms. ns a step, the best of many, CPU time.
local dm = require "dm"
local lua, hand = os.getenv "DMLUA" or arg[-1] or "build/dmlua", (os.getenv "B" or "build") .. "/bench/waves"

local SIZES = { { 256, 20000, 1.2 }, { 1024, 5000, 1.1 }, { 4096, 3000, 1.05 } }

local function step_of(N, steps, rounds)
  local wave = dm.schroedinger { x = { -10, 10, N }, V = function(x) return x ^ 2 / 2 end }
  local solver, best = wave:solver { rule = "strang", h = 0.01 }, math.huge
  local start = solver:run { psi = function(x) return math.exp(-(x - 1) ^ 2 / 2) end, steps = 0 }.psi[1]
  for _ = 1, rounds do
    local began = os.clock()
    solver:run { psi = start, steps = steps, every = steps }
    best = math.min(best, os.clock() - began)
  end
  return best / steps * 1e9, solver:report().fft
end
if arg[1] == "step" then
  print((step_of(tonumber(arg[2]), tonumber(arg[3]), 10)))
  return
end

local function told(command)
  local pipe = io.popen(command .. " 2>/dev/null")
  local number = pipe:read "n"
  pipe:close()
  return number
end

print "\nP9: a Strang step of a wave, ns"
print(("%-8s %9s %9s %7s %7s %14s %9s"):format("N", "dmlua", "by hand", "ratio", "bound", "hand, measured", "GSL"))
for _, size in ipairs(SIZES) do
  local N, steps, bound = table.unpack(size)
  local own, by_hand, measured = math.huge, math.huge, math.huge
  local function by(plan) return told(("%s %d %d %s"):format(hand, N, steps, plan)) end
  for _ = 1, 4 do
    own = math.min(own, (step_of(N, steps, 10)))
    by_hand = math.min(by_hand, by "estimate" or math.huge)
    measured = math.min(measured, by "measure" or math.huge)
  end
  local gsl = told(("DMLUA_FFT=no %s tests/bench/waves.lua step %d %d"):format(lua, N, steps // 4))
  print(("%-8d %9.0f %9.0f %7.2f %7.2f %14.0f %9.0f"):format(N, own, by_hand, own / by_hand, bound, measured,
    gsl or 0 / 0))
end
