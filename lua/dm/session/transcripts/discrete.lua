--- Examples of discrete Lagrangians, of shapes and of rules that are made.
local M = {}

M["discrete_lagrangian.against_exact"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> Ld = dm.discrete_lagrangian(s, { rule = "gauss(2)", h = 0.2 })
> a = Ld:against_exact { q = {1}, v = {0.5}, h = { 0.4, 0.2, 0.1 } }
> ("%.1f %.1f"):format(a.value_slope, a.momentum_slope)
5.0 4.0]=]

M["discrete_lagrangian.average"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(a, b, h)
>>   return (b - a):dot(b - a)/(2*h) - h*a[1]^2 end }
> mean = Ld:average(dm.SO(2))
> mean({ 3, 4 }, { 3, 4 })
-1.25]=]

M["discrete_lagrangian.coefficients"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> Ld = dm.discrete_lagrangian(s, { rule = "galerkin(2, lobatto(3))", h = 0.2 })
> Ld:coefficients().b
[0.16666666666667, 0.66666666666667, 0.16666666666667]]=]

M["discrete_lagrangian.connection"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "theta", "x" },
>>   L = function(q, v) return (v[1] + 2*v[2])^2/2 + v[2]^2/2 end }
> A = dm.discrete_lagrangian(s, { rule = "midpoint", h = 0.1 }):connection { cyclic = { "theta" } }
> A({ 0, 0 }, { 0, 1 })
[2]]=]

M["discrete_lagrangian.emit_c"] = [=[
> d = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> d:emit_c():match "void Ld[^\n]*"
void Ld(const double *in, double *out) {]=]

M["discrete_lagrangian.hamilton_pontryagin"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 end }
> Ld = dm.discrete_lagrangian(s, { rule = "gauss(2)", h = 0.1 })
> e = Ld:hamilton_pontryagin({ 0 }, { 0.1 })
> e.v, e.p
[[1],
 [1]]	[[1],
 [1]]]=]

M["discrete_lagrangian.legendre_minus"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> Ld:legendre_minus({ 0 }, { 0.3 })
[3]]=]

M["discrete_lagrangian.legendre_plus"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> Ld:legendre_plus({ 0 }, { 0.3 })
[3]]=]

M["discrete_lagrangian.momentum"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(2), h = 0.5,
>>   Ld = function(a, b, h) return (b - a):dot(b - a)/(2*h) end }
> Ld:momentum(dm.SO(2), { 1, 0 }, { 1, 1 })
[2]]=]

M["discrete_lagrangian.order"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> Ld = dm.discrete_lagrangian(s, { rule = "gauss(2)", h = 0.1 })
> ("%.0f"):format(Ld:order())
4]=]

M["discrete_lagrangian.solver"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> p = Ld:solver():run { q0 = {0}, q1 = {0.1}, steps = 10 }
> p.q[11]
[1]]=]

M["discrete_lagrangian.two_form"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> Ld:two_form({ 0 }, { 0.3 })
[[10]]]=]

M["discrete_lagrangian.value"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
>>   Ld = function(a, b, h) return (b[1] - a[1])^2/(2*h) end }
> Ld:value({ 0 }, { 0.3 })
0.45]=]

M["dm.discrete_shape"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D
discrete Lagrangian on R^2, h = 0.1, reduced to R^1]=]

M["discrete_shape.connection"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:connection({ 1, 0 }, { 1, 0.1 })
[0]]=]

M["discrete_shape.legendre_minus"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:legendre_minus({ 1 }, { 1.1 })
[1.0093081200734]]=]

M["discrete_shape.legendre_plus"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:legendre_plus({ 1 }, { 1.1 })
[0.99069187992657]]=]

M["discrete_shape.one_form"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:one_form({ 1 }, { 1.1 })
[-0.086383759853148]	[-0.086383759853148]]=]

M["discrete_shape.psi"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:psi({ 1 }, { 1 })
[0.1]]=]

M["discrete_shape.residual"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> x2 = D:step({ 1 }, { 1 })
> math.abs(D:residual({ 1 }, { 1 }, x2)[1]) < 1e-12
true]=]

M["discrete_shape.routhian"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:routhian({ 1 }, { 1 })
-0.1]=]

M["discrete_shape.solver"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> p = D:solver():run { q0 = {1}, q1 = {1}, steps = 100 }
> p.q[101][1] > 0.9
true]=]

M["discrete_shape.step"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:step({ 1 }, { 1 })
[1]	[0.1]]=]

M["discrete_shape.two_form"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:two_form({ 1 }, { 1 })
[[10.1]]]=]

M["discrete_shape.value"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> D = s:routh({ cyclic = { "phi" }, mu = 1 }):discrete { rule = "midpoint", h = 0.1 }
> D:value({ 1 }, { 1 })
0.0]=]

M["dm.amplification"] = [=[
> A, re, im = dm.amplification("verlet", 1)
> A
[[  0.5,     1],
 [-0.75,   0.5]]
> re, im
[0.5, 0.5]	[-0.86602540378444, 0.86602540378444]]=]

M["dm.galerkin"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> rule = dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } }
> solver = s:solver { rule = rule, h = 0.1 }
> solver:run({ q = {1}, v = {0}, t = 10 }):drift("energy").largest < 1e-5
true]=]

M["dm.multiscale"] = [=[
> fast = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - 1e4*q[1]^2/2 end }
> solver = fast:solver { rule = dm.multiscale { frequency = 100 }, h = 1 }
> p = solver:run { q = {1}, v = {0}, steps = 10 }
> math.abs(p.q[11][1] - math.cos(1000)) < 1e-8
true]=]

M["dm.sprk"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> half = dm.sprk { a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 } }
> half
rule sprk(own, 2)
> p = s:solver { rule = half, h = 0.1 }:run { q = {1}, v = {0}, t = 1 }
> math.abs(p.q[11][1] - math.cos(1)) < 1e-3
true]=]

M["dm.step"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> euler = dm.step { name = "symplectic Euler", unknowns = 1, order = 1,
>>   equation = function(y, x, h, m) return { x[1] - y.p[1] + h*y.q[1] } end,
>>   start = function(y, h, m) return { y.p[1] } end,
>>   next = function(y, x, h, m) return { q = { y.q[1] + h*x[1] }, p = { x[1] } } end }
> s:solver({ rule = euler, h = 0.1 }):run({ q = {1}, v = {0}, steps = 2 }).q[3]
[0.9701]]=]

M["dm.group_lagrangian"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld(0.1, 0.6)
0.24483487621925]=]
M["group_lagrangian.value"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:value(0.1, 0.6)
0.24483487621925]=]
M["group_lagrangian.legendre_minus"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:legendre_minus(0.1, 0.6)
[0.95885107720841]]=]
M["group_lagrangian.legendre_plus"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:legendre_plus(0.1, 0.6)
[0.95885107720841]]=]
M["group_lagrangian.momentum"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:momentum(dm.SO(2), 0.1, 0.6)
[0.95885107720841]]=]
M["group_lagrangian.two_form"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:two_form(0.1, 0.6)
[[1.7551651237807]]]=]
M["group_lagrangian.solver"] = [=[
> Ld = dm.discrete_lagrangian { Q = dm.SO(2), h = 0.5,
>>   Ld = function(a, b, h) return (1 - dm.cos(b - a))/h end }
> Ld:solver({}).h
0.5]=]

return M
