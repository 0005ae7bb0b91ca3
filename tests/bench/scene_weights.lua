-- tests/bench/scene_weights.lua [MODEL [ROUNDS]] - are the operations that scenes count worth the same ns for every rule? For each model: of all rules
-- that step it ns for an operation, the least of three rounds over all of them, over the median of these; how many are inside of 0.7 to 1.4, and those
-- that are not. MODEL "all": every one.
local dm = require "dm"
local model_of = require "dm.scene.model"
local whole = require "dm.scene.whole"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local search = require "dm.scene.search"

local cos, sqrt = math.cos, math.sqrt

local function three(q, v)
  local L = 0
  for i = 1, 3 do
    L = L + (2 + i) / 2 * (v[2 * i - 1] ^ 2 + v[2 * i] ^ 2)
    for j = 1, i - 1 do L = L + (2 + i) * (2 + j) / sqrt((q[2 * i - 1] - q[2 * j - 1]) ^ 2 + (q[2 * i] - q[2 * j]) ^ 2) end
  end
  return L
end
local function chain(q, v)
  local U = (q[1] ^ 2 + q[10] ^ 2) / 2
  for i = 1, 9 do U = U + (q[i + 1] - q[i]) ^ 2 / 2 + (q[i + 1] - q[i]) ^ 4 / 40 end
  return v:dot(v) / 2 - U
end
-- name, system, q, v, until_t, steps
local MODELS = {
  { "kepler", { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, { 0.4, 0 }, { 0, 2 }, 20, 2000 },
  { "double", { Q = dm.R(2), L = function(q, v)
    return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 9.81 * (2 * cos(q[1]) + cos(q[2]))
  end }, { 0.6, 0.4 }, { 0, 0 }, 10, 2000 },
  { "henon", { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3 end }, { 0, 0.1 }, { 0.3, 0.1 }, 20, 1000 },
  { "rod", { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end }, { 0.6, -0.8 },
    { 0.8, 0.6 }, 10, 1000 },
  { "rods", { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - q[2] - q[4] end, constraint = function(q)
    return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 }
  end }, { 0.6, -0.8, 0.6, -1.8 }, { 0, 0, 0, 0 }, 10, 1000 },
  { "three", { Q = dm.R(6), L = three }, { 1, 3, -2, -1, 1, -1 }, { 0, 0, 0, 0, 0, 0 }, 1, 1000 },
  { "pendulum", { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }, { 1 }, { 0.3 }, 20, 1000 },
  { "driven", { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + cos(q[1]) + 0.1 * q[1] * cos(t) end, force = function(_, v) return -0.1 * v end },
    { 1 }, { 0.3 }, 20, 1000 },
  { "chain", { Q = dm.R(10), L = chain }, { 1, 0, -1, 0, 1, 0, -1, 0, 1, 0 }, { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }, 10, 500 },
  { "body", { Q = dm.SO(3), L = function(g, xi) return (xi[1] ^ 2 + 2 * xi[2] ^ 2 + 3 * xi[3] ^ 2) / 2 - g[3][3] end },
    { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0.1, 2, 0.1 }, 10, 500 },
}

local function rates(row)
  local system = dm.system(row[2])
  local problem = (whole.is(system) and whole or model_of).problem(system, { q = row[3], v = row[4], until_t = row[5],
    watch = { system.place and "energy" or "q1" }, tolerance = 1e-6 })
  local model, counted, out = model_of.given(problem):ready(), profile.new(), {}
  for _, rule in ipairs(search.rules(nil, model.system)) do
    local N = pilot.is_even(rule.rule) and row[6] or 64
    local fine, work = pcall(counted.cost, counted, model, rule.rule, N)
    if fine then out[#out + 1] = { rule = rule.rule, N = N, work = work, rate = math.huge } end
  end
  -- in turn, so that what else the machine does meets all of them alike
  for _ = 1, tonumber(arg[2]) or 3 do
    for _, c in ipairs(out) do c.rate = math.min(c.rate, profile.time(model, c.rule, c.N) / c.work) end
  end
  table.sort(out, function(a, b) return a.rate < b.rate end)
  return out
end

for _, row in ipairs(MODELS) do
  if not arg[1] or arg[1] == "all" or arg[1] == row[1] then
    local all, inside, others = rates(row), 0, {}
    local median = all[(#all + 1) // 2].rate
    for _, c in ipairs(all) do
      local part = c.rate / median
      if part >= 0.7 and part <= 1.4 then inside = inside + 1 else others[#others + 1] = ("%s %.2f"):format(c.rule, part) end
    end
    print(("%-8s %d rules, %.2f ns an operation; %d inside of 0.7 to 1.4 of it; %s"):format(row[1], #all, median, inside, table.concat(others, ", ")))
  end
end
