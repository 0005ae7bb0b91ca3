--- Examples of methods of meshes: cells, homology, matchings, maps, connections.
local M = {}

M["dm.levi_civita"] = [=[
> K = dm.mesh { icosphere = 1 }
> A = K:levi_civita()
> A.rule, A.on
face	dual]=]

M["dm.matching"] = [=[
> K = dm.mesh { icosphere = 1 }
> m = require "dm.core".matching(K)
> #m:critical(0), #m:critical(1), #m:critical(2)
1	0	1]=]

M["dm.pair_tuple"] = [=[
> curve = dm.pair(0, 1, 3, 6)
> #curve, curve[2]
3	(1, 3)]=]

M["levi_civita.angle"] = [=[
> K = dm.mesh { icosphere = 1 }
> sum = 0
> for _, angle in ipairs(K:levi_civita():angle()) do sum = sum + angle end
> sum/math.pi
4.0]=]

M["levi_civita.curvature"] = [=[
> K = dm.mesh { points = { {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1} },
>>   simplices = { {1, 2, 3}, {1, 2, 4}, {1, 3, 4}, {2, 3, 4} } }
> A = K:levi_civita()
> A:angle()[1]/math.pi
1.0
> A:curvature(1):trace()/2
-1.0]=]

M["levi_civita.frame"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:levi_civita():frame(1)
[[1, 0],
 [0, 1]]]=]

M["levi_civita.holonomy"] = [=[
> K = dm.mesh { points = { {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1} },
>>   simplices = { {1, 2, 3}, {1, 2, 4}, {1, 3, 4}, {2, 3, 4} } }
> A = K:levi_civita()
> M = A:holonomy { 1, 2, 3, 1 }
> ("%.3f %.3f"):format(M[1][1], M[2][2])
-1.000 -1.000]=]

M["levi_civita.rotation"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> A = K:levi_civita()
> A:rotation(1, 2)
[[ 0.70710678118655,  0.70710678118655],
 [-0.70710678118655,  0.70710678118655]]]=]

M["levi_civita.transport"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> A = K:levi_civita()
> v = A:transport({ 1, 2 }, { 1, 0 })
> v
[0.70710678118655, -0.70710678118655]
> (A:frame(2)*v - A:frame(1)*dm.vector { 1, 0 }):norm() < 1e-15
true]=]

M["matching.cocone"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3} } }
> m = require "dm.core".matching(K)
> m:cocone(0, { 5, 7 })
[0, 5, 12]]=]

M["matching.core"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {1, 3} } }
> m = require "dm.core".matching(K)
> m:core(1)
0]=]

M["matching.critical"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {1, 3} } }
> m = require "dm.core".matching(K)
> m:critical(0), m:critical(1)
{ 1 }	{ 3 }]=]

M["matching.flow"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3} } }
> m = require "dm.core".matching(K)
> m:flow(0, { [3] = 1 })
{ 1, 1 }	{ 1 }]=]

M["matching.gather"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {1, 3} } }
> m = require "dm.core".matching(K)
> m:gather(1, { 1, 0, 0 }), m:gather(1, { 1, 1, 1 })
[1]	[1]]=]

M["mesh.betti"] = [=[
> dm.mesh { icosphere = 1 }:betti()
{ 1, 0, 1 }
> dm.mesh { torus = {8, 6}, radii = {2, 1} }:betti()
{ 1, 2, 1 }
> dm.mesh { named = "rp2" }:betti()
{ 1, 0, 0 }]=]

M["mesh.boundary"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> edge, vertices = K:boundary()
> edge, vertices
mesh of dimension 1: 4, 4 cells; orientable, chi 0	{ 1, 2, 3, 4 }]=]

M["mesh.boundary_cells"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:boundary_cells(1), K:boundary_cells(0)
{ 1, 3, 4, 5 }	{ 1, 2, 3, 4 }]=]

M["mesh.boundary_marks"] = [=[
> dm.mesh { grid = 2 }:boundary_marks(0)
[1, 1, 1, 1, 0, 1, 1, 1, 1]]=]

M["mesh.boundary_sum"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:simplices(1)
{ { 1, 2 }, { 1, 3 }, { 1, 4 }, { 2, 3 }, { 3, 4 } }
> K:boundary_sum(1, { 1, 0, 0, 0, 0 })
[-1, 1, 0, 0]]=]

M["mesh.chain"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> c = K:chain(1, { {2, {1, 2}}, {1, {3, 2}} })
> c
1-chain: 2 [1, 2] - [2, 3]
> c:boundary()
0-chain: -2 [1] + 3 [2] - [3]]=]

M["mesh.circumcentres"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:circumcentres(2)
[[0.5, 0.5],
 [0.5, 0.5]]]=]

M["mesh.coboundary"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:coboundary(0, { 0, 1, 3, 6 })
[1, 3, 6, 2, 3]
> K:simplices(1)
{ { 1, 2 }, { 1, 3 }, { 1, 4 }, { 2, 3 }, { 3, 4 } }]=]

M["mesh.cofaces"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:simplices(1)[2]
{ 1, 3 }
> K:cofaces(1, 2)
{ 1, 2 }]=]

M["mesh.component_of"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {4, 5} } }
> K:component_of()
[1, 1, 1, 2, 2]	2]=]

M["mesh.components"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {4, 5} } }
> K:components()
{ { 1, 2, 3 }, { 4, 5 } }]=]

M["mesh.cone"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> p = K:cone()
> p
dm.cone (matching) of a mesh of dimension 2, hub 1
> a = K:form(1, function(x, y) return { 1, 2 } end)
> (p:cocone(a):d() - a):norm() < 1e-15
true]=]

M["mesh.count"] = [=[
> K = dm.mesh { icosphere = 1 }
> K:count(0) - K:count(1) + K:count(2)
2]=]

M["mesh.dual_ring"] = [=[
> K = dm.mesh { icosphere = 1 }
> ring = K:dual_ring(1)
> #ring == #K:star_cells(0, 1, 2)
true]=]

M["mesh.faces"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:simplices(2)[1], K:faces(2, 1)
{ 1, 2, 3 }	{ 4, 2, 1 }]=]

M["mesh.find"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:find { 1, 3, 2 }
1	-1
> K:find { 2, 4 }]=]

M["mesh.flip_values"] = [=[
> kite = dm.mesh { points = { {0, 0}, {4, 0}, {2, 1}, {2, -1} },
>>   simplices = { {1, 2, 3}, {1, 2, 4} } }
> triangles, squares, flips = kite:flip_values()
> triangles, flips
[3, 1, 4, 4, 2, 3]	1]=]

M["mesh.frame_places"] = [=[
> K = dm.mesh { points = { {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1} },
>>   simplices = { {1, 2, 3}, {1, 2, 4}, {1, 3, 4}, {2, 3, 4} } }
> K:frame_places(1)
[[              0,               0],
 [2.8284271247462,               0],
 [1.4142135623731, 2.4494897427832]]]=]

M["mesh.frame_rotation"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:frame_rotation(1, 2)
[[ 0.70710678118655,  0.70710678118655],
 [-0.70710678118655,  0.70710678118655]]]=]

M["mesh.generators"] = [=[
> K = dm.mesh { annulus = {1, 6}, ratio = 2 }
> K:generators(1)[1]
1-chain: [1, 2] - [1, 6] + [2, 3] + [3, 4] + [4, 5] + [5, 6]]=]

M["mesh.homology"] = [=[
> K = dm.mesh { named = "rp2" }
> K:homology(1).betti, K:homology(1).torsion
0	{ 2 }
> K:homology(1).of_torsion[1]:boundary()
0-chain: 0]=]

M["mesh.incidence"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:incidence(0):dense()
[[-1,  1,  0,  0],
 [-1,  0,  1,  0],
 [-1,  0,  0,  1],
 [ 0, -1,  1,  0],
 [ 0,  0, -1,  1]]]=]

M["mesh.link"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> ring, vertices = K:link(0, 1)
> ring, vertices
mesh of dimension 1: 3, 2 cells; orientable, chi 1	{ 2, 3, 4 }]=]

M["mesh.make_delaunay"] = [=[
> kite = dm.mesh { points = { {0, 0}, {4, 0}, {2, 1}, {2, -1} },
>>   simplices = { {1, 2, 3}, {1, 2, 4} } }
> kite:quality().delaunay
false
> kite:make_delaunay():simplices(2)
{ { 1, 3, 4 }, { 2, 3, 4 } }]=]

M["mesh.open_star"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:open_star(0, 2)
{ { 1, 4 }, { 1 }, [0] = { 2 } }]=]

M["mesh.orientation"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:orientation()
[1, 1]
> dm.mesh { named = "rp2" }:orientation() == nil
true]=]

M["mesh.oriented"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:oriented(K:volume(2))
[0.5, 0.5]]=]

M["mesh.points"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:points()
[[0, 0],
 [1, 0],
 [1, 1],
 [0, 1]]]=]

M["mesh.simplices"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:simplices(2)
{ { 1, 2, 3 }, { 1, 3, 4 } }
> K:simplices(1)
{ { 1, 2 }, { 1, 3 }, { 1, 4 }, { 2, 3 }, { 3, 4 } }]=]

M["mesh.skeleton"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> wire = K:skeleton(1)
> wire
mesh of dimension 1: 4, 5 cells; not orientable, chi -1]=]

M["mesh.star_cells"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:star_cells(0, 2, 2), K:star_cells(0, 1, 2)
{ 1 }	{ 1, 2 }]=]

M["mesh.subcomplex"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> part, vertices = K:subcomplex { [2] = {2} }
> part, vertices
mesh of dimension 2: 3, 3, 1 cells; orientable, chi 1	{ 1, 3, 4 }]=]

M["mesh.volume"] = [=[
> K = dm.mesh { points = { {0, 0}, {1, 0}, {1, 1}, {0, 1} },
>>   simplices = { {1, 2, 3}, {1, 3, 4} } }
> K:volume(2), K:volume(1)
[0.5, 0.5]	[1, 1.4142135623731, 1, 1, 1]]=]

M["pair.inverse"] = [=[
> g = dm.pair(1, 2)
> g:inverse(), g*g:inverse()
(2, 1)	(1, 1)]=]

M["pair.is_identity"] = [=[
> g = dm.pair(1, 2)
> g:is_identity(), (g*g:inverse()):is_identity()
false	true]=]

M["pair.join"] = [=[
> dm.pair(1, 2):join(dm.pair(2, 5))
2 pairs: 1 -> 2 -> 5]=]

M["pair_tuple.inverse"] = [=[
> dm.pair(0, 1, 3):inverse()
2 pairs: 3 -> 1 -> 0]=]

M["pair_tuple.product"] = [=[
> dm.pair(0, 1, 3):product()
(0, 3)]=]

M["simplicial_map.homology"] = [=[
> K, L = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {1, 6} } },
>>   dm.mesh { simplices = { {1, 2}, {2, 3}, {1, 3} } }
> f = dm.simplicial_map(K, L, { 1, 2, 3, 1, 2, 3 })
> f:homology(1)
{ { 2 } }]=]

M["simplicial_map.pull"] = [=[
> K, L = dm.mesh { simplices = { {1, 2}, {2, 3} } }, dm.mesh { simplices = { {1, 2} } }
> f = dm.simplicial_map(K, L, { 1, 2, 1 })
> f:pull(L:form(1, { 7 }))
primal 1-form: [7, -7]]=]

M["simplicial_map.push"] = [=[
> K, L = dm.mesh { simplices = { {1, 2}, {2, 3} } }, dm.mesh { simplices = { {1, 2} } }
> f = dm.simplicial_map(K, L, { 1, 2, 2 })
> f:push(K:chain(1, { {3, {1, 2}}, {5, {2, 3}} }))
1-chain: 3 [1, 2]]=]

return M
