--- Examples of waves (Schroedinger).
local M = {}

M["dm.wave_equation"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> w.n, w.fft
64	FFTW]=]

M["dm.wave_path"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path.t, #path.psi
[0, 1, 2]	3]=]

M["dm.wave_solver"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> solver = wave:solver { rule = "strang", h = 0.05 }
> solver.rule, solver.h
strang	0.05]=]

M["dm.wave_stepper"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> core = require "dm.core"
> kind, kicks, drifts = core.wave_rule("verlet", 0)
> core.wave_stepper(w, kind, 0.05, kicks, drifts).iterations
0]=]

M["schroedinger.current"] = [=[
> wave = dm.schroedinger { x = {0, 2*math.pi, 16} }
> j, density = wave:current(function(x) return math.cos(3*x), math.sin(3*x) end)
> ("%.6f %.6f"):format(j[1], density[1])
3.000000 1.000000]=]

M["schroedinger.eigen"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> values = wave:eigen(3).values
> ("%.6f %.6f %.6f"):format(values[1], values[2], values[3])
0.500000 1.500000 2.500000]=]

M["schroedinger.equation"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> w.n
64]=]

M["schroedinger.observe"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> seen = wave:observe(function(x) return math.exp(-(x - 1)^2/2)/math.pi^0.25 end)
> ("%.4f %.4f %.4f"):format(seen.norm, seen.energy, seen.x)
1.0000 1.0000 1.0000]=]

M["schroedinger.resume"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> more = wave:resume(path):run { steps = 40 }
> more.t[#more]
4.0]=]

M["schroedinger.solver"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> wave:solver { rule = "strang", h = 0.05 }
solver of a wave: strang, h = 0.05
> wave:solver { rule = "gauss(2)", h = 0.1 }.rule
gauss(2)]=]

M["schroedinger.stability_limit"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> wave:stability_limit "strang"
inf	true
> h, exact = wave:stability_limit "two-step"
> 0 < h and h < 0.1, exact
true	true]=]

M["wave_equation.eigen"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> values = w:eigen(2)
> ("%.6f %.6f"):format(values[1], values[2])
0.500000 1.500000]=]

M["wave_equation.energies"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> energies, exact = w:energies()
> #energies, exact, ("%.6f"):format(energies[1])
64	true	0.500000]=]

M["wave_equation.lanczos"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> values = w:lanczos(2)
> ("%.6f %.6f"):format(values[1], values[2])
0.500000 1.500000]=]

M["wave_equation.matrix"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> H = w:matrix()
> H.rows, H.columns, math.abs(H[1][2] - H[2][1]) < 1e-12
64	64	true]=]

M["wave_equation.observe"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> re, im = dm.zeros(64), dm.zeros(64)
> for j, x in ipairs(wave.x:totable()) do re[j] = math.exp(-x^2/2)/math.pi^0.25 end
> norm, energy, x, momentum = w:observe(re, im)
> ("%.4f %.4f"):format(norm, energy)
1.0000 0.5000]=]

M["wave_equation.slope"] = [=[
> wave = dm.schroedinger { x = {0, 2*math.pi, 16} }
> re = dm.vector(wave.x:map(math.sin))
> slope = wave:equation():slope(re, dm.zeros(16))
> (slope - wave.x:map(math.cos)):norm() < 1e-12
true]=]

M["wave_path.animate"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:animate "wave.html"
wave.html
> os.remove "wave.html"
true]=]

M["wave_path.checkpoint"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:checkpoint "wave.state"
wave.state
> wave:resume("wave.state"):run { steps = 20 }.t[1]
2.0
> os.remove "wave.state"
true]=]

M["wave_path.column"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> (path:column "norm" - 1):norm() < 1e-12
true]=]

M["wave_path.csv"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:csv():match "^[^\n]*"
t,norm,energy,x,momentum,noether]=]

M["wave_path.drift"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:drift("norm").largest < 1e-12
true]=]

M["wave_path.plot"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:plot("density", { rows = 1, size = {40, 10}, ascii = true })
        strang, h = 0.05
a V, 0 to 32   b t = 0
|psi|^2
0.5+:.           .:            .
   | '.          :':         .a
   |   a:.      :  :      ..''
   |     ''a.   :  'b  ..a'
0.0+..b...b.:::ba...:a::b....b..
   +-----+--------+-------+-----
        -5        0       5
                 x]=]

M["wave_path.spacetime"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { steps = 40, every = 20,
>>   psi = function(x) return math.exp(-x^2/2)/math.pi^0.25 end }
> path:spacetime { size = {40, 4} }
        2 |                .:+@@#-:                |
        1 |                .:+@@#-:                |
        0 |                .:+@@#-:                |
           x = -8 to 7.75; |psi|^2, up to 0.564]=]

M["wave_solver.report"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> solver = wave:solver { rule = "strang", h = 0.05 }
> path = solver:run { psi = function(x) return math.exp(-x^2/2) end, steps = 40 }
> solver:report().steps
40]=]

M["wave_solver.run"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> path = wave:solver { rule = "strang", h = 0.05 }:run { t = 1,
>>   psi = function(x) return math.exp(-(x - 1)^2/2)/math.pi^0.25 end }
> ("%.3f %.3f"):format(path:column "x"[#path], math.cos(1))
0.540 0.540]=]

M["wave_stepper.run"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> re, im = dm.zeros(64), dm.zeros(64)
> for j, x in ipairs(wave.x:totable()) do re[j] = math.exp(-x^2/2)/math.pi^0.25 end
> core = require "dm.core"
> kind, kicks, drifts = core.wave_rule("verlet", 0)
> s = core.wave_stepper(w, kind, 0.05, kicks, drifts)
> s:start(re, im)
> rows, done, code = s:run(0, 0, 20, 10)
> done, code
20	ok]=]

M["wave_stepper.start"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> re, im = dm.zeros(64), dm.zeros(64)
> for j, x in ipairs(wave.x:totable()) do re[j] = math.exp(-x^2/2)/math.pi^0.25 end
> core = require "dm.core"
> kind, kicks, drifts = core.wave_rule("verlet", 0)
> s = core.wave_stepper(w, kind, 0.05, kicks, drifts)
> s:start(re, im)
> #s:state()
128]=]

M["wave_stepper.state"] = [=[
> wave = dm.schroedinger { x = {-8, 8, 64}, V = function(x) return x^2/2 end }
> w = wave:equation()
> re, im = dm.zeros(64), dm.zeros(64)
> for j, x in ipairs(wave.x:totable()) do re[j] = math.exp(-x^2/2)/math.pi^0.25 end
> core = require "dm.core"
> kind, kicks, drifts = core.wave_rule("verlet", 0)
> s = core.wave_stepper(w, kind, 0.05, kicks, drifts)
> s:start(re, im)
> kept = s:state()
> rows = s:run(0, 0, 20, 10)
> s:state(kept) == kept
true]=]

return M
