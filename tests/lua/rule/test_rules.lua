-- every claim of dm.rules(), measured: order, symplecticity, symmetry, momentum, forces a step; orders from 1 to 16. With a name
-- behind the file's (dmlua tests/lua/rule/test_rules.lua ruth3) those of that rule alone
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos, pi, log = math.sin, math.cos, math.pi, math.log

local twisted = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 * (1 + q[1] ^ 2 / 3 + q[2] ^ 2 / 5) + v[1] * v[2] * sin(q[2]) / 3 + cos(q[1]) * cos(q[2])
end }
local plain = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + cos(q[1]) * cos(q[2] - q[1] / 3) end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.4, 0.3 }, v = { 0.5, 0.7 } }
local function run(system, rule, s, T, N)
  local path = system:solver { rule = rule, h = T / N }:run { q = s.q, v = s.v, steps = N, every = N }
  return path.q[#path], path.p[#path]
end

-- rules that need L = T(v) - V(q) say so, and get one
local systems = {}
local function system_for(rule)
  if not systems[rule] then
    local fine, why = pcall(run, twisted, rule, start, 0.01, 1)
    if not fine and not tostring(why):find "need.* a separable L" then error(why) end
    systems[rule] = fine and twisted or plain
  end
  return systems[rule]
end
local function distance(q, p, Q, P) return ((q - Q):norm() ^ 2 + (p - P):norm() ^ 2) ^ 0.5 end

-- exponents between the runs N[k] and N[k + 2], the last ones above the floor; where what comes next is N^-2 smaller, as in
-- symmetric rules, it is taken out by extrapolation
local function exponent(errors, floor, extrapolate)
  local p, before, e
  for k = 1, #errors - 2 do
    local a, b = errors[k], errors[k + 2]
    if b[2] > floor then
      before, p, e = p and { p, e[1] }, log(a[2] / b[2]) / log(b[1] / a[1]), b
    end
  end
  if extrapolate and before then
    local x, y = before[2] ^ -2, e[1] ^ -2
    p = (p * x - before[1] * y) / (x - y)
  end
  return p, e and e[2]
end

-- up to order 6 against gauss(8) at small steps, where nothing is symmetric or periodic
local references = {}
for _, system in ipairs { twisted, plain } do references[system] = { run(system, "gauss(8)", start, 2, 60) } end
local function generic(r)
  local rule = r.rule
  local system, errors = system_for(rule), {}
  local Q, P = table.unpack(references[system])
  for _, N in ipairs { 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320, 448, 640, 896, 1280, 1792, 2560 } do
    local q, p = run(system, rule, start, 2, N)
    errors[#errors + 1] = { N, distance(q, p, Q, P) }
    if errors[#errors][2] < 1e-13 then break end
  end
  return exponent(errors, 3e-13, r.symmetric)
end

-- from order 7 on the circle q = (cos t, sin t) of Kepler's problem, exactly: error constants are reached at large steps. A
-- rule of odd order and its adjoint differ by twice their odd error, in which the next order does not mix. Errors of starts all
-- around, and of circles of other radii, are the same but for rotation and scale: their mean has less round-off, which beside an
-- error above 1e-11 is nothing with a few of them.
local STARTS, FEW = 192, 16
local function turned(d, a) return { cos(a) * d[1] + sin(a) * d[2], cos(a) * d[2] - sin(a) * d[1] } end
local function mean_of(starts, rule, adjoint, T, N)
  local sum = { 0, 0, 0, 0 }
  for k = STARTS // starts, STARTS, STARTS // starts do
    local a = 0.3 + 2 * pi * k / STARTS
    local b, R = a + T, 4 ^ (k * 7 % STARTS / STARTS)
    local V = R ^ -0.5
    local s = { q = { R * cos(a), R * sin(a) }, v = { -V * sin(a), V * cos(a) } }
    local done, q, p = pcall(run, kepler, rule, s, T * R / V, N)
    local also, Q, P = true, dm.vector { R * cos(b), R * sin(b) }, dm.vector { -V * sin(b), V * cos(b) }
    if adjoint then also, Q, P = pcall(run, kepler, adjoint, s, T * R / V, N) end
    if not (done and also) then return math.huge end
    local dq, dp = turned((q - Q) * (1 / R), b), turned((p - P) * (1 / V), b)
    for i = 1, 2 do sum[i], sum[2 + i] = sum[i] + dq[i] / starts, sum[2 + i] + dp[i] / starts end
  end
  return (sum[1] ^ 2 + sum[2] ^ 2 + sum[3] ^ 2 + sum[4] ^ 2) ^ 0.5
end
local function mean_error(...)
  local e = mean_of(FEW, ...)
  return e > 1e-11 and e or mean_of(STARTS, ...)
end

-- x of A x = b, 3 x 3, by Cramer's rule
local function determinant(A)
  return A[1][1] * (A[2][2] * A[3][3] - A[2][3] * A[3][2]) - A[1][2] * (A[2][1] * A[3][3] - A[2][3] * A[3][1])
    + A[1][3] * (A[2][1] * A[3][2] - A[2][2] * A[3][1])
end
local function second_of(A, b)
  local B = {}
  for i = 1, 3 do B[i] = { A[i][1], b[i], A[i][3] } end
  return determinant(B) / determinant(A)
end

-- log e = c - p log N + d / N^2 by least squares, each error known to its round-off; without symmetry from neighbours
local function circle(r)
  local T, count = r.order > 14 and 10 or 8, 0
  local adjoint = r.order % 2 == 1 and r.rule:find "radau%(" and r.rule:gsub("radau", "radau-left")
  local A, b, e, errors = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } }, { 0, 0, 0 }, nil, {}
  for _, N in ipairs { 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 256 } do
    e = mean_error(r.rule, adjoint, T, N)
    if e < 5e-15 then break end
    local x, w = { 1, -log(N), (10 / N) ^ 2 }, 1 / (0.005 + 1e-15 / e)
    errors[#errors + 1] = { N, e }
    if e < 1e-9 then
      count = count + 1
      for i = 1, 3 do
        for j = 1, 3 do A[i][j] = A[i][j] + w ^ 2 * x[i] * x[j] end
        b[i] = b[i] + w ^ 2 * x[i] * log(e)
      end
    end
  end
  if not (r.symmetric or adjoint) then return exponent(errors, 1e-12) end
  return count > 3 and second_of(A, b) or nil, e
end

-- on the circle rk8pd shows the order of its next term, elsewhere blanes-moan(6, 14) does, until round-off comes
local problems = { rk8pd = generic, ["curve(fehlberg7)"] = generic, ["curve(dop853)"] = generic, ["blanes-moan(6, 14)"] = circle }
local orders = {}
local function check_order(r)
  local p, e = (problems[r.rule] or r.order > 6 and circle or generic)(r)
  near(p or 0, r.order, 0.1, ("%s has order %d"):format(r.rule, r.order))
  if not (p and math.abs(p - r.order) < 0.1) then print("# at the error " .. tostring(e)) end
  orders[r.order] = true
end

-- the exact tangent of two steps, and the way back
local function check_structure(r)
  local solver = system_for(r.rule):solver { rule = r.rule, h = r.order > 10 and 1.2 or r.order > 6 and 0.8 or 0.3 }
  local defect = solver:symplecticity { q = start.q, v = start.v, steps = 2 }
  if r.symplectic then
    ok(defect < 1e-12, "  symplectic", defect)
  else
    ok(defect > 1e-9, "  not symplectic, as it says", defect)
  end
  local gap = solver:reversal { q = start.q, v = start.v, steps = 2 }
  if r.symmetric then
    ok(gap < 3e-14, "  symmetric", gap)
  else
    ok(gap > 1e-13, "  not symmetric, as it says", gap)
  end
end

-- symplectic rules keep the momentum map of the rotations of the plane
local function check_momentum(r)
  local path = kepler:solver { rule = r.rule, h = 0.1 }:run { q = { 1, 0.1 }, v = { 0.2, 0.9 }, steps = 200 }
  local J, worst = path:momentum(dm.SO(2)), 0
  for i = 1, #J do worst = math.max(worst, math.abs(J[i] - J[1])) end
  if r.symplectic then ok(worst < 1e-13, "  angular momentum", worst) end
end

local function check_cost(r)
  local solver = plain:solver { rule = r.rule, h = 0.1 }
  solver:run { q = start.q, v = start.v, steps = 4096, every = 4096 }
  local report = solver:report()
  if r.forces > 0 then near(report.evaluations / report.steps, r.forces, 0.05, "  forces a step") end
end

-- measured with what they are for
local elsewhere = { step = "test_step.lua", degenerate = "test_degenerate.lua", del = "test_solver.lua, test_discrete.lua",
  map = "test_discrete_steps.lua", ["log-hamiltonian"] = "test_times.lua", rattle = "test_rattle.lua",
  shake = "test_rattle.lua", rotations = "test_lift.lua", rkmk4 = "test_explicit.lua",
  ["crouch-grossman3"] = "test_explicit.lua", sem = "test_sem.lua",
  trial = "test_trial.lua, test_multiscale.lua" }
local function check(rule)
  ok(#rule.instances > 0 or elsewhere[rule.name], rule.name .. " is measured")
  ok(rule.order and rule.stages and rule.cost, rule.name .. " says its order, stages and cost")
  for _, r in ipairs(rule.instances) do
    check_order(r)
    check_structure(r)
    check_momentum(r)
    check_cost(r)
    ok(r.symplectic == rule.symplectic and (r.symmetric or not rule.symmetric), "  has what its family has")
    ok(twisted:solver({ rule = r.rule, h = 1 }).order == r.order, "  its solver says the order")
  end
end
local checked = 0
for _, rule in ipairs(dm.rules()) do
  if not arg[1] or rule.name == arg[1] then checked = checked + 1 check(rule) end
end
ok(checked > 0, "there are rules to check", arg[1])
for p = 1, arg[1] and 0 or 16 do ok(orders[p], ("there is a rule of order %d"):format(p)) end
tap.done()
