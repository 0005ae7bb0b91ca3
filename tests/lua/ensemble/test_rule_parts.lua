-- rows of members have the parts of a rule beside q and p, as rows of a run of its own: of rules
-- that scripts write and of the list, with parameters that vary, from a journal; summaries know them
local tap = require "tap"
local ok, raises = tap.ok, tap.raises

local function spring_of(k)
  return dm.system { Q = dm.R(1), params = { k = k },
    L = function(q, v, _, given) return v[1] ^ 2 / 2 - given.k * q[1] ^ 2 / 2 end }
end
local spring = spring_of(1)
-- symplectic Euler, which counts the action of its potential as F and twice its steps as G2
local euler = dm.step { name = "counting", unknowns = 1, order = 1, parts = { { "F", 1 }, { "G", 2 } },
  begin = function(x, y) return { F = x[1], G = { 0, 0 } } end,
  start = function() return { 0 } end,
  equation = function(y, x, h, m) return { x[1] - h * m.H_p(y.q, y.p, y.t)[1] } end,
  next = function(y, x, h, m)
    return { q = y.q + x, p = y.p - h * m.H_q(y.q + x, y.p, y.t), F = y.F + h * y.q[1] ^ 2,
      G = { y.G[1], y.G[2] + 2 } }
  end }

local function q(i) return 1 + i / 8 end
local function v(i) return i / 4 end
local function columns_of(path)
  local out = {}
  for _, name in ipairs(path.columns) do
    local column = path:column(name)
    for i = 1, #column do out[#out + 1] = ("%s %a"):format(name, column[i]) end
  end
  return table.concat(out, "\n")
end
local function same(e, solver, of)
  for i = 1, #e do
    local path = (of and of(i) or solver):run { q = { q(i) }, v = { v(i) }, steps = 7, every = 2 }
    if columns_of(e:path(i)) ~= columns_of(path) then return false end
  end
  return true
end

for _, rule in ipairs { euler, "sem(2, gauss(2))" } do
  local solver = spring:solver { rule = rule, h = 0.05 }
  local name = tostring(rule)
  local options = { members = 5, q = q, v = v, steps = 7, every = 2, threads = 2 }
  local e = solver:ensemble(options)
  local path = e:path(3)
  ok(same(e, solver), name .. ": columns of members are those of runs", table.concat(path.columns, " "))
  ok(#path.columns > 3 and path.columns[2] == "q1" and path.columns[3] == "p1", name .. ": q, p and more")
  ok(#e.q == 5 and e.p[2][1] == e:path(2).p[#e:path(2)][1], name .. ": ends")
  local last = path.columns[#path.columns]
  local column = path:column(last)
  ok(e:summary(last).last[3] == column[#column] and e:summary "q1".first[3] == q(3),
    name .. ": summaries of a part and of a coordinate")
  ok(e:summary()[last].largest == e:summary()[last].largest and e:summary().p1, name .. ": extents of all")
  options.vary = { k = function(i) return i end }
  ok(same(solver:ensemble(options), nil, function(i)
    return spring_of(i):solver { rule = rule, h = 0.05 }
  end), name .. ": parameters that vary")
  options.vary, options.journal = nil, os.tmpname()
  os.remove(options.journal)
  solver:ensemble(options)
  local again = solver:ensemble(options)
  os.remove(options.journal)
  ok(same(again, solver), name .. ": from a journal")
  options.journal, options.every, options.watch = nil, nil, { last }
  local watched = solver:ensemble(options)
  ok(#watched:path(1).columns == 2, name .. ": watch names all that is kept")
end

-- rows of a rule without parts have names, too; ends alone have none
local verlet = spring:solver { rule = "verlet", h = 0.1 }
local e = verlet:ensemble { members = 3, q = q, v = v, steps = 4, every = 1 }
ok(e:summary "q1".first[2] == q(2) and e:summary().p1.least <= v(1), "columns q1 and p1 of rows")
raises("rows have no column 'x', but t, q1, p1", e.summary, e, "x")
e = verlet:ensemble { members = 3, q = q, v = v, steps = 4 }
raises("kept only the ends", e.summary, e)
tap.done()
