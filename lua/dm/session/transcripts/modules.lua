--- Examples of what modules use of the core, and of what they are made of.
local M = {}

M["core.arity"] = [=[
> core = require "dm.core"
> core.arity "f(x, y) -> number", core.arity "path:drift(name)"
2	2]=]

M["core.avi"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> core.avi(field, dm.vector { 0, 0.1 }, 0):limits()
[0.70710678118655]]=]

M["core.cell_action"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> action = require "dm.dec.fields.action".new(K, 0, 1, squares).traced
> action:value { 0, 1, 1, 3 }
9.5]=]

M["core.orthonormality"] = [=[
> core = require "dm.core"
> R = dm.matrix { { 1, 0 }, { 0, 2 } }
> core.orthonormality(R, 1), core.orthonormality(R, 2)
0	3]=]

M["core.quaternion"] = [=[
> core = require "dm.core"
> core.quaternion(dm.matrix { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } })[4]^2
0.5]=]

M["core.rotation"] = [=[
> core = require "dm.core"
> core.rotation { 0, 1, 0, 0 }
[[ 1,  0,  0],
 [ 0, -1,  0],
 [ 0,  0, -1]]]=]

M["dm.cell_action"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> action = require "dm.dec.fields.action".new(K, 0, 1, squares).traced
> action:value { 0, 1, 1, 3 }
9.5
> action:gradient { 0, 1, 1, 3 }
[-5, -1, -1, 7]]=]

M["cell_action.check"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> act = require "dm.dec.fields.action".new(K, 0, 1, squares)
> act.traced:check(act.of, { 0, 1, 1, 3 })]=]

M["cell_action.value"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> action = require "dm.dec.fields.action".new(K, 0, 1, squares).traced
> action:value { 0, 0, 0, 2 }
6.0]=]

M["cell_action.gradient"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> action = require "dm.dec.fields.action".new(K, 0, 1, squares).traced
> action:gradient { 0, 0, 0, 2 }
[-2, -2, -2, 6]]=]

M["cell_action.hessian"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> squares = function(u) return K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end
> action = require "dm.dec.fields.action".new(K, 0, 1, squares).traced
> action:hessian({ 0, 0, 0, 0 }):diagonal()
[3, 2, 2, 3]]=]

M["core.cell_faces"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> faces = core.cell_faces(K, 2, 3)
> K:simplices(2)[1], faces[1], K:simplices(1)[faces[1]]
{ 1, 2, 4 }	1	{ 1, 2 }]=]

M["dm.cell_table"] = [=[
> core = require "dm.core"
> faces = core.cell_faces(dm.mesh { grid = 1 }, 2, 3)
> faces[1], faces[2]
1	2]=]

M["core.cell_list"] = [=[
> core = require "dm.core"
> cells = core.cell_list(dm.vector { 2, 5, 7 })
> cells[1], cells[3]
2	7]=]

M["core.prismal_run"] = [=[
> core = require "dm.core"
> field = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }:field {
>>   L = function(u, v) return v:dot(v)/2 - u:d():dot(u:d())/2 end }
> solver = field:solver { rule = "verlet", h = 1 }
> #core.prismal_run(solver, { q = { 0, 1 }, v = { 0, 0 } }, dm.vector { 0, 0.1, 0.3 }, 1)
3]=]

M["core.cell_sum"] = [=[
> core = require "dm.core"
> K = dm.mesh { grid = 1 }
> s = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> s:energy({ 0, 1, 0, 1 }, { 0, 0, 0, 0 })
1.5]=]

M["core.class"] = [=[
> core = require "dm.core"
> Counter = core.class({ __name = "dm.counter" }, "dm.counter: counts")
> up = function(c) c.n = c.n + 1 return c.n end
> core.method("dm.counter", "up", up, "counter:up() -> integer") == up
true
> c = setmetatable({ n = 0 }, Counter)
> c:up(), c:up()
1	2]=]

M["core.constant"] = [=[
> core = require "dm.core"
> core.constant(3, 0.5)
[0.5, 0.5, 0.5]]=]

M["core.cores"] = [=[
> core = require "dm.core"
> core.cores() >= 1
true]=]

M["core.crc32"] = [=[
> core = require "dm.core"
> ("%08x"):format(core.crc32 "123456789")
cbf43926]=]

M["core.cut_file"] = [=[
> core = require "dm.core"
> f = io.open("cut.txt", "w")
> f:write "wholesome"; f:close();
> core.cut_file("cut.txt", 5)
> io.open("cut.txt"):read "a"
whole]=]

M["core.lock_file"] = [=[
> core = require "dm.core"
> f = io.open("mine.txt", "w")
> core.lock_file(f)
true
> f:close();]=]

M["core.locked"] = [=[
> core = require "dm.core"
> list = core.locked({ "t", "q1" }, "the list of the columns")
> #list, list[2]
2	q1
> (pcall(function() list[2] = "q2" end))
false]=]

M["core.unlocked"] = [=[
> core = require "dm.core"
> list = core.unlocked(core.locked({ "t", "q1" }, "the list of the columns"))
> list[2] = "q2"
> list[2]
q2]=]

M["core.end_file"] = [=[
> core = require "dm.core"
> part = core.new_file "end.txt"
> f = io.open(part, "w")
> f:write "whole"; f:close();
> core.end_file(part, "end.txt")
true
> io.open("end.txt"):read "a"
whole]=]

M["core.end_process"] = [=[
> core = require "dm.core"
> w = core.worker(function(channel) channel:send "bye" core.end_process(0) end)
> w:receive(), w:receive()
bye]=]

M["core.ensemble_like"] = [=[
> core = require "dm.core"
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 10, q = function(i) return { i } end,
>>   v = function() return { 0 } end }
> more = core.ensemble_like(e, 5)
> #more
5]=]

M["core.ensemble_pack"] = [=[
> core = require "dm.core"
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 10, q = function(i) return { i } end,
>>   v = function() return { 0 } end }
> #core.ensemble_pack(e) > 0
true]=]

M["core.ensemble_unpack"] = [=[
> core = require "dm.core"
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 10, q = function(i) return { i } end,
>>   v = function() return { 0 } end }
> more = core.ensemble_like(e, 6)
> core.ensemble_unpack(more, 4, 3, core.ensemble_pack(e))
true
> more.q[6][1] == e.q[3][1]
true]=]

M["core.entries"] = [=[
> core = require "dm.core"
> core.entries(dm.matrix { { 1, 2 }, { 3, 4 } })
[1, 2, 3, 4]]=]

M["core.euler"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> engine:vorticity():sum() < 1e-15
true]=]

M["core.field_check"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.field_check(field, { 0, 1 })]=]

M["core.field_force"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.field_force(field, { 0, 1 })
[1, -1]]=]

M["core.field_hessian"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.field_hessian(field, { 0, 1 }):dense()
[[-1,  1],
 [ 1, -1]]]=]

M["core.field_masses"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.field_masses(field)
[0.5, 0.5]	nil]=]

M["core.field_is_timed"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.field_is_timed(field)
false]=]

M["core.field_system"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2/2 end, u) end }
> core.sizes(field)
2	2]=]

M["core.filon_weights"] = [=[
> core = require "dm.core"
> core.filon_weights({ named = "lobatto(2)" }, 0)
[0.5, 0.5]	[0, 0]	[0, 1]]=]

M["core.fingerprint"] = [=[
> core = require "dm.core"
> make = function(k) return dm.system { Q = dm.R(1),
>>   L = function(q, v) return v[1]^2/2 - k*q[1]^2/2 end } end
> core.fingerprint(make(1)) == core.fingerprint(make(1))
true
> core.fingerprint(make(1)) == core.fingerprint(make(2))
false]=]

M["core.gauss_phase"] = [=[
> core = require "dm.core"
> math.abs(core.gauss_phase(2, 0.1)) < 1e-6
true]=]

M["core.icosphere"] = [=[
> core = require "dm.core"
> triangles, points = core.icosphere(0)
> #triangles/3, points.rows
20.0	12]=]

M["core.is_silent"] = [=[
> core = require "dm.core"
> core.is_silent()
false]=]

M["core.is_symbol"] = [=[
> core = require "dm.core"
> core.is_symbol(1.5), core.is_symbol(dm.hyperdual(1))
false	true]=]

M["core.journal_file"] = [=[
> core = require "dm.core"
> file = core.journal_file("journal_file.journal", true)
> file:size()
0]=]

M["core.lattice"] = [=[
> core = require "dm.core"
> core.lattice({ 1, 1 }, { 2, 2 })
[[0, 0],
 [1, 0],
 [0, 1],
 [1, 1]]]=]

return M
