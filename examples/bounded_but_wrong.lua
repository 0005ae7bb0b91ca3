-- Bounded, and wrong: Verlet keeps the energy of an orbit in a band for ever, and is at the wrong place nevertheless. A
-- map over a duration tells the two apart; the moving picture shows Verlet beside the truth: energy fine, phase lost.
local dm = require "dm"
local folder = arg and arg[1] or "."

local kepler = dm.system { name = "Kepler", Q = dm.R(2), coordinates = { "x", "y" },
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.4, 0 }, v = { 0, 2 }, t = 20 * math.pi }

-- up to which step each rule is bounded, and up to which it is right, to a hundredth of the range of x and y
local map = kepler:stability { rules = { "verlet", "blanes-moan(6)", "gauss(4)" }, q = start.q, v = start.v, t = start.t,
  h = { 0.002, 0.3, 30, "log" } }
print(map)
for i, rule in ipairs(map.rules) do
  local right, bounded = map:limit(i, "right"), map:limit(i)
  print(("%-15s right up to h = %-8.4g bounded %s"):format(rule, right,
    bounded < math.huge and ("up to h = %.4g"):format(bounded) or "on the whole map"))
  assert(right < bounded)
end

-- one cell: the energy error is a hundredth and stays there; the planet is late by a good part of a turn
local wrong = kepler:stability { rule = "verlet", q = start.q, v = start.v, t = start.t, h = 0.05 }:at(1, 1)
print(wrong.why)
assert(wrong.class == "wrong" and wrong.error < 0.02 and wrong.off > 0.5 * wrong.range)

-- Verlet and the truth side by side, seen in x and y
local function rows(rule, h)
  return kepler:solver { rule = rule, h = h }:run { q = start.q, v = start.v,
    at = (function() local at = {} for i = 1, 400 do at[i] = start.t * i / 400 end return at end)() }
end
local verlet, truth = rows("verlet", 0.05), rows("gauss(6)", 0.05)
local apart = 0
for i = 1, #verlet do apart = math.max(apart, (verlet.q[i] - truth.q[i]):norm()) end
local energy, change = verlet:energy(), 0
for i = 1, #energy do change = math.max(change, math.abs(energy[i] - energy[1])) end
print(("energy of Verlet within %.2g of its start, position off by up to %.2g"):format(change, apart))
assert(apart > 0.5)
verlet:animate(folder .. "/bounded_but_wrong.html", { title = "Verlet, and the truth", plots = { "energy" }, trail = 4, dim = 2,
  draw = function(q, t)
    local r = truth.q[math.max(1, math.min(#truth, math.floor(t / start.t * 400 + 0.5)))]
    return { points = { { 0, 0 }, { q[1], q[2] }, { r[1], r[2] } }, rods = { { 1, 2 }, { 1, 3 } } }
  end })
