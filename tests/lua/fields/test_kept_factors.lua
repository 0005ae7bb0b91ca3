-- nearly linear fields keep the factors of an earlier step: what they step is the same L written out, a restart and a member of an
-- ensemble have the bits of a run, whatever was stepped before
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local K = dm.mesh { icosphere = 1 }
local star, edges, weight = K:star_weights(0), K:simplices(1), K:star_weights(1)
local n = #star

-- waves with - sum |*v| k u^4/4, and the force -c u' beside them
local function field_of(k, c)
  return K:field { L = function(u, w)
    return w:dot(w) / 2 - u:d():dot(u:d()) / 2 - k * K:sum(0, function(a, cell) return cell.star * a ^ 4 / 4 end, u)
  end, force = c and function(_, w) return -c * w end }
end
local function written_out(k, c)
  return dm.system { Q = dm.R(n), L = function(x, y)
    local L = 0
    for i = 1, n do L = L + star[i] * (y[i] ^ 2 / 2 - k * x[i] ^ 4 / 4) end
    for e = 1, #edges do L = L - weight[e] * (x[edges[e][1]] - x[edges[e][2]]) ^ 2 / 2 end
    return L
  end, force = c and function(_, y)
    local f = {}
    for i = 1, n do f[i] = -c * star[i] * y[i] end
    return f
  end }
end
local function start(shift)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = math.sin(i + shift), math.cos(2 * i) end
  return q, v
end

local STEPS, FIRST = 40, 17
for _, case in ipairs { { "midpoint", 1e-3 }, { "midpoint", 0.3 }, { "midpoint", 30 }, { "gauss(2)", 1e-2 }, { "lobatto(3)", 1e-2 },
  { "midpoint", 1e-2, 0.2 }, { "gauss(2)", 0.3, 0.2 } } do
  local rule, k, c = table.unpack(case)
  local what = ("%s, %g u^4%s"):format(rule, k, c and ", drag" or "")
  local field, q, v = field_of(k, c), start(0)
  local solver = field:solver { rule = rule, h = 0.5 }
  local run = solver:run { q = q, v = v, steps = STEPS, every = STEPS }
  local same = written_out(k, c):solver { rule = rule, h = 0.5 }:run { q = q, v = v, steps = STEPS, every = STEPS }
  local apart = (run.q[2] - same.q[2]):norm()
  ok(apart < 1e-9, what .. ": as written out", apart)

  local file = os.tmpname()
  solver:run { q = q, v = v, steps = FIRST, every = FIRST }:checkpoint(file)
  local rest = dm.resume(file, field):run { steps = STEPS - FIRST }
  os.remove(file)
  ok(rest.q[#rest] == run.q[2] and rest.p[#rest] == run.p[2], what .. ": a run that goes on has the same bits")

  local e = solver:ensemble { members = 3, steps = STEPS, threads = 1, q = function(i) return (start(i - 2)) end, v = function() return v end }
  ok(e.q[2] == run.q[2], what .. ": so has a member between others")
end
tap.done()
