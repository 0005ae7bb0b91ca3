--- Examples of methods of spaces: manifolds and groups.
local M = {}

M["dm.space"] = [=[
> S = dm.S(2)
> S, S.dimension
S(2)	2
> dm.product(dm.SO(3), dm.R(3)).dimension
6]=]

M["space.Ad"] = [=[
> dm.SO(3):Ad(dm.SO(3):exp { 0, 0, math.pi }, { 1, 2, 3 })
[-1, -2, 3]]=]

M["space.ad"] = [=[
> dm.SO(3):ad({ 1, 0, 0 }, { 0, 1, 0 })
[0, 0, 1]]=]

M["space.bonds"] = [=[
> G = dm.SO(3)
> G:bonds { 1, 0, 0, 0 }
{ 0.0 }
> G:bonds { 1, 1, 0, 0 }
{ 1.0 }]=]

M["space.cayley"] = [=[
> dm.SO(3):cayley { 0, 0, 1 }
[[ 0.6, -0.8,    0],
 [ 0.8,  0.6,    0],
 [   0,    0,    1]]]=]

M["space.cayleyinv"] = [=[
> G = dm.SO(3)
> G:cayleyinv(G:cayley { 0.5, 0, 1 })
[0.5, 0, 1]]=]

M["space.coAd"] = [=[
> G = dm.SE(2)
> g = { 1, 2, 0 }
> G:coAd(g, { 1, 0, 0 })
[1, 0, -2]
> G:Ad(G:inverse(g), { 0, 0, 1 })[1]
-2.0]=]

M["space.coad"] = [=[
> G = dm.SO(3)
> xi = dm.vector { 1, 1, 1 }
> G:coad(xi, { 1, 2, 3 }), dm.vector { 1, 2, 3 }:cross(xi)
[-1, 2, -1]	[-1, 2, -1]]=]

M["space.compose"] = [=[
> G = dm.SE(2)
> G:compose({ 1, 0, math.pi/2 }, { 1, 0, math.pi/2 })
[1, 1, 3.1415926535898]]=]

M["space.dcay"] = [=[
> G = dm.SO(3)
> G:dcay({ 0, 0, 2 }, { 0, 0, 1 })
[0, 0, 0.5]
> G:dcay({ 0, 0, 0 }, { 1, 2, 3 })
[1, 2, 3]]=]

M["space.dcayinv"] = [=[
> G = dm.SO(3)
> xi = { 0.1, 0.2, 0.3 }
> G:dcayinv(xi, G:dcay(xi, { 1, 2, 3 }))
[1, 2, 3]]=]

M["space.dexp"] = [=[
> G = dm.SO(3)
> G:dexp({ 0, 0, math.pi }, { 1, 0, 0 })[2]*math.pi
2.0
> G:dexp({ 0, 0, 3 }, { 0, 0, 1 })
[0, 0, 1]]=]

M["space.dexpinv"] = [=[
> G = dm.SO(3)
> G:dexpinv({ 0, 0, 0.5 }, { 0, 0, 7 })
[0, 0, 7]]=]

M["space.distance"] = [=[
> G = dm.SO(3)
> G:distance(G:identity(), G:exp { 0, 0, 1 })
1.0
> dm.S(2):distance({ 1, 0, 0 }, { 0, 1, 0 })/math.pi
0.5]=]

M["space.exp"] = [=[
> dm.SO(3):exp { 0, 0, math.pi/3 }
[[              0.5, -0.86602540378444,                 0],
 [ 0.86602540378444,               0.5,                 0],
 [                0,                 0,                 1]]
> dm.S(2):exp({ 0, 0, 1 }, { math.pi/2, 0, 0 })[1]
1.0]=]

M["space.flat"] = [=[
> G = dm.SO(3)
> q = G:flat(G:exp { 0, 0, math.pi/3 })
> ("%.6f %.6f"):format(q[1], q[4]), G:bonds(q)[1] < 1e-15
0.866025 0.500000	true]=]

M["space.hat"] = [=[
> dm.SO(3):hat { 1, 2, 3 }
[[ 0, -3,  2],
 [ 3,  0, -1],
 [-2,  1,  0]]
> dm.SE(2):hat { 1, 2, 3 }
[[ 0, -3,  1],
 [ 3,  0,  2],
 [ 0,  0,  0]]]=]

M["space.identity"] = [=[
> dm.SO(3):identity()
[[1, 0, 0],
 [0, 1, 0],
 [0, 0, 1]]
> dm.SE(2):identity()
[0, 0, 0]]=]

M["space.inverse"] = [=[
> G = dm.SO(3)
> g = G:exp { 0, 0, 1 }
> G:compose(g, G:inverse(g))
[[1, 0, 0],
 [0, 1, 0],
 [0, 0, 1]]]=]

M["space.left"] = [=[
> G = dm.SE(2)
> G:left({ 1, 2, 0 }, { 3, 4, 0.5 })
[4, 6, 0.5]]=]

M["space.left_tangent"] = [=[
> G = dm.SE(2)
> G:left_tangent({ 0, 0, math.pi }, { 1, 0, 0 }, { 2, 0, 0 })[1]
-2.0]=]

M["space.log"] = [=[
> dm.SO(3):log(dm.SO(3):exp { 0, 0, 1 })
[0, 0, 1]
> dm.S(2):log({ 0, 0, 1 }, { 1, 0, 0 })/math.pi
[0.5, 0, 0]]=]

M["space.matrix"] = [=[
> dm.Heisenberg(1):matrix { 1, 2, 3 }
[[1, 1, 4],
 [0, 1, 2],
 [0, 0, 1]]]=]

M["space.project"] = [=[
> dm.SO(3):project { { 2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 1 } }
[[1, 0, 0],
 [0, 1, 0],
 [0, 0, 1]]
> dm.S(1):project { 3, 4 }
[0.6, 0.8]]=]

M["space.random"] = [=[
> G = dm.SO(3)
> g = G:random(dm.random(1), 5)
> (G:valid(g))
true
> G:distance(g, G:random(dm.random(1), 5))
0.0]=]

M["space.right"] = [=[
> G = dm.SE(2)
> G:right({ 0, 0, math.pi }, { 1, 2, 0 })
[1, 2, 3.1415926535898]]=]

M["space.right_tangent"] = [=[
> G = dm.SE(2)
> G:right_tangent({ 5, 6, 0 }, { 1, 2, 0 }, { 1, 0, 0 })
[1, 0, 0]]=]

M["space.unflat"] = [=[
> dm.SO(3):unflat { 0, 0, 0, 1 }
[[-1,  0,  0],
 [ 0, -1,  0],
 [ 0,  0,  1]]]=]

M["space.valid"] = [=[
> G = dm.SO(3)
> G:valid(G:identity())
true	0
> G:valid { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } }
false	its determinant is -1]=]

M["space.vee"] = [=[
> dm.SO(3):vee { { 0, -3, 2 }, { 3, 0, -1 }, { -2, 1, 0 } }
[1, 2, 3]]=]

return M
