--- Examples of charts of fields over their size, and of checkpoints of fields on lines.
local M = {}

local CHART = [=[
> string_of = function(N) return dm.field { x = {0, 1, N}, fixed = "ends",
>>   L = function(u, ut, ux) return (ut^2 - ux^2)/2 end } end
> c = dm.chart { system = string_of, N = {8, 16, 32}, t = 0.5, h = function(N) return 1/(2*N) end,
>>   u = function(x) return math.sin(math.pi*x) end,
>>   exact = function(x, t) return math.cos(math.pi*t)*math.sin(math.pi*x) end,
>>   error = "largest" }
]=]

M["dm.field_chart"] = CHART .. [=[
> #c, c.name, c.against
3	N	a formula]=]

M["field_chart.order"] = CHART .. [=[
> ("%.1f"):format(c:order())
2.0]=]

M["field_chart.table"] = CHART .. [=[
> c:table():match "^rule +N +width"
rule                    N      width]=]

M["field_chart.csv"] = CHART .. [=[
> c:csv():match "^[^\n]*"
rule,size,width,h,steps,error,ns]=]

M["field_chart.plot"] = CHART .. [=[
> file = c:plot { file = os.tmpname() .. ".png" }
> os.remove(file)
true]=]

local STRING = [=[
> string_ = dm.field { x = {0, 1, 16}, fixed = "ends",
>>   L = function(u, ut, ux) return (ut^2 - ux^2)/2 end }
> run = string_:solver { h = 1/32 }:run { u = math.sin, steps = 8 }
> file = run:checkpoint(os.tmpname())
]=]

M["line_run.checkpoint"] = STRING .. [=[
> string_:resume(file):run { steps = 8 }.t[9], os.remove(file)
0.5	true]=]

M["line_field.resume"] = STRING .. [=[
> string_:resume(file):run { steps = 0 }.u[1] == run.u[9], os.remove(file)
true	true]=]

return M
