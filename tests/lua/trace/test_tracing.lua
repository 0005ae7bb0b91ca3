-- what a Lua function may and may not do when it is traced: exact derivatives, and an answer to every hazard
package.path = (arg[0]:match("^(.*/)") or "./") .. "?.lua;" .. package.path
local tap, dm = require "tap", require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local trace = dm.trace

-- exact derivatives against closed forms
local f = trace(function(x) return math.sin(x[1]) * x[2] ^ 3 end, 2)
ok(f { 0.3, 2 } == math.sin(0.3) * 8, "a traced function gives the value of the function")
near(f:gradient { 0.3, 2 }[2], 12 * math.sin(0.3), 1e-15, "gradient")
near(f:hessian { 0.3, 2 }[1][2], 12 * math.cos(0.3), 1e-15, "Hessian")
ok(f:hessian { 0.3, 2 } == f:hessian { 0.3, 2 }:transpose(), "the Hessian is symmetric")
ok(f:jacobian { 0.3, 2 }[1] == f:gradient { 0.3, 2 }, "the Jacobian of one output is the gradient")
ok(tostring(f):find("^function of 2 numbers to a number"), "it prints as a sentence", f)
ok(f:graph():find("sin(x1)", 1, true) and f:operations() >= 3, "graph and operations")
local polar = trace(function(r, phi) return { r * math.cos(phi), r * math.sin(phi) } end, "number", "number")
local J = polar:jacobian(2, 0.5)
near(J:det(), 2, 1e-15, "Jacobian of polar coordinates: determinant r")
ok(#polar(2, 0) == 2 and polar(2, 0)[1] == 2, "several arguments, a table as result")
raises("use f:jacobian", polar.gradient, polar, 1, 2)
raises("gives one number", polar.hessian, polar, 1, 2)

-- dm.derivative
local d = dm.derivative(function(x) return x ^ 3 end)
ok(d(2) == 12 and math.type(d(2)) == "float", "derivative of a function of one number is a number")
ok(dm.derivative(d)(2) == 12 and dm.derivative(dm.derivative(d))(5) == 6, "derivatives of derivatives")
ok(dm.derivative(function(x) return x:dot(x) end, 3) { 1, 2, 3 } == dm.vector { 2, 4, 6 }, "gradient as a vector")
ok(dm.derivative(f) { 0.3, 2 } == f:gradient { 0.3, 2 }, "derivative of a dm.function")
ok(dm.derivative(polar)(2, 0.5) == J, "derivative of a vector is a matrix")
local outer = trace(function(x) return f { x[2], x[1] } * 2 end, 2)
near(outer:gradient { 2, 0.3 }[1], 24 * math.sin(0.3), 1e-14, "a traced function inside a traced function")
local slope = trace(function(x) return dm.derivative(function(y) return y:dot(y) * y[1] end, 2)(x):sum() end, 2)
near(slope { 2, 3 }, 3 * 4 + 9 + 2 * 2 * 3, 1e-14, "a derivative taken inside a traced function")
near(d(dm.hyperdual(2, 1)).a, 12, 1e-14, "a traced function on hyper-dual numbers")

-- loops, tables, helpers, vectors and matrices made inside
local function poly(c, x) local y = 0; for k = #c, 1, -1 do y = y * x + c[k] end return y end
near(trace(function(x) return poly({ 1, 2, 3 }, x[1]) end, 1):gradient { 2 }[1], 14, 1e-14, "Horner's rule in a helper")
local filled = trace(function(x)
  local m, v = dm.zeros(2, 2), dm.vector(2)
  m[1][1], m[2][2], m[1][2], v[2] = x[1], 2, x[2], x[1] * 3
  return (m * v):dot { 1, 1 } + m:det()
end, 2)
near(filled { 5, 7 }, 7 * 15 + 2 * 15 + 10, 1e-12, "zeros filled with symbols")
ok(trace(function() return 4 end, 1) { 9 } == 4, "a constant")
ok(trace(function(x) return { 1, x[1] } end, 1) { 3 } == dm.vector { 1, 3 }, "numbers beside symbols")
ok(trace(function(x) return math.max(x[1], x[2], 0) end, 2):gradient { 3, 5 } == dm.vector { 0, 1 }, "max picks a side")
local text
trace(function(x) text = text or tostring(x[1] ^ 2 + math.sin(x[2])) .. tostring(x) return x[1] end, 2)
ok(text:find("x1") and text:find("sin(x2)", 1, true), "symbols print their expression", text)
local deep
trace(function(x) local y = x[1] for _ = 1, 200 do y = math.sin(y) + y end deep = deep or tostring(y) return y end, 1)
ok(#deep < 100, "a long expression is cut off", deep)

-- what needs a value raises and says what to use
local refused = {
  { "a comparison", function(x) return x[1] < 1 and x[1] or 0 end },
  { "a comparison <=", function(x) return 1 <= x[1] and x[1] or 0 end },
  { "== of symbols", function(x) return x[1] == x[2] and x[1] or 0 end },
  { "==  of vectors", function(x) return x == dm.vector { 1, 2 } and x[1] or 0 end },
  { "%", function(x) return x[1] % 2 end }, { "//", function(x) return x[1] // 2 end },
  { "&", function(x) return x[1] & 1 end }, { "~", function(x) return ~x[1] end },
  { "..", function(x) return x[1] .. "" end },
  { "math.floor", function(x) return math.floor(x[1]) end }, { "math.fmod", function(x) return math.fmod(x[1], 2) end },
  { "math.modf", function(x) return (math.modf(x[1])) end }, { "math.ceil", function(x) return math.ceil(x[1]) end },
  { "math.tointeger", function(x) return math.tointeger(x[1]) end },
}
for _, case in ipairs(refused) do
  local fine, message = pcall(trace, case[2], 2)
  ok(not fine and message:find("dm.where", 1, true) and message:find("test_tracing.lua:%d+:") or false,
    case[1] .. " is refused, with the place and what to use", message)
end
raises("no field 'x'", trace, function(x) return x[1].x end, 1)
raises("a call", trace, function(x) return x[1]() end, 1)
raises("cannot be an index", trace, function(x) return x[x[1]] end, 1)
raises("out of range", trace, function(x) return x[4] end, 2)
raises("got dm.symbol", trace, function(x) for i = 1, x[1] do return i end return 1 end, 1)

-- results
raises("must return a number, or a vector or table of numbers, got nil: is a return missing?", trace, function() end, 1)
raises("got none", trace, function() return {} end, 1)
raises("entry 1 of its result is string", trace, function() return { "x" } end, 1)
raises("got function", trace, function() return print end, 1)
raises("got dm.matrix", trace, function() return dm.identity(2) end, 1)

-- errors of the function itself
raises("oops", trace, function() error "oops" end, 1)
local object = { code = 7 }
local _, e = pcall(trace, function() error(object) end, 1)
ok(e == object, "an error object comes out as it is")
_, e = pcall(trace, function() error(nil) end, 1)
ok(e == nil, "an error that is nil comes out as it is")
local function culprit() local x = nil; return x.y end
local _, traceback = xpcall(trace, debug.traceback, culprit, 1)
ok(traceback:find("in upvalue 'culprit'") or traceback:find("in function <.-test_tracing"), "the traceback reaches the user's function", traceback)
raises("stack overflow", trace, function(x) local function g(y) return 1 + g(y) end return g(x[1]) end, 1)
local function nest(x) return trace(nest, 1)(x) end
raises("overflow", trace, nest, 1)
raises("yield", coroutine.wrap(function() return trace(function(x) coroutine.yield() return x[1] end, 1) end))
ok(coroutine.wrap(function() return trace(function(x) return x[1] * 2 end, 1) { 4 } end)() == 8, "a trace in a coroutine")

-- traces inside traces, and symbols that outlive theirs
local kept
local keep = trace(function(x) kept = kept or x[1] return x[1] end, 1)
raises("after its trace had ended", function() return kept + 1 end)
raises("after its trace had ended", function() return math.sin(kept) end)
raises("after its trace had ended", trace, function(x) return x[1] * kept end, 1)
ok(tostring(kept):find("ended") ~= nil, "a dead symbol says so", kept)
raises("symbol", f, { kept, 1 })
raises("symbols of two traces", trace, function(x) return trace(function(y) return y[1] * x[1] end, 1) { 1 } end, 1)
local good = trace(function(x)
  local inner = trace(function(y) return y[1] ^ 2 end, 1)
  return inner { x[1] } + inner { 3 }
end, 1)
ok(good { 2 } == 13, "an inner trace of its own arguments")
pcall(coroutine.resume, coroutine.create(function() trace(function(x) kept = x[1] error "dead" end, 1) end))
collectgarbage()
raises("after its trace had ended", function() return kept + 1 end)
-- a coroutine that died inside of a trace is over at once, collected or not
local factor, dead = 2, coroutine.create(function() trace(function(x) kept = x[1] error "dead" end, 1) end)
local fading = dm.root { equations = function(y, x) return factor * y - x end, start = 0 }
local failing = coroutine.create(function() trace(function(x) error(fading(x[1])) end, 1) end)
ok(not coroutine.resume(failing) and not coroutine.resume(dead), "two coroutines die inside of a trace")
raises("after its trace had ended", function() return kept * kept end)
local function by_root(x) return fading(x[1]) end
ok(trace(by_root, 1) { 4 } == 2, "a root that a dead coroutine has traced")
factor = 4
ok(trace(by_root, 1) { 4 } == 1, "is looked at again in the next trace")
local outer = trace(function(x)
  local inner = coroutine.create(function() return trace(function(y) error(y[1]) end, 1) end)
  assert(not coroutine.resume(inner))
  local powers = coroutine.wrap(function() for i = 1, 3 do coroutine.yield(x[1] ^ i) end end)
  return powers() + powers() + powers() + 2 * x[1]
end, 1)
ok(outer { 2 } == 18, "a trace goes on after a coroutine in it has died, and takes symbols from generators")
ok(coroutine.status(dead) == "dead" and not coroutine.close(dead), "closing it later does no harm")
local scratch = dm.vector(2)
local function uses_scratch(x) scratch[1], scratch[2] = x[1], 2 return scratch[1] * scratch[2] end
ok(trace(uses_scratch, 1) { 3 } == 6 and trace(uses_scratch, 1) { 4 } == 8, "a scratch vector outside the function")
trace(function(x) scratch[1] = x[1] return scratch[1] end, 1)
scratch[1] = 5
ok(scratch[2] ~= scratch[2], "what a trace left in a scratch vector and nobody filled is NaN")
raises("hyper-dual", trace, function(x) return x[1] + dm.hyperdual(1) end, 1)

-- finalizers: whatever they can still reach works, while the collector runs and when the state is closed
local late
local at_close = setmetatable({}, { __gc = function() assert(late { 3 } == 9 and late:gradient { 3 }[1] == 6) end })
late = trace(function(x) return x[1] ^ 2 end, 1)
local results = {}
do
  local inner
  local cycle = setmetatable({}, { __gc = function() results[1] = inner:hessian { 2 }[1][1] end })
  inner = trace(function(x) return x[1] ^ 3 end, 1)
  cycle.itself = cycle
end
do
  local symbol
  local watch = setmetatable({}, { __gc = function() results[2] = select(2, pcall(function() return symbol * 2 end)) end })
  coroutine.resume(coroutine.create(function() trace(function(x) symbol = x[1] error(watch) end, 1) end))
end
collectgarbage() collectgarbage()
ok(at_close and results[1] == 12, "a traced function works in a finalizer", results[1])
ok(tostring(results[2]):find("after its trace had ended"), "a symbol of a dead coroutine is refused in a finalizer", results[2])
local before = collectgarbage("count")
for _ = 1, 2000 do trace(function(x) return x[1] ^ 2 + x[2] end, 2) end
ok(collectgarbage("count") - before < 40000, "the collector sees the memory of graphs", collectgarbage("count") - before)

-- what a trace cannot see is found by comparing with plain calls
raises("is not what its trace says", trace, function(x) if type(x[1]) == "number" then return 0 end return x[1] end, 1)
ok(trace(function(x) if type(x[1]) == "number" then return 0 end return x[1] end, 1, "unchecked") { 7 } == 7,
  "but not where nothing is to be compared")
raises("bad argument #3", trace, function(x) return x[1] end, 1, nil, "unchecked")
raises("bad argument #2", trace, function(x) return x end, nil)
raises("is not what its trace says", trace, function(x) return math.type(x[1]) and x[1] + 1 or x[1] end, 1)
raises("different values for the same arguments", trace, function(x) return x[1] + math.random() end, 1)
local count = 0
raises("different values for the same arguments", trace, function(x) count = count + 1 return x[1] * count end, 1)
raises("is not what its trace says", trace, function(x) return { x[1], type(x[1]) == "number" and 1 or 2 } end, 1)
ok(trace(function(x) return (x[1] + 1e8) ^ 2 - x[1] ^ 2 - 2e8 * x[1] end, 1), "cancellation is not taken for a mismatch")
ok(trace(function(x) return math.log(x[1]) + math.sqrt(x[1] - 5) end, 1), "a domain away from zero is no mismatch")
ok(keep { 5 } == 5, "a finished trace still evaluates")

-- arguments of a traced function
raises("takes 1 argument (got 0)", f)
raises("must have 2 entries (got 3)", f, { 1, 2, 3 })
raises("got a number", f, 1)
raises("entry 1 is NaN", f, { 0 / 0, 1 })
raises("entry 2 must be a number", f, { 1, {} })
raises("NaN at this point", trace(function(x) return math.sqrt(x[1]) end, 1), { -1 })
raises("function expected", trace, 1, 1)
raises("number of entries", trace, print, 0)
raises("number of entries", trace, print, "numbers")
raises("at most 8", trace, print, 1, 2, 3, 4, 5, 6, 7, 8, 9)
raises("dm.function expected", f.gradient, {}, { 1, 2 })
ok(pcall(trace, setmetatable({}, { __call = function(_, x) return x[1] end }), 1) == false, "only functions are traced")

-- the same runs on hyper-dual numbers as on the trace
local function L(q, v) return v:dot(v) / 2 + 1 / q:norm() end
local start = { q = { 0.4, 0 }, v = { 0, 2 }, steps = 200 }
local function last(L_, derivatives)
  local path = dm.system({ Q = dm.R(2), L = L_, derivatives = derivatives }):solver({ rule = "midpoint", h = 0.01 }):run(start)
  return path.q[#path]
end
ok((last(L) - last(L, "hyperdual")):norm() < 1e-13, "traced and hyper-dual runs agree", (last(L) - last(L, "hyperdual")):norm())
local function branching(q, v) local r = q:norm() if r > 0.1 then return v:dot(v) / 2 + 1 / r end return v:dot(v) / 2 end
ok((last(branching, "hyperdual") - last(L)):norm() < 1e-13, "a function that branches runs on hyper-dual numbers")
raises("dm.where", last, branching)
raises("or dm.min, or derivatives", last, branching)
-- a way out is named where it is one
local function advice(options)
  options.Q, options.L = options.Q or dm.R(1), not options.H and (options.L or function(_, v) return v[1] ^ 2 / 2 end) or nil
  return (select(2, pcall(dm.system, options)))
end
local function side(q, v) return v[1] ^ 2 / 2 - (q[1] > 0 and 1 or 0) end
local function whole(q, v) return v[1] ^ 2 / 2 - math.floor(q[1]) end
for what, said in pairs {
  ["a force"] = advice { force = function(_, v) return v[1] > 0 and -1 or 1 end },
  ["L beside a force"] = advice { L = side, force = function(_, v) return -v[1] end },
  ["H"] = advice { H = side },
  ["math.floor beside a constraint"] = advice { Q = dm.R(2), L = whole, constraint = function(q) return q[2] end },
} do
  ok(said:find("dm.max or dm.min", 1, true) and not said:find "hyperdual", "advice that can be followed: " .. what, said)
end
ok(advice { L = whole }:find "met a symbol while L is traced.*hyperdual", "math.floor in L")
local calls = 0
raises("oops 40", last, function(q, v) calls = calls + 1 if calls == 40 then error("oops " .. calls) end return L(q, v) end, "hyperdual")

-- a branch that is not taken adds nothing, however often it uses what is not finite there
local function slope(f, x, times)
  for _ = 1, times or 1 do f = dm.derivative(f) end
  return f(x)
end
tap.near(slope(function(x) local u = math.sqrt(x) return dm.where(x, u ^ 3 + math.sin(u), 0) end, -1), 0, 0, "where: an intermediate used twice")
tap.near(slope(function(x) local u = math.acos(2 * x) return dm.where(x + 0.5, u ^ 2 + math.sin(u), 0) end, -0.8), 0, 0, "where: an inverse cosine used twice")
tap.near(slope(function(x) return dm.where(x, x ^ 1.5, 0) end, -1, 2), 0, 0, "where: second derivative of a guarded power")
tap.near(slope(function(x) return dm.where(x, x ^ 1.5, 0) end, 4, 2), 0.75 / 2, 1e-15, "and on the other side")
tap.near(slope(function(x) return dm.where(math.abs(x) - 1e-3, math.sin(x) / x, 1) end, 0, 2), 0, 0, "where: second derivative of a guarded quotient")
tap.near(slope(function(x) local r = math.sqrt(x) return dm.where(x, r, 0) + dm.where(x - 1, r * r * r, 0) end, -1), 0, 0, "two branches over one intermediate")
for _, rule in ipairs { "verlet", "gauss(2)", "rk4", "lobatto(3)" } do
  local hard = dm.system { Q = dm.R(1), L = function(q, v) local r = math.sqrt(q[1]) return v[1] ^ 2 / 2 - dm.where(q[1], r * math.exp(-r) + math.log(1 + q[1]) ^ 2 * r, 0) end }
  local p = hard:solver({ rule = rule, h = 0.1 }):run { q = { -1 }, v = { 0.5 }, steps = 3 }
  tap.near(p.q[4][1], -0.85, 1e-15, rule .. ": free where the potential is switched off")
end

-- hyper-dual quotients and roots keep their derivatives over the whole range of numbers
local x = dm.hyperdual(2, 1, 1, 0)
for _, scale in ipairs { 1, 1e-170, 1e170 } do
  local y = scale / (x * scale)
  tap.near(y.a, -0.25, 0, "d(1/x) at scale " .. scale)
  tap.near(y.ab, 0.25, 0, "d2(1/x) at scale " .. scale)
end
tap.near((math.sqrt(x * 1e220) / 1e110).ab, -0.25 / 2 ^ 1.5, 1e-16, "d2 sqrt at a large scale")

-- coefficients that gather to less than any number: the value itself is not small where x is large
local powers = dm.trace(function(x)
  local s = 1e-12 * (x[1] + x[2])
  for _ = 1, 5 do s = s * s end
  return s
end, 2)
near(powers { 6e11, 4e11 }, 1, 1e-13, "coefficients are not lost to underflow")

-- a force and its opposite are one sum: that between two springs is w2 - w1, rounded once
local random = dm.random(5)
for _, c in ipairs { { 1 / 2, 0.3, 0.25 }, { 0.7, -1.1, 0.37 }, { 1, 1 / 3, 0.6 } } do
  local V = dm.trace(function(q)
    local sum = 0
    for i = 1, 2 do
      local d = q[i + 1] - q[i]
      sum = sum + c[1] * d ^ 2 + c[2] * d ^ 3 + c[3] * d ^ 4
    end
    return sum
  end, 3)
  local exact = 0
  for i = 1, 200 do
    local g = V:gradient { random:uniform(i, 1), random:uniform(i, 2), random:uniform(i, 3) }
    exact = exact + (g[2] == -(g[1] + g[3]) and 1 or 0)
  end
  ok(exact == 200, "forces and their opposites, to the last bit", exact)
end

-- an upvalue that changes what numbers see, and not what symbols see, is found out from the same start, too
local lies = false
local liar = dm.system({ Q = dm.R(1), L = function(q, v)
  if lies and type(q[1]) == "number" then return v[1] ^ 2 end
  return v[1] ^ 2 / 2 - q[1] ^ 2
end }):solver { rule = "verlet", h = 0.01 }
liar:run { q = { 0.2 }, v = { 0 }, steps = 2 }
lies = true
raises("is not what its trace says", function() liar:run { q = { 0.2 }, v = { 0 }, steps = 2 } end)

-- what a system says of itself is compared, too
local branches = dm.system { Q = dm.R(1), L = function(q, v) return q[1] == 0 and v[1] ^ 2 / 2 or v[1] ^ 2 end }
for _, name in ipairs { "energy", "momentum", "mass", "velocity", "lagrangian" } do
  tap.raises("L is not what its trace says", branches[name], branches, { 0 }, { 1 })
end
local dice = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - math.random() * q[1] ^ 2 end }
tap.raises("it must not use random numbers", dice.energy, dice, { 1 }, { 1 })
-- numbers below all normal ones have lost digits: what is summed in another order may differ there
do
  local differ = 0
  for i = 1, 40 do
    local f = trace(function(y)
      local sum, length = 0, y[2] - y[1]
      for k = 1, 10 do sum = sum + (0.1 + 0.013 * k) * length * dm.exp(-(y[1] + 0.1 * k * length + 26.9 + i * 0.0125) ^ 2) end
      return sum
    end, 2)
    if not (f { 0.0001, 0.0005 } < 1e-307) then differ = differ + 1 end
  end
  ok(differ == 0, "sums of tiny exponentials are what their trace says", differ)
end
-- a force whose phase has no digit at the points that are tried (1e28 rad at t = 0.05): units of 1e20 and 1e-30
do
  local U, W = 1e20, 1e-30
  local forced = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1] ^ 2 - q[1] ^ 2 / W ^ 2) / 2 + 0.2 * U / W ^ 2 * math.cos(1.3 * t / W) * q[1] end }
  local path = forced:solver { rule = "gauss(6)", h = 0.02 * W }:run { q = { 0 }, v = { 0 }, t = 3 * W }
  -- 0.2 (cos t - cos 1.3 t)/(1.3^2 - 1)
  near(path.q[#path][1] / U, 0.2 * (math.cos(3) - math.cos(3.9)) / (1.3 ^ 2 - 1), 1e-9, "a driven oscillator in units of its own")
end
tap.done()
