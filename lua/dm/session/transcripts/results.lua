--- Examples of charts, ensembles, columns, failures and other results; of files and pages.
local M = {}

M["chart.cheapest"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 5, rules = { "verlet" }, h = { 0.2, 0.1 },
>>   rivals = false }
> c:cheapest(1e-2).rule
verlet]=]

M["chart.csv"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 5, rules = { "verlet" }, h = { 0.2, 0.1 },
>>   rivals = false }
> c:csv():match "^[^\n]*"
rule,h,error,ns,setup,steps,evaluations,newton]=]

M["chart.pareto"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 5, rules = { "verlet" }, h = { 0.2, 0.1 },
>>   rivals = false }
> #c:pareto() >= 1
true]=]

M["chart.plot"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 5, rules = { "verlet" }, h = { 0.2, 0.1 },
>>   rivals = false }
> c:plot { file = "chart.svg", against = "steps" }
chart.svg]=]

M["chart.table"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = dm.chart { s, q = {1}, v = {0}, t = 5, rules = { "verlet" }, h = { 0.2, 0.1 },
>>   rivals = false }
> c:table():match "%a+"
rule]=]

M["dm.columns"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver({ rule = "verlet", h = 0.1 }):run { q = {1}, v = {0}, steps = 100 }
> #path.q, path.t[101], path.q[1]
101	10.0	[1]]=]

M["dm.compare"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> a = s:solver({ rule = "gauss(2)", h = 0.1 }):run { q = {1}, v = {0}, t = 10 }
> b = s:solver({ rule = "gauss(3)", h = 0.1 }):run { q = {1}, v = {0}, t = 10 }
> c = dm.compare(a, b)
> c.worst < 1e-5, c.column
true	p1]=]

M["dm.commute"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> dm.commute(s, { q = { 1, 0 }, v = { 0, 1.2 }, h = 0.05, steps = 10, cyclic = "phi" }).commutes
true]=]

M["dm.complex_vector"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v
complex vector of 4: re [1, 1, 1, 1], im [0, 0, 0, 0]
> v.re[1], v.im[1], #v
1.0	0.0	4]=]

M["complex_vector.abs2"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v:abs2()
[1, 1, 1, 1]]=]

M["complex_vector.arg"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v:times(0, 1):arg()/math.pi
[0.5, 0.5, 0.5, 0.5]]=]

M["complex_vector.dot"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v:dot(v:times(0, 1))
0.0	1.0]=]

M["complex_vector.norm"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v:norm()
1.0]=]

M["complex_vector.times"] = [=[
> ring = dm.schroedinger { x = { 0, 1, 4 } }
> path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = function() return 1 end, steps = 1 }
> v = path.psi[1]
> v:times(0, 2).im
[2, 2, 2, 2]]=]

M["dm.ensemble"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> e
ensemble of 3 members at t = 5.0: all ok
> e.status[1], #e, e.q.rows
ok	3	3]=]

M["ensemble.departure"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> (e:departure(1, e, 1, { "energy" }))[1] < 1e-12
true]=]

M["ensemble.followed"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> flow = s:solver({ rule = "gauss(6)", h = 0.1 }):ensemble { members = 1, steps = 50, every = 1,
>>   watch = { "q1" }, q = { { 1 } }, v = { { 0 } } }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 1, steps = 50, q = { { 1 } },
>>   v = { { 0 } }, beside = { watch = { "q1" }, compared = { "q1" },
>>   flows = { { e = flow, i = 1, rows = 50 } } } }
> ("%.4f"):format(e:followed(1).q1)
0.0017]=]

M["ensemble.plot"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> e:plot { file = "fan.svg" }
fan.svg]=]

M["ensemble.range"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> (e:range(1, "energy")) < 0.01
true]=]

M["ensemble.stride"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> e:stride(1, { "energy" }, 0.1) >= 1
true]=]

M["ensemble.summary"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> e = s:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 3, steps = 50, every = 1,
>>   watch = { "energy" }, q = function(i) return { i/10 } end, v = function() return { 0 } end }
> e:summary("energy").first
{ -0.99500416527803, -0.98006657784124, -0.95533648912561 }]=]

M["dm.failure"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "gauss(2)", h = 3, newton = { max_iterations = 2 } }
> done, failure = pcall(solver.run, solver, { q = {1}, v = {0}, steps = 10 })
> done, failure.code, failure.step
false	no_convergence	1]=]

M["dm.branch"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> shape = s:routh { cyclic = { "phi" }, mu = 1 }
> e = shape:relative_equilibria({ region = { 0.5, 2 }, starts = 5 })[1]
> up = shape:continue(e, { mu = { 0.8, 1.2 } })
> up.mu[1], up.mu[#up], up.energy[1]
1.0	1.2	1.0]=]

M["branch.series"] = [=[
> s = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
>>   L = function(q, v) return v[1]^2/2 + q[1]^2*v[2]^2/2 - q[1]^2/2 end }
> shape = s:routh { cyclic = { "phi" }, mu = 1 }
> e = shape:relative_equilibria({ region = { 0.5, 2 }, starts = 5 })[1]
> up = shape:continue(e, { mu = { 0.8, 1.2 } })
> line = up:series()
> line.x[1], line.y[1]
1.0	1.0]=]

M["dm.adapt"] = [=[
> a = dm.adapt { W = function(s) return s^2/2 end, f = function(x) return 1 end,
>>   x = { 0, 1, 4 }, ends = { 0, 0 } }
> a.x, a.u
[0, 0.25, 0.5, 0.75, 1]	[0, 0.09375, 0.125, 0.09375, 0]]=]

M["dm.animate"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> a = s:solver({ rule = "verlet", h = 0.1 }):run { q = {1}, v = {0}, steps = 100 }
> b = s:solver({ rule = "rk4", h = 0.1 }):run { q = {1}, v = {0}, steps = 100 }
> dm.animate({ a, b }, "two.html", { names = { "verlet", "rk4" } })
two.html]=]

M["dm.lab"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> dm.lab { sliders = { h = { 0.05, 0.5, 3 } }, file = "lab.html", frames = 20,
>>   run = function(h)
>>     return s:solver({ rule = "verlet", h = h }):run { q = {1}, v = {0}, t = 10 } end }
lab.html]=]

M["dm.resume"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> half = solver:run { q = {1}, v = {0}, steps = 50 }
> whole = solver:run { q = {1}, v = {0}, steps = 100 }
> dm.resume(half):run({ steps = 50 }).q[51] == whole.q[101]
true
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> cable = u:solver { h = 0.05 }
> half = cable:run { u = function(x) return x - x^2 end, steps = 5 }
> whole = cable:run { u = function(x) return x - x^2 end, steps = 10 }
> dm.resume(half):run({ steps = 5 }).u[6] == whole.u[11]
true]=]

M["dm.path"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> t, q, p = {}, {}, {}
> for i = 1, 100 do t[i], q[i], p[i] = i/10, math.cos(i/10), -math.sin(i/10) end
> path = dm.path { system = s, h = 0.1, rule = "formula", columns = { t, q, p } }
> path:drift("energy").largest < 1e-15
true]=]

M["dm.scaling"] = [=[
> bond = function(a, b) return (b - a)^2/2 end
> bonds = function(q) return dm.sum_over(q, bond, { shift = 1 }) end
> chain = function(n)
>>   return dm.system { Q = dm.R(n), L = function(q, v) return v:dot(v)/2 - bonds(q) end } end
> start = function(n) return dm.zeros(n), dm.zeros(n) + 1 end
> cost = dm.scaling { system = chain, start = start, n = { 4, 8 }, rules = { "verlet" },
>>   h = 0.1, steps = 50, repeats = 1 }
> #cost.points, cost.points[2].size
2	8]=]

M["dm.scene"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> scene = dm.scene { system = s, q = {1}, v = {0}, watch = { "q1" }, tolerance = 1e-3,
>>   until_t = 5 }
> path = scene:run()
> scene.best.error < 1
true]=]

M["dm.schroedinger"] = [=[
> wave = dm.schroedinger { x = { 0, 2*math.pi, 16 } }
> wave
Schroedinger equation on a ring from 0 to 6.28319: 16 points, collocation
> ("%.6f"):format(wave:eigen(2).values[2])
0.500000]=]

M["dm.msfem"] = [=[
> a, f = function(x) return 1 end, function(x) return -1 end
> rod = dm.msfem { a = a, f = f, x = { 0, 0.5, 1 } }
> rod
multiscale elements for (a u')' = f: 3 nodes from 0 to 1, 16 panels
> rod:value(0.5), rod:exact(0.5)
0.125	0.125]=]

M["dm.lagrange_poincare"] = [=[
> l = function(f, h) local xi = dm.SO(3):cayleyinv(f) return xi:dot(xi)/(2*h) end
> lp = dm.lagrange_poincare { group = dm.SO(3), h = 0.1, l = l }
> path = lp:solver():run { mu = { 0, 0, 1 }, steps = 3 }
> path.mu[4]
[0, 0, 1]]=]

M["dm.euler_poincare"] = [=[
> h = function(mu) return mu[1]^2/2 + mu[2]^2/4 + mu[3]^2/6 end
> top = dm.euler_poincare { group = dm.SO(3), h = h }
> path = top:solver({ rule = "lie(1)", h = 0.1 }):run { p = { 1, 0.1, 1 }, steps = 100 }
> math.abs(path.mu[101]:norm() - path.mu[1]:norm()) < 1e-14
true]=]

M["dm.invariant_problem"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem
invariant problem of 2 points on R^1 under R^1]=]

M["dm.invariant_curve"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> curve = problem:boundary { first = { 0 }, last = { 3 }, n = 4 }
> curve
curve of 4 points]=]

M["invariant_problem.action_sum"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem:action_sum { { 0 }, { 1 }, { 3 } }
5.0]=]

M["invariant_problem.both_ways"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem:both_ways({ points = { { 0 }, { 1 } }, n = 10 }).difference < 1e-12
true]=]

M["invariant_problem.boundary"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> curve = problem:boundary { first = { 0 }, last = { 3 }, n = 4 }
> curve.points
[[0],
 [1],
 [2],
 [3]]]=]

M["invariant_problem.momentum"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem:momentum { { 0 }, { 1 } }
[2]]=]

M["invariant_problem.solve"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem:solve({ points = { { 0 }, { 1 } }, n = 5 }).points
[[0],
 [1],
 [2],
 [3],
 [4]]]=]

M["invariant_problem.stability"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> rho = dm.moving_frame { action = shifts, cross_section = function(a) return a end }
> problem = dm.invariant_problem { frame = rho, points = 2, L = function(I) return I[2][1]^2 end }
> problem:stability({ points = { { 0 }, { 1 } } }).momentum.largest
1.0]=]

return M
