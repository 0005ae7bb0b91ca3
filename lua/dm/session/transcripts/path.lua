--- Examples of methods of paths and of reduced paths.
local M = {}

M["dm.reduced_path"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> path = lp:solver():run { x = {1}, p = {0}, mu = { 0.1, 0, 3 }, steps = 10 }
> path
reduced path of 11 rows: reduced by SO(3), shapes in R^1, h = 0.1, lie(1)
> path.mu[1], #path.f
[0.1, 0, 3]	10]=]

M["dm.reduced_solver"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> lp:solver { h = 0.05 }
reduced by SO(3), shapes in R^1, h = 0.05, lie(1)]=]

M["path.animate"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:animate("orbit.html", { title = "a planet" })
orbit.html
> os.remove "orbit.html"
true]=]

M["path.checkpoint"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 100 }
> path:checkpoint "swing.state"
swing.state
> more = dm.resume("swing.state", s):run { steps = 100 }
> whole = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 200 }
> more.q[#more] == whole.q[201]
true
> os.remove "swing.state"
true]=]

M["path.column"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit.columns
{ "t", "q1", "q2", "p1", "p2" }
> orbit:column "q2"
[0, 0.1, 0.19900003749883, 0.29601037233566]]=]

M["path.csv"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:csv():match "^[^\n]*"
t,q1,q2,p1,p2
> orbit:csv "orbit.csv"
orbit.csv
> dm.load("orbit.csv").q2 == orbit:column "q2"
true
> os.remove "orbit.csv"
true]=]

M["path.drift"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 100 }
> drift = path:drift "energy"
> drift.largest < 2e-3, math.abs(drift.per_time) < 3*drift.error + 1e-5
true	true]=]

M["path.energy"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:energy()
[-0.5, -0.49999996851622, -0.49999987440246, -0.49999971866711]]=]

M["path.form"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }
> u = K:field { fixed = "boundary", L = function(a, v)
>>   return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> path = u:solver { rule = "verlet", h = 0.1 }:run {
>>   q = function(x) return x*(2 - x) end, v = function() return 0 end, steps = 10 }
> path:form(1)
primal 0-form: [0, 1, 0]
> path:form(1).values
[0, 1, 0]]=]

M["path.frequency"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - 25*q[1]^2/2 end }
> path = s:solver { rule = "gauss(4)", h = 0.02 }:run { q = {1}, v = {0}, steps = 2000 }
> ("%.3f"):format(path:frequency "q1")
5.000]=]

M["path.mass"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:mass { 1, 0 }
[[1, 0],
 [0, 1]]]=]

M["path.momentum"] = [=[
> k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
> orbit = k:solver { rule = "verlet", h = 0.1 }:run { q = {1, 0}, v = {0, 1}, steps = 3 }
> orbit:momentum(dm.SO(2))
[1, 1, 1, 1]
> orbit:momentum(function(q) return { -q[2], q[1] } end)
[1, 1, 1, 1]]=]

M["path.multipliers"] = [=[
> rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - 10*q[2] end,
>>   constraint = function(q) return q:norm() - 2 end }
> rattle = rod:solver { rule = "rattle", h = 0.05 }
> path = rattle:run { q = {0, -2}, v = {4, 0}, steps = 40 }
> M = path:multipliers()
> M[1][1]
-18.0]=]

M["path.noether"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> path = s:solver { rule = "gauss(4)", h = 0.1 }:run { q = {1}, v = {0}, steps = 400 }
> E = path:noether { generator = function(q, t) return { 0 }, 1 end }
> E[1], math.abs(E[401] - E[1]) < 1e-12
-0.5	true]=]

M["path.npy"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 100 }
> path:npy "swing.npy"
swing.npy
> dm.load("swing.npy").q1 == path:column "q1"
true
> os.remove "swing.npy"
true]=]

M["path.phases"] = [=[
> k = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = k:routh { cyclic = "theta", mu = 1 }
> path = shape:solver { rule = "gauss(2)", h = 0.1 }:run { q = {1}, v = {0}, steps = 10 }
> turn = path:phases()
> ("%.4f %.4f %.4f"):format(turn.total[11][1], turn.dynamic[11][1], turn.geometric[11][1])
1.0000 1.0000 0.0000]=]

M["path.plot"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 100 }
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

M["path.reconstruct"] = [=[
> k = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
>>   return (v[1]^2 + q[1]^2*v[2]^2)/2 + 1/q[1] end }
> shape = k:routh { cyclic = "theta", mu = 1 }
> path = shape:solver { rule = "gauss(2)", h = 0.1 }:run { q = {1}, v = {0}, steps = 10 }
> whole = path:reconstruct { theta = 0 }
> whole.columns
{ "t", "r", "theta", "p_r", "p_theta" }
> ("%.12f"):format(whole.q[11][2])
1.000000000000]=]

M["path.series"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {1}, v = {0}, steps = 100 }
> line = path:series("q1", "p1", "verlet")
> #line.x, line.name
101	verlet]=]

M["path.velocity"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v) return 5*v[1]^2/2 end }
> path = s:solver { rule = "verlet", h = 0.1 }:run { q = {0}, v = {2}, steps = 1 }
> path:velocity(), path.p[1]
[[2],
 [2]]	[10]
> path:velocity(2)
[2]]=]

M["path.vtk"] = [=[
> K = dm.mesh { simplices = { {1, 2}, {2, 3} }, points = { {0}, {1}, {2} } }
> u = K:field { fixed = "boundary", L = function(a, v)
>>   return v:dot(v)/2 - a:d():dot(a:d())/2 end }
> path = u:solver { rule = "verlet", h = 0.1 }:run {
>>   q = function(x) return x*(2 - x) end, v = function() return 0 end, steps = 10 }
> files = path:vtk "string.vtk"
> #files, files[1], files[#files]
12	string_00001.vtk	string.vtk.series
> for _, name in ipairs(files) do os.remove(name) end]=]

M["path.worst"] = [=[
> rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - 10*q[2] end,
>>   constraint = function(q) return q:norm() - 2 end }
> rattle = rod:solver { rule = "rattle", h = 0.05 }
> path = rattle:run { q = {0, -2}, v = {4, 0}, steps = 40 }
> path:worst "constraint" < 1e-13
true]=]

M["reduced_path.phases"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> path = lp:solver():run { x = {1}, p = {0}, mu = { 0.1, 0, 3 }, steps = 10 }
> turn = path:phases()
> math.abs(turn.total[11] - turn.dynamic[11] - turn.geometric[11]) < 1e-12
true]=]

M["reduced_path.reconstruct"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> path = lp:solver():run { x = {1}, p = {0}, mu = { 0.1, 0, 3 }, steps = 10 }
> whole = path:reconstruct { g = dm.SO(3):identity() }
> (dm.SO(3):coAd(whole.g[11], path.mu[11]) - path.mu[1]):norm() < 1e-12
true]=]

M["reduced_solver.ensemble"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> lp:solver():ensemble { members = 3, steps = 5,
>>   x = {1}, p = {0}, mu = function(i) return { 0, 0, i } end }
ensemble of 3 members at t = 0.5: all ok]=]

M["reduced_solver.run"] = [=[
> R, G = dm.R(1), dm.SO(3)
> s = dm.system { Q = dm.product(R, G), L = function(q, v)
>>   return v[1]^2/2 - q[1][1]^2/2 + (v[2]^2 + 2*v[3]^2 + 3*v[4]^2)/2 end }
> lp = s:reduce { group = G, rule = "lie(1)", h = 0.1 }
> path = lp:solver():run { x = {1}, p = {0}, mu = { 0, 0, 3 }, steps = 5 }
> path.mu[6], path.x[1]
[0, 0, 3]	[1]]=]

return M
