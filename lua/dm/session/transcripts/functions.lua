--- Examples of functions of dm.
local M = {}

M["dm.R"] = [=[
> dm.R(2), dm.R(2).dimension
R^2	2]=]

M["dm.SE"] = [=[
> G = dm.SE(2)
> G.dimension, G:identity()
3	[0, 0, 0]
> G:compose({ 1, 0, 0 }, { 0, 2, 0.5 })
[1, 2, 0.5]]=]

M["dm.SO"] = [=[
> dm.SO(3).dimension
3
> R = dm.SO(3):exp { 0, 0, math.pi/6 }
> R[1], R:det()
[0.86602540378444, -0.5, 0]	1.0]=]

M["dm.abs"] = [=[
> dm.abs(-2)
2]=]

M["dm.apropos"] = [=[
> dm.apropos "coboundary"
K:coboundary              d x of plain values x on the cells of degree k, on
                          those of degree k + 1.]=]

M["dm.bench"] = [=[
> seconds, text = dm.bench(function() return math.sin(1) end, 3)
> seconds < 1e-3, text:match "best of %d+"
true	best of 3]=]

M["dm.chart"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 10, rules = { "verlet" }, h = { 0.2, 0.1, 0.05 } }
> c:order "verlet" > 1.9
true]=]

M["dm.cite"] = [=[
> dm.cite "galerkin(2, lobatto(3))"
@article{marsden-west-2001,
  author = {Marsden, Jerrold E. and West, Matthew},
  title = {Discrete mechanics and variational integrators},
  journal = {Acta Numerica},
  volume = {10},
  pages = {357--514},
  year = {2001}
}

@phdthesis{leok-2004,
  author = {Leok, Melvin},
  title = {Foundations of Computational Geometric Mechanics},
  school = {California Institute of Technology},
  year = {2004}
}

@book{hlw-2006,
  author = {Hairer, Ernst and Lubich, Christian and Wanner, Gerhard},
  title = {Geometric Numerical Integration},
  publisher = {Springer},
  edition = {2nd},
  year = {2006}
}]=]

M["dm.derivative"] = [=[
> slope = dm.derivative(function(x) return math.sin(x[1])*x[2]^2 end, 2)
> slope { 0, 3 }
[9, 0]]=]

M["dm.discrete_lagrangian"] = [=[
> d = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> d
discrete Lagrangian on R^1, h = 0.1
> d({ 0 }, { 0.3 }), d:legendre_plus({ 0 }, { 0.3 })
0.45	[3]]=]

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
> s = dm.sweep { members = 4, run = function(i) return i end, journal = "four.journal" }
> j = dm.journal "four.journal"
> j.finished, j.members, j.missing
4	4	{}]=]

M["dm.load"] = [=[
> f = io.open("data.txt", "w")
> f:write "# t x\n0,5 1\n1,5 2\n"; f:close();
> data = dm.load "data.txt"
> data.columns, data.t, data.x
{ "t", "x" }	[0.5, 1.5]	[1, 2]]=]

M["dm.matrix"] = [=[
> A = dm.matrix { { 2, 1 }, { 1, 3 } }
> A, A*dm.vector { 1, 0 }
[[2, 1],
 [1, 3]]	[2, 1]]=]

M["dm.mesh"] = [=[
> dm.mesh { icosphere = 1 }
mesh of dimension 2: 42, 120, 80 cells; orientable, chi 2]=]

M["dm.palette"] = [=[
> dm.palette "lines"
{ "#3647ab", "#ee6b75", "#0e7b22", "#cfab30", "#57bee9", "#882763" }
> dm.palette("classes").bounded
#2877df]=]

M["dm.part"] = [=[
> k, n = dm.part()
> k, n
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
> re, im = dm.polynomial_roots { 1, 0, 1 }
> re, im
[0, 0]	[-1, 1]]=]

M["dm.pretty"] = [=[
> dm.pretty { 1, { 2 }, x = "y" }
{ 1, { 2 }, x = "y" }]=]

M["dm.random"] = [=[
> r = dm.random(3)
> x, y = r:uniform(1, 1), r:uniform(2, 1)
> x > 0 and x < 1, x ~= y, dm.random(3):uniform(1, 1) == x
true	true	true]=]

M["dm.rules"] = [=[
> rule = dm.rules()[1]
> rule.name, rule.order, rule.symplectic
verlet	2	true]=]

M["dm.solver"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = dm.solver { s, rule = "gauss(2)", h = 0.1 }
> solver:run({ q = {1}, v = {0}, t = 1 }).q[11], math.cos(1)
[0.54030242266954]	0.54030230586814]=]

M["dm.stability"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2)/2 end }
> m = dm.stability { system = s, rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> math.abs(m:limit(1) - 2) < 1e-3
true]=]

M["dm.stability_limit"] = [=[
> math.abs(dm.stability_limit "verlet" - 2) < 1e-6
true]=]

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
> seconds, text = dm.time(function() return math.sin(1) end)
> seconds < 1e-3, text:match "%d" ~= nil
true	true]=]

M["dm.vector"] = [=[
> v = dm.vector { 3, 4 }
> v, 2*v, v:norm()
[3, 4]	[6, 8]	5.0]=]

M["dm.zeros"] = [=[
> dm.zeros(3)
[0, 0, 0]
> dm.zeros(2, 3)
[[0, 0, 0],
 [0, 0, 0]]]=]

return M
