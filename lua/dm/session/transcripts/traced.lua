--- Examples of traced functions.
local M = {}

M["dm.function"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f { 3, 5 }
15.0
> f
function of 2 numbers to a number (1 operation, derivatives exact)]=]

M["function.bounds"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:bounds({ 0, 1 }, { 2, 3 })
0.0	6.0]=]

M["function.breaks"] = [=[
> f = dm.trace(function(x) return dm.where(x[1] - 2, dm.sqrt(x[2]), 0) end, 2)
> breaks, edges = f:breaks()
> breaks
function of 2 numbers to a vector of 1 (1 operation, derivatives exact)]=]

M["function.clear"] = [=[
> f = dm.trace(function(x) return dm.vector { x[1] - 3 } end, 2)
> f:clear({ 0, 0 }, { 1, 0 }, 100, 0.05)
{ -100.0, 2.9296875, 3.125, 100.0 }]=]

M["function.depends"] = [=[
> f = dm.trace(function(x, y) return x[1] + y[2]^2 end, 2, 2)
> f:depends()
{ { true, false }, { false, true } }]=]

M["function.emit_c"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:emit_c "area"
#include <math.h>

/* 1 operations; in[2], out[1] */
void area(const double *in, double *out) {
    const double x1 = in[0];
    const double x2 = in[1];
    const double t3 = x1 * x2;
    out[0] = t3;
}]=]

M["function.factors"] = [=[
> f = dm.trace(function(x) return 3/2*(x[1] - x[2])^2 end, 2)
> c, list = f:factors()
> c, list[1].power, list[1].base { 5, 1 }
1.5	2.0	4.0]=]

M["function.gradient"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:gradient { 3, 5 }
[5, 3]]=]

M["function.graph"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:graph()
y1 = x1*x2]=]

M["function.hessian"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:hessian { 3, 5 }
[[0, 1],
 [1, 0]]]=]

M["function.jacobian"] = [=[
> f = dm.trace(function(x) return { x[1]*x[2], x[1] + x[2] } end, 2)
> f:jacobian { 3, 5 }
[[5, 3],
 [1, 1]]]=]

M["function.operations"] = [=[
> f = dm.trace(function(x) return x[1]*x[2] end, 2)
> f:operations()
1]=]

M["function.terms"] = [=[
> f = dm.trace(function(x) return x[1]^2 + 3*x[1]*x[2] end, 2)
> for i, term in ipairs(f:terms()) do print(i, term { 2, 1 }) end
1	4.0
2	6.0]=]

M["dm.field"] = [=[
> cord = dm.field { x = { 0, 1, 20 }, L = function(u, ut, ux) return (ut^2 - ux^2)/2 end }
> run = cord:solver({ h = 0.05 }):run { u = function(x) return math.cos(math.pi*x) end, t = 1 }
> #run, run.t[21], math.abs(run.u[21][1] + 1) < 0.01
21	1.0	true]=]

return M
