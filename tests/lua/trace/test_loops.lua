-- explicit steps as loops: the same bits on the tape, in machine code, in lanes and however a run is cut
local dm = require "dm"
local tap = require "tap"
local ok = tap.ok
local cos, sin = math.cos, math.sin

local models = {
  { "Kepler", q = { 0.6, 0.1 }, v = { 0.1, 1.2 }, well = true,
    system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end } },
  { "J2 and masses", q = { 1, 0, 0.2 }, v = { 0, 0.96, 0.28 }, well = true,
    system = dm.system { Q = dm.R(3), L = function(q, v)
      local r = q:norm()
      return (v[1] ^ 2 + 2 * v[2] ^ 2 + 3 * v[3] ^ 2) / 2 + 1 / r - 0.05 / r ^ 3 * (1.5 * q[3] ^ 2 / r ^ 2 - 0.5)
    end } },
  { "coupled masses, a force of time", q = { 0.5, -0.2 }, v = { 0.3, 0.1 },
    system = dm.system { Q = dm.R(2), L = function(q, v, s)
      return v[1] ^ 2 + v[1] * v[2] / 2 + v[2] ^ 2 + 0.3 * v[1] + cos(q[1]) + cos(q[2] - q[1]) + 0.1 * q[1] * sin(2 * s)
    end } },
  { "a spring that hangs", q = { 0.8, -0.6 }, v = { 0.2, 0.1 },
    system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 5 * (q:norm() - 1) ^ 2 - 1.3 * q[2] end } },
  { "springs in a row", q = { 0.1, 0, 0, 0, 0.2, 0, 0.3 }, v = { 0, 1, 0, -1, 0, 0.5, 0 },
    system = dm.system { Q = dm.R(7), L = function(q, v)
      local L = v:dot(v) / 2
      for i = 2, 7 do L = L - (q[i] - q[i - 1]) ^ 2 / 2 - (q[i] - q[i - 1]) ^ 4 / 4 end
      return L
    end } },
}
local rules = { "verlet", "kahan-li(6)", "blanes-moan(4)", "blanes-moan(6, 14)", "symplectic-euler",
  "log-hamiltonian(kahan-li(8))" }

local function same(a, b)
  if #a ~= #b then return false end
  for i = 1, #a do
    if a.q[i] ~= b.q[i] or a.p[i] ~= b.p[i] then return false end
  end
  return true
end

local steps, h = 300, 0.03
for _, model in ipairs(models) do
  for _, rule in ipairs(rules) do
    if model.well or not rule:find "^log" then
      local function run(backend, every)
        return model.system:solver { rule = rule, h = h, backend = backend }
          :run { q = model.q, v = model.v, steps = steps, every = every }
      end
      local name = model[1] .. ", " .. rule .. ": "
      local whole, native = run("tape", steps), run("jit", 1)
      ok(same(whole, run("jit", steps)), name .. "tape and machine code")
      ok(same(native, run("tape", 1)), name .. "step by step")
      -- where L depends on t, the time of a step in a burst is not that of a burst which begins there
      local timeless = not model[1]:find "time"
      if timeless then
        ok(native.q[#native] == whole.q[#whole] and native.p[#native] == whole.p[#whole], name .. "one burst or many")
        local largest = native:drift "energy".largest
        ok(largest < (rule == "symplectic-euler" and 0.1 or 5e-3), name .. "energy", largest)
      end
      local crowd = model.system:solver { rule = rule, h = h }
        :ensemble { members = 19, q = function() return model.q end, v = function() return model.v end, steps = steps, threads = 1 }
      local alike = true
      for i = 1, 19 do alike = alike and (crowd.q[i] == native.q[#native] and crowd.p[i] == native.p[#native]) end
      ok(alike, name .. "a member of an ensemble")
    end
  end
end

-- a second run finds the loops of the first
local kepler = models[1]
local function compile_ms(rule)
  local solver = kepler.system:solver { rule = rule, h = h }
  solver:run { q = kepler.q, v = kepler.v, steps = 1 }
  return solver:report().compile_ms
end
compile_ms "suzuki(4)"
local ms = math.huge
for _, rule in ipairs { "kahan-li(8)", "yoshida(6)", "mclachlan(4)", "sofroniou-spaletta(10)" } do ms = math.min(ms, compile_ms(rule)) end
ok(ms < 0.1, "compositions share one loop", ms)
tap.done()
