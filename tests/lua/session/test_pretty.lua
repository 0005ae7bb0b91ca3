-- what a session shows of values, completes and times, asked as functions
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local pretty = dm.pretty

local function shows(value, text, options)
  local got = pretty(value, options)
  ok(got == text, "shows " .. text:gsub("\n", " "), got)
end

-- tables
shows({}, "{}")
shows({ 1, 2.5, "a" }, '{ 1, 2.5, "a" }')
shows({ x = 1, ["a b"] = 2, [10] = 3 }, '{ [10] = 3, ["a b"] = 2, x = 1 }')
shows({ [true] = 1, [false] = 2 }, "{ [false] = 2, [true] = 1 }")
shows({ "tab\t\"q\"\\\n\0" }, '{ "tab\\t\\"q\\"\\\\\\n\\000" }')
shows("as it is\n", "as it is\n")
shows({ { { { { 1 } } } } }, "{ { { { {...} } } } }")
shows({ { { 1 } } }, "{ { {...} } }", { depth = 2 })
shows({ 1, 2, 3, 4, 5 }, "{ 1, 2, ... 3 more }", { length = 2 })
shows(setmetatable({}, { __tostring = function() return "named" end }), "named")
shows(setmetatable({ 1 }, { __index = error, __len = error, __pairs = error }), "{ 1 }")

local cycle = { 1 }
cycle.me = cycle
shows(cycle, "{ 1, me = <cycle> }")
local shared = { 7 }
shows({ shared, shared }, "{ { 7 }, { 7 } }")

local many = {}
for i = 1, 1e5 do many[i], many["k" .. i] = i, i end
local text = pretty(many)
ok(#text < 3000, "a large table has a short text", #text)
ok(text:find("... 99970 more", 1, true) and text:find "k1%d* = ", "that says how much is left out", text)
for line in text:gmatch "[^\n]+" do
  if #line > 80 then ok(false, "a line is too long", line) end
end
ok(#pretty { ("x"):rep(1e6) } < 300, "a long string in a table is cut")
ok(pretty({ 1, nil, 3 }):find "3", "holes do not end a list")

local deep = {}
for _ = 1, 1e5 do deep = { deep } end
ok(#pretty(deep) < 100, "deep tables do not exhaust the stack")

-- other values
ok(pretty(dm.solver):find("function dm.solver{", 1, true) == 1, "a documented function shows its signature")
ok(pretty(function() end):find "test_pretty.lua:%d+$", "a function of a script shows its place")
shows({ dm.vector { 1, 2 } }, "{ " .. tostring(dm.vector { 1, 2 }) .. " }")
local colourful = pretty({ 1, "a" }, { colour = true })
ok(colourful:gsub("\27%[%d+m", "") == pretty { 1, "a" }, "colours change no text", colourful)
raises("'depth' must be a whole number", pretty, {}, { depth = -1 })

-- completion never runs a user's code
local complete = require "dm.session.complete"
local ran = false
local function touch() ran = true end
_G.trap = setmetatable({ seen = 1 }, { __index = touch, __pairs = touch, __len = touch, __call = touch, __eq = touch,
  __tostring = touch, __name = "trap" })
local function completes(typed, first)
  local list = complete.candidates(typed)
  list = type(list) == "table" and list or { tostring(list) }
  ok(list[1] == first, typed:gsub("\n", " ") .. " completes to " .. tostring(first), table.concat(list, " "))
end
completes("trap.s", "seen")
completes("trap.missing.", nil)
completes("trap().", nil)
completes("f(trap.s", "seen")
completes("-- trap.s", "nil")
completes("x = [[ trap.s", "true")
completes("x = [[ trap ]] .. trap.s", "seen")
completes("local y = 'a' .. ('b'):up", "upper")
completes("dm.vector { 1, 2 }:do", "dot")
completes("dm.system {\n  Q = dm.R(1),\n  coo", "coordinates = ")
completes("dm.system { Q = dm.R(1), L = mat", "math")
completes("dm.system { Q", "Q = ")
completes("dm.system { Q = dm.R(1), Q", nil)
completes("return whi", "while")
completes("3.", "nil")
completes("x.y.z.", nil)
ok(not ran, "nothing of the user ran")
_G.trap = nil
for _, part in ipairs { "", "(", "}", ":", ".", "a.", "a:", "'", '"', "[[", "--",
  "--[[", "f{", "f({", "{{{", ")))", "]", "a[1", "a]]", "\0", "a = {[", "::", "..." } do
  ok(pcall(complete.candidates, part), ("completion bears %q"):format(part))
end
ok(complete.is_silent "f(); -- done", "a ; before a comment silences")
ok(not complete.is_silent "s = ';'" and not complete.is_silent "f() -- ;", "one in a string or a comment does not")

-- dm.time and dm.bench by a clock of their own: calls of 2 us and of 3 s, and other work of the machine for 50 ms at every look of the clock at which it may disturb
local core = require "dm.core"
local clock = core.clock
for _, call in ipairs { 2e-6, 3 } do
  for disturbed = 0, 8 do
    local now, looks = 100, 0
    core.clock = function()
      looks = looks + 1
      if looks == disturbed or disturbed == 8 and looks % 5 == 0 then now = now + 0.05 end
      return now
    end
    local function work() now = now + call end
    for name, f in pairs { time = dm.time, bench = dm.bench } do
      looks = 0
      local seconds, words = f(work)
      ok(math.abs(seconds / call - 1) < 1e-6 and words:find(call < 1 and "^2 us per call" or "^3 s per call"), ("dm.%s of a call of %g s, disturbed at look %d"):format(name, call, disturbed), words)
    end
  end
end
core.clock = clock
local seconds, words = dm.time(function() for _ = 1, 1000 do end end)
ok(seconds > 0 and words:find "[nu]s per call", "the time of a call by the clock of the machine", words)
raises("a function is needed (got number)", dm.time, 3)
raises("oops", dm.time, function() error "oops" end)

-- what methods return prints itself in a script, too
local swing = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local solver = swing:solver { rule = "midpoint", h = 0.1 }
local path = solver:run { q = { 1 }, v = { 0 }, steps = 50 }
for name, result in pairs { drift = path:drift "energy", report = solver:report(), structure = swing:structure(), linear = swing:linearize { q = { 0 } } } do
  ok(tostring(result) == pretty(result) and tostring(result):match "^{.* = ", name .. " is shown by its entries", tostring(result))
end

-- the times of a path print as a vector, its rows as those of a matrix
local few, many = solver:run { q = { 1 }, v = { 0 }, steps = 2 }, path
ok(tostring(few.t) == "[0, 0.1, 0.2]" and tostring(few.q):match "^%[%[1%],\n %[0%.995%d+%],\n %[0%.98%d+%]%]$", "a few are shown whole", tostring(few.q))
ok(tostring(many.t) == "[0, 0.1, 0.2, ... , 5] (51)", "of many times the first and the last", tostring(many.t))
ok(tostring(many.p):match "^%[%[0%],\n %[[-.%d]+%],\n %[[-.%d]+%],\n %.%.%.\n %[[-.%d]+%]%] %(51 x 1%)$", "and of many rows", tostring(many.p))
local spun = dm.system { Q = dm.SO(3), L = function(_, w) return w:dot(w) / 2 end }:solver { rule = "lie(2)", h = 0.1 }
  :run { q = dm.SO(3):identity(), v = { 1, 0, 0 }, steps = 2 }
ok(tostring(spun.q) == "q of a path: 3 elements", "elements are counted", tostring(spun.q))
tap.done()
