-- solver:ensemble: members equal single runs, threads do not matter, failures stay alone; then misuse
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function q0(i) return { 0.4 + i * 1e-3, 0 } end
local function v0(i) return { 0, 2 - i * 1e-3 } end

for _, rule in ipairs { "verlet", "kahan-li(6)", "blanes-moan(6, 14)", "gauss(2)", "rk8pd", "log-hamiltonian(yoshida(4))" } do
  local solver = kepler:solver { rule = rule, h = 0.01 }
  local one = solver:ensemble { members = 41, q = q0, v = v0, steps = 30, threads = 1 }
  local many = solver:ensemble { members = 41, q = q0, v = v0, steps = 30, threads = 5 }
  local same, threads = true, one.q == many.q and one.p == many.p
  for i = 1, 41 do
    local path = solver:run { q = q0(i), v = v0(i), steps = 30, every = 30 }
    same = same and path.q[2] == one.q[i] and path.p[2] == one.p[i]
  end
  ok(same, rule .. ": members are single runs, bit for bit")
  ok(threads, rule .. ": five threads give the same bits as one")
end

-- starts from tables and matrices, momenta, a duration
local solver = kepler:solver { rule = "verlet", h = 0.01 }
local rows = solver:ensemble { members = 2, q = dm.matrix { { 0.4, 0 }, { 0.5, 0 } }, p = { { 0, 2 }, { 0, 1.5 } }, t = 0.3 }
ok(rows.steps[1] == 30 and rows.t == 0.3 and #rows == 2, "starts from a matrix and a table, a duration")
ok(rows.q[1] == solver:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 30 }.q[31], "and the same end")
ok(tostring(rows):find "2 members", "an ensemble prints itself", tostring(rows))

-- a member that leaves the domain of its Lagrangian
local bowl = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.sqrt(1 - q[1] ^ 2) end }
for _, rule in ipairs { "verlet", "gauss(2)" } do
  local mixed = bowl:solver({ rule = rule, h = 0.05 }):ensemble { members = 40, threads = 3, steps = 400,
    q = function() return { 0 } end, v = function(i) return { i % 20 == 5 and 10 or 0.5 } end }
  local failures = mixed:failures()
  ok(#failures == 2 and failures[1].member == 5 and failures[2].member == 25, rule .. ": two members fail alone", #failures)
  ok(mixed.status[4] == "ok" and mixed.steps[4] == 400 and mixed.steps[5] < 400, rule .. ": the others finish")
  ok(mixed.q[5][1] == mixed.q[5][1], rule .. ": a failed member keeps its last good state")
end
local lost = bowl:solver({ rule = "verlet", h = 0.05 }):ensemble { members = 2, steps = 1, q = function(i) return { i - 1 + 0.5 } end, v = function() return { 0 } end }
ok(lost.status[1] == "ok" and lost.status[2] == "not_finite", "a start outside the domain is one member's failure", lost.status[2])

-- misuse
local good = { members = 2, q = q0, v = v0, steps = 1 }
local function with(changes)
  local options = {}
  for key, value in pairs(good) do options[key] = value end
  for key, value in pairs(changes) do if value == "none" then options[key] = nil else options[key] = value end end
  return solver:ensemble(options)
end
raises("'members'", with, { members = 0 })
raises("'members'", with, { members = "none" })
raises("at most", with, { members = 1e12 })
raises("'q' of member 1 must have 2 entries", with, { q = function() return { 1 } end })
raises("'v' of member 2", with, { v = function(i) return i == 1 and { 0, 1 } or { 0, "x" } end })
raises("rows for 2 members", with, { q = { { 1, 0 } } })
raises("field 'q' must be a function", with, { q = 3 })
raises("one of 'v' and 'p'", with, { v = "none" })
raises("'threads'", with, { threads = 0 })
raises("at most 256", with, { threads = 1000 })
raises("'steps'", with, { steps = "none" })
raises("did you mean", with, { membres = 3 })
raises("oops", with, { q = function() error "oops" end })
tap.done()
