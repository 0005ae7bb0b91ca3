--- Examples of discrete tangent bundles, connections, classes of pairs, cross-sections.
local M = {}

M["dm.bundle"] = [=[
> b = dm.bundle { h = 0.5, system = dm.system { Q = dm.R(1),
>>   L = function(q, v) return v[1]^2/2 - q[1]^2/2 end } }
> b
discrete tangent bundle of R^1: segments by 'straight', bias 0.5, h = 0.5, dim V = 2
> b:check({ q = {1}, v = {0} }).ok
true]=]

M["bundle.action"] = [=[
> b = dm.bundle { h = 0.5, system = dm.system { Q = dm.R(1),
>>   L = function(q, v) return v[1]^2/2 end } }
> b:action({ 0 }, { 2 })
1.0]=]

M["bundle.check"] = [=[
> b = dm.bundle { h = 0.5, system = dm.system { Q = dm.R(1),
>>   L = function(q, v) return v[1]^2/2 - q[1]^2/2 end } }
> c = b:check { q = {1}, v = {0} }
> c.dimension, c.limit, c.ok
2	inf	true]=]

M["bundle.minus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:minus({ 1 }, { 2 }), b:plus({ 1 }, { 2 })
[0.5]	[1.5]]=]

M["bundle.momenta"] = [=[
> b = dm.bundle { h = 0.5, system = dm.system { Q = dm.R(1),
>>   L = function(q, v) return v[1]^2/2 - q[1]^2/2 end } }
> p0, p1 = b:momenta({ 0 }, { 1 })
> p0, p1
[1]	[1]]=]

M["bundle.pair"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:pair({ 1 }, { 2 })
[0.5]	[1.5]]=]

M["bundle.plus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5, bias = 0 }
> b:minus({ 1 }, { 2 }), b:plus({ 1 }, { 2 })
[0]	[1]]=]

M["bundle.split"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:split({ 1 }, { 2 }, { 1 }, { 0 })
[0.5]	[2]	[0.5]	[-2]]=]

M["bundle.tangent_minus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:tangent_minus({ 1 }, { 2 })
[[    1, -0.25]]]=]

M["bundle.tangent_plus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:tangent_plus({ 1 }, { 2 })
[[   1, 0.25]]]=]

M["bundle.velocity"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:velocity({ 0.5 }, { 1.5 })
[1]	[2]]=]

M["bundle.vertical_minus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:vertical_minus({ 1 }, { 2 }, { 1 })
[0.5]	[-2]]=]

M["bundle.vertical_plus"] = [=[
> b = dm.bundle { Q = dm.R(1), h = 0.5 }
> b:vertical_plus({ 1 }, { 2 }, { 1 })
[0.5]	[2]]=]

M["dm.curve"] = [=[
> s = dm.system {
>>   Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
> p = s:solver { rule = dm.curve "rk4", h = 0.1 }:run { q = {1}, v = {0}, t = 10 }
> p:drift("energy").largest < 1e-5
true]=]

M["dm.connection"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A
discrete connection of R^1 over R^1
> A({ {1}, {0} }, { {3}, {0} })
[4]]=]

M["connection.check"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:check().worst < 1e-9
true]=]

M["connection.compose"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:compose({ { {0}, {1} }, { {1}, {2} } }, { { {1}, {5} }, { {2}, {6} } })
{ { [0], [1] }, { [2], [3] } }]=]

M["connection.continuous"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:continuous { 2 }
[[2]]]=]

M["connection.curvature"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(2),
>>   local_form = function(x0, x1) return { (x0[1] + x1[1])/2*(x1[2] - x0[2]) } end }
> A:curvature({ 0, 0 }, 1, 2)
[1]]=]

M["connection.formation"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:formation { { {0}, {0} }, { {2}, {1} } }
{ { dx = [0], g = [0] }, { dx = [2], g = [3] } }]=]

M["connection.holonomy"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(2),
>>   local_form = function(x0, x1) return { (x0[1] + x1[1])/2*(x1[2] - x0[2]) } end }
> A:holonomy { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0, 0 } }
[-1]]=]

M["connection.hor"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:hor({ {1}, {0} }, { {3}, {0} })
{ [3], [-4] }]=]

M["connection.horizontal_splitting"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:horizontal_splitting({ 1 }, { 3 })
{ [1], [0] }	{ [3], [-4] }]=]

M["connection.join"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> parts = A:split { { {0}, {0} }, { {1}, {5} }, { {2}, {7} } }
> A:join(parts)[3]
{ [2], [7] }]=]

M["connection.lift"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:lift({ 1 }, { 3 }, { {1}, {0} })
{ [3], [-4] }]=]

M["connection.local_form"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:local_form({ 1 }, { 3 })
[4]]=]

M["connection.multi_lift"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:multi_lift({ {0}, {1}, {2} }, { {0}, {10} })
{ { [0], [10] }, { [1], [9.5] }, { [2], [8] } }]=]

M["connection.one_form"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:one_form({ {1}, {0} }, { {3}, {1} })
[5]]=]

M["connection.order"] = [=[
> A = dm.connection { group = dm.SO(3), base = dm.R(2), by = "cayley",
>>   form = function(x) return { { x[2], 0 }, { 0, x[1] }, { 1, 0 } } end }
> ("%.1f"):format(A:order())
2.0]=]

M["connection.relative"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:relative({ {1}, {0} }, { {3}, {0} })
[2]	[4]]=]

M["connection.representative"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:representative({ { {0}, {0} }, { {1}, {2} } }, { {0}, {10} })
{ { [0], [10] }, { [1], [12] } }]=]

M["connection.split"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:split({ { {0}, {0} }, { {1}, {5} } }).g
{ [5.5] }]=]

M["connection.splitting"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:splitting({ {1}, {0} }, { {3}, {0} })
class [{[1], [0]}, [4]]]=]

M["connection.variation"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:variation({ {1}, {0} }, { {3}, {0} }, { {1}, {0} })
{ [0], [3] }	{ [1], [-3] }]=]

M["connection.ver"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> A:ver({ {1}, {0} }, { {3}, {0} })
{ [1], [4] }]=]

M["dm.bundle_class"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> class = A:splitting({ {1}, {0} }, { {3}, {0} })
> class[1], class[2]
{ [1], [0] }	[4]]=]

M["bundle_class.at"] = [=[
> A = dm.connection { group = dm.R(1), base = dm.R(1),
>>   local_form = function(x0, x1) return { (x1[1]^2 - x0[1]^2)/2 } end }
> class = A:splitting({ {1}, {0} }, { {3}, {0} })
> class:at({ {1}, {10} })
class [{[1], [10]}, [4]]]=]

M["core.section"] = [=[
> core = require "dm.core"
> line = core.trace(function(x) return { 1 + x[2] } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> core.section(line, turned, nil):node({ 2, 0.25 }, 1)
[2, 0]	1.0	true]=]

M["dm.level_set"] = [=[
> core = require "dm.core"
> line = core.trace(function(x) return { 1 + x[2] } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> x, condition = core.section(line, turned, nil):cut { 3, 0 }
> x[1][1], condition
3	1.0]=]

M["level_set.node"] = [=[
> core = require "dm.core"
> wave = core.trace(function(x) return { 1 + x[2] - x[1]^2 } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> s = core.section(wave, turned, function(x) return x[1] < 0 end)
> x, sine, inside = s:node({ 1, 1 }, 1)
> x, math.abs(sine - 3/10^.5) < 1e-14, inside
[1, 1]	true	false]=]

M["level_set.cut"] = [=[
> core = require "dm.core"
> wave = core.trace(function(x) return { 1 + x[2] - x[1]^2 } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> slope, condition = core.section(wave, turned, nil):cut { 1, 3 }
> slope, math.abs(condition - 50^.5/7) < 1e-14
[[7]]	true]=]

M["level_set.distance"] = [=[
> core = require "dm.core"
> wave = core.trace(function(x) return { 1 + x[2] - x[1]^2 } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> off, _, inverse = core.section(wave, turned, nil):distance({ 1, 3 }, { 2 })
> math.abs(off - 2/7) < 1e-15, math.abs(inverse - 1/7) < 1e-15
true	true]=]

M["level_set.approach"] = [=[
> core = require "dm.core"
> line = core.trace(function(x) return { 1 + x[2] } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> core.section(line, turned, nil):approach({ 2, 0 }, { 7, 1 })
[0.5]]=]

M["level_set.deflated"] = [=[
> core = require "dm.core"
> two = core.trace(function(x) return { 1 + x[1]*(x[1] - 7) } end, 2) -- at 0, and at 7
> shifted = core.trace(function(y, x) return { x[1] + y[1], x[2] } end, 1, 2)
> y = core.section(two, shifted, nil):deflated({ 1, 0 }, 1, { 1 })
> math.abs(1 + y[1] - 7) < 1e-14
true]=]

M["level_set.folds"] = [=[
> core = require "dm.core"
> wave = core.trace(function(x) return { 1 + x[2] - 0.9*dm.sin(3*x[1]) } end, 2)
> turned = core.trace(function(y, x) return { x[1] - y[1]*x[2], x[2] + y[1]*x[1] } end, 1, 2)
> s = core.section(wave, turned, nil)
> l = s:folds({ { { 0.5, 0.9 }, 1 } }, 100, 1)
> #l, math.abs(l[1][1]:norm() - 1.06) < 0.02
1	true]=]

return M
