--- Examples of methods of systems, solvers, paths, ensembles, sweeps, maps, charts.
local M = {}

M["chart.order"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> c = s:chart { q = {1}, v = {0}, t = 10, rules = { "gauss(2)" }, h = { 0.4, 0.2, 0.1 } }
> c:order "gauss(2)" > 3.8
true]=]

M["ensemble.failures"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:ensemble { members = 3, steps = 50,
>>   q = function(i) return { i } end, v = function() return { 0 } end }:failures()
{}]=]

M["ensemble.path"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> #solver:ensemble { members = 3, steps = 50, every = 10,
>>   q = function(i) return { i } end, v = function() return { 0 } end }:path(2)
6]=]

M["path.column"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:column("q1")[1]
1.0]=]

M["path.csv"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:csv():match "^[^\n]*"
t,q1,p1]=]

M["path.drift"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:drift("energy").largest < 0.01
true]=]

M["path.energy"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> #path:energy()
101]=]

M["path.form"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }]=]

M["path.momentum"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:momentum(dm.SO(2))
[1, 1, 1, 1]]=]

M["path.plot"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:plot("t", "q1", { width = 40, height = 10, ascii = true })
        verlet, h = 0.1
q1
 1+':.             .:''.
  |  ':.         .:'    :.
 0+    :.       .:       ':
  |     ':     :'          :.
-1+       '..:'             ':.
  ++-------------+------------+
   0             5           10
                t]=]

M["path.series"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> path:series("t", "q1").name
q1]=]

M["solver.ensemble"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> e = solver:ensemble { members = 3, steps = 50,
>>   q = function(i) return { i } end, v = function() return { 0 } end }
> e
ensemble of 3 members at t = 5.0: all ok]=]

M["solver.lyapunov"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:lyapunov { q = {1}, v = {0}, t = 100 }.megno < 4
true]=]

M["solver.report"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> solver:report().steps
100]=]

M["solver.reversal"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:reversal { q = {1}, v = {0}, steps = 10 } < 1e-10
true]=]

M["solver.run"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> path = solver:run { q = {1}, v = {0}, steps = 100 }
> #path, path.t[#path]
101	10.0]=]

M["solver.step"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:step({1}, {0})
[-1]]=]

M["solver.symplecticity"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> solver = s:solver { rule = "verlet", h = 0.1 }
> solver:symplecticity { q = {1}, v = {0}, steps = 10 } < 1e-10
true]=]

M["stability_map.at"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> m = s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> m:at(1, 1).class
bounded]=]

M["stability_map.limit"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> m = s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }
> (m:limit(1))
2.2420054996926]=]

M["sweep.csv"] = [=[
> s = dm.sweep { members = 2, run = function(i) return i end }
> s:csv()
member,value
1,1
2,2
]=]

M["sweep.failures"] = [=[
> s = dm.sweep { members = 3, run = function(i) return i end }
> #s:failures()
0]=]

M["system.emit_c"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:emit_c():match "void (%a+)"
lagrangian]=]

M["system.energy"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:energy({1}, {0})
-0.54030230586814]=]

M["system.lagrangian"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:lagrangian({0}, {2})
3.0]=]

M["system.legendre"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:legendre({0}, {2})
[2]]=]

M["system.linearize"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:linearize { q = {0} }.fastest
1.0]=]

M["system.solver"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:solver { rule = "gauss(2)", h = 0.1 }.rule
gauss(2)]=]

M["system.stability"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> (s:stability { rule = "verlet", q = {1}, v = {0}, steps = 1000,
>>   h = { 0.1, 3, 20, "log" } }:limit(1))
2.2420054996926]=]

M["system.structure"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> s:structure().separable, s:structure().autonomous
true	true]=]

return M
