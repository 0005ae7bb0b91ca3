-- A full constant mass whose units are far apart is regular or singular as it is in units of 1: by
-- a run against the run in units of 1, and by squares of one velocity less than there are
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
math.randomseed(71)
local function signed() return 2 * math.random() - 1 end

-- T = sum of squares of `rows`(v/s), V = |q/s|^2/2
local function model(rows, s)
  return dm.system { Q = dm.R(#s), L = function(q, v)
    local L = 0
    for i = 1, #s do L = L - (q[i] / s[i]) ^ 2 / 2 end
    for _, row in ipairs(rows) do
      local w = 0
      for i = 1, #s do w = w + row[i] * v[i] / s[i] end
      L = L + w ^ 2 / 2
    end
    return L
  end }
end

local function last(rows, s, q, v, rule)
  local at, speed = {}, {}
  for i = 1, #s do at[i], speed[i] = q[i] * s[i], v[i] * s[i] end
  local path = model(rows, s):solver { rule = rule, h = 0.05 }:run { q = at, v = speed, steps = 50 }
  local z = path.q[#path.q]:totable()
  for i = 1, #s do z[i] = z[i] / s[i] end
  return z
end

local function numbers(n, f)
  local list = {}
  for i = 1, n do list[i] = f(i) end
  return list
end

local worst, refused, taken = 0, 0, 0
for k = 1, 240 do
  local n = math.random(2, 4)
  local s = numbers(n, function() return 10 ^ (9 * signed()) end)
  local rows = numbers(n, function(i)
    return numbers(n, function(j) return signed() + (i == j and 2.5 or 0) end) end)
  local q, v = numbers(n, signed), numbers(n, signed)
  local rule = ({ "verlet", "gauss(2)", "midpoint" })[k % 3 + 1]
  local fine, z = pcall(last, rows, s, q, v, rule)
  if fine then
    local known = last(rows, numbers(n, function() return 1 end), q, v, rule)
    for i = 1, n do worst = math.max(worst, math.abs(z[i] - known[i])) end
  else
    refused = refused + 1
  end
  rows[n] = nil
  if pcall(last, rows, s, q, v, rule) then taken = taken + 1 end
end
ok(refused == 0, "regular masses in all units are stepped", refused)
ok(worst < 1e-9, "as in units of 1", worst)
ok(taken == 0, "singular masses in all units are refused", taken)
tap.done()
