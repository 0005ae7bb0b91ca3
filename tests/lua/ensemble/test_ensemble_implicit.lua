-- implicit rules of ensembles in lanes: every member is a run of its own, bit for bit, on every way that a step can go
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local cos, sin, sqrt = math.cos, math.sin, math.sqrt

-- two rods on a sphere each: a mass matrix that varies with q
local function rods(q, v)
  local function velocity(a, b, da, db)
    return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
  end
  local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
  local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
  local T = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
  return T + 9.81 * (2 * cos(q[1]) + cos(q[3]))
end
local function kepler(q, v) return v:dot(v) / 2 + 1 / q:norm() end

local models = { -- name, L, q, v, small and large step
  { "kepler", kepler, { 0.4, 0 }, { 0, 2 }, 0.05, 0.35 }, -- diagonal mass; sweeps too slow at the near end
  { "rods", rods, { 1, 0, 0.7, 0.4 }, { 0, 1.5, 0, 2 }, 0.01, 0.06 },
  { "full mass", function(q, v) return v[1] ^ 2 + v[1] * v[2] * 0.3 + v[2] ^ 2 / 2 + 0.3 * v[1] - q[1] ^ 4 - q[1] * q[2] - q[2] ^ 2 end,
    { 1, 0.3 }, { 0.1, 0.2 }, 0.1, 0.6 },
  { "driven", function(q, v, t) return v[1] ^ 2 / 2 * (1 + q[2] ^ 2) + v[1] ^ 4 / 10 + v[2] ^ 2 / 2 - q[1] ^ 4 - q[2] ^ 2 + q[1] * cos(3 * t) end,
    { 1, 0.3 }, { 0.1, 0.2 }, 0.1, 0.3 }, -- not quadratic in v, depends on t
  { "bowl", function(q, v) return v[1] ^ 2 / 2 + sqrt(1 - q[1] ^ 2) end, { 0.01 }, { 0.9 }, 0.05, 0.1 }, -- some leave the domain
}
local rules = { "midpoint", "gauss(1)", "gauss(2)", "gauss(3)", "gauss(5)", "gauss(6, 4)", "gauss(3, 1)", "trapezoidal", "lobatto(3)", "lobatto(5)",
  "galerkin(3, lobatto(4))", "galerkin(2, gauss(3))", "verlet", "symplectic-euler(a)", "sprk(radau-2a, 2)", "sprk(lobatto-3b-3a, 3)" }

-- member i is off the model's start, every fifth far off
local function start(model, i)
  local q, v = { table.unpack(model[3]) }, { table.unpack(model[4]) }
  q[1] = q[1] + i * 0.01
  v[1] = v[1] + (i % 5 == 2 and 0.03 * i or 0)
  return q, v
end

-- the first member that is not as alone: end, rows, status, steps; and how many fail
local function as_alone(solver, model, members, steps)
  local e = solver:ensemble { members = members, steps = steps, every = 7, t0 = 0.2, threads = 2,
    q = function(i) return (start(model, i)) end, v = function(i) return select(2, start(model, i)) end }
  local failures = 0
  for i = 1, members do
    local q, v = start(model, i)
    local fine, path = pcall(solver.run, solver, { q = q, v = v, steps = steps, every = 7, t0 = 0.2 })
    local code, finished = "ok", steps
    if not fine then code, finished, path, failures = path.code, path.step - 1, path.path, failures + 1 end
    local rows = e:path(i)
    local same = path.q[#path] == e.q[i] and path.p[#path] == e.p[i] and #rows == #path and rows.q[2] == path.q[2] and rows.p[2] == path.p[2]
    if not same or code ~= e.status[i] or finished ~= e.steps[i] then return i, failures, e.lanes end
  end
  return nil, failures, e.lanes
end

local most = dm.system({ Q = dm.R(2), L = kepler }):solver({ rule = "verlet", h = 0.01 })
  :ensemble({ members = 1, q = { { 1, 0 } }, v = { { 0, 1 } }, steps = 1 }).lanes
local refused, narrow, failed, tried = {}, {}, 0, 0
for _, model in ipairs(models) do
  local system = dm.system { Q = dm.R(#model[3]), L = model[2] }
  for _, rule in ipairs(rules) do
    for h = 5, 6 do
      local fine, solver = pcall(system.solver, system, { rule = rule, h = model[h] })
      local unlike, failures, lanes
      if fine then fine, unlike, failures, lanes = pcall(as_alone, solver, model, 13, 60) end
      if fine then
        tried, failed = tried + 1, failed + failures
        if lanes ~= most then narrow[#narrow + 1] = model[1] .. " " .. rule end
        ok(not unlike, ("%s, %s, h = %g: members are single runs"):format(model[1], rule, model[h]), unlike)
      else
        refused[#refused + 1] = model[1] .. " " .. rule
      end
    end
  end
end
ok(tried > 140 and failed > 20, "runs that end and runs that fail are among them", tried .. " " .. failed)
local known = { ["driven gauss(6, 4)"] = true, ["driven gauss(3, 1)"] = true } -- a number of sweeps is for L quadratic in v
local others = {}
for _, name in ipairs(refused) do if not known[name] then others[#others + 1] = name end end
ok(#others == 0, "all rules step all models", table.concat(others, ", "))
local explicit = true
for _, name in ipairs(narrow) do explicit = explicit and name:find "trapezoidal" or name:find "galerkin%(3, lobatto" end
ok(explicit, "all of them in lanes but what needs no solving", table.concat(narrow, ", "))

-- numbers of members that do not fill the lanes
local solver = dm.system({ Q = dm.R(4), L = rods }):solver { rule = "midpoint", h = 0.01 }
for _, members in ipairs { 1, 2, most, most + 1, 8 * most + 3 } do
  local unlike = as_alone(solver, models[2], members, 20)
  ok(not unlike, members .. " members as alone", unlike)
end

-- steps of their own
local paced = solver:ensemble { members = 9, t = 0.3, h = function(i) return i < 5 and 0.01 or 0.015 end,
  q = function(i) return (start(models[2], i)) end, v = function(i) return select(2, start(models[2], i)) end }
local same = true
for i = 1, 9 do
  local q, v = start(models[2], i)
  local h = i < 5 and 0.01 or 0.015
  local path = dm.system({ Q = dm.R(4), L = rods }):solver({ rule = "midpoint", h = h }):run { q = q, v = v, steps = math.ceil(0.3 / h - 1e-9) }
  same = same and path.q[#path] == paced.q[i] and path.p[#path] == paced.p[i]
end
ok(same, "members with steps of their own are such runs")

-- starts that are moved onto constraints: velocities are those that were given, not those of momenta
local slope = dm.system { Q = dm.R(3), constraint = function(q) return q[1] + 0.2 * dm.sin(q[2] + q[3]) - 0.1 end, rolling = function(q, v)
  return v[2] - 0.3 * dm.cos(q[1]) * v[3] end, L = function(q, v)
  return 0.75 * v:dot(v) + (0.31 * v[1] - 0.83 * v[2] + 0.7 * v[3]) ^ 2 / 6 + (0.57 * v[2] + 0.77 * v[3]) ^ 2 / 7 - q:dot(q) / 2 end }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)", "curve(rk4)" } do
  local solver = slope:solver { rule = rule, h = 0.05 }
  local function q(i) return { 0.1 * i, 0.3, -0.2 } end
  local function v(i) return { 0.7, 0.1 * i, 0.33 - 0.07 * i } end
  local all = solver:ensemble { members = 12, q = q, v = v, steps = 20, project = true }
  local equal = 0
  for i = 1, 12 do
    local path = solver:run { q = q(i), v = v(i), steps = 20, project = true }
    if all.q[i] == path.q[21] and all.p[i] == path.p[21] then equal = equal + 1 end
  end
  ok(equal == 12, rule .. ": starts that are projected are those of runs", equal)
end

-- the same ends whatever the processor offers
local dmlua = os.getenv "DMLUA" or arg[-1]
local script = [[
  local dm = require "dm"
  local L = { function(q, v) return v:dot(v) / 2 + 1 / q:norm() end, function(q, v) return v:dot(v) / 2 * (1 + q[1] ^ 2) + 1 / q:norm() end }
  for k = 1, 2 do for _, rule in ipairs { "midpoint", "gauss(3)", "gauss(5)", "lobatto(3)" } do
    local e = dm.system({ Q = dm.R(2), L = L[k] }):solver({ rule = rule, h = 0.03 }):ensemble { members = 11, steps = 40,
      q = function(i) return { 0.4 + i / 100, 0 } end, v = function(i) return { 0, 2 } end }
    for i = 1, #e do print(("%a %a"):format(e.q[i][1], e.p[i][2])) end
  end end]]
local function under(lanes, processor)
  local pipe = io.popen(("DMLUA_LANES=%d DMLUA_PROCESSOR=%s %s -e '%s' 2>&1"):format(lanes, processor, dmlua, script))
  local text = pipe:read "a"
  pipe:close()
  return text
end
for _, processor in ipairs { "plain", "fma", "avx512" } do
  local one = under(1, processor)
  ok(select(2, one:gsub("\n", "")) == 88, processor .. ": numbers of all members", one)
  for _, lanes in ipairs { 0, 4, 8 } do
    ok(under(lanes, processor) == one, ("%s: the same bits with %d lanes"):format(processor, lanes))
  end
end
tap.done()
