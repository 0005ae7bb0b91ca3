--- Examples of what modules use of the core: methods to workers; files of journals.
local M = {}

M["dm.journal_file"] = [=[
> core = require "dm.core"
> file = core.journal_file("journal_file.journal", true)
> file:append "a record"
true
> file:read(0, 8)
a record]=]

M["journal_file.append"] = [=[
> core = require "dm.core"
> file = core.journal_file("append.journal", true)
> file:append "one"
true
> file:append "two"
true
> file:read(0, 6)
onetwo]=]

M["journal_file.close"] = [=[
> core = require "dm.core"
> file = core.journal_file("close.journal", true)
> file:close()]=]

M["journal_file.read"] = [=[
> core = require "dm.core"
> file = core.journal_file("read.journal", true)
> file:append "0123456789"
true
> file:read(3, 4)
3456]=]

M["journal_file.size"] = [=[
> core = require "dm.core"
> file = core.journal_file("size.journal", true)
> file:append "0123456789"
true
> file:size()
10]=]

M["journal_file.sync"] = [=[
> core = require "dm.core"
> file = core.journal_file("sync.journal", true)
> file:append "kept"
true
> file:sync()
true]=]

M["journal_file.truncate"] = [=[
> core = require "dm.core"
> file = core.journal_file("truncate.journal", true)
> file:append "0123456789"
true
> file:truncate(4)
true
> file:size()
4]=]

M["core.marks"] = [=[
> core = require "dm.core"
> type(core.marks(dm.vector { 0, 1, 2 }))
userdata]=]

M["core.matching"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 2 }
> m = core.matching(K)
> m:critical(0), m:critical(1), m:critical(2)
{ 1 }	{}	{}]=]

M["core.matrix_rows"] = [=[
> core = require "dm.core"
> core.matrix_rows(dm.matrix { { 1, 2 }, { 3, 4 }, { 5, 6 } }, 2, 2)
[[3, 4],
 [5, 6]]]=]

M["core.method"] = [=[
> core = require "dm.core"
> rows = function(path) return #path.t end
> core.method("dm.path", "rows", rows, "path:rows() -> integer") == rows
true
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:solver({ rule = "verlet", h = 0.1 }):run({ q = {1}, v = {0}, steps = 9 }):rows()
10]=]

M["core.miss"] = [=[
> core = require "dm.core"
> seek = function(t, key) core.miss("dm.point", key, { x = 1, y = 1 }) end
> point = setmetatable({}, { __index = seek })
> point.z.x
stdin:1: attempt to index a nil value (field 'z'): a dm.point has no 'z': there is x, y
stack traceback:
	stdin:1: in main chunk
	[C]: in ?]=]

M["core.names_in"] = [=[
> core = require "dm.core"
> io.open("some.txt", "w"):close();
> table.concat(core.names_in ".", " "):find "some.txt" ~= nil
true]=]

M["core.nap"] = [=[
> core = require "dm.core"
> a = dm.clock()
> core.nap(0.01)
> dm.clock() - a >= 0.01
true]=]

M["core.tied_step"] = [=[
> core = require "dm.core"
> s = core.stand_in { Q = dm.SE(2), L = function(g, xi) return xi:dot(xi)/2 end,
>>   constraint = function(g) return g[2] end }
> rule = core.tied_step { unknowns = 4, order = 1, holonomic = 1, rolling = 0,
>>   start = function() return { 0, 0, 0, 0 } end,
>>   equation = function(y, x) return { x[1] - y.p[1], x[2] - y.p[2] + x[4], x[3] - y.p[3],
>>     dm.SE(2):compose(y.q, dm.SE(2):exp { x[1], x[2], x[3] })[2] } end,
>>   next = function(y, x)
>>     return { q = dm.SE(2):compose(y.q, dm.SE(2):exp { x[1], x[2], x[3] }), p = y.p } end }
> path = s:solver { rule = rule, h = 1 }:run { q = { 0, 0, 0 }, p = { 1, 2, 0 }, steps = 2,
>>   record = { "impulses" } }
> path.q[3], path.impulses[2]
[2, 0, 0]	[2]]=]

M["core.stand_in"] = [=[
> core = require "dm.core"
> s = core.stand_in { Q = dm.SO(2), L = function(g, xi) return xi[1]^2/2 end }
> path = s:solver({ rule = "lie(1)", h = 0.1 }):run { q = 0, p = { 1 }, steps = 2 }
> tostring(path):find "energy" == nil
true]=]

M["core.prolonged"] = [=[
> core = require "dm.core"
> s = core.prolonged { Q = dm.R(4), L = function(x, y) return y[1]*y[3] + y[2]*y[4] end,
>>   constraint = function(x) return { x[1]*x[2], x[3]*x[2] + x[1]*x[4] } end }
> run = { q = { -1, 0, 0, 0 }, v = { 1, 0, 1, 0 }, steps = 30 }
> ran, failure = pcall(function() return s:solver { rule = "midpoint", h = 0.07 }:run(run) end)
> ran, failure.constraint
false	1]=]

M["core.nearest"] = [=[
> core = require "dm.core"
> core.nearest("stpes", { "steps", "every", "rule" })
steps
> core.nearest("xyz", { "steps", "every", "rule" }) == nil
true]=]

M["core.new_file"] = [=[
> core = require "dm.core"
> part = core.new_file "result.txt"
> part:match "result" ~= nil, io.open(part) ~= nil
true	true]=]

M["core.trace_with"] = [=[
> core = require "dm.core"
> s = dm.system { Q = dm.R(1), params = { k = 1, m = 1 },
>>   L = function(q, v, t, p) return v[1]^2 - p.k*q[1]^2 end }
> core.trace_with(s, { __index = function(_, name) print(name); return 1 end })
k]=]

M["core.open_file"] = [=[
> core = require "dm.core"
> select(2, core.open_file "/dev/zero")
cannot read /dev/zero: it is a device, which may have no end, and no file]=]

M["core.one"] = [=[
> core = require "dm.core"
> f = core.one(function(x) return x, 2*x end, "the metric")
> select(2, pcall(f, 1))
the metric must return one value, not 2: a list of numbers is one as a table, return { a, b }]=]

M["core.own_group"] = [=[
> core = require "dm.core"
> kit = require "dm.group".kit(dm.R(2))
> G = core.own_group("plane", 2, kit)
> G:compose({ 1, 2 }, { 3, 4 })
[4, 6]]=]

M["core.pick"] = [=[
> core = require "dm.core"
> core.pick({ 10, 20, 30 }, { 1, 0, 1 })
[10, 30]]=]

M["core.pass_stop"] = [=[
> core = require "dm.core"
> core.within(0.02, function() while true do core.pass_stop() end end) == false
true]=]

M["core.processor"] = [=[
> core = require "dm.core"
> ({ plain = true, fma = true, avx512 = true })[core.processor()]
true]=]

M["core.quadrature"] = [=[
> core = require "dm.core"
> core.quadrature { named = "lobatto(3)" }
[0, 0.5, 1]	[0.16666666666667, 0.66666666666667, 0.16666666666667]]=]

M["core.ranks_abort"] = [=[
> core = require "dm.core"
> select(2, pcall(core.ranks_abort, 1))
MPI is not open: require "dm.mpi"]=]

M["core.ranks_barrier"] = [=[
> core = require "dm.core"
> select(2, pcall(core.ranks_barrier))
MPI is not open: require "dm.mpi"]=]

M["core.ranks_broadcast"] = [=[
> core = require "dm.core"
> select(2, pcall(core.ranks_broadcast, 0, "the same everywhere"))
MPI is not open: require "dm.mpi"]=]

M["core.ranks_open"] = [=[
> core = require "dm.core"
> pcall(core.ranks_open, "a world")
false	bad argument #1 to '?' (a surplus argument: core.ranks_open())]=]

M["core.ranks_receive"] = [=[
> core = require "dm.core"
> select(2, pcall(core.ranks_receive, 0, 7))
MPI is not open: require "dm.mpi"]=]

M["core.ranks_send"] = [=[
> core = require "dm.core"
> select(2, pcall(core.ranks_send, 1, 7, "bytes"))
there are ranks 0 to 0 (got 1)]=]

M["core.result"] = [=[
> core = require "dm.core"
> core.result { order = 2, ok = true }
{ ok = true, order = 2 }]=]

M["core.sem_energies"] = [=[
> core = require "dm.core"
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "sem(1, gauss(1))", h = 0.1 }
> E, H = core.sem_energies(solver, { q = {1}, v = {0} }, { 0.1 })
> math.abs(E[1] - H) < 0.01, H
true	0.5]=]

M["core.sizes"] = [=[
> core = require "dm.core"
> core.sizes(dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v)/2 end })
3	3]=]

M["core.smith_form"] = [=[
> core = require "dm.core"
> s = core.smith_form { { 2, 4 }, { 6, 8 } }
> s.factors
{ 2, 4 }]=]

M["core.solvers"] = [=[
> core = require "dm.core"
> type(core.solvers())
string]=]

M["core.sparse"] = [=[
> core = require "dm.core"
> core.sparse(2, 2, { 1, 1, 2 }, { 1, 1, 2 }, { 2, 3, 7 }):dense()
[[5, 0],
 [0, 7]]]=]

M["core.spread"] = [=[
> core = require "dm.core"
> core.spread({ 10, 30 }, { 1, 0, 1 })
[10, 0, 30]
> core.spread({ 10, 30 }, { 1, 0, 1 }, { 7, 8, 9 })
[10, 8, 30]]=]

M["core.start_vector"] = [=[
> core = require "dm.core"
> x = core.start_vector(1000)
> x[1] == core.start_vector(1000)[1], x[1] == core.start_vector(1000, 1)[1]
true	false]=]

M["core.strip"] = [=[
> cable = dm.field { x = { 0, 1, 4 }, L = function(u, ut, ux) return (ut^2 - ux^2)/2 end }
> strip = cable:solver({ h = 0.1 }):run({ u = 0, ut = 1, steps = 4 }).level.strip
> strip:momenta({ 0, 0, 0, 0, 0 }, { 1, 1, 1, 1, 1 }, 0, 0.5)
[0.25, 0.5, 0.5, 0.5, 0.25]]=]

M["core.strip_fail"] = [=[
> core = require "dm.core"
> raised, failure = pcall(core.strip_fail, { status = 1, done = 2, time = 0.2 }, "cell", nil)
> failure.code, failure.step
no_convergence	3]=]

M["core.summary"] = [=[
> core = require "dm.core"
> s = core.summary({ 0, 1, 2, 3, 4 }, { 1, 3, 5, 7, 9 })
> s.first, s.largest, s.slope, s.late
1.0	9.0	2.0	8.0]=]

M["core.system_of"] = [=[
> core = require "dm.core"
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
> core.system_of(s:solver { rule = "verlet", h = 0.1 }) == s, core.system_of(s)
true	nil]=]

M["core.tiling"] = [=[
> core = require "dm.core"
> core.tiling({ 2 }, { 3 }, { 0, 1 })
[1, 2, 2, 3]]=]

M["core.trial_rule"] = [=[
> core = require "dm.core"
> core.trial_rule { text = "mine", each = 2, named = "gauss(2)" }
rule mine]=]

M["core.until_stop"] = [=[
> core = require "dm.core"
> core.until_stop(function(x) return x + 1 end, 2)
true	3
> core.until_stop(error, "not stopped")
false	not stopped]=]

M["core.wait"] = [=[
> core = require "dm.core"
> workers = { core.worker(function(channel) channel:send "first" end) }
> core.wait(workers)
1]=]

M["core.wave"] = [=[
> core = require "dm.core"
> w = core.wave("collocation", 0, 2*math.pi, 1, 1, 0, dm.zeros(8))
> w:observe(dm.zeros(8) + 1, dm.zeros(8))
6.2831853071796	0.0	2.7488935718911	0.0]=]

M["core.wave_fail"] = [=[
> core = require "dm.core"
> raised, failure = pcall(core.wave_fail, "not_finite", "strang", 3, 0.3, 0.1, 0, 0)
> failure.code, failure.rule, failure.step
not_finite	strang	3]=]

M["core.wave_nodes"] = [=[
> core = require "dm.core"
> core.wave_nodes("collocation", 0, 1, 4)
[0, 0.25, 0.5, 0.75]]=]

M["core.wave_points"] = [=[
> core = require "dm.core"
> core.wave_points("collocation", 0, 1, 4)
[0, 0.25, 0.5, 0.75]	[0.25, 0.25, 0.25, 0.25]]=]

M["core.wave_rule"] = [=[
> core = require "dm.core"
> core.wave_rule("verlet", 0.1)
split	[0.5, 0.5]	[1]]=]

M["core.wave_stepper"] = [=[
> core = require "dm.core"
> wave = dm.schroedinger { x = { 0, 1, 8 } }
> stepper = core.wave_stepper(wave:equation(), "split", 0.1, { 0.5, 0.5 }, { 1 })
> stepper:start(dm.zeros(8) + 1, dm.zeros(8))
> stepper:state()
[0.35355339059327, 0, 0.35355339059327, ... , 0] (16)]=]

M["core.wave_values"] = [=[
> core = require "dm.core"
> wave = dm.schroedinger { x = { 0, 1, 4 } }
> path = wave:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> core.wave_values(path.rows, 1)
[1, 1, 1, 1]	[0, 0, 0, 0]]=]

M["core.with_step"] = [=[
> core = require "dm.core"
> Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end
> map = function(q, p) return { q[1] + 0.1*p[1], p[1] } end
> core.with_step { Q = dm.R(1), h = 0.1, Ld = Ld, map = map }
discrete Lagrangian on R^1, h = 0.1]=]

M["core.within"] = [=[
> core = require "dm.core"
> core.within(5, function(x) return 2*x end, 21)
true	42
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> core.within(0.02, solver.run, solver, { q = {1}, v = {0}, steps = 1e10, every = 1e9 }) == false
true]=]

M["core.worker"] = [=[
> core = require "dm.core"
> w = core.worker(function(channel) channel:send(channel:receive():upper()) end)
> w:send "hello"
true
> w:receive()
HELLO]=]

return M
