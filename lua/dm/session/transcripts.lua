--- Examples of functions, methods and classes: what is typed at a prompt and what is answered,
-- by the names under which help knows them. tests/lua/session/test_transcripts.lua types all of
-- them again.
local M = {}

M["chart.order"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = s:chart { q = {1}, v = {0}, t = 10, rules = { "gauss(2)" }, h = { 0.4, 0.2, 0.1 } }
> c:order "gauss(2)" > 3.8
true]=]

M["dm.R"] = [=[
> dm.R(2), dm.R(2).dimension
R^2	2]=]

M["dm.SE"] = [=[
> dm.SE(3)
SE(3)]=]

M["dm.SO"] = [=[
> dm.SO(3), dm.SO(3):exp { 0, 0, math.pi/2 }
SO(3)	[[1.1102230246252e-16,                  -1,                   0],
 [                  1, 1.1102230246252e-16,                   0],
 [                  0,                   0,                   1]]]=]

M["dm.abs"] = [=[
> dm.abs(-2)
2]=]

M["dm.animate"] = [=[
> pcall(dm.animate, {}, "x.html") == false
true]=]

M["dm.apropos"] = [=[
> pcall(dm.apropos, "solvability")
solver:solvability{q=, v= | p=, energy=} -> { solvable, h, C, order, energy, why }
rules of dm.solver{ rule = }, ?name says more:
  sem  Symplectic-energy-momentum steps: curves of degree s, the action by ...
true]=]

M["dm.bench"] = [=[
> select("#", dm.bench(function() return 1 end, 3))
2]=]

M["dm.chart"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 10, rules = { "verlet" }, h = { 0.2, 0.1, 0.05 } }
> c:order "verlet" > 1.9
true]=]

M["dm.cite"] = [=[
> dm.cite("verlet"):match "^@%a+"
@article]=]

M["dm.derivative"] = [=[
> slope = dm.derivative(function(x) return math.sin(x[1])*x[2]^2 end, 2)
> slope { 0, 3 }
[9, 0]]=]

M["dm.discrete_lagrangian"] = [=[
> d = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> d
discrete Lagrangian on R^1, h = 0.1]=]

M["dm.figure"] = [=[
> dm.figure { { { 1, 2, 3 }, { 1, 4, 9 } }, width = 40, height = 10, ascii = true }
y
8+                        ..:'
6+                   ..:''
 |              ..:''
4+      ....:''''
2+..''''
 ++-------------+------------+
  1             2            3
               x]=]

M["dm.help"] = [=[
> dm.help "who"
who()
  The globals that were made in this session, with what they are.]=]

M["dm.identity"] = [=[
> dm.identity(2)
[[1, 0],
 [0, 1]]]=]

M["dm.journal"] = [=[
> file = os.tmpname() .. ".journal"
> s = dm.sweep { members = 4, run = function(i) return i end, journal = file }
> dm.journal(file).finished
4
> os.remove(file)
true]=]

M["dm.load"] = [=[
> file = os.tmpname()
> f = io.open(file, "w")
> f:write "t;x\n0;1,5\n1;2,5\n"; f:close();
> dm.load(file).x
[1.5, 2.5]
> os.remove(file)
true]=]

M["dm.matrix"] = [=[
> A = dm.matrix { { 2, 1 }, { 1, 3 } }
> A, A*dm.vector { 1, 0 }
[[2, 1],
 [1, 3]]	[2, 1]]=]

M["dm.mesh"] = [=[
> dm.mesh { icosphere = 1 }
mesh of dimension 2: 42, 120, 80 cells; orientable, chi 2]=]

M["dm.palette"] = [=[
> dm.palette("lines")[1], dm.palette("classes").bounded
#3647ab	#2877df]=]

M["dm.part"] = [=[
> dm.part()
1	1]=]

M["dm.plot"] = [=[
> dm.plot({ 1, 2, 3 }, { 1, 4, 9 }, { width = 40, height = 10, ascii = true })
y
8+                        ..:'
6+                   ..:''
 |              ..:''
4+      ....:''''
2+..''''
 ++-------------+------------+
  1             2            3
               x]=]

M["dm.polynomial_roots"] = [=[
> #dm.polynomial_roots { -1, 0, 1 }
2]=]

M["dm.pretty"] = [=[
> dm.pretty { 1, { 2 }, x = "y" }
{ 1, { 2 }, x = "y" }]=]

M["dm.random"] = [=[
> dm.random(3):uniform(1, 1) == dm.random(3):uniform(1, 1)
true]=]

M["dm.rules"] = [=[
> #dm.rules() > 20
true]=]

M["dm.solver"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> dm.solver { s, rule = "verlet", h = 0.1 }.rule
verlet]=]

M["dm.stability"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2)/2 end }
> m = dm.stability { system = s, rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> (m:limit(1))
1.9997894043754]=]

M["dm.stability_limit"] = [=[
> (dm.stability_limit "verlet")
2.0000000000003]=]

M["dm.sweep"] = [=[
> s = dm.sweep { members = 5, run = function(i) return { square = i^2 } end }
> s, s.square
sweep of 5 members (square): all ok	[1, 4, 9, 16, 25]]=]

M["dm.system"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s
system on R^1: separable, constant mass, 4 operations, derivatives exact]=]

M["dm.time"] = [=[
> select("#", dm.time(function() return 1 end))
2]=]

M["dm.vector"] = [=[
> v = dm.vector { 3, 4 }
> v, 2*v, v:norm()
[3, 4]	[6, 8]	5.0]=]

M["dm.zeros"] = [=[
> dm.zeros(3)
[0, 0, 0]]=]

M["ensemble.failures"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:ensemble { members = 3, steps = 50,
>>   q = function(i) return { i } end, v = function() return { 0 } end }:failures()
{}]=]

M["ensemble.path"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> #solver:ensemble { members = 3, steps = 50, every = 10,
>>   q = function(i) return { i } end, v = function() return { 0 } end }:path(2)
6]=]

M["matrix.det"] = [=[
> dm.matrix { { 2, 1 }, { 1, 3 } }:det()
5.0]=]

M["matrix.inverse"] = [=[
> dm.matrix { { 2, 0 }, { 0, 4 } }:inverse()
[[ 0.5,    0],
 [   0, 0.25]]]=]

M["matrix.solve"] = [=[
> dm.matrix { { 2, 0 }, { 0, 4 } }:solve { 2, 2 }
[1, 0.5]]=]

M["matrix.totable"] = [=[
> dm.matrix { { 1, 2 } }:totable()
{ { 1.0, 2.0 } }]=]

M["matrix.transpose"] = [=[
> dm.matrix { { 1, 2 }, { 3, 4 } }:transpose()
[[1, 3],
 [2, 4]]]=]

M["mesh.betti"] = [=[
> dm.mesh { icosphere = 1 }:betti()
{ 1, 0, 1 }]=]

M["path.column"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:column("q1")[1]
1.0]=]

M["path.csv"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:csv():match "^[^\n]*"
t,q1,p1]=]

M["path.drift"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:drift("energy").largest < 0.01
true]=]

M["path.energy"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> #path:energy()
101]=]

M["path.form"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }]=]

M["path.momentum"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:momentum(dm.SO(2))
[1, 1, 1, 1]]=]

M["path.plot"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:plot("t", "q1", { width = 40, height = 10, ascii = true })
        verlet, h = 0.1
q1
 1+':.             .:''.
  |  ':.         .:'    :.
 0+    :.       .:       ':
  |     ':     :'          :.
-1+       '..:'             ':.
  ++-------------+------------+
   0             5           10
                t]=]

M["path.series"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:series("t", "q1").name
q1]=]

M["random.normal"] = [=[
> dm.random(1):normal(1, 1) == dm.random(1):normal(1, 1)
true]=]

M["random.uniform"] = [=[
> x = dm.random(1):uniform(1, 1)
> x > 0 and x < 1
true]=]

M["solver.ensemble"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 50,
>>   q = function(i) return { i } end, v = function() return { 0 } end }
> e
ensemble of 3 members at t = 5.0: all ok]=]

M["solver.lyapunov"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:lyapunov { q = {1}, v = {0}, t = 100 }.megno < 4
true]=]

M["solver.report"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> solver:report().steps
100]=]

M["solver.reversal"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:reversal { q = {1}, v = {0}, steps = 10 } < 1e-10
true]=]

M["solver.run"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> #path, path.t[#path]
101	10.0]=]

M["solver.step"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:step({1}, {0})
[-1]]=]

M["solver.symplecticity"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:symplecticity { q = {1}, v = {0}, steps = 10 } < 1e-10
true]=]

M["space.Ad"] = [=[
> dm.SO(3):Ad(dm.SO(3):exp { 0, 0, math.pi/2 }, { 1, 0, 0 })
[1.1102230246252e-16, 1, 0]]=]

M["space.ad"] = [=[
> dm.SO(3):ad({ 1, 0, 0 }, { 0, 1, 0 })
[0, 0, 1]]=]

M["space.cayley"] = [=[
> dm.SO(3):cayley { 0, 0, 1 }
[[ 0.6, -0.8,    0],
 [ 0.8,  0.6,    0],
 [   0,    0,    1]]]=]

M["space.compose"] = [=[
> dm.SO(3):compose(dm.SO(3):exp { 0, 0, 1 }, dm.SO(3):exp { 0, 0, -1 })
[[1, 0, 0],
 [0, 1, 0],
 [0, 0, 1]]]=]

M["space.distance"] = [=[
> dm.SO(3):distance(dm.SO(3):identity(), dm.SO(3):exp { 0, 0, 1 })
1.0]=]

M["space.exp"] = [=[
> dm.SO(2):exp(math.pi/2)
1.5707963267949]=]

M["space.hat"] = [=[
> dm.SO(3):hat { 1, 2, 3 }
[[ 0, -3,  2],
 [ 3,  0, -1],
 [-2,  1,  0]]]=]

M["space.identity"] = [=[
> dm.SO(3):identity()
[[1, 0, 0],
 [0, 1, 0],
 [0, 0, 1]]]=]

M["space.inverse"] = [=[
> dm.SO(3):inverse(dm.SO(3):exp { 0, 0, 1 })
[[0.54030230586814,  0.8414709848079,                0],
 [-0.8414709848079, 0.54030230586814,                0],
 [               0,                0,                1]]]=]

M["space.log"] = [=[
> dm.SO(3):log(dm.SO(3):exp { 0, 0, 1 })
[0, 0, 1]]=]

M["space.valid"] = [=[
> dm.SO(3):valid(dm.matrix { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } })
false	its determinant is -1]=]

M["space.vee"] = [=[
> dm.SO(3):vee(dm.SO(3):hat { 1, 2, 3 })
[1, 2, 3]]=]

M["stability_map.at"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> m = s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> m:at(1, 1).class
bounded]=]

M["stability_map.limit"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> m = s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> (m:limit(1))
2.2420054996926]=]

M["sweep.csv"] = [=[
> s = dm.sweep { members = 2, run = function(i) return i end }
> s:csv()
member,value
1,1
2,2
]=]

M["sweep.failures"] = [=[
> s = dm.sweep { members = 3, run = function(i) return i end }
> #s:failures()
0]=]

M["system.emit_c"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:emit_c():match "void (%a+)"
lagrangian]=]

M["system.energy"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:energy({1}, {0})
-0.54030230586814]=]

M["system.lagrangian"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:lagrangian({0}, {2})
3.0]=]

M["system.legendre"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:legendre({0}, {2})
[2]]=]

M["system.linearize"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:linearize { q = {0} }.fastest
1.0]=]

M["system.solver"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:solver { rule = "gauss(2)", h = 0.1 }.rule
gauss(2)]=]

M["system.stability"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> (s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }:limit(1))
2.2420054996926]=]

M["system.structure"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:structure().separable, s:structure().autonomous
true	true]=]

M["vector.cross"] = [=[
> dm.vector { 1, 0, 0 }:cross(dm.vector { 0, 1, 0 })
[0, 0, 1]]=]

M["vector.dot"] = [=[
> dm.vector { 1, 2 }:dot { 3, 4 }
11.0]=]

M["vector.norm"] = [=[
> dm.vector { 3, 4 }:norm()
5.0]=]

M["vector.slice"] = [=[
> dm.vector { 1, 2, 3, 4 }:slice(2, 3)
[2, 3]]=]

M["vector.totable"] = [=[
> dm.vector { 1, 2 }:totable()
{ 1.0, 2.0 }]=]

return M
