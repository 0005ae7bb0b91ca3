-- ensembles of systems on groups in lanes: every member is a run of its own, bit for bit
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local SO3, SE3, SL2 = dm.SO(3), dm.SE(3), dm.SL(2)
local function top(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end
local function near_top(i) return SO3:exp { 0.4 + 0.01 * i, 0.02 * i, -0.01 * i } end
-- every fifth turns so fast that a large step leaves the chart
local function spin(i) return { 0.2 + 0.03 * i, 0.1, (i % 5 == 2 and 3.5 or 1.5) - 0.1 * i } end

local models = { -- name, system, q, p, small and large step
  { "top", dm.system { Q = SO3, L = top }, near_top, spin, 0.05, 0.5 },
  { "free body", dm.system { Q = SO3, L = function(_, w) return top({ 0, 0, { 0, 0, 0 } }, w) end }, near_top, spin, 0.1, 0.7 },
  { "driven, with friction", dm.system { Q = SO3, L = function(R, w, t) return top(R, w) + 0.2 * R[1][3] * dm.sin(3 * t) end,
    force = function(_, w) return -0.05 * w end }, near_top, spin, 0.05, 0.5 },
  { "right", dm.system { Q = SO3, trivialization = "right", L = function(R, w) return top(R, R:transpose() * w) end }, near_top, spin, 0.05, 0.4 },
  { "SE(3)", dm.system { Q = SE3, L = function(g, x)
    return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2 + 1.5 * x[4] ^ 2 + x[5] ^ 2 + 0.5 * x[6] ^ 2) / 2 - 0.5 * g[3][4] - 0.3 * g[1][4] ^ 2 - g[1][1]
  end }, function(i) return SE3:exp { 0.1, 0.2 + 0.01 * i, 0.3, 0.3, -0.2, 0.4 } end,
    function(i) return { 0.5, -0.4, 0.9, 0.3, 0.6 - 0.05 * i, i % 5 == 2 and 1 or -0.2 } end, 0.05, 0.6 },
  { "SL(2)", dm.system { Q = SL2, L = function(g, x)
    return (x[1] ^ 2 + 2 * x[2] ^ 2 + 1.5 * x[3] ^ 2) / 2 + 0.3 * x[1] * x[2] - (g[1][1] - 1) ^ 2 - g[1][2] ^ 2
  end }, function(i) return SL2:exp { 0.1, 0.2 + 0.01 * i, 0.3 } end, function(i) return { 0.4, -0.3 - 0.03 * i, 0.6 } end, 0.02, 0.3 },
  { "SL(3)", dm.system { Q = dm.SL(3), L = function(g, x) return x:dot(x) / 2 - (g[1][1] - 1) ^ 2 - g[1][2] ^ 2 end },
    function(i) return dm.SL(3):exp { 0.1, 0.2 + 0.01 * i, 0.3, 0, 0.1, 0, 0.2, 0 } end, function(i) return { 0.4, -0.3 - 0.03 * i, 0.6, 0, 0, 0, 0.1, 0 } end,
    0.02, 0.3 }, -- a matrix made row by row
}
local rules = { "lie(1)", "lie(2)", "lie(1, gauss(1), cayley)", "lie(2, lobatto(3))", "lie(2, pade(2))",
  "gauss(1)", "gauss(2)", "gauss(3)", "gauss(3, 4)", "lobatto(3)" }

local function same_element(a, b)
  if not a or not b then return a == b end
  for i = 1, a.rows do for j = 1, a.columns do if a[i][j] ~= b[i][j] then return false end end end
  return true
end

-- the first member that is not as alone: end, rows, status, steps; and how many fail
local function as_alone(model, rule, h, members, steps)
  local solver = model[2]:solver { rule = rule, h = h }
  local e = solver:ensemble { members = members, steps = steps, every = 7, t0 = 0.2, threads = 2, q = model[3], p = model[4] }
  local failures = 0
  for i = 1, members do
    local fine, path = pcall(solver.run, solver, { q = model[3](i), p = model[4](i), steps = steps, every = 7, t0 = 0.2 })
    local code, finished = "ok", steps
    if not fine then code, finished, path, failures = path.code, path.step - 1, path.path, failures + 1 end
    local rows = e:path(i)
    local same = same_element(path.q[#path], e.q[i]) and path.p[#path] == e.p[i] and #rows == #path
      and same_element(rows.q[2], path.q[2]) and rows.p[2] == path.p[2]
    if not same or code ~= e.status[i] or finished ~= e.steps[i] then return i, failures, e.lanes end
  end
  return nil, failures, e.lanes
end

local most = dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }):solver({ rule = "verlet", h = 0.01 })
  :ensemble({ members = 1, q = { { 1, 0 } }, v = { { 0, 1 } }, steps = 1 }).lanes
-- every model and every rule, and of the pairs one in three (SAMPLES=1: all)
local stride, narrow, refused, failed = math.min(4, 60 // tap.samples(60)), {}, {}, 0
for k, model in ipairs(models) do
  for j, rule in ipairs(model[1] == "SL(3)" and { "lie(1)", "lie(2)", "gauss(2)" } or rules) do
    local last = rule == "gauss(3, 4)" and 5 or 6 -- which ends in numbers that are none
    for h = 5, (j + k) % stride == 0 and last or 0 do
      local fine, unlike, failures, lanes = pcall(as_alone, model, rule, model[h], 11, 30)
      if fine then
        failed = failed + failures
        if lanes ~= most and not (model[1]:find "driven" and not rule:find "lie") then narrow[#narrow + 1] = model[1] .. " " .. rule end
        ok(not unlike, ("%s, %s, h = %g: members are single runs"):format(model[1], rule, model[h]), unlike)
      else
        refused[#refused + 1] = model[1] .. " " .. rule
      end
    end
  end
end
local known = { ["driven, with friction gauss(3, 4)"] = true, ["SL(2) gauss(3, 4)"] = true }
local others = {}
for _, name in ipairs(refused) do if not known[name] then others[#others + 1] = name end end
ok(#others == 0, "all rules step all models, but a number of sweeps", table.concat(others, ", "))
ok(#narrow == 0, "all of them in lanes", table.concat(narrow, ", "))
ok(failed > 20 / stride, "runs that leave the chart are among them", failed)
for _, members in ipairs { 1, most, 8 * most + 3 } do
  ok(not as_alone(models[1], "lie(1)", 0.05, members, 9), members .. " members as alone")
end

-- steps of their own, and those of the first lanes again in the next group
local function own(i) return 0.01 + 0.0005 * (i - 1) end
local function again(i) return own((i - 1) % most + 1) end
for _, rule in ipairs { "lie(2)", "midpoint", "gauss(2)", "gauss(3)", "gauss(2, 12)", "lobatto(3)",
  "verlet" } do
  for k, step in ipairs { own, again } do
    local paced = models[1][2]:solver({ rule = rule, h = 0.01 }):ensemble { members = 2 * most + 3,
      t = 0.3, h = step, q = near_top, p = spin }
    local same = true
    for i = 1, #paced do
      local path = models[1][2]:solver({ rule = rule, h = step(i) }):run { q = near_top(i),
        p = spin(i), steps = math.ceil(0.3 / step(i) - 1e-9) }
      same = same and same_element(path.q[#path], paced.q[i]) and path.p[#path] == paced.p[i]
    end
    ok(same, ("%s: members with steps of their own are such runs, %d"):format(rule, k))
    ok(paced.lanes == most, "in lanes", paced.lanes)
  end
end

-- the same ends whatever the processor offers
local dmlua = os.getenv "DMLUA" or arg[-1]
local script = [[
  local dm = require "dm"
  local G = dm.SO(3)
  local top = dm.system { Q = G, L = function(R, w) return (w[1]^2 + 1.2*w[2]^2 + 0.6*w[3]^2)/2 - R[3][3] end }
  for _, rule in ipairs { "lie(1)", "lie(2)", "lie(2, gauss(2), cayley)", "gauss(2)", "gauss(3, 5)", "gauss(5)", "lobatto(3)" } do
    local e = top:solver({ rule = rule, h = 0.05 }):ensemble { members = 11, steps = 40,
      q = function(i) return G:exp { 0.4 + i/100, 0, 0 } end, p = function(i) return { 0.2, 0.1, 1.5 } end }
    for i = 1, #e do print(("%a %a"):format(e.q[i][1][2], e.p[i][2])) end
  end]]
local function under(lanes, processor)
  local pipe = io.popen(("DMLUA_LANES=%d DMLUA_PROCESSOR=%s %s -e '%s' 2>&1"):format(lanes, processor, dmlua, script))
  local text = pipe:read "a"
  pipe:close()
  return text
end
for _, processor in ipairs { "plain", "fma", "avx512" } do
  local one = under(1, processor)
  ok(select(2, one:gsub("\n", "")) == 77, processor .. ": numbers of all members", one)
  for _, lanes in ipairs { 0, 4, 8 } do
    ok(under(lanes, processor) == one, ("%s: the same bits with %d lanes"):format(processor, lanes))
  end
end
tap.done()
