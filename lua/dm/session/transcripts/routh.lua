--- Examples of systems reduced at a momentum (Routh) and by groups.
local M = {}

M["dm.level"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> level.group, level.mu, level.dimension
SO(3)	[0, 0, 4]	4
> level.isotropy, level.orbit
{ [0, 0, 1] }	2]=]

M["level.amended_potential"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> level:amended_potential { 0 }
2.0
> level:amended_potential({ 1 }, { 4, 0, 0 })
8.5]=]

M["level.connection"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> level:connection { 0 }
[[0],
 [0],
 [0]]]=]

M["level.locked_inertia"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> level:locked_inertia { 0 }
[[1, 0, 0],
 [0, 2, 0],
 [0, 0, 4]]]=]

M["level.relative_equilibria"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> found = level:relative_equilibria { x = {0} }
> #found, found[1].energy, found[1].xi:norm(), found[1].stable
6	2.0	1.0	true]=]

M["level.routhian"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> level:routhian({ 0 }, { 0 })
-2.0]=]

M["level.solver"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:routh { group = dm.SO(3), mu = { 0, 0, 4 } }
> path = level:solver { rule = "lie(1)", h = 0.05 }:run { x = {0.1}, p = {0}, steps = 20 }
> #path, path.mu[1]:norm(), math.abs(path.mu[21]:norm() - 4) < 1e-13
21	4.0	true]=]

M["system.amended_potential"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:amended_potential { 1 }
-0.5
> shape:amended_potential { 2 }
-0.375]=]

M["system.at_momentum"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:at_momentum(2):amended_potential { 4 }
-0.125]=]

M["system.connection"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "theta" }, L = function(q, v)
>>   return (v[1]^2 + v[2]^2)/2 + (v[3] + q[1]*v[2])^2/2 end }
> shape = s:routh { cyclic = "theta", mu = 2 }
> shape:connection { 5, 0 }
[[0, 5]]]=]

M["system.continue"] = [=[
> hoop = dm.system { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v)
>>   local s = math.sin(q[1])
>>   return (v[1]^2 + (1 + s^2)*v[2]^2)/2 + math.cos(q[1]) end }
> shape = hoop:routh { cyclic = "phi", mu = 0.5 }
> rest = shape:relative_equilibria { region = { { -0.1, 0.1 } } }[1]
> branch = shape:continue(rest, { mu = { 0, 2 } })
> branch
branch of 77 relative equilibria, mu from 0.5 to 2
  index 0 to 1 (another branch crosses) near mu = 1.01, x = (0)
  stable (minimum) to unstable near mu = 1.01, x = (0)]=]

M["system.curvature"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "theta" }, L = function(q, v)
>>   return (v[1]^2 + v[2]^2)/2 + (v[3] + q[1]*v[2])^2/2 end }
> shape = s:routh { cyclic = "theta", mu = 2 }
> shape:curvature { 5, 0 }
[[ 0,  2],
 [-2,  0]]
> shape:curvature({ 5, 0 }, 0, 1)
[[ 0,  1],
 [-1,  0]]]=]

M["system.discrete"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> D = shape:discrete { rule = "midpoint", h = 0.1 }
> D
discrete Lagrangian on R^2, h = 0.1, reduced to R^1]=]

M["system.holonomy"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "theta" }, L = function(q, v)
>>   return (v[1]^2 + v[2]^2)/2 + (v[3] + q[1]*v[2])^2/2 end }
> shape = s:routh { cyclic = "theta", mu = 2 }
> circle = function(s) return { math.cos(2*math.pi*s), math.sin(2*math.pi*s) } end
> shape:holonomy(circle)/math.pi
[-1]]=]

M["system.level"] = [=[
> free = dm.system { Q = dm.product(dm.SO(3), dm.R(1)), L = function(q, v)
>>   return (v[1]^2 + 2*v[2]^2 + 4*v[3]^2)/2 + v[4]^2/2 - q[2][1]^2/2 end }
> level = free:level { group = dm.SO(3), mu = { 0, 0, 4 } }
> level.group, level.mu, level.dimension
SO(3)	[0, 0, 4]	4]=]

M["system.lift"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:lift({ 2 }, { 0 })
[2, 0]	[0, 0.25]]=]

M["system.locked_inertia"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:locked_inertia { 3 }
[[9]]]=]

M["system.magnetic_momentum"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "theta" }, L = function(q, v)
>>   return (v[1]^2 + v[2]^2)/2 + (v[3] + q[1]*v[2])^2/2 end }
> shape = s:routh { cyclic = "theta", mu = 2 }
> shape:magnetic_momentum({ 5, 0 }, { 1, 10 })
[1, 0]]=]

M["system.reduction"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:reduction().cyclic, shape:reduction().mu
{ 2 }	[1]]=]

M["system.relative_equilibria"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> orbits = shape:relative_equilibria { region = { { 0.2, 5 } } }
> #orbits, orbits[1].x, orbits[1].energy, orbits[1].stable
1	[1]	-0.5	energy]=]

M["system.routh"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape.coordinates, shape.params
{ "r" }	{ mu = 1 }]=]

M["system.routhian"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:routhian({ 1 }, { 0 })
0.5]=]

M["system.rsprk"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> step = shape:rsprk { rule = "gauss(1)", h = 0.1 }
> x, s = step({ 1 }, { 0 })
> x, s
[1]	[0]]=]

M["system.slice"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> line = shape:slice("amended_potential", { from = { 1 }, to = { 4 }, points = 4 })[1]
> line.x, line.y
{ 1.0, 2.0, 3.0, 4.0 }	{ -0.5, -0.375, -0.27777777777778, -0.21875 }]=]

M["system.start"] = [=[
> kepler = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = kepler:routh { cyclic = "theta", mu = 1 }
> shape:start({ 2, 0.5 }, { 0.1, 0.25 })
[2]	[0.1]	[0.5]]=]

M["system.symplectic_form"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "theta" }, L = function(q, v)
>>   return (v[1]^2 + v[2]^2)/2 + (v[3] + q[1]*v[2])^2/2 end }
> shape = s:routh { cyclic = "theta", mu = 2 }
> shape:symplectic_form { 5, 0 }
[[ 0, -2,  1,  0],
 [ 2,  0,  0,  1],
 [-1,  0,  0,  0],
 [ 0, -1,  0,  0]]]=]

return M
