-- dmlua tests/bench/table/instructions.lua BEFORE NOW [WORD ...] - rows of make bench by two builds: instructions a step,
-- which do not depend on what else the machine does. Each row runs inside callgrind at level fma with two numbers of
-- steps: the difference is that of steps alone, a step of one member. WORDs: rows that have them all.
-- From the top of the tree: build/dmlua tests/bench/table/instructions.lua OTHER/build/dmlua build/dmlua Kepler
local ROWS = { -- model, rule, steps, members
  { "P1-0.6", "verlet", 20000 }, { "P1-0.6", "verlet", 2000, 64 }, { "P1-0.6", "blanes-moan(6)", 8000 },
  { "P1-0.6", "blanes-moan(6)", 1000, 64 }, { "P1-0.6", "kahan-li(8)", 1000, 64 },
  { "P1-0.6", "midpoint", 8000 }, { "P1-0.6", "trapezoidal", 4000 }, { "P1-0.6", "del", 4000 },
  { "P1-0.6", "gauss(2)", 4000 }, { "P1-0.6", "gauss(2)", 400, 16 }, { "P1-0.6", "gauss(3)", 4000 },
  { "P1-0.6", "gauss(6)", 2000 }, { "P1-0.6", "gauss(8)", 2000 },
  { "P2", "midpoint", 4000 }, { "P2", "gauss(2)", 4000 }, { "P2", "gauss(3)", 4000 }, { "P2", "gauss(2)", 400, 16 },
  { "P3", "midpoint", 1000 }, { "P3", "midpoint", 300, 16 }, { "P3", "gauss(2)", 1000 }, { "P3", "gauss(2)", 300, 16 },
  { "P3", "gauss(3)", 1000 }, { "P3", "gauss(3)", 300, 16 }, { "P3", "gauss(4)", 500 }, { "P3", "gauss(4)", 200, 16 },
  { "P3", "gauss(6)", 500 }, { "P3", "gauss(6)", 200, 16 }, { "P3", "gauss(8)", 500 }, { "P3", "gauss(8)", 200, 16 },
  { "P4", "midpoint", 2000 }, { "P4", "gauss(2)", 2000 }, { "P4", "gauss(4, 3)", 2000 }, { "P4", "rk8pd", 500 },
  { "P6-1e4", "gauss(2)", 4000 }, { "P6-1e4", "gauss(3)", 4000 },
  { "P8-fpu-3", "gauss(2)", 4000 }, { "P8-fpu-3", "gauss(3)", 4000 }, { "P8-toda-3", "gauss(2)", 4000 },
  { "P8-fpu-32", "gauss(2)", 1000 }, { "three bodies", "midpoint", 4000 },
  { "double spherical pendulum", "midpoint", 2000 }, { "double spherical pendulum", "midpoint", 300, 16 },
  { "double spherical pendulum", "gauss(2)", 1000 }, { "double spherical pendulum", "lobatto(3)", 500 },
  { "spherical pendulum in space", "midpoint", 2000 }, { "double spherical pendulum in space", "midpoint", 1000 },
  { "double spherical pendulum in R^6", "rattle", 8000 },
}
local STEP = { ["P1-0.6"] = 0.05, P2 = 0.05, P3 = 100, P4 = 0.01, ["P6-1e4"] = 0.01, ["P8-fpu-3"] = 0.1,
  ["P8-toda-3"] = 0.1, ["P8-fpu-32"] = 0.1 }

local function model_of(key)
  for _, file in ipairs { "models", "step_models" } do
    for _, m in ipairs(dofile("tests/bench/dm/" .. file .. ".lua")) do
      if m.key == key then return m end
    end
  end
end

-- members a little apart
local function starts(m, members)
  local q, v = {}, {}
  for i = 1, members do
    q[i], v[i] = { table.unpack(m.q) }, m.v
    q[i][1] = q[i][1] + 1e-3 * i / members * (m.constraint and 0 or 1)
  end
  return dm.matrix(q), dm.matrix(v)
end

local function solver_of(m, rule, h)
  if rule ~= "del" then return m.system:solver { rule = rule, h = h } end
  local L = m.system.given.L
  return dm.solver { dm.discrete_lagrangian { Q = m.system.Q, h = h, Ld = function(a, b)
    return h * (L(a, (b - a) / h) + L(b, (b - a) / h)) / 2
  end } }
end

local function run(row, steps)
  local key, rule, _, members = table.unpack(row)
  local m = model_of(key)
  local solver = solver_of(m, rule, m.h or STEP[key])
  local name = rule == "del" and "p" or "v" -- an Ld takes no v; masses are one
  if not members then return solver:run { q = m.q, [name] = m.v, steps = steps, every = steps } end
  local q, v = starts(m, members)
  solver:ensemble { members = members, q = q, v = v, steps = steps, threads = 1 }
end

local CLOCK = "build/bench/still_clock.so" -- bursts whose lengths the clock chooses are those of a fast machine
local COMMAND = "DMLUA_PROCESSOR=fma LD_PRELOAD=" .. CLOCK .. " valgrind --tool=callgrind --callgrind-out-file=/dev/null "
  .. "--toggle-collect=dm_run --toggle-collect=dm_ensemble_run %s %s run %d %d 2>&1"
local function count(program, i, steps)
  local pipe = assert(io.popen(COMMAND:format(program, arg[0], i, steps)))
  local said = pipe:read "a"
  local counted = said:match "Collected : (%d+)"
  return pipe:close() and tonumber(counted) or error(("%s, row %d: %s"):format(program, i, said), 0)
end

local function is_asked_for(text)
  for k = 3, #arg do
    if not text:find(arg[k], 1, true) then return false end
  end
  return true
end

if arg[1] == "run" then
  run(ROWS[tonumber(arg[2])], tonumber(arg[3]))
else
  assert(os.execute("mkdir -p build/bench && cc -shared -fPIC -o " .. CLOCK .. " tests/bench/table/still_clock.c"))
  print(("%-34s %-16s %7s %9s %9s %7s"):format("row", "rule", "members", "before", "now", "ratio"))
  for i, row in ipairs(ROWS) do
    local key, rule, steps, members = table.unpack(row)
    if is_asked_for(("%s %s %s"):format(key, rule, members and "members" or "alone")) then
      local less = steps // 4
      local function a_step(program) return (count(program, i, steps) - count(program, i, less)) / (steps - less) / (members or 1) end
      local before, now = a_step(arg[1]), a_step(arg[2])
      print(("%-34s %-16s %7s %9.1f %9.1f %7.3f"):format(key, rule, members or "", before, now, now / before))
    end
  end
end
