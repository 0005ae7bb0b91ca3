--- Arguments: numbers, texts, functions and objects of every kind, and what fits a name in the
-- signature of a doc, so that calls get past the first check.
local dm = require "dm"
local callbacks = require "callbacks"

local M = {}

---- what anything may be ----

local NUMBERS = { 0, 1, 2, 3, -1, 0.5, 1e-3, -0.0, 1e300, -1e300, 5e-324, 0 / 0, 1 / 0, -1 / 0, 7,
  100, math.maxinteger, math.mininteger, 2 ^ 31, 2 ^ 32, 2 ^ 53, 2 ^ 63, 1.5 }
local STRINGS = { "", "q1", "t", "energy", "verlet", "gauss(2)", "gauss(", "gauss(-1)",
  "lobatto(3)", "gauss(9999)", "midpoint", "\0", "%s%n", ("x"):rep(1000), "dm.path",
  "no/such/folder/f.csv", "f.csv", "f.npy", "\xff\xfe", "nan", "boundary", "vertices", "dual" }
local RULES = { "verlet", "midpoint", "trapezoidal", "gauss(2)", "gauss(3)", "lobatto(3)", "rk4",
  "rkf45", "rk8pd", "yoshida(4)", "suzuki(4, midpoint)", "mclachlan(4)", "lie(1)", "lie(2)",
  "lie(1, cayley)", "log-hamiltonian(verlet)", "blanes-moan(4, 6)", "degenerate(2)", "rattle",
  "euler-a", "shake", "kahan-li(6)" }

local function raises() error "raised on purpose" end
local FUNCTIONS = { raises, function() error {} end, function() end, function(q) return q end,
  function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end, function(q) return q[1] * q[1] end,
  function() return 0 / 0 end, function() return {} end, function() return "x" end,
  function(...) return select("#", ...) end, math.sin, coroutine.yield,
  function(q) return dm.derivative(function(x) return x[1] * q[1] end, 1) { 1 }[1] end }
-- what is right somewhere, and then goes wrong
local RIGHT = { FUNCTIONS[4], FUNCTIONS[5], FUNCTIONS[6], function(_, v) return v[1] end,
  function(i) return { i, 0 } end, function(a, b) return (b - a):dot(b - a) end,
  function() return 1 end, function(x, f, h) return x + h * f(x) end,
  function(x, y) return { y, x } end, function(...) return { ... } end,
  function(...) return (...) end, function(x, y) return x * y end }
local deep = {}
for _ = 1, 200 do deep = { deep } end
local cyclic = {}
cyclic[1], cyclic.q, cyclic.x = cyclic, cyclic, cyclic
local hostile = setmetatable({}, { __index = raises, __len = raises, __tostring = raises,
  __call = raises })

local random, pool, made
local function pick(list) return list[random(#list)] end
M.pick = pick

local value, fitting

local function list(depth)
  local t = {}
  for i = 1, random(0, 4) do t[i] = value(depth + 1) end
  return t
end
local function callback() return callbacks.callback(random, pick(RIGHT), value) end
local KINDS = {
  function() return nil end,
  function() return pick(NUMBERS) end,
  function() return random() * 4 - 2 end,
  function() return random(-2, 6) end,
  function() return pick(STRINGS) end,
  function() return random() < 0.5 end,
  function() return pick(FUNCTIONS) end,
  function() return pool[random(#pool)] end,
  function() return pool[random(made)] end,
  function() return { random(), random() } end,
  function() return dm.vector { random(), pick(NUMBERS) } end,
  function() return pick { deep, cyclic, hostile } end,
  list, callback,
}
value = function(depth)
  if depth > 3 then return pick(NUMBERS) end
  return pick(KINDS)(depth)
end
M.value = value

---- what fits a name ----

local function class_of(x)
  local meta = debug.getmetatable(x)
  local name = type(meta) == "table" and rawget(meta, "__name")
  return type(name) == "string" and name or nil
end

local by_class -- class -> objects of the pool as it was made
local function of_class(class)
  local some = by_class[class]
  if random(4) == 1 then
    local newer = pool[random(#pool)] -- a result of an earlier call
    if class_of(newer) == class then return newer end
  end
  return some and pick(some)
end
M.of_class = of_class

-- how many coordinates the object has that the method is called on
local function size_of(self)
  local fine, n = pcall(function()
    local Q = self.Q or self.system and self.system.Q or self
    return Q.dimension or #self
  end)
  return fine and math.type(n) == "integer" and n > 0 and n < 9 and n or random(1, 3)
end
local function reals(n)
  local out = {}
  for i = 1, n do out[i] = random(12) == 1 and pick(NUMBERS) or random() * 2 - 1 end
  return out
end
local function numbers_of(self)
  local out = reals(size_of(self))
  local kind = random(8)
  return kind == 1 and dm.vector(out) or kind == 2 and out[1] or out
end
local function element_of(self)
  local fine, g = pcall(function()
    local G = self.Q or self.group or self
    assert(G.dimension < 40) -- a result may be R^(10^9)
    return G:exp(reals(G.dimension))
  end)
  return fine and g or numbers_of(self)
end
local function integer() return random(0, 3) end
local function a_system()
  return of_class(pick { "dm.system", "dm.system", "dm.discrete_lagrangian" })
end
local function some_steps() return pick { 0, 1, 2, 3, 10, 20, 1.5, -1, "10" } end
local function function_or_wrong() return random(3) == 1 and callback() or pick(RIGHT) end
local function matrix()
  local n, out = random(1, 3), {}
  for i = 1, n do out[i] = reals(n) end
  return random(2) == 1 and out or dm.matrix(out)
end
local function integers()
  local rows, out = random(1, 3), {}
  for i = 1, rows do
    out[i] = {}
    for j = 1, rows + random(-1, 1) do out[i][j] = random(-3, 3) end
  end
  return out
end
local function file()
  return pick { "f.csv", "f.npy", "f.html", "f.vtk", "f.off", "f.obj", "f.txt", "no/such/f" }
end
local function per_cell(self)
  local fine, n = pcall(function() return self:count(random(0, self.dimension)) end)
  return fine and n < 300 and random(3) > 1 and dm.vector(reals(n)) or numbers_of(self)
end

local FIT = {
  h = function() return pick { 0.01, 0.1, 0.1, 1e-300, 1e300, -0.1, { 0.1, 0.05 } } end,
  t = function() return pick { 0, 0.1, 1, -1, 0 / 0, 0.35 } end, rule = function()
    return random(8) == 1 and of_class "dm.rule" or pick(RULES)
  end,
  rules = function() return { pick(RULES), pick(RULES) } end,
  system = a_system, Ld = function()
    return random(2) == 1 and of_class "dm.discrete_lagrangian" or pick(FUNCTIONS)
  end,
  f = function() return random(3) == 1 and of_class(pick { "dm.function", "dm.form",
    "dm.simplicial_map" }) or function_or_wrong() end,
  steps = some_steps, every = function() return pick { 1, 3, 0, -1, 1000 } end,
  Q = function() return of_class "dm.space" end,
  members = function() return pick { 0, 1, 2, 3, 9, -1, 1e9 } end,
  threads = function() return pick { 0, 1, 2, 3 } end,
  newton = function()
    return pick { {}, { tolerance = 1e-6 }, { tolerance = -1 }, { max_iterations = 1 } }
  end,
  derivatives = function() return pick { "exact", "hyperdual" } end,
  backend = function() return pick { "tape", "native", "jit", "auto" } end,
  sums = function() return pick { "plain", "compensated" } end,
  file = file, checkpoint = function() return "f.checkpoint" end,
  cyclic = function() return pick { 1, { 1 }, "q1", { 1, 1 } } end,
  mu = function() return pick { 1, { 1 }, { 0.5, 1.5 }, 0 / 0 } end,
  region = function() return pick { { 0.5, 2 }, { { 0, 1 }, { 0, 1 } } } end,
  exponents = function() return pick { 1, 2, 3, 4, "all" } end,
  period = function() return pick { 1, 0.5, -1 } end,
  k = integer, l = function(self) return random(2) == 1 and integer() or function_or_wrong(self) end,
  i = function() return random(0, 9) end, j = function() return random(0, 9) end,
  m = integer, n = integer, d = integer, degree = integer, vertex = function() return random(9) end,
  count = integer, points = function(self)
    return random(2) == 1 and random(0, 6) or { numbers_of(self), numbers_of(self) }
  end,
  group = function() return of_class "dm.space" end, G = function() return of_class "dm.space" end,
  H = function() return of_class(pick { "dm.space", "dm.system" }) end,
  V = function() return of_class "dm.space" end,
  action = function() return of_class "dm.action" end,
  advected = function() return of_class "dm.action" end,
  frame = function() return of_class "dm.frame" end,
  g = element_of, K = function() return of_class "dm.mesh" end,
  L = function() return random(3) == 1 and of_class "dm.mesh" or pick(FUNCTIONS) end,
  c = function() return of_class "dm.chain" end,
  A = matrix, D = matrix, M = matrix, S = function() return of_class "dm.sparse" end,
  mass = function() return of_class "dm.sparse" end,
  factor = function() return of_class "dm.factor" end,
  X = function() return of_class "dm.vector_field" end,
  rows = integers, columns = integers, over = function() return pick { "Z", "Q", 2, 5, 4 } end,
  top = function() return { integers(), integers() } end,
  maps = function() return { integers(), integers(), integers() } end,
  simplices = function() return { { 1, 2, random(3, 5) }, { 2, 3, random(4) } } end,
  lengths = function() return random(2) == 1 and 1 or function_or_wrong() end,
  relative = function() return pick { "boundary", {}, { { 1, 2 } } } end,
  fixed = function() return pick { "boundary", { boundary = 0 }, { [1] = 1 }, { 1, 2 } } end,
  dual = function() return pick { true, false, "barycentric", "circumcentric" } end,
  pinv = function() return pick { true, false } end,
  on = function() return pick { "vertices", "cells" } end,
  to = function() return pick { "vertices", "cells", "primal", "dual" } end,
  boundary = function() return pick { "flux", 0, 1 } end,
  hub = function() return random(5) end, at = function() return pick { 0, 1, { 0.5, 0.5 } } end,
  x = per_cell, values = per_cell, alpha = per_cell, order = integer, chart = function()
    return random(2) == 1 and "x" or nil
  end,
  name = function() return pick(STRINGS) end, spec = function() return pick(STRINGS) end,
  seed = integer, stream = function() return of_class "dm.random" end,
  bottom = function() return { integers(), integers() } end,
  seconds = function() return 0.01 end, repeats = function() return 1 end,
  samples = function() return pick { 1, 2, 3 } end, starts = function() return pick { 1, 2, 3 } end,
  until_t = function() return pick { 0.1, 0.5, 1 } end, sites = integer, up_to = integer,
  frames = integer,
  fn = function_or_wrong, width = function() return pick { 10, 40, 0, 1e9 } end,
  height = function() return pick { 5, 20, 0, 1e9 } end,
}
for _, key in ipairs { "constraint", "rolling", "force", "control", "reaction", "equation", "next",
  "map", "cross_section", "branch", "solution", "equations", "stationary", "term", "inside",
  "permeability", "source", "pressure", "flux", "watch", "project", "start", "draw" } do
  FIT[key] = function_or_wrong
end
for _, key in ipairs { "q", "v", "p", "q0", "q1", "p0", "p1", "x0", "x1", "x2", "theta", "z", "z1",
  "xi", "eta", "w", "y", "u", "dq", "dv", "dp", "list", "guess", "first", "last" } do
  FIT[key] = numbers_of
end

-- a form beside this one, as operands are: mostly of the same mesh
local function operand(self)
  local class = class_of(self)
  local other = class and of_class(class)
  return other ~= nil and other or value(0)
end
FIT.a, FIT.b = operand, operand
for _, key in ipairs { "q", "x", "u" } do
  local plain = FIT[key]
  FIT[key] = function(self)
    local class = class_of(self)
    if class == "dm.solver" or class == "dm.system" or class == "dm.action" then
      return random(4) == 1 and element_of(self) or plain(self)
    end
    return plain(self)
  end
end

---- from the items of a signature ----

-- how long a call takes: what is asked to go on for ever says nothing
local BOUNDED = { steps = true, t = true, until_t = true, up_to = true, members = true, n = true,
  seconds = true, samples = true, sites = true, frames = true, repeats = true, h = true, at = true,
  points = true, order = true, starts = true, n0 = true }

local function choice(item, self, depth)
  local c = pick(item)
  if c.text then return c.text end
  if c.items then return fitting(c.items, self, depth + 1) end
  local fit = FIT[item.key or c.word] or FIT[c.word]
  if not fit or random(8) == 1 and not BOUNDED[item.key or c.word] then return value(depth) end
  return fit(self)
end

--- A table of options by the items: most keys, some of them with what does not belong there.
fitting = function(items, self, depth)
  local t = {}
  if depth > 4 then return t end
  for _, item in ipairs(items) do
    if not item.key then t[#t + 1] = choice(item, self, depth)
    elseif random(3) > 1 then t[item.key] = choice(item, self, depth) end
  end
  if random(30) == 1 then t[pick(STRINGS)] = value(depth) end
  return t
end

--- Arguments by the items of one way to call it, behind `self` for a method: list, number of them.
function M.by_signature(items, self, is_method)
  local out, n = {}, 0
  if is_method then out[1], n = self, 1 end
  for i, item in ipairs(items) do
    if i > 1 and random(6) == 1 then break end
    n = n + 1
    if not item.key then out[n] = choice(item, self, 0) end
  end
  if random(20) == 1 then
    n = n + 1
    out[n] = value(0)
  end
  return out, n
end

--- Arguments of any kind.
function M.anything(self, is_method)
  local out, n = {}, random(0, 3)
  for i = 1, n do out[i] = value(0) end
  if is_method then return { self, table.unpack(out, 1, n) }, n + 1 end
  return out, n
end

--- A table like `t`: a field changed or left out, functions that go wrong after some calls.
function M.like(t, depth)
  if type(t) ~= "table" or getmetatable(t) or depth > 3 then return t end
  local out, keys = {}, {}
  for key, x in next, t do
    out[key], keys[#keys + 1] = x, key
    if type(x) == "function" and random(8) == 1 then
      out[key] = callbacks.callback(random, x, value)
    end
  end
  table.sort(keys, function(a, b) return tostring(a) < tostring(b) end)
  if #keys == 0 or random(4) == 1 then return out end
  local key = pick(keys)
  if type(out[key]) == "table" and random(3) > 1 then
    out[key] = M.like(out[key], depth + 1)
  elseif FIT[key] and random(2) == 1 then
    out[key] = FIT[key](nil)
  elseif BOUNDED[key] then
    out[key] = pick { 0, -1, 1.5, "x", {}, 0 / 0, 2 }
  else
    out[key] = value(1)
  end
  return out
end

--- Says where objects come from: a list that grows by results, and how many were made before.
function M.open(generator, objects)
  random, pool, made, by_class = generator, objects, #objects, {}
  for _, x in ipairs(objects) do
    local class = class_of(x)
    if class then
      by_class[class] = by_class[class] or {}
      table.insert(by_class[class], x)
    end
  end
end

M.class_of = class_of

return M
