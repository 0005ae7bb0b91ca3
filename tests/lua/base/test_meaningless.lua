-- an option that would change nothing raises: of all calls in templates.lua, each option of all docs with a value that no option takes; then
-- pairs of good ones of which one was dropped without a word
package.path = package.path .. ";tests/fuzz/?.lua"
local tap = require "tap"
local dm = require "dm"
local docs = require "dm.core".docs
local ok, raises = tap.ok, tap.raises

local names = {}
for _, doc in pairs(docs) do
  for signature in doc:sub(1, 600):gmatch "%b{}" do
    for key in signature:gmatch "([%a_][%w_]*)%s*=" do names[key] = true end
  end
end
local odd = coroutine.create(print)
-- tables whose keys are names of the user, and calls that draw
local OF_USERS = { params = true, watch = true, events = true, forms = true }
local DRAW = { ["plot of a mesh"] = true, ["space and time"] = true }
-- 1 / volume where there is one is what it is without pinv
local TRUE_ALIKE = { sharp = { pinv = true } }

-- systems are made again where their own options are tried, not for those of a run
local walked, made = nil, setmetatable({}, { __mode = "k" })
for _, name in ipairs { "system", "euler_poincare" } do
  local make = dm[name]
  dm[name] = function(options) -- luacheck: ignore
    if options == walked or type(options) ~= "table" then return make(options) end
    made[options] = made[options] or make(options)
    return made[options]
  end
end

-- in order: a table of options takes a third of the names, which one by its place (SAMPLES=1: all)
local sorted = {}
for key in pairs(names) do sorted[#sorted + 1] = key end
table.sort(sorted)
local stride = 60 // tap.samples(60)
local taken, tried = {}, 0
local function walk(row, t, path)
  local found, turn = {}, #row[1] + #path
  walked = t
  for i, key in ipairs(sorted) do
    if t[key] == nil and (i + turn) % stride == 0 then
      t[key], tried = odd, tried + 1
      if pcall(row[2], row[3]) and not (TRUE_ALIKE[row[1]] or {})[key] then found[#found + 1] = row[1] .. path .. ": " .. key end
      t[key] = nil
    end
  end
  if #found < 60 / stride then table.move(found, 1, #found, #taken + 1, taken) end -- else no table of options: what a template keeps apart
  for key, value in pairs(t) do
    local of_options = type(key) == "string" and type(value) == "table" and not getmetatable(value) and type(next(value)) == "string"
    if of_options and not OF_USERS[key] then walk(row, value, path .. "." .. key) end
  end
end
for _, row in ipairs(require "templates".rows()) do
  if not DRAW[row[1]] and pcall(row[2], row[3]) then walk(row, row[3], "") end
end
walked, made = nil, {}
for _, file in ipairs { "f.npy", "f.checkpoint", "f.vtk", "f.html" } do os.remove(file) end
table.sort(taken)
ok(#taken == 0 and tried > 10000 / stride, ("no option is taken without a look (%d tried)"):format(tried), table.concat(taken, "\n# "))

---- options whose value is good, beside others ----

local line = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local solver = line:solver { rule = "gauss(2)", h = 0.1 }
local function with(more)
  local out = { q = { 1 }, v = { 0 }, steps = 3 }
  for key, value in pairs(more) do out[key] = value end
  return out
end
raises("field 'gaps' is about NaN in columns", solver.run, solver, with { gaps = true })
raises("field 'gaps' is about NaN in columns", solver.ensemble, solver, { members = 1, q = { { 1 } }, v = { { 0 } }, steps = 1, gaps = true })
ok(#solver:run(with { gaps = false }) == 4, "false is what there is without it")
ok(#solver:run(with { gaps = true, watch = { "q1" } }) == 4 and #solver:run(with { gaps = false, record = { "energy" } }) == 4, "with columns it is taken")
for _, verb in ipairs { "tangent", "lyapunov", "symplecticity", "multipliers", "reversal", "singularities", "run" } do
  raises("give", solver[verb], solver, with { p = { 0.3 } })
  raises("'t'", solver[verb], solver, with { t = 1, steps = 30 })
end
raises("not both", solver.fold, solver, { q = { 1 }, v = { 0 }, p = { 0.3 }, up_to = 1 })
raises("not both", dm.scene, { line, q = { 1 }, v = { 0 }, p = { 0.3 }, watch = { "q1" }, tolerance = 0.1, until_t = 0.5 })
raises("given twice", dm.scene, { line, system = line, q = { 1 }, v = { 0 }, watch = { "q1" }, tolerance = 0.1, until_t = 0.5 })
raises("given twice", dm.chart, { line, system = line, q = { 1 }, v = { 0 }, t = 1, rules = { "verlet" } })
raises("option 'steps' has no meaning here: 'h'", dm.chart, { line, q = { 1 }, v = { 0 }, t = 1, rules = { "verlet" }, h = { 0.1 }, steps = { 0.2 } })
raises("option 'dual' has no meaning here", dm.mesh, { simplices = { { 1, 2, 3 } }, dual = "barycentric" })
raises("option 'pinv' has no meaning here", function() dm.mesh { grid = 2 }:star(1, { pinv = true }) end)
ok(tostring(dm.mesh { grid = 2 }:star(1, { pinv = false }).matrix) == tostring(dm.mesh { grid = 2 }:star(1).matrix), "false asks for nothing")
raises("carried along", dm.euler_poincare, { group = dm.SO(3), l = function(W) return W:dot(W) / 2 end, a = { 1, 2, 3 } })
raises("carries no quantity", solver.section, solver, { q = { 1 }, v = { 0 }, a = { 1 }, g = "q1", x = "q1", y = "p1", steps = 9 })
raises("option 'start' has no meaning here", dm.moving_frame, { action = dm.action { group = dm.SO(2), on = dm.R(2) }, start = { 0 },
  cross_section = function(z) return z[2] end, branch = function(z) return z[1] end, solution = function(z) return -dm.atan(z[2], z[1]) end })
tap.done()
