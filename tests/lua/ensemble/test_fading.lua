-- members that fail where d2L/dv2 loses a value say so, as runs of their own do: in lanes, alone,
-- with steps of their own, from a journal
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

-- d2L/dv2 = 3 v^2 - 1 vanishes at v = 1/sqrt 3, where motions end
local folds = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 4 / 4 - v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local MEMBERS, reason = 41, "a value of d2L/dv2 goes to zero there"
local function start(i) return { 0.22 + 0.08 * (i - 1) / (MEMBERS - 1) } end
local function last(options, many)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  out.members, out.q, out.v = many or MEMBERS, function() return { 1 } end, start
  return out
end
local function of(list)
  local out = {}
  for _, f in ipairs(list) do out[f.member] = f end
  return out
end

local journal = os.tmpname()
for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "gauss(3)", "lobatto(3)", "trapezoidal",
  "galerkin(2, gauss(2))", "curve(rk4)", "rk4" } do
  for _, h in ipairs { 0.05, 0.02 } do
    local solver, name = folds:solver { rule = rule, h = h }, ("%s, h = %g: "):format(rule, h)
    local lanes = of(solver:ensemble(last { steps = 200, every = 1 }):failures())
    local own = of(solver:ensemble(last { steps = 200, h = function(i)
      return i % 2 == 0 and h or h / 2 end }):failures())
    os.remove(journal)
    local written = last { steps = 200, journal = journal }
    solver:ensemble(written)
    local read = of(solver:ensemble(written):failures())
    local wrong, told = nil, 0
    for i = 1, MEMBERS do
      local fine, f = pcall(solver.run, solver, { q = { 1 }, v = start(i), steps = 200 })
      local m, again = lanes[i], read[i]
      if fine ~= (m == nil) or not fine and (m.code ~= f.code or m.step ~= f.step
        or (f.fading ~= nil) ~= (m.message:find(reason, 1, true) ~= nil)
        or again.message ~= m.message or i % 2 == 0 and own[i].message ~= m.message) then
        wrong = ("member %d: %s; alone %s"):format(i, m and m.code .. " " .. m.message or "ok",
          tostring(f))
      end
      told = told + (not fine and (f.fading or f.code == "inertia") and 1 or 0)
    end
    ok(not wrong, name .. "members say what runs say", wrong)
    ok(told == MEMBERS, name .. "and all name d2L/dv2", told)
  end
end
os.remove(journal)
tap.done()
