-- rows of fields on meshes in files: q and p are arrays, whether a run writes them as they come or a path when it is done
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local K = dm.mesh { triangle = 3 }
local name = os.tmpname() .. ".npy"
local starts = {
  { "functions", { form = 0, L = wave }, { q = function(x, y) return x * y end, v = function() return 0 end } },
  { "forms of degree 1", { form = 1, fixed = "boundary", L = wave }, { q = function(x, y) return { y, x ^ 2 } end, v = function() return { 0, 0 } end } },
  { "two values", { form = 0, values = 2, L = wave }, { q = function(x, y) return { x, y ^ 2 } end, v = function() return { 0, 0 } end } },
}
for _, case in ipairs(starts) do
  local field = K:field(case[2])
  local solver, n = field:solver { rule = "verlet", h = 0.05 }, field.Q.dimension
  local function run(more)
    for key, value in pairs(case[3]) do more[key] = value end
    return solver:run(more)
  end
  local path = run { steps = 20, every = 2 }
  path:npy(name)
  local late = dm.load(name)
  local short = run { steps = 20, every = 2, file = name }
  local streamed = dm.load(name)
  local same = #streamed.t == 11 and #streamed.columns == 3 and table.concat(late.columns, " ") == table.concat(streamed.columns, " ")
  for i = 1, 11 do
    for k = 1, n do
      same = same and late.q[i][k] == path.q[i][k] and streamed.q[i][k] == path.q[i][k] and streamed.p[i][k] == path.p[i][k] and late.p[i][k] == path.p[i][k]
    end
  end
  ok(same and #late.q[1] == n, case[1] .. ": t, q and p, with a row of numbers each", table.concat(streamed.columns, " "))
  ok(#short == 1, "of a run that writes its rows one stays")
  -- a run that goes on adds to its file
  local mark = run { steps = 10, every = 2, file = name }:checkpoint(os.tmpname())
  dm.resume(mark, field):run { steps = 10, every = 2, file = name }
  os.remove(mark)
  local joined, all = dm.load(name), true
  for i = 1, 11 do for k = 1, n do all = all and joined.q[i][k] == path.q[i][k] end end
  ok(all and #joined.t == 11, case[1] .. ": and a run that goes on adds to its file")
  run { steps = 4, watch = { "energy", first = function(q) return q[1] end }, file = name }
  ok(table.concat(dm.load(name).columns, " ") == "t energy first", "what is watched has columns of its own")
end
-- other systems have a field for each coordinate, as before
local pendulum = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
pendulum:solver { rule = "verlet", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 3, file = name }
ok(table.concat(dm.load(name).columns, " ") == "t q1 q2 p1 p2", "coordinates of other systems have fields of their own")
raises("other columns", function()
  local solver = K:field { L = wave }:solver { rule = "verlet", h = 0.05 }
  local mark = solver:run { q = function(x) return x end, v = function() return 0 end, steps = 2 }:checkpoint(os.tmpname())
  dm.resume(mark, solver.system):run { steps = 2, file = name }
end)
os.remove(name)
tap.done()
