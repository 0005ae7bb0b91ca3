--- Examples of methods of vectors, matrices, spaces, meshes, random numbers.
local M = {}

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

M["random.normal"] = [=[
> dm.random(1):normal(1, 1) == dm.random(1):normal(1, 1)
true]=]

M["random.uniform"] = [=[
> x = dm.random(1):uniform(1, 1)
> x > 0 and x < 1
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
