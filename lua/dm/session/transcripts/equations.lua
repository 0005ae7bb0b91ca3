--- Examples of sparse matrices, multigrid, multiscale elements, reduced equations, scenes.
local M = {}

M["dm.msfem_solution"] = [=[
> s = dm.msfem { a = function(x) return 1 end, f = function(x) return -2 end,
>>   x = { 0, 0.25, 0.5, 1 } }
> s
multiscale elements for (a u')' = f: 4 nodes from 0 to 1, 16 panels
> s.u, s.elements
[0, 0.1875, 0.25, 0]	multiscale]=]

M["dm.sparse"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A, A.nonzeros
sparse matrix, 2 x 3, 4 entries	4
> A*dm.vector { 1, 4, 9 }
[3, 5]]=]

M["dm.symbol"] = [=[
> f = dm.trace(function(q) return math.sin(q[1])*q[1] end, 1)
> f:graph()
y1 = x1*sin(x1)

> dm.trace(function(q) print(getmetatable(q[1]).__name) return q[1] end, 1)
dm.symbol
function of 1 number to a number (0 operations, derivatives exact)]=]

M["lagrange_poincare.residual"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> run = lp:solver():run { x = {1}, p = {0}, mu = { 0.1, 0, 3 }, steps = 10 }
> ver, hor = lp:residual({ run.x[1], run.x[2], run.x[3] }, { run.f[1], run.f[2] })
> ver:norm() < 1e-13, hor:norm() < 1e-13
true	true]=]

M["lagrange_poincare.solver"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> lp:solver { h = 0.05 }
reduced by SO(3), shapes in R^1, h = 0.05, lie(1)]=]

M["msfem_solution.exact"] = [=[
> s = dm.msfem { a = function(x) return 1 end, f = function(x) return -2 end,
>>   x = { 0, 0.25, 0.5, 1 } }
> s:exact(0.5)
0.25]=]

M["msfem_solution.plot"] = [=[
> s = dm.msfem { a = function(x) return 1 end, f = function(x) return -2 end,
>>   x = { 0, 0.25, 0.5, 1 } }
> s:plot { size = {40, 8}, ascii = true }
a exact   b multiscale   c nodes
0.2+       ca.:baco:b:...
0.1+   a.:''         '''ba:..
0.0+ c'b                   'bao
   +-+------------+-----------+-
    0.0          0.5         1.0
                 x]=]

M["msfem_solution.shape"] = [=[
> s = dm.msfem { a = function(x) return 1 end, f = function(x) return -2 end,
>>   x = { 0, 0.25, 0.5, 1 } }
> s:shape(3, 0.5), s:shape(3, 0.375), s:shape(3, 0.25)
1.0	0.5	0.0]=]

M["msfem_solution.value"] = [=[
> s = dm.msfem { a = function(x) return 1 end, f = function(x) return -2 end,
>>   x = { 0, 0.25, 0.5, 1 } }
> s:value(0.5), s:value(0.75), s:exact(0.75)
0.25	0.125	0.1875]=]

M["multigrid.matrix"] = [=[
> mg = dm.multigrid { dm.mesh { grid = 2 }, dm.mesh { grid = 4 }, dm.mesh { grid = 8 } }
> mg:matrix(1):dense()[5][5]
4.0
> #mg, mg:matrix(3).rows
3	81]=]

M["multigrid.prolong"] = [=[
> mg = dm.multigrid { dm.mesh { grid = 2 }, dm.mesh { grid = 4 }, dm.mesh { grid = 8 } }
> coarse = mg.meshes[1]:form(0, function(x, y) return x + 2*y end)
> fine = mg.meshes[2]:form(0, function(x, y) return x + 2*y end)
> (mg:prolong(coarse) - fine):norm() < 1e-15
true]=]

M["multigrid.restrict"] = [=[
> mg = dm.multigrid { dm.mesh { grid = 2 }, dm.mesh { grid = 4 }, dm.mesh { grid = 8 } }
> one = mg.meshes[2]:form(0, function() return 1 end)
> mg:restrict(one).values
[2.5, 3, 2, 3, 4, 3, 2, 3, 2.5]]=]

M["multigrid.solve"] = [=[
> mg = dm.multigrid { dm.mesh { grid = 2 }, dm.mesh { grid = 4 }, dm.mesh { grid = 8 } }
> u, report = mg:solve(mg.meshes[3]:form(0, function(x, y) return 1 end))
> report.code, report.factor < 0.3
ok	true]=]

M["scaling.exponent"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> c = dm.scaling { system = s, start = function(i) return { i/4 }, { 0 } end,
>>   members = { 4, 8 }, rules = { "verlet" }, h = 0.1, steps = 10, repeats = 1 }
> c.points[1].size, type(c:exponent "verlet")
4	nil]=]

M["scaling.plot"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> c = dm.scaling { system = s, start = function(i) return { i/4 }, { 0 } end,
>>   members = { 4, 8 }, rules = { "verlet" }, h = 0.1, steps = 10, repeats = 1 }
> c:plot { file = "cost.svg" }
cost.svg
> os.remove "cost.svg"
true]=]

M["scaling.table"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> c = dm.scaling { system = s, start = function(i) return { i/4 }, { 0 } end,
>>   members = { 4, 8 }, rules = { "verlet" }, h = 0.1, steps = 10, repeats = 1 }
> c:table():match "verlet"
verlet]=]

M["scene.animate"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> scene = dm.scene { system = s, q = {1}, v = {0}, watch = { "q1" }, tolerance = 1e-3,
>>   until_t = 5, rules = { "verlet" } }
> scene:animate "scene.html"
scene.html
> os.remove "scene.html"
true]=]

M["scene.run"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> scene = dm.scene { system = s, q = {1}, v = {0}, watch = { "q1" }, tolerance = 1e-3,
>>   until_t = 5, rules = { "verlet" } }
> path = scene:run()
> path.columns, path.error_estimate < 1e-3
{ "t", "q1" }	true]=]

M["scene.why"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> scene = dm.scene { system = s, q = {1}, v = {0}, watch = { "q1" }, tolerance = 1e-3,
>>   until_t = 5, rules = { "verlet" } }
> scene:why():match "choice: ([^:]*)"
linear about an equilibrium, 1 of 1 modes, verlet with h = 0.06329 (79 steps)]=]

M["sparse.all_eigenpairs"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> S = A:gram { 1, 1 }
> values, modes = S:all_eigenpairs { 1, 1, 1 }
> ("%.6f %.6f"):format(values[2], values[3])
1.000000 3.000000]=]

M["sparse.asymmetry"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:gram({ 1, 1 }):asymmetry()
0.0]=]

M["sparse.dense"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:dense()
[[-1,  1,  0],
 [ 0, -1,  1]]]=]

M["sparse.diagonal"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> S = A:gram { 1, 1 }
> S:diagonal()
[1, 2, 1]]=]

M["sparse.eigenpairs"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> S = K:incidence(0):gram { 1, 1, 1 }:pick({ 0, 1, 1, 0 }, { 0, 1, 1, 0 })
> values = S:eigenpairs({ 1, 1 }, S:factor "cholesky", 0, 1)
> ("%.6f"):format(values[1])
1.000000]=]

M["sparse.factor"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> S = A:gram { 1, 1 }
> F = S:pick({ 1, 1, 0 }, { 1, 1, 0 }):factor "dense"
> F:solve { 1, 0 }
[2, 1]	0]=]

M["sparse.gram"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:gram({ 1, 2 }):dense()
[[ 1, -1,  0],
 [-1,  3, -2],
 [ 0, -2,  2]]]=]

M["sparse.negatives"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> S = A:gram { 1, 1 }
> (S:scale({ -1, -1, -1 })):pick({ 1, 1, 0 }, { 1, 1, 0 }):negatives()
2]=]

M["sparse.pick"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:pick({ 1, 0 }, nil):dense()
[[-1,  1,  0]]]=]

M["sparse.row_sums"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:row_sums()
[2, 2]]=]

M["sparse.saddle"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:saddle({ 1, 1, 1 }):dense()
[[ 1,  0,  0,  1,  0],
 [ 0,  1,  0, -1,  1],
 [ 0,  0,  1,  0, -1],
 [ 1, -1,  0,  0,  0],
 [ 0,  1, -1,  0,  0]]]=]

M["sparse.scale"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:scale({ 2, 3 }):dense()
[[-2,  2,  0],
 [ 0, -3,  3]]]=]

M["sparse.transpose"] = [=[
> A = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }:incidence(0)
> A:transpose():dense()
[[-1,  0],
 [ 1, -1],
 [ 0,  1]]]=]

return M
