-- what a run leaves undone until it is needed: the kernel of Newton's method behind sweeps, points of a comparison
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

-- a chain of stiff springs between walls, h where sweeps do not contract
local n, stiff = 6, 1e4
local function chain(q, v)
  local L = v:dot(v) / 2 - stiff / 2 * q[1] ^ 2 - 25 * q[n] ^ 4
  for i = 2, n do L = L - stiff / 2 * (q[i] - q[i - 1]) ^ 2 + dm.cos(q[i]) end
  return L
end
local q, v, steps = { 0.1, -0.2, 0.3, 0.1, -0.1, 0.2 }, { 1, 0, 0, -1, 0, 0.5 }, 20
local function solver(rule, backend)
  return dm.system({ Q = dm.R(n), L = chain }):solver { rule = rule, h = 0.02, backend = backend }
end
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)", "yoshida(midpoint)" } do
  local alone = solver(rule)
  local path = alone:run { q = q, v = v, steps = steps }
  ok(alone:report().newton > 0, rule .. ": steps that sweeps cannot take go by Newton's method", alone:report().newton)
  local taped = solver(rule, "tape"):run { q = q, v = v, steps = steps }
  -- an ensemble has all kernels before its first step
  local members = solver(rule):ensemble { members = 3, q = function() return q end, v = function() return v end, steps = steps, threads = 2 }
  local again = alone:run { q = q, v = v, steps = steps }
  local same, there = true, true
  for i = 1, n do
    local x = path.q[steps + 1][i]
    same = same and x == taped.q[steps + 1][i] and x == again.q[steps + 1][i]
    there = there and x == members.q[3][i]
  end
  ok(same, rule .. ": the same bits on the tape, and where the kernel is there already")
  ok(there, rule .. ": and as a member of an ensemble")
end

-- a function of thousands of operations is compared in fewer points; what differs there is seen all the same
local function long(term)
  return dm.system { Q = dm.R(3), L = function(a, b)
    local L = b:dot(b) / 2
    for i = 1, 800 do L = L + dm.sin(i * a[1]) * a[2] + a[3] / i end
    return L + term(a)
  end }
end
local function start(term) return long(term):solver({ rule = "verlet", h = 1e-3 }):run { q = { 0, 0.1, 0.2 }, v = { 0, 0, 0 }, steps = 1 } end
ok(#start(function() return 0 end) == 2, "a long function runs")
raises("is not what its trace says", start, function(a) return type(a[1]) == "number" and 1 or 0 end)
raises("is not what its trace says", start, function(a) return a[1] == 0 and 1 or 0 end)
local calls = 0
raises("gives different values for the same arguments", start, function(a)
  calls = calls + 1
  return calls * a[2]
end)
tap.done()
