-- What do a kink and an antikink do to each other? They pass, each ahead of where it would have been alone.
-- u_tt - u_xx + sin u = 0, on bilinear cells of space and time (Leok 5.1).
local dm = require "dm"

local v = 0.5
local g = 1 / math.sqrt(1 - v * v)

-- the exact solution: kink and antikink that meet at t = 0 (Perring, Skyrme 1962)
local function exact(x, t) return 4 * math.atan(dm.sinh(g * v * t) / (v * dm.cosh(g * x))) end

local t0, dt = -12, 1e-5
local field = dm.field { x = { -25, 25, 400 }, fixed = "ends",
  L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 - (1 - dm.cos(u)) end }
local run = field:solver { rule = "cell(gauss(2))", h = 0.0625 }:run { t0 = t0, t = 24, every = 8,
  u = function(x) return exact(x, t0) end,
  ut = function(x) return (exact(x, t0 + dt) - exact(x, t0 - dt)) / (2 * dt) end }
print(run)

local worst = 0
for i, x in ipairs(run.nodes:totable()) do
  worst = math.max(worst, math.abs(run.u[#run][i] - exact(x, run.t[#run])))
end
print(("off by %.2g after the collision"):format(worst))
assert(worst < 0.02)

-- where u passes pi on its way down: at v t, had it met nobody; it is ahead by log(1/v)/g
local function place(row)
  local u = run.u[row]
  for i = 2, #u do
    if u[i - 1] >= math.pi and u[i] < math.pi then
      return run.nodes[i - 1] + (u[i - 1] - math.pi) / (u[i - 1] - u[i]) * field.dx
    end
  end
end
local ahead = math.log(1 / v) / g
print(("the right one stands at %.3f, alone at %.3f; ahead by %.3f in theory"):format(place(#run), v * 12, ahead))
assert(math.abs(place(#run) - (v * 12 + ahead)) < 0.02)

-- what the cells keep: the multisymplectic form to round-off, energy without drift
local form = run:multisymplectic()
print(("form formula %.1e, energy off by %.1e"):format(form, run:drift "energy".largest))
assert(form < 1e-11 and run:drift "energy".largest < 1e-3 * run.energy[1])

if arg and arg[1] then run:plot("u", { file = arg[1] .. "/kinks.png", title = "kink and antikink of sine-Gordon, v = 1/2" }) end
