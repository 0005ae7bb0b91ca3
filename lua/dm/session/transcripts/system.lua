--- Examples of methods of systems.
local M = {}

M["system.acceleration"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:acceleration({ math.pi/2 }, { 0 })
[-1]]=]

M["system.chart"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = s:chart { q = {1}, v = {0}, t = 10, rules = { "verlet", "rk4" },
>>   h = { 0.2, 0.1, 0.05 } }
> ("%.1f %.1f"):format(c:order "verlet", c:order "rk4")
2.0 4.0]=]

M["system.constraint"] = [=[
> rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - 10*q[2] end,
>>   constraint = function(q) return q:norm() - 2 end }
> rod:constraint { 0, -2 }
[0]
> rod:constraint { 3, -4 }
[3]]=]

M["system.control"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 end,
>>   control = function(q, v, t) return { -2*v[1] } end,
>>   force = function(q, v, t, u) return { u[1] } end }
> s:control({ 0 }, { 3 })
[-6]]=]

M["system.emit_c"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> code = s:emit_c()
> for line in code:gmatch "void [^\n]*" do print(line) end
void lagrangian(const double *in, double *out) {
void slope(const double *in, double *out) {
void energy(const double *in, double *out) {]=]

M["system.energy"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:energy({ 0 }, { 2 })
1.0]=]

M["system.force"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 end,
>>   force = function(q, v, t) return { 3 - v[1] } end }
> s:force({ 0 }, { 1 })
[2]]=]

M["system.graph"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - 3*q[1]^2 end }
> s:graph()
y1 = 0.5*dq1^2 - 3*q1^2
]=]

M["system.lagrangian"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:lagrangian({ 0 }, { 2 })
3.0]=]

M["system.legendre"] = [=[
> s = dm.system { Q = dm.R(2), L = function(q, v) return v[1]^2/2 + 3*v[2]^2/2 - q[1] end }
> s:legendre({ 0, 0 }, { 2, 2 })
[2, 6]]=]

M["system.independent"] = [=[
> s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - q[2] end,
>>   constraint = function(q) return { q:dot(q) - 1, 2*q:dot(q) - 2 } end }
> once, numbers = s:independent { q = { 1, 0 } }
> numbers, once:structure().constraints
{ 2 }	1]=]

M["system.linearize"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> around = s:linearize { q = { math.pi } }
> around.stable, around.rates
false	[-1, 1]
> s:linearize { q = { 0 } }.frequencies
[-1, 1]
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> k:linearize({ q = { 1, 0 }, v = { 0, 1 } }).frozen
true
> turn = function(q) return { -q[2], q[1] } end
> circle = k:linearize { q = { 1, 0 }, v = { 0, 1 }, generator = turn }
> circle.stable, circle.fastest
true	1.0]=]

M["system.mass"] = [=[
> s = dm.system { Q = dm.R(2), L = function(q, v) return v[1]^2/2 + 3*v[2]^2/2 - q[1] end }
> s:mass({ 0, 0 }, { 0, 0 })
[[1, 0],
 [0, 3]]]=]

M["system.mechanical_connection"] = [=[
> s = dm.system { Q = dm.product(dm.R(1), dm.R(1)),
>>   L = function(q, v) return v[1]^2/2 + (v[2] + 3*v[1])^2/2 end }
> A = s:mechanical_connection { group = dm.R(1), rule = "gauss(1)", h = 0.1 }
> A
discrete connection of R^1 over R^1, by gauss(1)]=]

M["system.modes"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> chord = K:field { fixed = "boundary", L = function(a, v)
>>   return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> chord:modes(2).values
[1, 3]]=]

M["system.momentum"] = [=[
> s = dm.system { Q = dm.R(2), L = function(q, v) return v[1]^2/2 + 3*v[2]^2/2 - q[1] end }
> s:momentum({ 0, 0 }, { 2, 2 })
[2, 6]]=]

M["system.multipliers"] = [=[
> rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - 10*q[2] end,
>>   constraint = function(q) return q:norm() - 2 end }
> rod:multipliers({ 0, -2 }, { 0, 0 })
[-10]
> rod:multipliers({ 0, -2 }, { 4, 0 })
[-18]]=]

M["system.reduce"] = [=[
> s = dm.system { Q = dm.product(dm.R(1), dm.SO(3)), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = dm.SO(3), rule = "lie(1)", h = 0.1 }
> lp
reduced by SO(3), shapes in R^1, h = 0.1, lie(1)
> lp.group, lp.base
SO(3)	R^1]=]

M["system.rolling"] = [=[
> s = dm.system { Q = dm.R(3), coordinates = { "x", "y", "heading" },
>>   L = function(q, v) return v:dot(v)/2 end,
>>   rolling = function(q, v) return v[1]*math.sin(q[3]) - v[2]*math.cos(q[3]) end }
> s:rolling({ 0, 0, 0 }, { 2, 0, 1 })
[0]
> s:rolling({ 0, 0, 0 }, { 0, 1, 0 })
[-1]]=]

M["system.solver"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "gauss(2)", h = 0.1 }
> solver.rule, solver.order, solver.h
gauss(2)	4	0.1
> s:solver { rule = "verlet", h = 0.1 }.order
2]=]

M["system.stability"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = { 0.001 }, v = { 0 }, steps = 1000,
>>   h = { 0.5, 1, 1.5, 2.5 } }
> (map:limit(1))
2.0]=]

M["system.stability_limit"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3}, {3, 4} }, points = { {0}, {1}, {2}, {3} } }
> chord = K:field { fixed = "boundary", L = function(a, v)
>>   return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> chord:stability_limit "verlet"
1.1547005383793]=]

M["system.structure"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> s:structure().cyclic, s:structure().constant_mass, s:structure().autonomous
{ "theta" }	false	true]=]

M["system.velocity"] = [=[
> s = dm.system { Q = dm.R(2), L = function(q, v) return v[1]^2/2 + 3*v[2]^2/2 - q[1] end }
> s:velocity({ 0, 0 }, { 2, 6 })
[2, 2]]=]

return M
