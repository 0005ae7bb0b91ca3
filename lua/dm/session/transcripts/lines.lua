--- Examples of fields on lines, their runs and their strips.
local M = {}

M["dm.line_field"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> u
field on [0, 1]: 10 cells of 0.1, fixed ends
> u.nodes, u.dx, u.periodic
11	0.1	false]=]

M["dm.line_run"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> #run, run.t[#run], run.steps
41	2.0	40]=]

M["dm.line_solver"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(2))", h = 0.05 }
> solver.rule, solver.h
cell(gauss(2))	0.05]=]

M["dm.strip"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> levels = s:run { u = {0, 0, 0}, p = {0, 0, 0}, t0 = 0, h = 0.5, steps = 4, every = 2 }
> levels.code, levels.t
ok	[0, 1, 2]]=]

M["line_field.reflection"] = [=[
> u = dm.field { x = {0, 1, 10}, absorbing = 3,
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> u:reflection()
{ left = -0.5, right = -0.5 }]=]

M["line_field.solver"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> u:solver { rule = "cell(gauss(2))", h = 0.05 }
solver of a field on a line: cell(gauss(2)), h = 0.05]=]

M["line_field.stability_limit"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> ("%.4f"):format(u:stability_limit "cell(corners)")
0.1012]=]

M["line_run.animate"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:animate("wave.html", { of = "u", seconds = 5 })
wave.html
> os.remove "wave.html"
true]=]

M["line_run.column"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> ("%.3f"):format(run:column("u6")[41])
0.999]=]

M["line_run.conservation"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:conservation "t" < 1e-2
true]=]

M["line_run.drift"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:drift("energy").largest < 1e-12
true]=]

M["line_run.multisymplectic"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:multisymplectic { seed = 1 } < 1e-12
true]=]

M["line_run.npy"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:npy "wave.npy"
wave.npy
> dm.load("wave.npy").t[41]
2.0
> os.remove "wave.npy"
true]=]

M["line_run.plot"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> run:plot("u", { size = {30, 5} })
u, cell(gauss(1)), h = 0.05
       2 |=*#@@@@@#*=
     1.5 |=+++++++++=
       1 |=-:     :-=
     0.5 |===========
       0 |=*#@@@@@#*=
          0         1
t up, x across; ' ' = -0.9998, '@' = 1]=]

M["line_run.vtk"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, steps = 40 }
> files = run:vtk "wave"
> #files, files[1], files[#files]
42	wave_00001.vtk	wave.vtk.series
> for _, name in ipairs(files) do os.remove(name) end]=]

M["line_solver.run"] = [=[
> u = dm.field { x = {0, 1, 10}, fixed = "ends",
>>   L = function(u, ut, ux) return ut^2/2 - ux^2/2 end }
> solver = u:solver { rule = "cell(gauss(1))", h = 0.05 }
> run = solver:run { u = function(x) return math.sin(math.pi*x) end,
>>   ut = function() return 0 end, t = 2 }
> ("%.2f"):format(run.u[#run][6])
1.00]=]

M["strip.cells"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:cells({ 0, 0, 0 }, { 1, 2, 4 }, 0, 0.1, "value")
[[12.45],
 [ 49.8]]]=]

M["strip.energies"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:energies { u = dm.matrix { { 0, 0, 0 }, { 1, 2, 4 } }, t = { 0, 0.1 } }
[627.5]	[0]]=]

M["strip.follows"] = [=[
> core = require "dm.core"
> function cell(k) return function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - k*slope^2) end end
> s = core.strip(cell(1), { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1},
>>   absorbs = {0, 0} })
> s:follows(cell(1)), s:follows(cell(2))
true	false]=]

M["strip.limit"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:limit({ 0, 0, 0 }, 1)
1.0]=]

M["strip.momenta"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:momenta({ 0, 0, 0 }, { 1, 2, 4 }, 0, 0.1)
[5.1, 20.1, 19.8]]=]

M["strip.residual"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:residual { u = dm.matrix { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 } }, t = { 0, 0.1, 0.2 },
>>   xi = dm.matrix { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } },
>>   leave = { 0, 0, 0 }, area = 1 }
0.0	5.0]=]

M["strip.run"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> levels = s:run { u = { 0, 0, 0 }, p = { 0.5, 1, 0.5 }, t0 = 0, h = 0.1, steps = 2, every = 1 }
> levels.u
[[  0,   0,   0],
 [0.1, 0.1, 0.1],
 [0.2, 0.2, 0.2]]]=]

M["strip.vary"] = [=[
> core = require "dm.core"
> s = core.strip(function(a, b, x, t)
>>   local rate, slope = (b - a)/t[2], b[2] - b[1]
>>   return t[2]*(rate:dot(rate)/4 - slope^2/2)
>> end, { values = 1, cells = 2, held = {0, 0, 0}, place = {0, 1}, absorbs = {0, 0} })
> s:vary { u = dm.matrix { { 0, 0, 0 }, { 1, 1, 1 } }, t = { 0, 0.1 },
>>   v = { 1, 0, 0 }, dp = { 0, 0, 0 } }
[[1, 0, 0],
 [1, 0, 0]]	[-0.1, 0.1, 0]]=]

return M
