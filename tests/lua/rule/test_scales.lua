-- units of time far from 1: with q as it is, h in 2^-e and frequencies in 2^e of theirs, steps have the same bits
local tap = require "tap"
local dm = require "dm"

local function slow(w)
  return dm.system { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - w * w * (q[1] * q[2] ^ 2 + math.cos(q[1]) + q[2] ^ 2)
  end }
end
local function top(w)
  return dm.system { Q = dm.SO(3), L = function(R, v)
    return (v[1] ^ 2 + 2 * v[2] ^ 2 + 1.5 * v[3] ^ 2) / 2 - w * w * R[3][3]
  end }
end
local cases = {
  { slow, { "verlet", "midpoint", "gauss(2)", "gauss(3)", "lobatto(3)", "rk4" },
    { 0.3, 0.2 }, { 0.1, 0.5 } },
  { top, { "lie(2)", "gauss(2)", "lobatto(3)", "rotations(2)" },
    dm.SO(3):exp { 0.4, 0.2, 0 }, { 0.1, 0.5, 0.2 } },
}
for _, case in ipairs(cases) do
  for _, rule in ipairs(case[2]) do
    local function run(e)
      local w = 2.0 ^ e
      return case[1](w):solver { rule = rule, h = 0.05 / w }
        :run { q = case[3], v = dm.vector(case[4]) * w, steps = 20 }
    end
    local usual = run(0)
    for _, e in ipairs { -90, 70, 160 } do
      local path, worst = run(e), 0
      for k = 1, #usual.columns do
        local name = usual.columns[k]
        if name:find "^q" then
          worst = math.max(worst, math.abs(path:column(name)[21] - usual:column(name)[21]))
        end
      end
      tap.ok(worst <= 1e-15, ("%s: h = 0.05 * 2^%d"):format(rule, -e), worst)
    end
  end
end
tap.done()
