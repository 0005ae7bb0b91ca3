-- bits do not depend on where bursts of steps end: they end at rows, and where the clock is looked at
local tap = require "tap"
local dm = require "dm"

local cos = math.cos
local MODELS = {
  { "q + q^2", function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 - q[1] ^ 3 / 3 end, { -0.3 }, { 0.1 } },
  { "q^3", function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 4 / 4 end, { -0.3 }, { 0.1 } },
  { "Kepler", function(q, v) return v:dot(v) / 2 + 1 / q:norm() end, { 0.4, 0 }, { 0, 2 } },
  { "pendulums", function(q, v) return v:dot(v) / 2 + cos(q[1]) + cos(q[2] - q[1]) end, { 1, 0.2 }, { 0, 0.3 } },
  { "coupled", function(q, v) return v:dot(v) / 2 + 0.3 * v[1] * v[2] - q[1] ^ 2 * q[2] - q[2] ^ 2 - (q[1] - q[2]) ^ 4 end,
    { 0.1, 0.2 }, { 0, 0.1 } },
}
local RULES = { "verlet", "symplectic-euler", "symplectic-euler(b)", "yoshida(4)", "blanes-moan(6)", "log-hamiltonian" }
local STEPS = 2000

local function last_of(path)
  local r, out = #path, {}
  for i = 1, #path.q[r] do out[#out + 1] = ("%a %a"):format(path.q[r][i], path.p[r][i]) end
  return table.concat(out, " ")
end

for _, model in ipairs(MODELS) do
  local name, L, q, v = table.unpack(model)
  local system, count, other = dm.system { Q = dm.R(#q), L = L }, 0, {}
  for _, rule in ipairs(RULES) do
    local fine, solver = pcall(system.solver, system, { rule = rule, h = 0.0437 })
    local function alone(every) return last_of(solver:run { q = q, v = v, steps = STEPS, every = every }) end
    local ran, whole = pcall(alone, STEPS)
    if fine and ran then -- log-hamiltonian wants a well that attracts
      count = count + 1
      for _, every in ipairs { 1, 8, 100 } do
        if alone(every) ~= whole then other[#other + 1] = rule .. ", a row every " .. every end
        local e = solver:ensemble { members = 9, q = function() return q end, v = function() return v end, steps = STEPS,
          every = every }
        for i = 1, 9 do
          if last_of(e:path(i)) ~= whole then other[#other + 1] = ("%s, member %d, every %d"):format(rule, i, every) end
        end
      end
    end
  end
  tap.ok(#other == 0 and count >= 5, ("%s: %d rules"):format(name, count), table.concat(other, "; "))
end
tap.done()
