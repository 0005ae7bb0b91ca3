-- What does a tall soliton do to a small one? It overtakes it, and both go on as they were, displaced: u_t + 6 u u_x +
-- u_xxx = 0 (Korteweg & de Vries 1895; Zabusky & Kruskal 1965), a multisymplectic equation, by Preissman's box.
local dm = require "dm"
local cosh, log, abs = dm.cosh, math.log, math.abs
local folder = arg and arg[1] or "."

-- M z_t + K z_x = grad S(z) with phi_x = u, v = u_x and w = v_x + 3 u^2 + phi_t/2
local kdv = dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, x = { -20, 20, 401, periodic = true },
  M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } },
  K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
  S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }

-- of speed 4 k^2; two that are far apart are a solution but for their tails
local tall, small = 1, 0.6
local function soliton(k, x) return 2 * k ^ 2 / cosh(k * x) ^ 2 end
local run = kdv:solver { h = 0.005 }:run { t = 5, every = 20,
  z = { u = function(x) return soliton(tall, x + 8) + soliton(small, x) end } }
print(run)

-- the highest top of a row, by the parabola through three nodes
local function top(u)
  local i = 2
  for k = 3, #u - 1 do i = u[k] > u[i] and k or i end
  local a, b, c = u[i - 1], u[i], u[i + 1]
  return run.nodes[i] + (run.nodes[2] - run.nodes[1]) * (a - c) / (2 * (a - 2 * b + c)), b
end
local place, height = top(run.u[#run.t])
local alone = -8 + 4 * tall ^ 2 * 5
local ahead = log((tall + small) / (tall - small)) / tall -- Hirota 1971
print(("the tall one is %.2f ahead of where it would be alone, by the exact solution %.2f; height %.3f")
  :format(place - alone, ahead, height))
assert(abs(place - alone - ahead) < 0.06 and abs(height - 2) < 0.02, "a collision of solitons")
assert(run:drift "energy".largest < 1e-3 and run:drift "momentum".largest < 5e-3, "what boxes nearly keep")

local rows = {}
for i = 1, #run.t, 10 do
  rows[#rows + 1] = { x = run.nodes, y = run.u[i] + 1.5 * (#rows), name = ("t = %g"):format(run.t[i]) }
end
dm.plot(rows, { file = folder .. "/kdv.png", title = "A tall soliton overtakes a small one", xlabel = "x",
  ylabel = "u, each row 1.5 above the one before", legend = false })
print("picture  " .. folder .. "/kdv.png")
