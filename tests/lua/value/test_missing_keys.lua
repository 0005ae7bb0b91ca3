-- a name or index that is not there is nil, and the error that comes of the nil says which and what is near
local tap = require "tap"
local dm = require "dm"
local explain = require "dm.session.missing".explain
local ok, raises = tap.ok, tap.raises

local function says(words, f)
  local _, text = xpcall(f, explain)
  ok(tostring(text):find(words, 1, true), "says '" .. words .. "'", text)
end
local function is_plain(f, name)
  local _, text = xpcall(f, explain)
  local _, bare = pcall(f)
  ok(text == bare, name .. ": Lua's own message", text)
end

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local solver = kepler:solver { rule = "verlet", h = 0.1 }
local path = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2 }
local v = dm.vector { 1, 2 }

says("a dm.system has no 'solvr'; did you mean 'solver'?", function() kepler:solvr { h = 1 } end)
says("a dm.solver has no 'rnu'; did you mean 'run'?", function()
  solver
    :rnu {
      q = v,
    }
end)
says("a dm.path has no 'enrgy'; did you mean 'energy'?", function() return path.enrgy + 1 end)
says("a dm.path has no '1'; rows are those of its columns: path.q[1], path.t[1]", function() return path[1][1] end)
says("a dm.action has no 'on_pints'; did you mean 'on_points'?", function() dm.action { group = dm.SE(2), on = dm.R(2) }:on_pints(2) end)
says("a dm.space has no 'on_pairs'; it is a method of dm.action", function() dm.SE(2):on_pairs() end)
says("a dm.system has no 'run'; a solver of it has: system:solver { rule =, h = }:run", function() kepler:run { q = { 1, 0 }, v = { 0, 1 }, t = 1 } end)
says("a dm.space has no 'csv'; it is a method of dm.path, dm.chart, ", function() dm.SE(2):csv() end)
says("a dm.system has no 'commute'; it is dm.commute, a function", function() kepler:commute {} end)
says("dm has no 'sytem'; did you mean 'system'?", function() dm.sytem {} end)
says("a vector of 2 has no entry 3", function() return v[3] + 1 end)
says("cannot compute nil * dm.vector: a vector of 2 has no entry 3", function() return v[3] * v end)
says("a matrix of 1 rows has no entry 2", function() return dm.matrix { { 1, 2 } }[2][1] end)
says("a dm.chart has no 'cheapst'; did you mean 'cheapest'?", function()
  kepler:chart({ q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, steps = { 10, 20 } }):cheapst()
end)

-- in functions that are traced, under pcall too where the message is ours
local function oscillator(L) return dm.system { Q = dm.R(1), params = { stiffness = 2 }, L = L } end
says("the table of params has no 'stifness'; did you mean 'stiffness'?",
  function() oscillator(function(q, w, _, P) return w[1] ^ 2 / 2 - P.stifness * q[1] ^ 2 / 2 end) end)
says("the table of params has no 'k': there is stiffness", function() oscillator(function(q, w, _, P) return w[1] ^ 2 / 2 - q[1] ^ P.k end) end)
tap.raises("cannot compute nil * dm.symbol: a vector of 1 has no entry 2",
  function() oscillator(function(q, w) return w[1] ^ 2 / 2 - q[2] * q[1] end) end)
ok(oscillator(function(q, w, _, P) return w[1] ^ 2 / 2 - (P.k or P.stiffness) * q[1] ^ 2 end):energy({ 1 }, { 0 }) == 2,
  "a parameter that may be missing can be asked for")
says("a dm.vector has no 'nrm'; did you mean 'norm'?", function() kepler:routh { mu = 1, action = function(_, q) return q:nrm() end } end)

tap.raises("L must return a number, got nil: a vector of 1 has no entry 2", function() oscillator(function(q) return q[2] end) end)
tap.raises("L must return a number, got nil: is a return missing?", function() local _ = v[3] oscillator(function() end) end)
tap.raises("the cross-section gives nothing: a vector of 2 has no entry 3", function()
  dm.moving_frame { action = dm.action { group = dm.SO(2), on = dm.R(2) }, cross_section = function(q) return q[3] end }
end)
tap.raises("G:vee(M) gives that of a matrix", function() dm.SO(3):exp(dm.matrix { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }) end)

-- a hint stands there once, also where the function of a user is called inside a run
do
  local line = dm.field { x = { 0, 1, 4 }, fixed = "ends", L = function(u, ut) return ut ^ 2 / 2 + dm.cos(u) end }
  local function wave(x) return cos(x) end
  local _, text = xpcall(function() line:solver { rule = "cell(gauss(1))", h = 0.1 }:run { u = wave, ut = wave, steps = 1 } end, explain)
  ok(select(2, tostring(text):gsub(": it is math%.cos", "")) == 1, "one hint", text)
end

-- a method that is read like a field
says("(field 'energy'): it is a method, x:energy(...)", function() return path.energy - 1 end)
says("(field 'energy'): it is a method, x:energy(...)", function() return path.energy[1] end)

-- and says nothing where the nil is another
is_plain(function() local t = { own = print } return t.own + 1 end, "a function of a table of one's own")
is_plain(function() local t = {} return kepler.foo == nil and t.bar + 1 end, "a nil field of a table after a probe")
is_plain(function() for _ in ipairs(v) do local _ = 0 end local t = {} return t[1] + 1 end, "an index after ipairs over a vector")
is_plain(function() local t = {} t:run() end, "a method of a table of one's own")
ok(kepler.solvr == nil and dm.sytem == nil and v[3] == nil, "names that are not there can be probed")

local pipe = io.popen((os.getenv "DMLUA" or "build/dmlua") .. " -e 'dm.R(2):dimenson()' 2>&1")
ok(pipe:read "a":find("a dm.space has no 'dimenson'; did you mean 'dimension'?", 1, true), "dmlua says so of a script")
pipe:close()


-- a nil is named as Lua names what it computes itself, whatever stands around it
do
  local function L(f) return function() return dm.system { Q = dm.R(1), L = f } end end
  _G.there = 2
  raises("cannot compute nil * dm.symbol (global 'stiffness')",
    L(function(q, v) return v[1] ^ 2 / 2 - stiffness * q[1] end))
  local outer
  raises("(upvalue 'outer')", L(function(q, v) return v[1] ^ 2 / 2 - q[1] * outer end))
  local spring = { k = {} }
  raises("(field 'stiff')", L(function(q, v) return v[1] ^ 2 / 2 - spring.k.stiff * q[1] end))
  raises("(local 'K')", L(function(q, v)
    local T, K = v[1] ^ 2 / 2
    for i = 1, 3 do
      if i > 2 then T = T + i else T = T + q[1] ^ i end
    end
    return T - K * q[1]
  end))
  raises("(global 'first')", L(function(q, v) return first * q[1] + second * v[1] end))
  raises("(field '?')", L(function(q, v) return spring[q] * v[1] end))
  -- registers serve again along a line
  raises("(global 'first')", L(function(q, v) return (q[1] - v[1]) / first end))
  raises("(global 'first')", L(function(q, v) return q[1] / first / second end))
  raises("(global 'second')", L(function(q, v) return q[1] / there / second end))
  raises("(global 'second')", L(function(q, v) return q[1] / second / there end))
  _G.there = nil
  raises("(field 'kk'): the table of params has no 'kk'; did you mean 'k'?", function()
    dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p) return v[1] ^ 2 - p.kk * q[1] end }
  end)
  raises("dm.vector + nil (global 'shift')", function() return dm.vector { 1, 2 } + shift end)
  -- and where it is an argument of a function
  for _, f in ipairs { function(q) return dm.max(q[1], stiffness) end, function(q) return math.min(stiffness, q[1]) end, function(q) return math.sin(stiffness) + q[1] end,
    function(q) return dm.where(q[1], stiffness, 1) end, function(q) return q:dot(stiffness) end, function(q) return dm.max(q[1], 2) + dm.max(q[1], stiffness) end,
    function(q) return q[1] + math.max(1, stiffness) end, function(q) return q[1] + dm.min(stiffness, 1) end, function(q) return q[1] + math.fmod(1, stiffness) end,
    function(q)
      local x = math.atan(stiffness, q[1])
      return x
    end } do
    raises("got nil (global 'stiffness'))", L(function(q, v) return v[1] ^ 2 / 2 - f(q) end))
  end
  raises("got nil (field 'kk'): the table of params has no 'kk'; did you mean 'k'?", function()
    dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p) return v[1] ^ 2 - dm.max(p.kk, q[1]) end }
  end)
  raises("number expected, got nil)", L(function(q, v) return math.max(v[1], first) + math.max(q[1], second) end))
  -- a chunk that is loaded without its names is as good as it can be
  local code = string.dump(function() return require "dm".vector { 1 } * nothing end, true)
  local bare = load(code, "bare", "b", { require = require })
  local fine, why = pcall(bare)
  ok(not fine and tostring(why):find "dm.vector %* nil", "code without names", why)
end

-- a method of a value that is called like a field; one that is called as it should be lacks an argument
do
  local dmlua = os.getenv "DMLUA" or arg[-1]
  local function said(code)
    local pipe = assert(io.popen(("%s -e 'v = dm.vector { 3, 4 } %s' 2>&1"):format(dmlua, code)))
    local text = pipe:read "l"
    pipe:close()
    return text
  end
  for code, name in pairs { ["x = v.norm()"] = "norm", ["x = 1 + v.dot(v)"] = "dot", ["x = dm.matrix({ { 1 } }).transpose()"] = "transpose",
    ["dm.system { Q = dm.R(2), L = function(q) return q.norm() + 1 end }"] = "norm" } do
    local text = said(code)
    ok(text:find(("a method is called with a colon, x:%s(...)"):format(name), 1, true), code, text)
  end
  for _, code in ipairs { "x = v:dot()", "x = math.sin()", "x = string.rep()" } do
    local text = said(code)
    ok(text:find "got no value%)$", code, text)
  end
  local text = said [[s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 end } path = s:solver({ rule = "verlet", h = 1 }):run { q = { 1 }, v = { 2 }, steps = 1 } print(path.v[1])]]
  ok(text:find("a dm.path has no 'v'; it is path:velocity()", 1, true), "velocities of a path", text)
end
tap.done()
