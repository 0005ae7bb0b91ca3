--- Examples of methods of ensembles and charts.
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

return M
