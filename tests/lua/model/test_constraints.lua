-- constraints, rolling, forces from Lua: what is read off them, starts on and off them, rules that do not know them, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt = math.sqrt

local function L(_, v) return v:dot(v) / 2 end
local function system(fields)
  fields.Q, fields.L = fields.Q or dm.R(3), fields.L or L
  return dm.system(fields)
end
local sphere = system { constraint = function(q) return { q:dot(q) - 1 } end, L = function(q, v) return v:dot(v) / 2 - q[3] end }

-- values and structure
local all = system { constraint = function(q, t) return q[1] - t end, rolling = function(q, v) return dm.vector { v[3] - q[2] * v[1] } end,
  force = function(q, v, t) return -0.5 * v + t * q end, reaction = function(q) return { { -q[2], 0, 1 } } end }
near(all:constraint({ 2, 0, 0 }, 0.5)[1], 1.5, 0, "constraint(q, t), a bare number")
near(all:rolling({ 1, 2, 3 }, { 4, 5, 6 })[1], -2, 0, "rolling(q, v), a vector")
near((all:force({ 1, 2, 3 }, { 4, 5, 6 }, 2) - dm.vector { 0, 1.5, 3 }):norm(), 0, 1e-15, "force(q, v, t)")
local s = all:structure()
ok(s.constraints == 1 and s.rolling == 1 and s.forced and not s.autonomous, "structure counts them, and sees the time")
ok(tostring(all):find("1 constraint, 1 rolling constraint, a force", 1, true), "a system says what ties it", tostring(all))
ok(not tostring(system {}):find "constraint" and system {}:structure().constraints == 0, "one without says nothing")
raises("this system has no force", sphere.force, sphere, { 1, 0, 0 }, { 0, 0, 0 })
raises("domain", function() system { constraint = function(q) return math.log(q[1]) end }:constraint { -1, 0, 0 } end)

-- parameters and upvalues
local radius = 1
local bound = system { params = { a = 2 }, constraint = function(q, _, params) return q:dot(q) - radius * params.a end }
near(bound:constraint({ 1, 0, 0 })[1], -1, 0, "params come last")
local on_it = bound:solver { rule = "rattle", h = 0.1 }
local start = { q = { sqrt(2), 0, 0 }, v = { 0, 1, 0 }, steps = 1 }
ok(pcall(on_it.run, on_it, start), "a start on it")
radius = 2
raises("constraint 1: |g(q)| = 2", on_it.run, on_it, start)
radius = 1
ok(pcall(on_it.run, on_it, start), "an upvalue that changes is picked up")

-- starts
local solver = sphere:solver { rule = "rattle", h = 0.02 }
local function run(q, v, project) return solver:run { q = q, v = v, steps = 1, project = project } end
raises("constraint 1: |g(q)| = 0.13; project = true", run, { 0.7, 0, -0.8 }, { 0, 1, 0 })
raises("the velocity does not fit constraint 1: |G v + dg/dt| = 1.2", run, { 0.6, 0, -0.8 }, { 1, 1, 0 })
raises("true or false", run, { 0.6, 0, -0.8 }, { 0, 1, 0 }, 1)
raises("gradient of constraint 1 is zero at this q", run, { 0, 0, 0 }, { 0, 1, 0 })
raises("q0: no start: it is off the constraints", solver.run, solver, { q0 = { 0.7, 0, -0.8 }, q1 = { 0.6, 0, -0.8 }, steps = 1 })
raises("the velocity does not fit", solver.run, solver, { q = { 0.6, 0, -0.8 }, p = { 1, 0, 0 }, steps = 1 })
ok(pcall(run, { 0.6, 0, -0.8 }, { 1e-13, 1, 0 }), "a start on it to round-off")
local path = run({ 0.7, 0, -0.8 }, { 0.5, 1, 0.5 }, true)
local q, p = path.q[1], path.p[1]
near((q - dm.vector { 0.7, 0, -0.8 } / sqrt(1.13)):norm(), 0, 1e-15, "project moves q along the radius")
near((p - (dm.vector { 0.5, 1, 0.5 } - q * q:dot { 0.5, 1, 0.5 })):norm(), 0, 1e-15, "and v onto the tangent plane")
ok(path:worst "constraint" < 1e-15, "and the run stays there", path:worst "constraint")
-- masses 1 and 4 on a rod along x: the light one moves four times as far; a wire y = x^2: nearest points have normal distances
local rod = system { Q = dm.R(2), L = function(_, v) return v[1] ^ 2 / 2 + 2 * v[2] ^ 2 end, constraint = function(x) return x[2] - x[1] - 1 end }
path = rod:solver({ rule = "rattle", h = 0.1 }):run { q = { 0, 2 }, v = { 5, 0 }, steps = 1, project = true }
near((path.q[1] - dm.vector { 0.8, 1.8 }):norm(), 0, 1e-15, "nearest in the metric of the mass")
near((path.p[1] - dm.vector { 1, 4 }):norm(), 0, 1e-14, "which keeps the momentum of the whole")
local wire = system { Q = dm.R(2), constraint = function(x) return x[2] - x[1] ^ 2 end }
q = wire:solver({ rule = "rattle", h = 0.1 }):run({ q = { 1, 0.5 }, v = { 1, 1 }, steps = 1, project = true }).q[1]
near(q[2] - q[1] ^ 2, 0, 1e-15, "onto a parabola")
near((1 - q[1]) + (0.5 - q[2]) * 2 * q[1], 0, 1e-14, "at a right angle")
local nowhere = system { constraint = function(x) return x:dot(x) + 1 end }
raises("begin nearer", function() nowhere:solver({ rule = "rattle", h = 0.1 }):run { q = { 0, 3, 0 }, v = { 0, 0, 0 }, steps = 1, project = true } end)
-- two positions
local one = solver:step { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 } }
local two = solver:step({ 0.6, 0, -0.8 }, one)
local straight = solver:run { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, steps = 2 }
near((two - straight.q[3]):norm(), 0, 1e-13, "from two positions to the next")
path = solver:run { q0 = { 0.6, 0, -0.8 }, q1 = one, steps = 2 }
near((path.p[1] - dm.vector { 0, 1, 0 }):norm(), 0, 1e-12, "whose momentum is tangent")
local loose = sphere:solver { rule = "shake", h = 0.02 }
path = loose:run { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, steps = 10 }
local rest = loose:run { q = path.q[5], p = path.p[5], steps = 6 }
near((rest.q[7] - path.q[11]):norm(), 0, 1e-13, "shake goes on from its own momenta")

-- redundant constraints
local twice = system { constraint = function(x) return { x[1] - x[2], x:dot(x) - 1, 3 * (x[1] - x[2]) + 0 * x[3] } end }
raises("constraint 3 depends on those before it, most of all on constraint 1", function()
  twice:solver({ rule = "rattle", h = 0.1 }):run { q = { 0, 0, 1 }, v = { 1, 1, 0 }, steps = 1 }
end)
local sum = system { Q = dm.R(4), constraint = function(x) return { x[1] + x[2], x[3], 2 * x[3] - x[1] - x[2] } end }
raises("constraint 3 depends on those before it, most of all on constraint 2", function()
  sum:solver({ rule = "rattle", h = 0.1 }):run { q = { 0, 0, 0, 0 }, v = { 0, 0, 0, 1 }, steps = 1 }
end)
raises("member 2: no start: it is off the constraints", function()
  solver:ensemble { members = 2, steps = 1, q = { { 0.6, 0, -0.8 }, { 0.7, 0, -0.8 } }, v = { { 0, 1, 0 }, { 0, 1, 0 } } }
end)
local members = solver:ensemble { members = 2, steps = 1, project = true, q = { { 0.6, 0, -0.8 }, { 0.7, 0, -0.8 } },
  v = { { 0, 1, 0 }, { 0, 1, 0 } } }
near(members.q[2]:norm(), 1, 1e-15, "members are projected too")

-- no rule ignores a constraint or a force
local written = { gauss = "gauss(2)", lobatto = "lobatto(3)", galerkin = "galerkin(2, gauss(2))" }
for name, tie in pairs { constraint = function(x) return x:dot(x) - 1 end, rolling = function(x, v) return v[3] - x[2] * v[1] end,
  force = function(x) return -x end } do
  local tied, known = system { [name] = tie }, {}
  for _, rule in ipairs(dm.rules()) do
    if not rule.for_pairs then
      local text = written[rule.name] or rule.name .. (rule.signature:match "%((%d+)" and ("(" .. rule.signature:match "%((%d+)" .. ")") or "")
      local fine, message = pcall(function()
        tied:solver({ rule = text, h = 0.1 }):run { q = { 0, 0.6, -0.8 }, v = { 0, 0, 0 }, steps = 1 }
      end)
      if fine then known[#known + 1] = rule.name else
        ok(tostring(message):find "cannot step this system" or tostring(message):find "field 'rule'", text .. " refuses a " .. name, message)
      end
    end
  end
  ok(#known > 0, "rules that know a " .. name .. ": " .. table.concat(known, " "))
end
raises("rattle, shake (where base", function() sphere:solver({ rule = "rk4", h = 0.1 }):run { q = { 0, 0, 1 }, v = { 0, 0, 0 }, steps = 1 } end)
raises("no place for the constraints", dm.discrete_lagrangian, sphere, { rule = "gauss(2)", h = 0.1 })

-- misuse
raises("field 'constraint' must be a function", system, { constraint = 3 })
raises("is a return missing?", system, { constraint = function() end })
raises("constraint 1 does not depend on q", system, { constraint = function() return 3 end })
raises("constraint 2 does not depend on q", system, { constraint = function(x, t) return { x[1], t } end })
raises("got none", system, { constraint = function() return {} end })
raises("got string", system, { force = function() return "a" end })
raises("4 constraints for 3 coordinates", system, { constraint = function(x) return { x[1], x[2], x[3], x[1] - 1 } end })
raises("force must return 3 numbers, one per coordinate, got 2", system, { force = function() return { 1, 2 } end })
raises("rolling constraint 1 does not depend on v", system, { rolling = function(x) return x[1] end })
raises("there are none", system, { reaction = function(x) return { x } end })
raises("1 rows of 3 numbers", system, { rolling = function(_, v) return v[1] end, reaction = function() return { 1, 2 } end })
raises("derivatives as expressions", system, { force = function(_, v) return v end, derivatives = "hyperdual" })
raises("did you mean 'constraint'", system, { constrain = function(x) return x[1] end })
raises("dm.where", system, { constraint = function(x) if x[1] > 0 then return x[1] end return x[2] end })
local blind = system { force = function(x) return { x[1] == 0 and 1 or 2, 0, 0 } end }
raises("force is not what its trace says", function() blind:solver({ rule = "rattle", h = 0.1 }):run { q = { 0, 0, 0 }, v = { 0, 0, 0 }, steps = 1 } end)
local undefined = system { force = function(x) return { math.log(x[1]), 0, 0 } end }
raises("force is", function() undefined:solver({ rule = "rattle", h = 0.1 }):run { q = { -1, 0, 0 }, v = { 0, 0, 0 }, steps = 1 } end)
raises("no rolling constraint", straight.worst, straight, "rolling")
raises("path:worst takes \"constraint\" or \"rolling\"", straight.worst, straight, "energy")

-- constraints that become dependent on the way are named, not d2L/dv2
local function lost(what, number, rule, options, q, v, h)
  options.Q, options.L = dm.R(3), function(_, u) return u:dot(u) / 2 end
  local solver = dm.system(options):solver { rule = rule, h = h or 0.1 }
  local fine, failure = pcall(solver.run, solver, { q = q, v = v, steps = 30 })
  ok(not fine and failure.code == "singular" and failure[what] == number and failure.step == math.ceil(1 / (h or 0.1))
    and (failure.message:find(("constraint %d depends on those before it"):format(number), 1, true)
      or number == 1 and failure.message:find("constraint 1 vanishes inside of this step", 1, true)) and not failure.message:find "d2L",
    ("%s: %s %d is named"):format(tostring(rule), what, number), fine or failure.message)
end
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(3)" } do
  lost("rolling", 2, rule, { rolling = function(x, u) return { u[1] - x[3] * u[2], u[1] + x[3] * u[2] } end }, { 0, 0, 1 }, { 0, 0, -1 })
end
local r = 0.5 ^ 0.5
lost("constraint", 2, "lobatto(3)", { constraint = function(x) return { x[1] ^ 2 + x[2] ^ 2 - x[3] ^ 2, x[1] ^ 2 - x[2] ^ 2 } end },
  { r, r, 1 }, { -r, -r, -1 })
-- by rules that see it only where the step leads; the apex of a cone, met to the last bit
local rk4 = dm.curve { order = 4, method = function(x, f, h)
  local k1 = f(x)
  local k2 = f(x + h / 2 * k1)
  local k3 = f(x + h / 2 * k2)
  return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(x + h * k3))
end }
lost("rolling", 2, rk4, { rolling = function(x, u) return { u[1] - x[3] * u[2], u[1] + 2 * x[3] * u[2] } end },
  { 0, 0, 1 }, { 0, 0, -1 }, 1 / 16)
for _, rule in ipairs { "rattle", "shake", "yoshida(4, rattle)" } do
  lost("constraint", 1, rule, { constraint = function(x) return x[1] ^ 2 + x[2] ^ 2 - x[3] ^ 2 end },
    { 1, 0, 1 }, { -1, 0, -1 }, 1 / 16)
end
lost("constraint", 2, "yoshida(4, rattle)", { constraint = function(x) return { x[3], x[3] - x[1] * x[2] } end },
  { 1, 0, 0 }, { -1, 0, 0 }, 1 / 16)
-- one of each kind: a rolling condition that becomes one more holonomic one
lost("rolling", 1, "gauss(2)", { constraint = function(x) return x[1] end,
  rolling = function(x, u) return { x[3] * u[2] - u[1] } end }, { 0, 0, 1 }, { 0, 0, -1 })

-- rows of unequal length, also where they have as many numbers in all as are wanted
for _, rows in ipairs { { { 1, 0, 0, 2 }, { 0, 1 } }, { { 1, 0 }, { 0, 1, 0, 0 } },
  { 1, { 0, 1, 0, 0, 0 } } } do
  raises("rows of different lengths were returned: row 1 has", function()
    system { rolling = function(_, v) return { v[1], v[2] } end,
      reaction = function() return rows end }
      :solver { rule = "gauss(2)", h = 0.1 }:run { q = { 0, 0, 0 }, v = { 0, 0, 1 }, steps = 1 }
  end)
end

-- a rule that does not know what is beside L is refused where it is named
do
  local function beside(what) return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, [what[1]] = what[2] } end
  for _, what in ipairs { { "constraint", function(q) return q:dot(q) - 1 end, "constraints", "verlet", "midpoint" },
    { "rolling", function(q, v) return v[1] - q[2] * v[2] end, "rolling constraints", "rattle", "midpoint" },
    { "force", function(_, v) return -v end, "forces", "log-hamiltonian", "verlet" } } do
    local s = beside(what)
    tap.raises(("rule '%s' cannot step this system: it knows no %s; rules that do: %s"):format(what[4], what[3], what[5]), s.solver, s,
      { rule = what[4], h = 0.1 })
    tap.ok(s:solver { rule = "gauss(2)", h = 0.1 }, "and another is taken")
  end
end

tap.done()
