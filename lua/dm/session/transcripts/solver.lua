--- Examples of methods of solvers, rules, maps of stability, sections, sweeps, scenes.
local M = {}

M["dm.rule"] = [=[
> rule = dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 }, weights = { 1/6, 4/6, 1/6 } }
> rule
rule galerkin(2, 3 own nodes)
> rule.order, rule.symplectic
4	true]=]

M["dm.section"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> section = solver:section { g = "q1", q = {1}, v = {0}, t = 30 }
> section, #section
section of 1 orbit: 4 crossings as (q1, p1)	1]=]

M["dm.stability_map"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> #map.h, map.rules[1], map:at(1, 2).class
3	verlet	bounded]=]

M["dm.worker"] = [=[
> core = require "dm.core"
> worker = core.worker(function(channel) channel:send(channel:receive():upper()) end)
> worker:send "hello", worker:receive()
true	HELLO
> worker:close()]=]

M["section.plot"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> section = solver:section { g = "q1", q = {1}, v = {0}, t = 30, x = "t", y = "p1" }
> section:plot { width = 40, height = 8, ascii = true }
p1 - 0.957744 (10^-7)
4+ o
2+         o
 |                  o       o
 +-------+------------+-------
        10           20
               t]=]

M["section.series"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> section = solver:section { g = "q1", q = {1}, v = {0}, t = 30, x = "t", y = "p1" }
> section:series()[1].x
[5.0231876643335, 11.720718924757, 18.418250058012, 25.115781079214]]=]

M["solver.backward_error"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:backward_error { q = {1}, v = {0}, steps = 1000 }
> ("%.2f"):format(e.order), math.abs(e.drift) < 1e-6
2.00	true]=]

M["solver.ensemble"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 50,
>>   q = function(i) return { i } end, v = function() return { 0 } end }
> e
ensemble of 3 members at t = 5.0: all ok
> e.q
[[-0.022207856984365],
 [  -1.6835386214654],
 [  -1.6761235348193]]]=]

M["solver.fold"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + q[1]^3/3 end }
> s:solver { rule = "midpoint", h = 0.1 }:fold { q = {1}, v = {0} }.h
1.0]=]

M["solver.lyapunov"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> still = solver:lyapunov { q = {1}, v = {0}, t = 1000 }
> still.exponent < 0.01, ("%.1f"):format(still.megno)
true	1.8]=]

M["solver.measured_order"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> ("%.2f"):format(solver:measured_order { q = {1}, v = {0}, t = 2 }.order)
2.00]=]

M["solver.modified_energy"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:modified_energy { q = {1}, v = {0}, steps = 200 }
> e.amplitude < 1e-10
true]=]

M["solver.multipliers"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "gauss(4)", h = math.pi/20 }
> m = solver:multipliers { q = {1}, v = {0}, steps = 40 }
> m.stable, m.closes < 1e-9
true	true]=]

M["solver.report"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> solver:report().steps, solver:report().order, solver:report().rule
100	2	verlet]=]

M["solver.reversal"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:reversal { q = {1}, v = {0}, steps = 100 } < 1e-13
true]=]

M["solver.run"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> #path, path.t[#path]
101	10.0
> fall = solver:run { q = {1}, v = {0}, t = 10,
>>   events = { bottom = { g = function(q) return q[1] end, stop = true } } }
> ("%.2f"):format(fall.events[1].t)
1.67]=]

M["solver.section"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> section = solver:section { g = "q1", q = {1}, v = {0}, t = 30, y = "p1", x = "t" }
> section.count
4
> section.orbits[1].y
[0.95774445692105, 0.95774430371272, 0.95774416463924, 0.95774404080718]]=]

M["solver.singularities"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return q[1]*v[1]^2/2 end }
> solver = s:solver { rule = "gauss(2)", h = 0.01 }
> solver:singularities { q = {1}, v = {-1}, steps = 100 }.why:match "^[^:]*"
d2L/dv2 is singular at t = 0.66]=]

M["solver.solvability"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "sem(1, gauss(1))", h = 0.1 }
> solver:solvability { q = {1}, v = {0.5} }.solvable
true]=]

M["solver.step"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "gauss(1)", h = 0.1 }
> solver:step { q = {1}, v = {0} }
[0.99501246882793]	[-0.099750623441397]
> (1 - 0.05^2)/(1 + 0.05^2)
0.99501246882793]=]

M["solver.step_tangent"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> taylor = dm.curve { method = function(x, f, h)
>>   local k = f(x)
>>   return x + h*k + h^2/2*f:along(x, k) end }
> D = s:solver { rule = taylor, h = 0.1 }:step_tangent { q = {1}, v = {0} }
> ("%.12f"):format(D:det())
1.000000000000]=]

M["solver.symplecticity"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:symplecticity { q = {1}, v = {0}, steps = 50 } < 1e-13
true
> s:solver { rule = "rk4", h = 0.5 }:symplecticity { q = {1}, v = {0}, steps = 50 } > 1e-5
true]=]

M["solver.tangent"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> solver = s:solver { rule = "gauss(6)", h = math.pi/20 }
> M = solver:tangent { q = {1}, v = {0}, steps = 10 }
> ("%.6f %.6f %.6f %.6f"):format(M[1][1], M[1][2], M[2][1], M[2][2])
0.000000 1.000000 -1.000000 0.000000]=]

M["stability_map.at"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> map:at(1, 1).class, map:at(1, 3).class
bounded	off
> map:at(1, 3).why:match "^[^;]*"
off: the energy has gone far elsewhere, and stays there: another motion]=]

M["stability_map.csv"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> map:csv():match "^[^\n]*"
rule,h,class,steps,error,slope,slope_error,growth,exponent,megno,off,range,hidden]=]

M["stability_map.limit"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.001}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> limit, why = map:limit(1)
> math.abs(limit - 2) < 2e-3
true
> why:match "^[^:]*"
off from h = 2.00195 on]=]

M["stability_map.plot"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> map:plot()
verlet
        2.5 o
        1.5 ·
        0.5 ·
          h
· bounded   o off]=]

M["stability_map.resonances"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> for _, r in ipairs(map:resonances(1)) do print(r.n, ("%.3f"):format(r.h)) end
6	1.000
5	1.176
4	1.414
3	1.732]=]

M["stability_map.table"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> map:table():sub(1, 78)
row                                  limit of h       theory  beyond
verlet   ]=]

M["stability_map.theory"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> map = s:stability { rule = "verlet", q = {0.01}, v = {0}, steps = 500, h = {0.5, 1.5, 2.5} }
> string.format("%.6f", (map:theory(1)))
2.000000]=]

M["sweep.csv"] = [=[
> dm.sweep { members = 2, run = function(i) return i^2 end }:csv()
member,value
1,1
2,4
]=]

M["sweep.failures"] = [=[
> s = dm.sweep { members = 3, run = function(i) return i end }
> #s:failures(), s.status[3]
0	ok]=]

M["sweep.npy"] = [=[
> s = dm.sweep { members = 3, run = function(i) return { a = i, b = -i } end }
> s:npy "sweep.npy"
sweep.npy
> dm.load("sweep.npy").b
[-1, -2, -3]
> os.remove "sweep.npy"
true]=]

M["sweep.plot"] = [=[
> s = dm.sweep { members = 9, run = function(i) return i^2 end }
> s:plot("member", "value", { width = 40, height = 8, ascii = true })
value
  |                       o  o
50+                 o  o
 0+ o  o  o  o   o
  +----+-----+------+-----+----
       2     4      6     8
              member]=]

M["worker.close"] = [=[
> core = require "dm.core"
> worker = core.worker(function(channel) channel:send "ready" end)
> worker:receive()
ready
> worker:close()]=]

M["worker.receive"] = [=[
> core = require "dm.core"
> worker = core.worker(function(channel) channel:send "one" end)
> worker:receive(), worker:receive()
one]=]

M["worker.send"] = [=[
> core = require "dm.core"
> worker = core.worker(function(channel) channel:send(channel:receive()*2) end)
> worker:send "21", worker:receive()
true	42]=]

return M
