-- a session as someone at a terminal sees it: the program tests/c/pty.c types and watches
local tap = require "tap"
local ok = tap.ok

local build = os.getenv "B" or arg[-1]:match "^(.*)/"
local dmlua, pty = os.getenv "DMLUA" or arg[-1], build .. "/tests/pty"
local home = os.tmpname()
os.remove(home)
assert(os.execute("mkdir -p " .. home .. "/config/dmlua " .. home .. "/state"))

local function write(name, text)
  local file = assert(io.open(name, "w"))
  file:write(text)
  file:close()
end

-- play a script against `dmlua options`; what the terminal got, colours and controls of readline left out
local function play(options, script, environment)
  write(home .. "/script", script)
  local variables = ("env -u NO_COLOR -u FORCE_COLOR -u LUA_INIT TERM=xterm PAGER=cat HOME=%s XDG_STATE_HOME=%s/state"
    .. " XDG_CONFIG_HOME=%s/config %s"):format(home, home, home, environment or "")
  local pipe = io.popen(("%s %s %s %s < %s/script 2>&1"):format(variables, pty, dmlua, options, home))
  local raw = pipe:read "a"
  pipe:close()
  return raw:gsub("\27%[[%d;?]*[a-zA-Z]", ""):gsub("\r", ""), raw
end

-- the end of a script: at the next prompt, Ctrl-D
local BYE = "wait 2004h\npause 50\nsend \\004\n"

-- entries typed one after another at fresh prompts
local function session(entries, options, environment)
  local script = { "wait 2004h" }
  for _, entry in ipairs(entries) do
    script[#script + 1] = "send " .. entry:gsub("\\", "\\\\") .. "\\r"
    script[#script + 1] = "wait 2004h"
  end
  return play(options or "", table.concat(script, "\n") .. "\npause 50\nsend \\004\n", environment)
end

local function has(text, part, sentence) ok(text:find(part, 1, true), sentence, text) end
local function lacks(text, part, sentence) ok(not text:find(part, 1, true), sentence, text) end

if not require "dm.manual".readline then
  print "1..0 # SKIP built without readline"
  os.exit()
end

-- a chroot or container may have no pseudo-terminals
if not os.execute(pty .. " true </dev/null >/dev/null 2>&1") then
  print "1..0 # SKIP no pseudo-terminal can be opened here"
  os.exit()
end

-- printing
local text, raw = session { "1 + 1", "_ * 10", "out[1] + out[2]", "3 + 4;", "_", "s = 'a;'", "s", "{ 1, { 2 }, x = 'y' }", "nil", "#_" }
has(text, "type ? for help", "one line of banner")
has(text, "> 1 + 1\n2\n", "an expression prints")
has(text, "> _ * 10\n20\n", "_ is the last value")
has(text, "\n22\n", "out[n] is the n-th")
has(text, "> 3 + 4;\n> _\n7\n", "a trailing ; prints nothing but sets _")
has(text, "> s\na;\n", "a ; in a string does not count")
has(text, '{ 1, { 2 }, x = "y" }', "a table prints")
has(text, "> nil\nnil\n> #_\n2\n", "nil prints, and leaves _ as it is")
has(text, "exit 0", "Ctrl-D ends with 0")
has(raw, "\27[36m2\27[0m", "numbers are coloured on a terminal")

text, raw = session({ "2 + 3" }, "", "NO_COLOR=1")
lacks(raw, "\27[36m", "NO_COLOR is obeyed")
has(text, "5", "and prints the same")
raw = select(2, session({ "2 + 3" }, "--color=always", "NO_COLOR=1"))
has(raw, "\27[36m5", "--color=always is stronger")
raw = select(2, session({ "2 + 3" }, "--color=never", "FORCE_COLOR=1"))
lacks(raw, "\27[36m", "--color=never is stronger")
text = session({ "2 + 3" }, "-q")
lacks(text, "type ?", "-q: no banner")

-- multi-line entries and history
text = session { "for i = 1, 2 do", "print(i * 11)", "end" }
has(text, ">> print(i * 11)\n>> end\n11\n22\n", "an entry of several lines")
local history = io.open(home .. "/state/dmlua/history"):read "a"
has(history, "for i = 1, 2 do\\nprint(i * 11)\\nend\n", "is one item of the history")
has(history, "{ 1, { 2 }, x = 'y' }\n", "entries of earlier sessions are kept")
text = play("", "wait 2004h\nsend \\e[A\nwait end\npause 50\nsend \\r\nwait 22\n" .. BYE)
has(text, "for i = 1, 2 do\nprint(i * 11)\nend\n11\n22\n", "and is recalled whole in the next session")
text = session { "'back\\\\slash'", "x = [[a", "b]]", "#x" }
has(text, "> #x\n3\n", "a long string over two lines")
ok(select(2, io.open(home .. "/state/dmlua/history"):read "a":gsub("x = %[%[a\\nb%]%]\n", "")) == 1, "newlines are written \\n")

-- start-up file
write(home .. "/config/dmlua/init.lua", "started = 'by the start-up file'")
has(session { "started" }, "by the start-up file", "the start-up file runs")
has(session({ "started" }, "-n"), "> started\nnil\n", "-n: it does not")
has(session({ "started" }, "-E"), "> started\nnil\n", "-E: it does not")
local before = io.open(home .. "/state/dmlua/history"):read "a"
session({ "unseen = 1" }, "-E")
ok(io.open(home .. "/state/dmlua/history"):read "a" == before, "-E: no history")
write(home .. "/config/dmlua/init.lua", "error 'in the start-up file'")
text = session { "1 + 1" }
has(text, "in the start-up file", "its error is shown")
has(text, "\n2\n", "and the session goes on")
os.remove(home .. "/config/dmlua/init.lua")

-- completion: type, Tab, and see what stands there
local function completes(typed, result, setup)
  local script = "wait 2004h\n"
  if setup then script = script .. "send " .. setup .. "\\r\nwait 2004h\n" end
  -- after Tab: to the start of the line (Ctrl-A) and its end (Ctrl-E), to make a string of it
  script = script .. ("send %s\\t\npause 150\nsend \\001r = [==[\\005]==]\\r\nwait 2004h\n"):format(typed)
    .. "send io.write('<', r, '>\\\\n')\\r\n" .. BYE
  local got = play("", script)
  ok(got:find("\n<" .. result .. ">", 1, true), typed:gsub("\\t", "") .. " completes to " .. result, got)
end
local system = "s = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q:dot(q) end }"
text = play("", "wait 2004h\nsend for i = 1, 1 do\\r\nwait >>\nsend \\t\\tprint(i * 55)\\r\nwait >>\nsend end\\r\nwait 55\n" .. BYE)
has(text, "end\n55\n", "Tab at the start of a line of a longer entry indents")
completes("setmet", "setmetatable")
for _, hidden in ipairs { "dm.doc", "dm.mis", "dm.until", "dm.nea" } do completes(hidden, hidden) end
completes("dm.scene { sec", "dm.scene { seconds = ")
completes("c.riv", "c.rival", "c = setmetatable({}, debug.getregistry()['dm.chart'] or getmetatable(require 'dm').load_all() "
  .. "and debug.getregistry()['dm.chart'])")
completes("string.for", "string.format")
completes("('x'):rep", "('x'):rep")
completes("dm.sol", "dm.solver")
completes("whi", "while")
completes("s:lag", "s:lagrangian", system)
completes("s.coord", "s.coordinates", system)
completes("s:solver { ru", "s:solver { rule = ", system)
completes("s:solver({ h = 0.1, ru", "s:solver({ h = 0.1, rule = ", system)
completes("s:solver { rule = \"verl", "s:solver { rule = \"verlet\"", system)
completes("s:solver { h = 0.1 }:run { ste", "s:solver { h = 0.1 }:run { steps = ", system)
local run = system .. " p = s:solver({ rule = 'verlet', h = 0.1 }):run { q = {1}, v = {0}, steps = 2 }"
completes("p:drift \"ener", "p:drift \"energy\"", run)
completes("p:plot(\"t\", { \"q", "p:plot(\"t\", { \"q1\"", run)
completes("p:worst(\"cons", "p:worst(\"constraint\"", run)
completes("p.q[1]:nor", "p.q[1]:norm", run)
completes("p.system:lag", "p.system:lagrangian", run)
completes("s:chart { rules = { 'verlet', 'blanes", "s:chart { rules = { 'verlet', 'blanes-moan'", system)
completes("demo \"noe", "demo \"noether\"")
completes("help \"no_conv", "help \"no_convergence\"")
completes("t.alph", "t.alpha", "t = setmetatable({ alpha = 1 }, { __index = function() error 'ran' end })")
completes("t.be", "t.beta", "t = setmetatable({}, { __index = { beta = 1 } })")
completes("t.gam", "t.gam", "t = setmetatable({}, { __index = function() gamma = 1 end, __pairs = error })")
completes("t[1].dee", "t[1].deep", "t = { { deep = 1 } }")
write(home .. "/some_file.csv", "x\n")
completes("io.open('" .. home .. "/some_f", "io.open('" .. home .. "/some_file.csv'")

-- help
text = session { "?dm.solver", "?", "help 'keys'", "?dm.path", "?string.find", "apropos 'legendre'", "x = 4", "who()",
  "help(nil)", "G = dm.SE(2);", "?G", "?rho.invariantize", "?problem:solve" }
has(text, "dm.solver{system, rule=", "?x prints the doc")
has(text, 'apropos "word"', "? lists the topics")
has(text, "a trailing ; evaluates without printing", "help 'keys'")
has(text, "path:drift", "a class lists its methods")
has(text, "reference manual section 6.4", "standard functions name their section")
has(text, "system:legendre           The momentum p = dL/dv of dim Q entries", "apropos finds, with the first sentence")
has(text, "invariant whatever f is", "a method as the docs write it, where no class has the name")
has(text, "The sequence of n points", "also with a colon")
has(text, "x  4", "who")
has(text, "SE(2): a group of dimension 3. An element is a vector of 3 numbers", "a group says what its elements look like")
has(text, "help(dm.SE) gives", "and where the order of the entries of its algebra stands")
has(text, "nil: a nil of Lua", "help(nil) does not mind")
text = session { "help(dm.failure)", "help(dm.R(2).exq)", "help(dm.systm)", "x = dm.nothing", "help(nil)" }
has(text, "dm.failure: raised when a computation fails", "help(dm.failure) is ?dm.failure, though dm has no such value")
has(text, "a dm.space has no 'exq'; did you mean 'exp'?", "help of a name that is not there says which is near")
has(text, 'nothing mentions "dm.systm"; did you mean dm.system?', "also of one of dm")
has(text, "nil: a nil of Lua", "and of a nil of another entry nothing")

text = session { "apropos 'soliton'", "apropos 'no_convergence'", "?no_convergence", "?soliton_of_nothing", "?dm.systm", "?noether", "?henon_heiles", "?examples",
  "apropos 'damping'", "apropos 'Poincaré'", "apropos 'eccentric'" }
has(text, "  chain  Chains: a soliton", "apropos finds demonstrations")
has(text, 'demo "name" runs one', "and says how to open them")
has(text, "  chain    Do solitons of a chain", "and examples")
has(text, "/examples/name.lua . runs one", "with their files")
has(text, "  no_convergence  the step equation did not converge", "and codes of failures")
has(text, "Take a smaller h; solver:fold says", "?code says what to try")
has(text, 'nothing mentions "soliton_of_nothing"', "and where nothing is found it says so")
has(text, 'nothing mentions "dm.systm"; did you mean dm.system?', "a name that is nearly one")
do
  local near = session { "?vektor", "?multiplyers", "?verlt", "?noethr", "?solver.lyapunof" }
  has(near, 'nothing mentions "vektor"; did you mean dm.vector?', "of dm, one level down")
  has(near, "did you mean path:multipliers, solver:multipliers, system:multipliers?", "of classes, all that have it")
  has(near, "did you mean verlet?", "of a rule")
  has(near, "did you mean noether", "of a demonstration")
  has(near, "did you mean 'lyapunov'?", "and of a class that is named")
end
do
  local near = session { "u = dm.vector { 3, 4 }", "?u.nrom", "help 'solver.multiplier'", "?path.flub" }
  has(near, "a dm.vector has no 'nrom'; did you mean 'norm'?", "a method that is nearly one, of a value")
  has(near, "a dm.solver has no 'multiplier'; did you mean 'multipliers'?", "and of a class")
  has(near, "a dm.path has no 'flub'; help(x) lists what there is", "and one that is like none")
end
has(text, 'demo "noether" runs it', "?name of a demonstration")
local asked = session { "?v" }
local said = asked:match "> %?v\n(.-)\n> " or asked
local _, lines = said:gsub("\n", "")
ok(lines < 10 and said:find('"v" has no doc of its own', 1, true) and said:find('apropos "v"', 1, true),
  "?v of a name without a doc: ten lines", said)
has(text, "Henon and Heiles (1964): is a star's motion in a galaxy orderly or chaotic?", "?name of an example")
has(text, "guiding_centre", "?examples lists them")
has(text, '"friction" is spoken of:', "apropos knows what others call it")
asked = session { "dm.so3", "pi", "none", "v = dm.vector { 1 }", "v.x", "v.x == nil", "t = {}", "t.x", "dm.eye", "#dm.systm" }
for _, words in ipairs { "dm has no 'so3'; did you mean 'SO'?", "pi is math.pi", "a dm.vector has no 'x'; its entries are [1]", "did you mean 'identity'?", "dm has no 'systm'" } do
  has(asked, words, "a nil that comes of a name says which: " .. words)
end
local _, nils = asked:gsub("\nnil", "")
local _, told = asked:gsub(" has no ", "")
ok(nils == 6 and told == 4, "and no other nil says anything", asked)
asked = session { "?fpu", "?boris", "?Lorentz", "?snake", "?section", "?jupyter", "?python", "?euler angles" }
for word, there in pairs { jupyter = "dmlua --jupyter", python = "path:npy and path:csv", ["euler angles"] = "dm.SO(3)", fpu = "?dm.sum_over", boris = "?charged_particle", Lorentz = "?guiding_centre", snake = "?chaplygin_sleigh" } do
  said = asked:match("> %?" .. word .. "\n(.-)\n> ") or asked
  ok(said:find(there, 1, true) and not said:find "did you mean", "?" .. word .. " says how it is written here", said)
end
ok(asked:find("solver:section{g=", 1, true) and not asked:find("Newton steps of least length", 1, true), "?section is that of runs alone", asked)
has(text, "  log-hamiltonian  Splitting of the logarithmic", "and rules")
has(text, "> apropos 'Poincaré'\nG:coad  ", "accents do not count")

text = session { "?classes", "?routh", "?frame", "?plot", "?dm.demo", "help(7)" }
has(text, "dm.stability_map: where a method fails", "every class, also one that was not used")
has(text, "The system without its group variables", "a method by its name alone")
has(text, "rho:check{samples=}", "a class without its dm.")
has(text, "path:plot(x, y", "several of one name")
ok(not text:find("shape:slice", 1, true), "and no more than these", text)
has(text:gsub("%s+", " "), "runs it and explains what came out. On a terminal", "prose is wrapped once")
has(text, "7: an integer of Lua", "help(7)")

-- an example below the text
text = session { "?vector.cross", "help(dm.tan)", "?dm.pair", "?action.free" }
has(text, "Raises for other lengths.\n\n  Example:\n    > dm.vector", "a method has an example")
has(text, "\n  Example:\n    > dm.tan(math.pi/4)\n    1.0\n", "a function has one")
has(text, "    > g*h, g:inverse()\n    (1, 5)	(2, 1)\n", "one with several lines")

-- readline's keys, and those that its file binds
write(home .. "/.inputrc", '"\\C-xq": "6*7"\n')
text = play("-n", "wait 2004h\nsend \\030q\\r\nwait 42\nwait 2004h\nsend 12\\0013+\\r\nwait 15\n" .. BYE)
has(text, "6*7\n42", "keys of ~/.inputrc")
has(text, "\n15\n", "Ctrl-A goes to the beginning of the line")
os.remove(home .. "/.inputrc")

-- a text longer than the screen of 24 lines goes through $PAGER
text = session({ "?dm.chart", "?dm.abs", "6*7" }, "", "PAGER='cat -n'")
has(text, "\n     1\tdm.chart{system", "the pager gets the text")
has(text, "\n    29\t", "all of it")
has(text, "> ?dm.abs\nmath.abs(x) -> number", "not what fits")
has(text, "> 6*7\n42", "and the session goes on")
text = session({ "help(dm.chart)", "apropos 'energy'" }, "", "PAGER='head -n 1'")
has(text, "> help(dm.chart)\ndm.chart{system", "help(x) too")
local _, count = text:gsub("\n", "")
ok(count < 20, "and apropos; a pager may leave early", text)
for _, pager in ipairs { "cat", "''" } do
  text = session({ "?dm.chart" }, "", "PAGER=" .. pager)
  has(text, "> ?dm.chart\ndm.chart{system", "PAGER=" .. pager .. ": printed")
end
text = session({ "?dm.chart" }, "", "PAGER=no-such-pager")
has(text, "no-such-pager", "a pager that is not there is told")
has(text, "\ndm.chart{system", "and the text printed")
assert(os.execute("mkdir -p " .. home .. "/bin"))
write(home .. "/bin/less", "#!/bin/sh\necho less $*\ncat\n")
os.execute("chmod +x " .. home .. "/bin/less")
text = session({ "?dm.chart" }, "", ("env -u PAGER PATH=%s/bin:$PATH"):format(home))
has(text, "less -FRX\ndm.chart{system", "without PAGER: less, which ends by itself at the end of a page")
text = play("", "wait > \nsend ?dm.chart\\r\nwait chart:table() -> string\nwait > \npause 50\nsend \\004\n",
  "PAGER='cat -n' TERM=dumb")
has(text, "dm.chart{system", "help on a terminal without commands of its own")
lacks(text, "     1\t", "not on a terminal that cannot turn pages")

-- errors
text = session { "y = dm.moving_frame { action = 1 }" }
has(text, "stdin:1: ", "an error of a module names the line that was typed")
lacks(text, "blame.lua", "and its traceback only what the user wrote")
text = session { "S = dm.system { Q = dm.SO(3), L = function(g, xi) return xi:dot(xi) end }",
  "S:energy({ 1, 0, 0, 0 }, { 0, 0, 1 })", "S:energy(dm.identity(3), { 1, 2 })",
  "dm.system { Q = dm.SO(3), L = function(g, xi) return g:dot(xi) end }",
  "dm.system { Q = dm.SO(3), L = function(_, xi) return xi[1]^2 end,",
  "force = function() return { 1, 0 } end }" }
has(text, "stdin:1: field 'q': the group element must be a matrix", "elements that are none")
has(text, "stdin:1: field 'v' must have 3 entries (got 2)", "velocities that are none")
lacks(text, "lua/dm/", "no line of a module")
text = session { "dm.euler_poincare { group = dm.SO(3), l = function(xi, a) return a[3] end }" }
has(text, "stdin:1: attempt to index", "a mistake in a function that was typed on the same line")
lacks(text, "stdin:1: stdin:1:", "names this line once")
text = session { "error 'oops'", "error { 1 }", "x = = 1", "local t <close> = 1",
  "setmetatable({}, { __tostring = function() error 'in tostring' end })", "1 + 1" }
has(text, "oops\nstack traceback:", "an error with its traceback")
has(text, "(error object is a table value)", "an error that is no string")
has(text, "unexpected symbol near '='", "a syntax error")
has(text, "in tostring", "an error while printing")
has(text, "\n2\n", "and the session goes on")

for _, farewell in ipairs { "quit", "exit()" } do
  text = play("", "wait 2004h\nsend exit = nil\\r\nwait 2004h\nsend " .. farewell .. "\\r\npause 100\n")
  has(text, "exit 0", farewell .. " leaves")
end
text = session { "quit = 6", "quit", "quit * 7" }
has(text, "\n42\n", "unless there is something of that name")

-- Ctrl-C: after each, the session must still answer
local ANSWER = "wait 2004h\nsend 40 + 2\\r\nwait 42\n" .. BYE
-- what runs says so itself, in words that the echo of its line does not have: a slow machine takes its time
local RUNS = "print('it ' .. 'runs') "
local function stopping(lines) return play("", "wait 2004h\n" .. table.concat(lines, "\n") .. "\n") end

text = stopping { "send " .. RUNS .. "while true do end\\r", "wait it runs", "send \\003", "wait interrupted!", ANSWER }
has(text, "exit 0", "Ctrl-C stops Lua code, and the session goes on")
text = stopping { "send endless = setmetatable({}, { __index = function() " .. RUNS .. "while true do end end })\\r", "wait 2004h",
  "send print('a path?', pcall(dm.compare, endless, endless))\\r", "wait it runs", "send \\003", ANSWER }
has(text:gsub("%s+", " "), "a path? false interrupted!", "a module that tries things under pcall passes it on; a pcall of the user has it")
text = stopping { "send coroutine.wrap(function() coroutine.wrap(function() " .. RUNS .. "while true do end end)() end)()\\r", "wait it runs", "send \\003",
  "wait interrupted!", "send co = coroutine.create(function() while true do coroutine.yield() end end)\\r", "wait 2004h",
  "send " .. RUNS .. "while true do coroutine.resume(co) end\\r", "wait it runs", "send \\003", "wait interrupted!",
  "send coroutine.resume(coroutine.create(function() error 'own' end))\\r", "wait own", ANSWER }
has(text, "exit 0", "code in coroutines is stopped too, and one that fails later is its own affair")
text = stopping { "send some rubbish", "pause 50", "send \\003", ANSWER }
has(text, "> 40 + 2\n42", "at the prompt it clears the line")
text = stopping { "send for i = 1, 2 do\\r", "wait >> ", "pause 50", "send \\003", ANSWER }
has(text, "> 40 + 2\n42", "and drops an entry of several lines")
text = stopping { "send a = string.rep('a', 300000) " .. RUNS .. "string.find(a, '.*b')\\r", "wait it runs", "pause 300", "send \\003",
  "pause 1000", "send \\003" }
has(text, "signal 2", "a second one kills what does not stop")

local orbit = "send o = s:solver { rule = 'verlet', h = 0.01 }:run "
  .. "{ q = { 1 }, v = { 0 }, steps = 1e10, every = 1e6 }\\r"
local stopped = { "send \\003", "wait stopped after step", "wait 2004h", "send _\\r", "wait path of", "wait 2004h",
  "send print(_.steps > 10, o)\\r", "wait true", BYE }
text = stopping { "send " .. system .. "\\r", "wait 2004h", orbit, "wait step/s", "pause 300", table.unpack(stopped) }
has(text, "left (Ctrl-C stops)", "a long run shows progress")
has(text, "_ is the path so far", "Ctrl-C stops a run")
has(text, "true\tnil", "and _ holds the path")
text = stopping { "send " .. system:gsub(" }$", ", derivatives = 'hyperdual' }") .. "\\r", "wait 2004h", orbit, "wait step/s",
  table.unpack(stopped) }
has(text, "_ is the path so far", "also one whose Lagrangian runs in Lua")
local many = "send s:solver { rule = 'verlet', h = 0.01 }:ensemble { members = 9, steps = 1e10, q = function() return { 1 } end, "
  .. "v = function() return { 0 } end }\r"
text = stopping { "send " .. system .. "\r", "wait 2004h", many, "wait step/s", "send \003", "wait stopped; _ is what",
  "wait 2004h", "send _\r", "wait ensemble of", BYE }
has(text, "stopped; _ is what was computed before", "of an ensemble no single step is told")
local chart = "send s:chart { q = 1, v = 0, t = 1, rules = { 'verlet' }, h = { 0.1, 1e-11 }, error = 'energy', rivals = false }\r"
text = stopping { "send " .. system .. "\r", "wait 2004h", chart, "wait step/s", "send \003", "wait stopped; _ is what",
  "wait 2004h", "send print(#_.points, _.points[1].rule, o)\r", "wait verlet", BYE }
has(text, "1\tverlet\tnil", "of a chart the points that were measured")

-- not a terminal
local pipe = io.popen(("echo '1 + 1; print(3)' | %s 2>&1; printf 'print(3)' | FORCE_COLOR= %s 2>&1 | od -c | head -1")
  :format(dmlua, dmlua))
local plain = pipe:read "a"
pipe:close()
has(plain, "unexpected symbol", "stdin that is no terminal is a script")
has(plain, "0000000   3  \\n", "no banner, no prompt, no colour")

os.execute("rm -r " .. home)
tap.done()
