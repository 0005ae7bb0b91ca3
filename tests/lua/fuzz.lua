--[[ dmlua tests/lua/fuzz.lua SECONDS [SEED] [CALLS] - random arguments to every function, method and operator, options by the names that
docs give them, functions that go wrong in every way, and files that were spoilt; until so many seconds, or calls, are over.
Whatever is given, a call must return or raise an error with a message: it must not crash, hang or
leave a message that says nothing. Prints the number of calls; under sanitizers it also finds what
only they see. Files are written to the current folder: tests/lua/value/test_fuzz.lua makes an empty one.
The call that is under way is in the file "last-call", so that a crash names it.]]
local here = arg[0]:match "^(.*)/" or "."
package.path = here .. "/?.lua;" .. package.path
local dm = require "dm"
local parts = require "fuzz_parts"
local reference = require "dm.session.reference"
local docs = require "dm.core".docs

local seconds, seed, most = tonumber(arg[1]) or 10, math.tointeger(arg[2]) or 1, math.tointeger(arg[3]) or math.maxinteger
math.randomseed(seed)
local random = math.random
local function pick(list) return list[random(#list)] end

---- what is called

local calls = {} -- { name, function, class of self or nil }
-- left out: what ends the process, waits for the keyboard or takes minutes by design
local skip = { ["dm.core"] = true, ["dm.time"] = true, ["dm.demo"] = true, ["core.end_file"] = true }
for name, f in pairs(reference.functions(dm)) do
  if not skip[name] then calls[#calls + 1] = { name, f, nil, parts.keys(docs[f]) } end
end
for name, f in pairs(reference.for_modules()) do
  if not skip[name] then calls[#calls + 1] = { name, f } end
end
for class, methods in pairs(reference.classes()) do
  for name, f in pairs(methods) do calls[#calls + 1] = { class .. ":" .. name, f, class, parts.keys(docs[f]) } end
  local meta = debug.getregistry()[class]
  for name, f in pairs(meta) do
    -- collecting twice by hand is a broken promise of the script that has debug.getregistry
    if type(f) == "function" and name ~= "__gc" and name ~= "__close" then
      calls[#calls + 1] = { class .. "." .. name, f, class }
    end
  end
end
for _, name in ipairs { "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "max", "min",
  "floor", "ceil", "fmod", "tointeger", "modf" } do
  calls[#calls + 1] = { "math." .. name, math[name] }
end
table.sort(calls, function(a, b) return a[1] < b[1] end) -- one order for one seed

---- what they are called with

local stale -- a symbol that outlived its trace
pcall(function() dm.derivative(function(x) stale = x[1]; return x[1] end, 1) { 1 } end)
local stale_vector
pcall(function() dm.derivative(function(x) stale_vector = x; return x[1] end, 2) { 1, 2 } end)

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local swing = dm.system { Q = dm.T(1), L = function(q, v) return v:dot(v) / 2 + math.cos(q[1]) end }
local mine = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 * (2 + q[1] ^ 2) - q[1] ^ 4 end }
local solver = kepler:solver { rule = "verlet", h = 0.01 }
local path = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 20 }
local clipped = dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v)
  if q[1] > 0 then return v[1] ^ 2 / 2 - q[1] ^ 2 end
  return v[1] ^ 2 / 2 - q[1] ^ 4
end }
local own = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(q0, q1, h)
  return (q1[1] - q0[1]) ^ 2 / (2 * h) - h * (q0[1] + q1[1]) ^ 2 / 8
end }
local stiff = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.exp(q[1]) end }
local _, failure = pcall(function()
  stiff:solver { rule = "midpoint", h = 2 }:run { q = { 0 }, v = { 0 }, steps = 1000 }
end)
local derived = dm.derivative(function(x) return dm.where(x[1], x[1] ^ 2, x[2]) * math.exp(x[2]) end, 2)

local function raises() error "raised on purpose" end
local function raises_table() error {} end
local deep = {}
for _ = 1, 200 do deep = { deep } end
local cyclic = {}
cyclic[1], cyclic.q, cyclic.x = cyclic, cyclic, cyclic
local hostile = setmetatable({}, { __index = raises, __len = raises, __tostring = raises, __call = raises })

local numbers = { 0, 1, 2, 3, -1, 0.5, 1e-3, -0.0, 1e300, -1e300, 5e-324, 0 / 0, 1 / 0, -1 / 0, 7, 100,
  math.maxinteger, math.mininteger, 2 ^ 31, 2 ^ 32, 2 ^ 53, 2 ^ 63, 1.5 }
local strings = { "", "q1", "t", "energy", "verlet", "gauss(2)", "gauss(", "gauss(-1)", "lobatto(3)", "gauss(9999)",
  "midpoint", "\0", "%s%n", ("x"):rep(1000), "dm.path", "no/such/folder/f.csv", "f.csv", "f.npy", "\xff\xfe", "nan" }
local functions = { raises, raises_table, function() end, function(q) return q end,
  function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end, function(q) return q[1] * q[1] end,
  function() return 0 / 0 end, function() return stale end, function() return {} end, function() return "x" end,
  function(...) return select("#", ...) end, math.sin, coroutine.yield, coroutine.wrap(function() coroutine.yield() end),
  function(q) return dm.derivative(function(x) return x[1] * q[1] end, 1) { 1 }[1] end,
  function(q) local function f(n) return f(n + 1) + 1 end return f(1) end }
local pool = {}
local function add(...)
  for i = 1, select("#", ...) do pool[#pool + 1] = (select(i, ...)) end
end
add(kepler, swing, mine, solver, path, failure, stale, stale_vector, dm.R(2), dm.T(1), dm.SO(3), dm.SO(2),
  dm.vector { 1, 2, 3 }, dm.vector { 1, 0 }, dm.matrix { { 1, 2 }, { 3, 4 } }, dm.matrix { { 1, 2 }, { 2, 4 } },
  dm.matrix { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, io.stderr, coroutine.create(raises),
  dm.trace(function(x) return x[1] * x[2] end, 2), derived, clipped, own, stiff, dm.solver { own },
  clipped:solver { rule = "midpoint", h = 0.1 }, swing:solver { rule = "trapezoidal", h = 0.1 },
  mine:solver { rule = "gauss(2)", h = 0.1 }, mine:solver { rule = "rk8pd", h = 0.1 },
  kepler:solver { rule = "lobatto(3)", h = 0.1 }, kepler:solver { rule = "yoshida(4)", h = 0.1 },
  solver:ensemble { members = 3, q = function(i) return { i, 0 } end, v = function() return { 0, 1 } end,
    steps = 10 })

-- an object of every other class
parts.objects(add)
-- a reduced system and what comes of it
local planet = dm.system { Q = dm.R(2), L = function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2] end }
local shape = planet:routh { cyclic = 1, mu = 1 }
local at_rest = shape:relative_equilibria { region = { 0.5, 2 }, starts = 5 }[1]
add(planet, shape, shape:discrete { rule = "gauss(2)", h = 0.1 }, shape:solver { rule = "gauss(2)", h = 0.1 }, at_rest,
  shape:solver({ rule = "gauss(2)", h = 0.1 }):run { q = 1, v = 0.1, steps = 20 }, shape:continue(at_rest, { mu = { 0.5, 1.5 }, step = 0.2 }))

local made = #pool -- results of calls stand behind what was made above
local value
local keys = { "cyclic", "action", "section", "mu", "connection", "region", "theta", "from", "to", "q", "v", "p", "q0", "q1", "p0", "p1", "h", "t", "rule", "steps", "every", "Q", "L", "Ld", "params", "newton",
  "tolerance", "derivatives", "name", "units", "coordinates", "file", "title", "log", "degree", "quadrature", "x", "y",
  "width", "height", "at", "t0", "members", "threads",
  "backend", "max_iterations", 1, 2, 3 }
-- values that fit a key, so that calls get past the first check
local fitting = {
  Q = { dm.R(2), dm.R(1), dm.T(1), dm.SO(3) }, L = functions, Ld = functions, h = { 0.01, 0.1, 1e-300, 1e300, -0.1 },
  rule = { "verlet", "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "lobatto(3)", "rk4", "rkf45", "rk8pd",
    "yoshida(4)", "suzuki(4, midpoint)", "mclachlan(4)", "kahan-li(6)", "blanes-moan(4, 6)", "log-hamiltonian(verlet)" },
  derivatives = { "exact", "hyperdual" }, t = { 0, 0.1, 1, -1, 0 / 0 }, members = { 0, 1, 3, 65, -1 },
  threads = { 0, 1, 2, 3, 1000 }, newton = { {}, { tolerance = 1e-6 }, { tolerance = -1 }, { max_iterations = 1 } },
  q = { { 1, 0 }, { 1 }, { 0, 0 }, dm.vector { 1, 0 }, { 1, 0 / 0 } }, v = { { 0, 1 }, { 1 }, { 0, 0 } },
  p = { { 0, 1 }, { 1 } }, q0 = { { 1, 0 }, { 1 } }, q1 = { { 1, 0.01 }, { 1 } }, file = { "f.csv", "f.npy", "no/such/f" },
  cyclic = { 1, { 1 }, "q1", { 1, 1 } }, mu = { 1, { 1 }, { 0.5, 1.5 }, 0 / 0 }, region = { { 0.5, 2 }, { { 0, 1 }, { 0, 1 } } }, theta = { 0.1, { 0.1 } },
  action = { function(t, q) return { q[1] + t, q[2] } end, functions[4] }, from = { 1, { 0.5 } }, to = { 2, { 1.5 } },
  steps = { 0, 1, 10, 100, 1.5, -1, 2 ^ 62 // 1 | 0, "10" }, every = { 1, 3, 0, -1, 1000 },
}
local function options(depth)
  local t = {}
  for _ = 1, random(0, 5) do
    local key = pick(keys)
    if key == "steps" or key == "t" or (fitting[key] and random() < 0.8) then t[key] = pick(fitting[key] or numbers)
    else t[key] = value(depth + 1) end
  end
  return t
end
-- a call that is nearly right: what a run or a system needs, with one field wrong
local function nearly(depth)
  local t = pick { { Q = dm.R(2), L = functions[5] }, { rule = pick(fitting.rule), h = 0.01 },
    { q = { 1, 0 }, v = { 0, 1 }, steps = 10 }, { q = { 1 }, v = { 0.1 }, steps = 10, every = 2 },
    { members = 3, q = function(i) return { i } end, v = function() return { 1 } end, steps = 5, threads = random(0, 3) },
    { members = 2, q = { { 1, 0 }, { 2, 0 } }, v = { { 0, 1 }, { 0, 1 } }, steps = 5 }, { q = { 1, 0 }, p = { 0, 1 }, t = 1 },
    { Q = dm.R(1), L = functions[6], derivatives = "hyperdual" }, { Q = dm.R(1), h = 0.1, Ld = functions[5] } }
  if random() < 0.3 then return t end
  local key = pick(keys)
  t[key] = fitting[key] and pick(fitting[key]) or value(depth + 1)
  return t
end
-- options by the names of the doc of what is called
local function documented(keys, depth)
  local t = {}
  for _ = 1, random(1, 6) do
    local key = pick(keys)
    if fitting[key] and random() < 0.7 then t[key] = pick(fitting[key]) else t[key] = value(depth + 1) end
  end
  return t
end
local rights = { functions[4], functions[5], functions[6], function(q, v) return v[1] end, function(i) return { i, 0 } end,
  function(a, b) return (b - a):dot(b - a) end, function() return 1 end, function(x, f, h) return x + h * f(x) end }
local function callback() return parts.callback(random, pick(rights), value) end
local function list(depth)
  local t = {}
  for i = 1, random(0, 4) do t[i] = value(depth + 1) end
  return t
end
local makers = {
  function() return nil end,
  function() return pick(numbers) end,
  function() return random() * 4 - 2 end,
  function() return random(-2, 6) end,
  function() return pick(strings) end,
  function() return random() < 0.5 end,
  function() return pick(functions) end,
  function() return pool[random(made + 60)] end,
  function() return pool[random(made)] end,
  function() return { random(), random() } end,
  function() return dm.vector { random(), pick(numbers) } end,
  function() return pick { deep, cyclic, hostile } end,
  list, options, options, nearly, nearly, callback, callback,
}
function value(depth)
  if depth > 3 then return pick(numbers) end
  return pick(makers)(depth)
end

---- calling

local function class_of(x)
  local meta = debug.getmetatable(x)
  return type(meta) == "table" and rawget(meta, "__name")
end
local function of_class(class)
  local some = {}
  for _, x in pairs(pool) do
    if class_of(x) == class then some[#some + 1] = x end
  end
  return #some > 0 and pick(some) or value(1)
end
local log = assert(io.open("last-call", "w"))
local function note(text)
  log:seek "set"
  log:write(text, (" "):rep(200), "\n")
  log:flush()
end
-- a short word for an argument, without calling anything of it
local function shown(x, depth)
  local kind = math.type(x) or type(x)
  if kind == "string" then return ("%q"):format(x:sub(1, 20)) end
  if kind == "table" and depth < 2 and getmetatable(x) == nil then
    local words = {}
    for k, v in next, x do words[#words + 1] = shown(k, 2):sub(1, 20) .. "=" .. shown(v, depth + 1) end
    return "{" .. table.concat(words, ", ") .. "}"
  end
  if kind == "userdata" then return (getmetatable(x) or {}).__name or kind end
  return kind == "function" and kind or kind == "table" and kind or tostring(x)
end
local function listed(arguments, n)
  local words = {}
  for i = 1, n do words[i] = shown(arguments[i], 0) end
  return table.concat(words, ", ")
end
-- what is asked to go on for ever, such as 2^31 samples, is stopped: loops of C look at their own limits
local INSTRUCTIONS = 3e6
local function too_long() error("interrupted! the fuzzer lost patience", 0) end
local function guarded(f)
  return function(...)
    debug.sethook(too_long, "", INSTRUCTIONS)
    return f(...)
  end
end
local empty = {} -- functions that raised a message without words
local spoil = parts.files(random)
local function once(i)
  local call, arguments = pick(calls), {}
  if random(400) == 1 then call = { "a spoilt file", spoil } end
  local n = random(0, 4)
  for k = 1, n do arguments[k] = value(0) end
  if call[4] and #call[4] > 0 and random() < 0.6 then
    local at = call[3] and 2 or random(1, math.max(n, 1))
    n = math.max(n, at)
    arguments[at] = documented(call[4], 0)
  end
  if call[3] and random() < 0.9 then
    n = math.max(n, 1)
    arguments[1] = of_class(call[3])
  end
  note(("seed %d call %d: %s(%s)"):format(seed, i, call[1], listed(arguments, n)))
  local f = call[2]
  local called = guarded(f)
  local fine, result = pcall(random() < 0.95 and called or coroutine.wrap(called), table.unpack(arguments, 1, n))
  debug.sethook()
  if not fine and type(result) == "string" and not result:find "%a%a%a" then empty[call[1]] = result end
  -- results live on as arguments
  if fine and (type(result) == "userdata" or getmetatable(result)) and random() < 0.2 then pool[made + random(60)] = result end
  if fine then pcall(tostring, result) end
  return fine, call[1]
end

-- pictures of the terminal and the like go nowhere
local report = io.stdout
io.stdout = assert(io.open("/dev/null", "w")) -- luacheck: ignore
io.output(io.stdout)
print = function() end -- luacheck: ignore
local start, n, returned = os.time(), 0, 0
local returns = {} -- by name
while os.difftime(os.time(), start) < seconds and n < most do
  for _ = 1, 50 do
    n = n + 1
    local fine, name = once(n)
    if fine then returned, returns[name] = returned + 1, true end
  end
end
log:close()
for name, message in pairs(empty) do report:write(("%s raised %q\n"):format(name, message)) end
local reached = 0
for _, call in ipairs(calls) do reached = reached + (returns[call[1]] and 1 or 0) end
report:write(("%d calls of %d functions, methods and operators: %d returned, of %d of them, the others raised an error\n")
  :format(n, #calls, returned, reached))
local without = {} -- classes of which there was no object
for class in pairs(reference.classes()) do
  local found = false
  for _, x in pairs(pool) do found = found or class_of(x) == class end
  if not found then without[#without + 1] = class end
end
table.sort(without)
if #without > 0 then report:write("no object of ", table.concat(without, " "), "\n") end
os.exit(next(empty) == nil, true)
