--- Examples of functions of numbers, of the machine and of the session.
local M = {}

M["dm.acos"] = [=[
> dm.acos(-1) == math.pi
true
> s = dm.derivative(math.acos)
> s(0)
-1.0]=]

M["dm.asin"] = [=[
> dm.asin(1) == math.pi/2
true]=]

M["dm.atan"] = [=[
> dm.atan(1, -1)/math.pi
0.75]=]

M["dm.ceil"] = [=[
> dm.ceil(2.1), dm.ceil(-2.1)
3	-2]=]

M["dm.cos"] = [=[
> dm.cos(math.pi)
-1.0
> f = dm.trace(function(x) return math.cos(x) end)
> f:gradient(math.pi/2)
[-1]]=]

M["dm.cosh"] = [=[
> dm.cosh(0)
1.0
> x = 0.3
> math.abs(dm.cosh(x)^2 - dm.sinh(x)^2 - 1) < 1e-15
true]=]

M["dm.exp"] = [=[
> dm.exp(1)
2.718281828459]=]

M["dm.floor"] = [=[
> dm.floor(2.9), dm.floor(-2.1)
2	-3]=]

M["dm.fmod"] = [=[
> dm.fmod(7, 3), dm.fmod(-7, 3)
1	-1]=]

M["dm.log"] = [=[
> dm.log(math.exp(2)), dm.log(8, 2)
2.0	3.0]=]

M["dm.log10"] = [=[
> dm.log10(1000)
3.0]=]

M["dm.max"] = [=[
> dm.max(3, 1, 2)
3]=]

M["dm.min"] = [=[
> dm.min(3, 1, 2)
1]=]

M["dm.modf"] = [=[
> dm.modf(-3.25)
-3	-0.25]=]

M["dm.pow"] = [=[
> dm.pow(2, 10)
1024.0]=]

M["dm.sign"] = [=[
> dm.sign(-0.5), dm.sign(0), dm.sign(7)
-1.0	0.0	1.0]=]

M["dm.sin"] = [=[
> dm.sin(math.pi/6)
0.5
> sine = dm.derivative(math.sin)
> sine(0)
1.0]=]

M["dm.sinh"] = [=[
> dm.sinh(math.log(2))
0.75]=]

M["dm.sqrt"] = [=[
> dm.sqrt(2)
1.4142135623731
> dm.sqrt(-1) ~= dm.sqrt(-1)
true]=]

M["dm.tan"] = [=[
> dm.tan(math.pi/4)
1.0]=]

M["dm.tanh"] = [=[
> dm.tanh(0), dm.tanh(100)
0.0	1.0]=]

M["dm.tointeger"] = [=[
> dm.tointeger(3.0), dm.tointeger(3.5)
3	nil]=]

M["dm.where"] = [=[
> size = dm.trace(function(x) return dm.where(x, x, -x) end)
> size(-3), size(2)
3.0	2.0]=]

M["dm.clock"] = [=[
> a = dm.clock()
> b = dm.clock()
> b >= a
true]=]

M["dm.cpu"] = [=[
> a = dm.cpu()
> for i = 1, 1e5 do math.sin(i) end
> dm.cpu() > a
true]=]

M["dm.load_average"] = [=[
> dm.load_average() >= 0
true]=]

M["dm.pin"] = [=[
> before = dm.pin()
> dm.unpin(before) == (before ~= nil)
true]=]

M["dm.unpin"] = [=[
> dm.unpin()]=]

M["dm.terminal"] = [=[
> terminal = dm.terminal "stdin"
> terminal.tty, terminal.colour
false	false]=]

M["dm.who"] = [=[
> length, mass = 1.5, dm.vector { 1, 2 }
> dm.who()
length  1.5
mass    [1, 2]]=]

M["dm.example"] = [=[
> dm.example("dm.abs"):match "> ([^\n]*)"
dm.abs(-2)
> dm.example "no such thing" == nil
true]=]

M["dm.demo"] = [=[
> _, why = pcall(dm.demo, "no such demonstration")
> why:match "^[^;]*"
demo: there is no demonstration 'no such demonstration']=]

M["dm.trace"] = [=[
> f = dm.trace(function(x) return x[1]^2*x[2] end, 2)
> f { 3, 5 }
45.0
> f:gradient { 3, 5 }
[30, 9]
> f:hessian { 3, 5 }
[[10,  6],
 [ 6,  0]]]=]

M["dm.hyperdual"] = [=[
> x = dm.hyperdual(2, 1, 1)
> y = x^3
> y.f, y.a, y.ab
8.0	12.0	12.0]=]

M["dm.extremum"] = [=[
> s = dm.system { Q = dm.R(1), L = function(q, v)
>>   local f = function(q, v, y) return v[1]*y[1] - y[1]^2/2 - q[1]^2/2 end
>>   return dm.extremum(v[1]^2/2 - q[1]^2/2, f, { v[1] }, q, v) end }
> s:energy({ 1 }, { 2 })
2.5]=]

M["dm.fft"] = [=[
> re, im = dm.fft { 1, 0, -1, 0 }
> re, im
[0, 2, 0, 2]	[0, 0, 0, 0]]=]

M["dm.ifft"] = [=[
> x = dm.ifft(dm.fft { 1, 2, 3 })
> x
[1, 2, 3]]=]

M["dm.embeddable"] = [=[
> D = { { 0, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 } }
> select(3, dm.embeddable(D))
2
> D[1][2], D[2][1] = 3, 3
> dm.embeddable(D) == false
true]=]

M["dm.drift"] = [=[
> t, y = {}, {}
> for i = 1, 100 do t[i], y[i] = i, 5 + 0.01*i end
> d = dm.drift(t, y)
> ("%.4f"):format(d.per_time)
0.0100]=]

M["dm.filon"] = [=[
> dm.filon("lobatto(3)", 0)
[0.16666666666667, 0.66666666666667, 0.16666666666667]	[0, 0, 0]	[0, 0.5, 1]
> re = dm.filon("lobatto(3)", 100)
> sum = re[1] + re[2] + re[3]
> math.abs(sum - math.sin(100)/100) < 1e-14
true]=]

M["dm.recurrence"] = [=[
> dm.recurrence { 1, -2, 1 }.stable, dm.recurrence { 1, 0, 1 }.stable
false	true
> dm.recurrence { 1, 0, 1 }.im
[-1, 1]]=]

M["dm.smith"] = [=[
> s = dm.smith { { 2, 4 }, { 6, 8 } }
> s.factors, s.rank
{ 2, 4 }	2]=]

M["dm.exact"] = [=[
> e = dm.exact({ { 2 } }, { { 0 } })
> e.mono, e.exact, e.cokernel
true	false	{ rank = 0, torsion = { 2 } }]=]

M["dm.five_lemma"] = [=[
> f = { { 1 }, { 0 } }
> g = { { 0, 1 } }
> l = dm.five_lemma { top = { f, g }, bottom = { f, g },
>>   maps = { { { 1 } }, { { 1, 3 }, { 0, 1 } }, { { 1 } } } }
> l.commutes, l.exact, l.holds
true	true	true
> l.maps[2].iso
true]=]

M["dm.root"] = [=[
> f = dm.root { equations = function(y, x) return y^3 + y - x end, start = 1 }
> f(2), f(10)
1.0	2.0
> dm.derivative(f)(2)
0.25]=]

M["dm.sum_over"] = [=[
> m, x = { 1, 2 }, { 3, 4 }
> dm.sum_over(m, x, function(mi, xi) return mi*xi end)
11.0
> dm.sum_over(x, function(a, b) return (b - a)^2 end, { shift = 1 })
1.0]=]

M["dm.sequence"] = [=[
> rows = dm.sequence { unknowns = 1, y = { 1 }, steps = 4,
>>   equation = function(y, x) return { x[1]^2 - 2*y[1] } end,
>>   start = function(y) return { y[1] + 1 } end, next = function(y, x) return { x[1] } end }
> rows
[[              1],
 [1.4142135623731],
 [1.6817928305074],
 [1.8340080864093],
 [1.9152065613971]]]=]

M["dm.stationary"] = [=[
> x, report = dm.stationary { sites = 5, block = 1, window = 2, x = { 0, 0, 0, 0, 1 },
>>   term = function(w) return (w[2] - w[1])^2 end, given = { true, false, false, false, true } }
> x
[0, 0.25, 0.5, 0.75, 1]]=]

return M
