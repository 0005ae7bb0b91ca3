--- Examples of methods of vectors, matrices, random numbers, roots.
local M = {}

M["matrix.column"] = [=[
> m = dm.matrix { { 1, 2 }, { 3, 4 } }
> m:column(2)
[2, 4]]=]

M["matrix.copy"] = [=[
> m = dm.matrix { { 1, 2 }, { 3, 4 } }
> n = m:copy()
> n[1][1] = 10
> m:trace(), n:trace()
5.0	14.0]=]

M["matrix.det"] = [=[
> dm.matrix { { 2, 1 }, { 1, 3 } }:det()
5.0]=]

M["matrix.eigenvalues"] = [=[
> re, im = dm.matrix { { 0, 1 }, { -4, 0 } }:eigenvalues()
> re, im
[0, 0]	[-2, 2]]=]

M["matrix.inverse"] = [=[
> dm.matrix { { 2, 0 }, { 0, 4 } }:inverse()
[[ 0.5,    0],
 [   0, 0.25]]]=]

M["matrix.modes"] = [=[
> mass = dm.matrix { { 1, 0 }, { 0, 1 } }
> stiffness = dm.matrix { { 2, -1 }, { -1, 2 } }
> squares, shapes = stiffness:modes(mass)
> squares
[1, 3]
> shapes[1][2]/shapes[2][2]
-1.0]=]

M["matrix.row"] = [=[
> m = dm.matrix { { 1, 2 }, { 3, 4 } }
> m:row(2)
[3, 4]]=]

M["matrix.solve"] = [=[
> dm.matrix { { 2, 1 }, { 1, 3 } }:solve { 3, 4 }
[1, 1]]=]

M["matrix.totable"] = [=[
> dm.matrix { { 1, 2 }, { 3, 4 } }:totable()
{ { 1.0, 2.0 }, { 3.0, 4.0 } }]=]

M["matrix.trace"] = [=[
> dm.matrix { { 2, 1 }, { 1, 3 } }:trace()
5.0]=]

M["matrix.transpose"] = [=[
> dm.matrix { { 1, 2 }, { 3, 4 } }:transpose()
[[1, 3],
 [2, 4]]]=]

M["random.normal"] = [=[
> r = dm.random(7)
> r:normal(1, 0) == r:normal(1, 0), r:normal(1, 0) == r:normal(1, 1)
true	false
> sum = 0
> for k = 1, 10000 do sum = sum + r:normal(1, k, 5, 0.1) end
> math.abs(sum/10000 - 5) < 0.005
true]=]

M["random.uniform"] = [=[
> r = dm.random(7)
> x = r:uniform(1, 0, -2, 2)
> -2 < x and x < 2, x == dm.random(7):uniform(1, 0, -2, 2)
true	true]=]

M["root.traced"] = [=[
> root = dm.root { start = 1, equations = function(y, x) return y^2 - x end }
> root:traced(4)
2.0]=]

M["root.inverse"] = [=[
> root = dm.root { start = 1, equations = function(y, x) return y^2 - x end }
> root(4), root:inverse(4)
2.0	[[0.25]]]=]

M["root.value"] = [=[
> lowest = dm.root { start = 0, stationary = function(y, x) return y^2/2 - x*y end }
> lowest(3), lowest:value(3)
3.0	-4.5]=]

M["vector.copy"] = [=[
> v = dm.vector { 1, 2, 3 }
> w = v:copy()
> w[1] = 10
> v, w
[1, 2, 3]	[10, 2, 3]]=]

M["vector.cross"] = [=[
> dm.vector { 1, 0, 0 }:cross { 0, 1, 0 }
[0, 0, 1]
> dm.vector { 1, 2 }:cross { 3, 4 }
-2.0]=]

M["vector.dot"] = [=[
> dm.vector { 1, 2 }:dot { 3, 4 }
11.0]=]

M["vector.map"] = [=[
> dm.vector { 1, 4, 9 }:map(math.sqrt)
[1, 2, 3]
> dm.vector { 5, 5, 5 }:map(function(x, i) return x*i end)
[5, 10, 15]]=]

M["vector.norm"] = [=[
> dm.vector { 3, 4 }:norm()
5.0
> dm.vector { 3e200, 4e200 }:norm()
5e+200]=]

M["vector.outer"] = [=[
> dm.vector { 1, 2 }:outer { 3, 4, 5 }
[[ 3,  4,  5],
 [ 6,  8, 10]]]=]

M["vector.slice"] = [=[
> dm.vector { 1, 2, 3, 4 }:slice(2, 3)
[2, 3]
> dm.vector { 1, 2, 3, 4 }:slice(3)
[3, 4]]=]

M["vector.sum"] = [=[
> dm.vector { 1, 2, 3, 4 }:sum()
10.0]=]

M["vector.totable"] = [=[
> dm.vector { 1, 2 }:totable()
{ 1.0, 2.0 }]=]

M["core.plain"] = [=[
> core = require "dm.core"
> core.plain({ 1, 2 }, 2), core.plain(3, 1), core.plain({ 1, 2 }, 3) == nil
[1, 2]	[3]	true]=]

M["core.largest"] = [=[
> core = require "dm.core"
> core.largest(dm.vector { 1, -3 }), core.largest { 2, "x" } == nil
3.0	true]=]

M["core.joined"] = [=[
> core = require "dm.core"
> core.joined { dm.vector { 1, 2 }, dm.vector { 3 } }
[1, 2, 3]]=]

M["core.images"] = [=[
> core = require "dm.core"
> core.images(function(g, z) return { z[1] + g, z[2] } end, 5, { dm.vector { 1, 2 } }, 2)
{ [6, 2] }	6.0]=]

M["core.normals"] = [=[
> core = require "dm.core"
> r = dm.random(3)
> core.normals(r, 5, 2, 1) == dm.vector { r:normal(5, 0), r:normal(5, 1) }
true]=]

return M
