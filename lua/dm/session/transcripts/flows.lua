--- Examples of flows by their vorticity, and of lines of cells and boxes.
local M = {}

M["dm.euler"] = [=[
> ball = dm.mesh { icosphere = 2 }
> flow = ball:euler { vorticity = function(x, y, z) return z end }
> flow
flow on a surface of 162 vertices and 320 triangles]=]

M["euler.solver"] = [=[
> ball = dm.mesh { icosphere = 2 }
> flow = ball:euler { vorticity = function(x, y, z) return z end }
> run = flow:solver({ h = 0.1 }):run { steps = 10 }
> run:drift("energy").largest < 1e-12
true]=]

M["dm.euler_solver"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> solver.rule, solver.h
midpoint	0.1]=]

M["euler_solver.run"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10, every = 5 }
> #run, run.t
3	[0, 0.5, 1]]=]

M["dm.flow"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run
flow of 10 steps of midpoint to t = 1; 11 rows]=]

M["euler.resume"] = [=[
> flow = dm.mesh({ icosphere = 2 }):euler { vorticity = function(x, y, z) return z + x*y end }
> solver = flow:solver { h = 0.1 }
> whole, half = solver:run { steps = 10 }, solver:run { steps = 5 }
> flow:resume(half):run({ steps = 5 }).w[6] == whole.w[11]
true]=]

M["flow.checkpoint"] = [=[
> flow = dm.mesh({ icosphere = 2 }):euler { vorticity = function(x, y, z) return z + x*y end }
> run = flow:solver({ h = 0.1 }):run { steps = 5 }
> run:checkpoint "flow.state"
flow.state
> more = flow:resume("flow.state"):run { t = 1 }
> os.remove "flow.state"
true]=]

M["flow.animate"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:animate "flow.html"
flow.html]=]

M["flow.column"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:column("t")[11], math.abs(run:column("circulation")[11]) < 1e-12
1.0	true]=]

M["flow.drift"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:drift("enstrophy").largest < 1e-12
true]=]

M["flow.form"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:form(1):max()
1.0]=]

M["flow.npy"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:npy "flow.npy"
flow.npy
> dm.load("flow.npy").columns
{ "t", "w", "energy", "enstrophy", "circulation" }]=]

M["flow.plot"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:plot("w", { file = "flow.svg" })
flow.svg]=]

M["flow.beta"] = [=[
> ring = dm.mesh { torus = {8, 6}, radii = {2, 1} }
> flow = ring:euler { vorticity = 0, harmonic = function(x, y) return { -y, x, 0 } end }
> run = flow:solver({ h = 0.1 }):run { steps = 1 }
> beta = run:beta(1)
> beta:d():norm() < 1e-12, math.abs(beta:norm()^2/2 - run:column("energy")[1]) < 1e-12
true	true]=]

M["flow.stream"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10 }
> run:stream(1):max() > 0
true]=]

M["flow.vtk"] = [=[
> ball = dm.mesh { icosphere = 2 }
> solver = ball:euler({ vorticity = function(x, y, z) return z + x*y end }):solver { h = 0.1 }
> run = solver:run { steps = 10, every = 5 }
> files = run:vtk "flow"
> files[1], #files
flow_00001.vtk	4]=]

M["dm.euler_engine"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> engine:advance(0.1, 5)
5	5]=]

M["euler_engine.advance"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> engine:advance(0.1, 5)
5	5]=]

M["euler_engine.fail"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> engine:advance(1e6, 1)
0	501
> raised, failure = pcall(engine.fail, engine, 0, 0.3, 0.1, "midpoint", nil)
> failure.rule, failure.code
midpoint	no_convergence]=]

M["euler_engine.around"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> #engine:around()
0]=]

M["euler_engine.low"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> engine:low():norm()
0.0]=]

M["euler_engine.measure"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> psi, energy, enstrophy, circulation = engine:measure()
> energy > 0, enstrophy > 0, math.abs(circulation) < 1e-15
true	true	true]=]

M["euler_engine.vorticity"] = [=[
> core = require "dm.core"
> K = dm.mesh { icosphere = 0 }
> solved, part = dm.zeros(12) + 1, dm.zeros(12) + 1
> solved[1] = 0
> A = K:incidence(0):gram(K:volume(1)):pick(solved, solved)
> w = K:form(0, function(x, y, z) return z end).values
> engine = core.euler(K, A:factor "dense", solved, part, K:volume(2), w)
> #engine:vorticity()
12]=]

M["dm.avi_cells"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> cells = core.avi(field, dm.vector { 0, 0.1 }, 0)
> cells:sums()
{ { 2, 1 } }]=]

M["avi_cells.limits"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> cells = core.avi(field, dm.vector { 0, 0.1 }, 0)
> cells:limits()
[0.70710678118655]]=]

M["avi_cells.resonances"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> cells = core.avi(field, dm.vector { 0, 0.1 }, 0)
> cells:limits()
[0.70710678118655]
> path, status = cells:run({ p = dm.vector { 0, 0 } }, dm.vector { 0.1 }, dm.vector { 0, 0.1 })
> cells:resonances(0.05)
0]=]

M["avi_cells.run"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> cells = core.avi(field, dm.vector { 0, 0.1 }, 0)
> cells:limits()
[0.70710678118655]
> path, status = cells:run({ p = dm.vector { 0, 0 } }, dm.vector { 0.1 }, dm.vector { 0, 0.1, 0.2 })
> status, path.q[3]:sum()
0	0.1]=]

M["avi_cells.sums"] = [=[
> core = require "dm.core"
> K = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
> field = K:field { form = 0, L = function(u, v)
>>   return v:dot(v)/2 - K:sum(1, function(e) return (e[2] - e[1])^2 end, u) end }
> cells = core.avi(field, dm.vector { 0, 0.1 }, 0)
> cells:sums()
{ { 2, 1 } }]=]

M["dm.multisymplectic"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 - dm.cos(z[1]) end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:balance "multisymplectic" < 1e-10
true]=]

M["dm.boxes"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> boxes
boxes for u, p, q on a ring of 33 cells from 0 to 6.28319]=]

M["boxes.solver"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> solver = boxes:solver { h = 0.1 }
> solver.h, #solver.held
0.1	0]=]

M["boxes.resume"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> solver = boxes:solver { h = 0.1 }
> start = { u = math.sin, p = math.cos }
> half = solver:run { z = start, steps = 5 }
> whole = solver:run { z = start, steps = 10 }
> boxes:resume(half):run({ steps = 5 }).u[6] == whole.u[11]
true]=]

M["dm.box_solver"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> boxes:solver { h = 0.1 }
solver of boxes for u, p, q on a ring of 33 cells from 0 to 6.28319, h = 0.1]=]

M["box_solver.run"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> #run, run.t[11]
11	1.0]=]

M["dm.box_run"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run
run of 10 boxes a node to t = 1, h = 0.1: 11 rows of u, p, q at 33 nodes
> run.u[1][1], #run.u[1]
0.0	33]=]

M["box_run.checkpoint"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:checkpoint "boxes.state"
boxes.state]=]

M["box_run.animate"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:animate "boxes.html"
boxes.html]=]

M["box_run.balance"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:balance "energy" < 1e-12, run:balance "multisymplectic" < 1e-12
true	true]=]

M["box_run.column"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> #run:column "u7", run:column("u7")[11] == run.u[11][7]
11	true
> ("%.3f %.3f"):format(run:column("energy")[1], run:column("momentum")[11])
9.349 3.123]=]

M["box_run.drift"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:drift("energy").largest < 1e-13, run:drift("momentum").largest < 1e-13
true	true]=]

M["box_run.npy"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:npy "boxes.npy"
boxes.npy
> dm.load("boxes.npy").columns
{ "t", "u", "p", "q" }]=]

M["box_run.plot"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> run:plot("u", { file = "boxes.svg" })
boxes.svg]=]

M["box_run.vtk"] = [=[
> boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 2*math.pi, 33, periodic = true },
>>   M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
>>   S = function(z) return z[2]^2/2 - z[3]^2/2 + 2*z[1]^2 end }
> run = boxes:solver({ h = 0.1 }):run { z = { u = math.sin, p = math.cos }, steps = 10 }
> files = run:vtk "boxes"
> files[1], #files
boxes_00001.vtk	12]=]

return M
