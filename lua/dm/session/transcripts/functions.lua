--- Examples of functions of dm.
local M = {}

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

M["dm.apropos"] = [=[
> dm.apropos "coboundary"
K:coboundary              d x of plain values x on the cells of degree k, on
                          those of degree k + 1.]=]

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
  The globals that were made in this session, with what they are.

  Example:
    > length, mass = 1.5, dm.vector { 1, 2 }
    > dm.who()
    length  1.5
    mass    [1, 2]]=]

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

return M
