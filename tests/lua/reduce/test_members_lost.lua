-- Jumps of reduced runs: found whatever rows are kept, and in members of ensembles, where a run of
-- its own would have been refused
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local satellite = dm.system { Q = dm.R(3), coordinates = { "theta", "r", "z" }, L = function(q, v)
  return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / dm.sqrt(q[2] ^ 2 + q[3] ^ 2)
end }
local shape = satellite:routh { cyclic = "theta", mu = 0.03 }
local solver = shape:solver { rule = "gauss(2)", h = 0.1 }
local function start(i, more)
  local out = { q = { 1, 0 }, v = { 0, 0.8 + 0.01 * i }, t = 30 }
  for key, value in pairs(more or {}) do out[key] = value end
  return out
end
local function try(options, by)
  local fine, result = pcall(function() return (by or solver):run(options) end)
  return not fine and result.reason, not fine and result.step, result
end

-- the same step is named whatever rows are kept, and no right run is refused
local lost, apart = {}, {}
for i = 1, 25 do
  local code, step = try(start(i))
  lost[i] = code and { code = code, step = step } or nil
  for _, every in ipairs { 7, 50, 300 } do
    local other, at = try(start(i, { every = every }))
    if other ~= code or at ~= step then apart[#apart + 1] = i .. "/" .. every end
  end
  local there = try { q = { 1, 0 }, v = { 0, 0.8 + 0.01 * i }, at = { 10, 30 } }
  local file = os.tmpname() .. ".npy"
  local filed, at = try(start(i, { every = 10, file = file }))
  os.remove(file)
  if filed ~= code or at ~= step then apart[#apart + 1] = i .. "/file" end
  if there ~= code then apart[#apart + 1] = i .. "/at" end
end
local count = 0
for _ in pairs(lost) do count = count + 1 end
ok(count >= 5 and count <= 20, "some of these starts jump over the wall, some do not", count)
ok(#apart == 0, "the same ones, at the same step, for any rows", table.concat(apart, " "))

-- members, few and many, by functions that give another number when asked again
local calls = 0
for _, more in ipairs { {}, { every = 50 } } do
  for _, times in ipairs { 1, 8 } do
    local members = 25 * times
    local function number(i) return (i - 1) % 25 + 1 end
    local given = { members = members, q = function() return { 1, 0 } end, t = 30,
      v = function(i)
        calls = calls + 1
        return { 0, 0.8 + 0.01 * number(i) + (calls > members and 0.5 or 0) }
      end, every = more.every }
    calls = 0
    local e = solver:ensemble(given)
    local told, wrong = e:failures(), 0
    for i = 1, members do
      local expected = lost[number(i)]
      if e.status[i] ~= (expected and expected.code or "ok") then wrong = wrong + 1 end
    end
    ok(wrong == 0 and #told == count * times, members .. " members are told as their runs are", wrong)
    local first = told[1]
    ok(first.step == lost[number(first.member)].step and first.message:find "locked inertia",
      "with step and reason", first.message)
    ok(tostring(e):find(count * times .. " lost their way", 1, true), "the ensemble says so", tostring(e))
  end
end

-- members with a momentum or a step of their own
local varied = solver:ensemble { members = 3, vary = { mu = { 0.03, 0.3, 0.03 } },
  q = { { 1, 0 }, { 1, 0 }, { 1, 0 } }, v = { { 0, 0.94 }, { 0, 0.94 }, { 0, 0.94 } }, t = 30 }
ok(varied.status[1] == "collapse" and varied.status[2] == "ok" and varied.status[3] == "collapse",
  "vary = { mu = }", table.concat(varied.status, " "))
local paced = solver:ensemble { members = 2, h = { 0.1, 0.001 }, q = { { 1, 0 }, { 1, 0 } },
  v = { { 0, 0.94 }, { 0, 0.94 } }, t = 30 }
ok(paced.status[1] == "collapse" and paced.status[2] == "ok", "h of a member", table.concat(paced.status, " "))

-- a system that is not reduced, and one that goes well, are as they were
local plain = satellite:solver({ rule = "gauss(2)", h = 0.1 }):ensemble { members = 2, steps = 10,
  q = { { 0, 1, 0 }, { 0, 1, 0 } }, v = { { 0.5, 0, 0.5 }, { 0.5, 0, 0.5 } } }
ok(plain.status[1] == "ok" and #plain:failures() == 0 and tostring(plain):find("all ok", 1, true), "unreduced members")
local well = shape:solver({ rule = "gauss(3)", h = 0.01 }):ensemble { members = 4, steps = 500,
  q = function() return { 1, 0 } end, v = function(i) return { 0, 1 + 0.01 * i } end }
ok(#well:failures() == 0 and tostring(well):find("all ok", 1, true), "and reduced ones that go well", tostring(well))

-- a wall so narrow that the energy does not show the jump; none where mu is 0 along what vanishes
local pendulum = dm.system { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v)
  return (v[1] ^ 2 + dm.sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + dm.cos(q[1])
end }
for _, mu in ipairs { 1e-6, 1e-4, 0.005 } do
  local plain_theta = dm.system { Q = dm.R(1), L = function(q, v)
    return v[1] ^ 2 / 2 + dm.cos(q[1]) - mu ^ 2 / (2 * dm.sin(q[1]) ^ 2)
  end }
  local over = pendulum:routh { cyclic = "phi", mu = mu }
  local wrong = 0
  for _, by in ipairs { { "gauss(1)", 0.1 }, { "gauss(2)", 0.2 }, { "verlet", 0.05 } } do
    local many = over:solver({ rule = by[1], h = by[2] }):ensemble { members = 10, t = 20,
      q = function() return { 0.8 } end, v = function(i) return { 0.06 * i } end }
    for i = 1, 10 do
      local given = { q = { 0.8 }, v = { 0.06 * i }, t = 20 }
      local fine, path = pcall(function()
        return plain_theta:solver({ rule = by[1], h = by[2] }):run(given)
      end)
      path = fine and path or path.path
      local crossed = false
      for k = 2, #path do crossed = crossed or path.q[k][1] * path.q[k - 1][1] < 0 end
      local code = try(given, over:solver { rule = by[1], h = by[2] })
      if crossed and not (code and many.status[i] == code) then wrong = wrong + 1 end
    end
  end
  ok(wrong == 0, "runs and members that crossed theta = 0 are told, mu = " .. mu, wrong)
end
local pair = dm.system { Q = dm.R(4), coordinates = { "r", "s", "a", "b" }, L = function(q, v)
  return (v[1] ^ 2 + v[2] ^ 2 + q[1] ^ 2 * v[3] ^ 2 + q[2] ^ 2 * v[4] ^ 2) / 2
    - q[1] ^ 2 / 2 - q[2] ^ 2 - 0.1 * q[1] ^ 2 * q[2] ^ 2
end }
local through = pair:routh({ cyclic = { "a", "b" }, mu = { 1, 0 } }):solver({ rule = "gauss(2)", h = 0.05 })
  :run { q = { 1, 0.7 }, v = { 0.1, 0.2 }, steps = 400 }
ok(#through == 401, "s passes 0 where b has no momentum")
tap.done()
