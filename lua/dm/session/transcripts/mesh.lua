--- Examples of methods of meshes: forms, operators, equations.
local M = {}

M["dm.operator"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> d = K:d(0)
> d.from, d.to, d.nonzeros
{ degree = 0, side = "primal" }	{ degree = 1, side = "primal" }	10
> d * K:form(0, { 0, 1, 3, 6 })
primal 1-form: [1, 3, 6, 2, 3]]=]

M["dm.vector_field"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> X = K:vector_field(function(x, y) return { 1, x } end)
> X.on, #X, X[2]
vertices	4	{ 1.0, 1.0 }
> (2*X)[2]
{ 2.0, 2.0 }]=]

M["mesh.animate"] = [=[
> K = dm.mesh { icosphere = 1 }
> K:animate("ball.html", { forms = { height = K:form(0, function(x, y, z) return z end) } })
ball.html
> os.remove "ball.html"
true]=]

M["mesh.contract_values"] = [=[
> K = dm.mesh { grid = 4 }
> a = K:form(1, function(x, y) return { 3, 0 } end)
> X = K:vector_field(function(x, y) return { 2, 0 } end)
> K:contract_values(1, a.values, X.values, "vertices")[13]
6.0]=]

M["mesh.d"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> d = K:d(0)
> d
operator from primal 0-forms to primal 1-forms
> d.matrix:dense()
[[-1,  1,  0,  0],
 [-1,  0,  1,  0],
 [-1,  0,  0,  1],
 [ 0, -1,  1,  0],
 [ 0,  0, -1,  1]]]=]

M["mesh.darcy"] = [=[
> K = dm.mesh { grid = 4 }
> flow = K:darcy { permeability = 2, pressure = function(x, y) return 1 - x end }
> across = K:form(1, function(x, y) return { 0, 2 } end)
> (flow.flux.values - across.values):norm() < 1e-12
true]=]

M["mesh.deficits"] = [=[
> K = dm.mesh { icosphere = 1 }
> sum = 0
> for _, angle in ipairs(K:deficits()) do sum = sum + angle end
> sum/math.pi
4.0]=]

M["mesh.divergence_values"] = [=[
> K = dm.mesh { grid = 4 }
> X = K:vector_field(function(x, y) return { x, y } end)
> K:divergence_values(X.values, "vertices")[13]
2.0]=]

M["mesh.dual_volume"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:dual_volume(0), K:dual_volume(0):sum()
[0.25, 0.25, 0.25, 0.25]	1.0]=]

M["mesh.dual_wedge_values"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> one = K:form(0, { 1, 1 }, { dual = true })
> two = K:form(0, { 3, 5 }, { dual = true })
> K:dual_wedge_values(0, one.values, 0, two.values)
[3, 5]]=]

M["mesh.euler"] = [=[
> K = dm.mesh { icosphere = 1 }
> flow = K:euler { vorticity = function(x, y, z) return z end }
> run = flow:solver { h = 0.1 }:run { t = 1 }
> run
flow of 10 steps of midpoint to t = 1; 11 rows]=]

M["mesh.field"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> u = K:field { fixed = "boundary", L = function(a, v)
>>   return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> u
system on R^4: separable, constant mass, 2 operations, derivatives exact
> u:modes(2).values
[1, 3]]=]

M["mesh.flat_values"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:flat_values(dm.matrix { {1, 0}, {1, 0}, {1, 0}, {1, 0} }, "vertices", "primal")
[1, 1, 0, 0, -1]	0
> K:simplices(1)
{ { 1, 2 }, { 1, 3 }, { 1, 4 }, { 2, 3 }, { 3, 4 } }]=]

M["mesh.form"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> length = K:form(1, function(x, y) return { 1, 0 } end)
> length
primal 1-form: [1, 1, 0, 0, -1]
> K:form(0, function(x, y) return x*y end).values
[0, 0, 1, 0]]=]

M["mesh.fundamental"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> area = K:form(2, function(x, y) return 1 end)
> K:fundamental()
2-chain: [1, 2, 3] + [1, 3, 4]
> area:pair(K:fundamental())
1.0]=]

M["mesh.harmonic"] = [=[
> K = dm.mesh { annulus = {2, 12}, ratio = 2 }
> h = K:harmonic(1)
> #h, h[1]:d():norm() < 1e-12, h[1]:delta():norm() < 1e-12
1	true	true]=]

M["mesh.integrals"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:integrals(1, function(x, y) return { y, 0 } end)
[0, 0.5, 0, 0, -1]]=]

M["mesh.laplace_beltrami"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> (K:laplace_beltrami() * K:form(0, function(x) return x^2 end)).values:slice(2, 3)
[2, 2]]=]

M["mesh.laplacian"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> K:laplacian(0, { fixed = "boundary" }) * K:form(0, { 0, 1, 2, 0 })
primal 0-form: [0, 0, 3, 0]
> K:laplacian(0, { fixed = "boundary" }):eigen(2).values
[1, 3]]=]

M["mesh.levi_civita"] = [=[
> K = dm.mesh { icosphere = 1 }
> A = K:levi_civita()
> A
Levi-Civita connection on dual edges of mesh of dimension 2: 42, 120, 80 cells; orientable, chi 2]=]

M["mesh.lumped"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> K:lumped(1, { 1, 1, 1 })
[0.5, 1, 1, 0.5]]=]

M["mesh.plot"] = [=[
> dm.mesh { grid = 2 }:plot { size = {30, 10}, ascii = true }
mesh of 9 vertices
y
1.0+:'''::''::
   |: .' :.' :
0.5+:'''::''::
   |: .' :.' :
0.0+::...:...:
   ++----+---+
    0.0 0.5 1.0
        x]=]

M["mesh.poisson"] = [=[
> K = dm.mesh { grid = 8 }
> u = K:poisson { f = 0, fixed = { boundary = function(x, y) return x + 2*y end } }
> exact = K:form(0, function(x, y) return x + 2*y end)
> (u - exact):norm() < 1e-12
true]=]

M["mesh.potential"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> b = K:potential(K:form(1, function(x, y) return { 2, 0 } end))
> b.values - b.values[1]
[0, 2, 2, 0]]=]

M["mesh.folds"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {0.5, 1}, {0.5, 0.8} },
>>   simplices = { {1, 2, 3}, {1, 2, 4} } }
> K
mesh of dimension 2: 4, 5, 2 cells; orientable, chi 1, folded
> K:folds()
1	{1, 2}]=]

M["mesh.quality"] = [=[
> dm.mesh { points = { {0, 0}, {1, 0}, {0, 1} } }:quality().well_centred
false
> q = dm.mesh { triangle = 2 }:quality()
> q.well_centred, ("%.3f"):format(q.least), q.negative
true	0.333	{ 0, 0, [0] = 0 }]=]

M["mesh.save"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:save "square.off"
square.off
> dm.mesh("square.off"):count(2)
2
> os.remove "square.off"
true]=]

M["mesh.sharp_values"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:sharp_values(K:form(1, function(x, y) return { 2, 3 } end).values, "primal", "cells")
[[2, 3],
 [2, 3]]]=]

M["mesh.star"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> area = K:form(0, { 1, 1, 1, 1 })
> K:star(0) * area
dual 2-form: [0.25, 0.25, 0.25, 0.25]]=]

M["mesh.star_values"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:star_values(0, { 1, 1, 1, 1 }, "primal")
[4, 4, 4, 4]]=]

M["mesh.star_weights"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> K:star_weights(1)
[1, 1, 1]	0	0	0	0]=]

M["mesh.stationary"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> u, report = K:stationary { fixed = "boundary", x = function(x) return x^2 end,
>>   term = function(a) return a:d():dot(a:d())/2 end }
> u.values, report.code
[0, 3, 6, 9]	ok]=]

M["mesh.sum"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> x = K:form(0, function(x, y) return x end)
> K:sum(2, function(x, cell) return cell.volume*x:sum()/3 end, x)
0.5]=]

M["mesh.tangent_values"] = [=[
> K = dm.mesh { icosphere = 1 }
> up = {}
> for i = 1, K:count(2) do up[i] = { 0, 0, 1 } end
> tangent, gone = K:tangent_values(dm.matrix(up), "cells")
> tangent.rows, 0.9 < gone and gone <= 1
80	true]=]

M["mesh.transfer"] = [=[
> K, M = dm.mesh { grid = 1 }, dm.mesh { grid = 2 }
> T = K:transfer(M, 0)
> T * { 1, 2, 3, 4 }
[1, 1.5, 2, 2, 2.5, 3, 3, 3.5, 4]]=]

M["mesh.vector_field"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> X = K:vector_field(function(x, y) return { 1 - y, x } end)
> X
field of vectors on 4 vertices: [[1, 0],
 [1, 1],
 [0, 1],
 [0, 0]]
> X[3]
{ 0.0, 1.0 }]=]

M["mesh.wedge_values"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> dx = K:form(1, function(x, y) return { 1, 0 } end)
> dy = K:form(1, function(x, y) return { 0, 1 } end)
> K:wedge_values(1, dx.values, 1, dy.values)
[0.5, 0.5]]=]

M["mesh.weighted_dual"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:weighted_dual(0, { 1, 1 }), K:weighted_dual(0, { 2, 0 })
[0.25, 0.25, 0.25, 0.25]	[0.25, 0.5, 0.25, 0]]=]

M["operator.eigen"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> modes = K:laplacian(0, { fixed = "boundary" }):eigen(2)
> modes.values
[1, 3]
> modes.forms[1].values
[0, 0.70710678118655, 0.70710678118655, 0]
> u = modes.forms[1] + modes.forms[2]   -- heat: u' = -laplacian u, mode by mode
> part = math.exp(-modes.values[1])*modes.forms[1]:dot(u)   -- of the first mode at t = 1
> ("%.4f"):format(part)
0.3679]=]

M["remesh.matrix"] = [=[
> K, M = dm.mesh { grid = 1 }, dm.mesh { grid = 2 }
> T = dm.remesh(K, M)
> T:matrix(0):dense()[2]
[0.5, 0.5, 0, 0]]=]

M["vector_field.curl"] = [=[
> K = dm.mesh { grid = 4 }
> K:vector_field(function(x, y) return { -y, x } end):curl().values[1]
2.0]=]

M["vector_field.div"] = [=[
> K = dm.mesh { grid = 4 }
> X = K:vector_field(function(x, y) return { x, y } end)
> div = X:div()
> div.values[13]
2.0]=]

M["vector_field.flat"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:vector_field(function(x, y) return { 1, 0 } end):flat()
primal 1-form: [1, 1, 0, 0, -1]]=]

M["vector_field.plot"] = [=[
> K = dm.mesh { grid = 3 }
> K:vector_field(function(x, y) return { 1, 0 } end):plot { size = {30, 10}, ascii = true }
vectors on 16 vertices, longest arrow: 1
y
1.0+''''''''''''
   |............
0.5+
   |''''''''''''
0.0+............
   ++---+---+---
    0.0    1.0
         x]=]

return M
