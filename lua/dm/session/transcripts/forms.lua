--- Examples of chains, forms, cones, maps of meshes and flows on them.
local M = {}

M["dm.complex"] = [=[
> K = dm.complex { simplices = { { 1, 2, 3 }, { 1, 3, 4 } },
>>   points = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } }
> K
mesh of dimension 2: 4, 5, 2 cells; orientable, chi 1
> K:volume(2)
[0.5, 0.5]]=]

M["dm.delaunay"] = [=[
> #dm.delaunay(dm.matrix { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1.1, 1 } })/3
2.0]=]

M["dm.chain"] = [=[
> K = dm.mesh { grid = 1 }
> c = K:chain(1, { { 1, { 1, 2 } }, { 1, { 2, 4 } } })
> c
1-chain: [1, 2] + [2, 4]
> c + c == 2*c
true]=]

M["chain.boundary"] = [=[
> K = dm.mesh { grid = 1 }
> path = K:chain(1, { { 1, { 1, 2 } }, { 1, { 2, 4 } } })
> path:boundary()
0-chain: -[1] + [4]
> #K:chain(2, { { 1, { 1, 2, 4 } } }):boundary():boundary():support()
0]=]

M["chain.support"] = [=[
> K = dm.mesh { grid = 1 }
> K:chain(0, { { 1, { 1 } }, { -1, { 4 } } }):support()
{ 1, 4 }]=]

M["dm.form"] = [=[
> K = dm.mesh { grid = 1 }
> x = K:form(0, function(x, y) return x end)
> x.values, x:d():at { 1, 2 }
[0, 1, 0, 1]	1.0]=]

M["form.at"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> dx:at { 1, 2 }, dx:at { 2, 1 }
1.0	-1.0]=]

M["form.contract"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> X = K:vector_field(function() return { 3, 0 } end)
> dx:contract(X).values
[3, 3, 3, 3]]=]

M["form.d"] = [=[
> K = dm.mesh { grid = 1 }
> x = K:form(0, function(x, y) return x end)
> x:d():at { 1, 3 }
0.0
> x:d():d():max()
0]=]

M["form.delta"] = [=[
> ring = dm.mesh { square_torus = 4 }
> u, w = {}, {}
> for i = 1, 16 do u[i] = math.sin(i) end
> for i = 1, 48 do w[i] = math.cos(i) end
> f, a = ring:form(0, u), ring:form(1, w)
> math.abs(f:d():dot(a) - f:dot(a:delta())) < 1e-12
true]=]

M["form.dot"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> dx:dot(dx)
1.0]=]

M["form.grad"] = [=[
> K = dm.mesh { grid = 1 }
> K:form(0, function(x, y) return 2*x + 3*y end):grad()[1]
{ 2.0, 3.0 }]=]

M["form.hodge"] = [=[
> ring = dm.mesh { square_torus = 4 }
> w = {}
> for i = 1, 48 do w[i] = math.cos(i) end
> a = ring:form(1, w)
> parts = a:hodge()
> (a - parts.exact - parts.coexact - parts.harmonic):max() < 1e-12
true
> parts.exact:dot(parts.coexact) < 1e-12
true]=]

M["form.lie"] = [=[
> K = dm.mesh { grid = 1 }
> x = K:form(0, function(x, y) return x end)
> X = K:vector_field(function() return { 3, 0 } end)
> x:lie(X).values
[3, 3, 3, 3]]=]

M["form.max"] = [=[
> K = dm.mesh { grid = 1 }
> K:form(0, function(x, y) return -5*x end):max()
5.0]=]

M["form.norm"] = [=[
> K = dm.mesh { grid = 1 }
> K:form(2, function() return 2 end):norm()
2.0]=]

M["form.pair"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> dx:pair(K:chain(1, { { 1, { 1, 2 } }, { 1, { 2, 4 } } }))
1.0]=]

M["form.plot"] = [=[
> K = dm.mesh { grid = 4 }
> f = K:form(0, function(x, y) return x*y end)
> f:plot { file = "form.svg" }
form.svg]=]

M["form.sharp"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> dx:sharp()[1], dx:sharp({ to = "cells" })[1]
{ 1.0, 0.0 }	{ 1.0, 0.0 }]=]

M["form.star"] = [=[
> K = dm.mesh { grid = 1 }
> area = K:form(2, function() return 1 end)
> area:star().values
[1, 1]]=]

M["form.wedge"] = [=[
> K = dm.mesh { grid = 1 }
> dx = K:form(0, function(x, y) return x end):d()
> dy = K:form(0, function(x, y) return y end):d()
> dx:wedge(dy).values
[0.5, -0.5]]=]

M["dm.cone"] = [=[
> K = dm.mesh { grid = 1 }
> p = K:cone()
> p, p:check()
dm.cone (matching) of a mesh of dimension 2, hub 1	0]=]

M["cone.augment"] = [=[
> K = dm.mesh { grid = 1 }
> p = K:cone()
> more = p:augment { at = 2, ring = { 4 }, vertex = { 2, 0.5 } }
> more.mesh, more:check()
mesh of dimension 2: 5, 7, 3 cells; orientable, chi 1	0]=]

M["cone.carry"] = [=[
> K = dm.mesh { grid = 1 }
> f = dm.simplicial_map(K, K, { 1, 3, 2, 4 })
> K:cone():carry(f):check()
0]=]

M["cone.check"] = [=[
> dm.mesh { grid = 3 }:cone():check()
0]=]

M["cone.cocone"] = [=[
> K = dm.mesh { grid = 1 }
> closed = K:form(0, function(x, y) return x + 2*y end):d()
> (K:cone():cocone(closed):d() - closed):max()
0]=]

M["cone.project"] = [=[
> K = dm.mesh { grid = 1 }
> K:cone():project(K:chain(0, { { 5, { 3 } } }))
0-chain: 5 [1]]=]

M["dm.simplicial_map"] = [=[
> circle = dm.mesh { simplex_boundary = 2 }
> turn = dm.simplicial_map(circle, circle, { 2, 3, 1 })
> turn:homology(1)
{ { 1 } }]=]

M["dm.diffeo"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> phi
diffeomorphism of a mesh of dimension 2: 4, 5, 2 cells; orientable, chi 1]=]

M["diffeo.compose"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> there_and_back = phi:inverse():compose(phi)
> there_and_back.from == K, there_and_back.to == K
true	true]=]

M["diffeo.dual"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> centres, images = phi:dual()
> centres[1], images[1]
[0.5, 0.5]	[1, 0.5]]=]

M["diffeo.dual_velocity"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, function(t)
>>   return { { 0, 0 }, { 1 + t, 0 }, { 0, 1 }, { 1 + t, 1 } } end)
> v = phi:dual_velocity(0)
> ("%.6f"):format(v[1][1])
0.500000]=]

M["diffeo.inverse"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> phi:inverse().to == K
true]=]

M["diffeo.material_velocity"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, function(t)
>>   return { { 0, 0 }, { 1 + t, 0 }, { 0, 1 }, { 1 + t, 1 } } end)
> phi:material_velocity(1)[2]
{ 1.0, 0.0 }]=]

M["diffeo.pair"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> phi:pair().source == K
true]=]

M["diffeo.pull"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> area = phi.to:form(2, function() return 1 end)
> phi:pull(area).values
[1, -1]]=]

M["diffeo.push"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, dm.mesh { grid = 1, map = function(x, y) return { 2*x, y } end })
> X = K:vector_field(function() return { 1, 0 } end, { on = "cells" })
> phi:push(X)[1]
{ 2.0, 0.0 }]=]

M["diffeo.spatial_velocity"] = [=[
> K = dm.mesh { grid = 1 }
> phi = dm.diffeo(K, function(t)
>>   return { { 0, 0 }, { 1 + t, 0 }, { 0, 1 }, { 1 + t, 1 } } end)
> phi:spatial_velocity(1)[2]
{ 1.0, 0.0 }]=]

M["dm.remesh"] = [=[
> K, M = dm.mesh { grid = 1 }, dm.mesh { grid = 2 }
> T = dm.remesh(K, M)
> x = T(K:form(0, function(x, y) return x end))
> (x - M:form(0, function(x, y) return x end)):max()
0]=]

M["dm.prismal"] = [=[
> K = dm.mesh { triangle = 2 }
> u = K:field { L = function(a, v) return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> solver = u:solver { rule = dm.prismal { 0, 0.1, 0.15, 0.25 } }
> solver:run { q = function(x, y) return x end, v = function() return 0 end }.t[3]
0.15]=]

M["dm.prismal_solver"] = [=[
> K = dm.mesh { triangle = 2 }
> u = K:field { L = function(a, v) return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> solver = u:solver { rule = dm.prismal { 0, 0.1, 0.15, 0.25 } }
> solver.slices
prismal: 3 slices from t = 0 to 0.25]=]

M["prismal_solver.run"] = [=[
> K = dm.mesh { triangle = 2 }
> u = K:field { L = function(a, v) return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> solver = u:solver { rule = dm.prismal { 0, 0.1, 0.15, 0.25 } }
> #solver:run { q = function(x, y) return x end, v = function() return 0 end, every = 2 }
3]=]

M["dm.multigrid"] = [=[
> mg = dm.multigrid { dm.mesh { grid = 2 }, dm.mesh { grid = 4 }, dm.mesh { grid = 8 } }
> mg
multigrid of 9, 25, 81 vertices]=]

M["dm.factor"] = [=[
> core = require "dm.core"
> A = core.sparse(2, 2, { 1, 1, 2, 2 }, { 1, 2, 1, 2 }, { 2, 1, 1, 3 })
> f = A:factor "cholesky"
> f.kind, f.unknowns
cholesky	2]=]

M["factor.solve"] = [=[
> core = require "dm.core"
> A = core.sparse(2, 2, { 1, 1, 2, 2 }, { 1, 2, 1, 2 }, { 2, 1, 1, 3 })
> x = A:factor("cholesky"):solve { 3, 4 }
> x
[1, 1]]=]

return M
