-- What does reduction buy when the group grows? k rotors sit on a sledge that slides on a plane between springs; each is dragged along when
-- the sledge moves and when its neighbour turns, and the further out the sledge is the larger is its inertia. k angles are cyclic: their momenta
-- are conserved, and what is left has two coordinates, whatever k is.
local dm = require "dm"
local picture = (arg and arg[1] or ".") .. "/carousel.png"

local function carousel(k)
  local names = {}
  for a = 1, k do names[a] = "theta" .. a end
  names[k + 1], names[k + 2] = "x", "y"
  return dm.system { name = "carousel", Q = dm.R(k + 2), coordinates = names, L = function(q, v)
    local x, y, u, w = q[k + 1], q[k + 2], v[k + 1], v[k + 2]
    local sum = (u ^ 2 + w ^ 2) / 2 - (x * x + 2 * y * y) / 2 - 0.1 * x * x * y
    for a = 1, k do
      local rate = v[a] + 0.3 * y * u / a - (a > 1 and 0.2 * v[a - 1] or 0)
      sum = sum + (1 + (x - 0.3 * a) ^ 2 + y * y) * rate ^ 2 / 2
    end
    return sum
  end }
end

-- ns a step, best of runs that take turns
local function race(a, b)
  local best = { math.huge, math.huge }
  for _ = 1, 9 do
    for i, s in ipairs { a, b } do best[i] = math.min(best[i], s.solver:run { q = s.q, v = s.v, steps = 400, every = 400 }.ns_per_step) end
  end
  return best[1], best[2]
end

local rules, series, size = { "gauss(1)", "lobatto(3)" }, {}, { 1, 2, 3, 4, 6 }
for i, rule in ipairs(rules) do series[i] = { x = {}, y = {}, name = rule } end
for j, k in ipairs(size) do
  local system, q, v = carousel(k), {}, {}
  for a = 1, k do q[a], v[a] = 0, 0.3 end
  q[k + 1], q[k + 2], v[k + 1], v[k + 2] = 1, 0.5, 0, 0.3
  local shape = system:routh { q = q, v = v }  -- the cyclic coordinates are found in the graph
  assert(#shape:reduction().group == k)
  local x, u = shape:start(q, v)
  for i, rule in ipairs(rules) do
    local full, reduced = system:solver { rule = rule, h = 0.05 }, shape:solver { rule = rule, h = 0.05 }
    local a = full:run { q = q, v = v, steps = 200 }
    local b = reduced:run { q = x, v = u, steps = 200 }
    local off = dm.compare(a, b:reconstruct())
    assert(off.worst < 1e-12, tostring(off))
    local slow, quick = race({ solver = full, q = q, v = v }, { solver = reduced, q = x, v = u })
    series[i].x[j], series[i].y[j] = k, quick / slow
  end
  print(("%d rotors: a step costs %.2f (gauss(1)) and %.2f (lobatto(3)) of the unreduced one"):format(k, series[1].y[j], series[2].y[j]))
end
print("picture  " .. dm.figure { { series[1], series[2], style = "linespoints", xlabel = "rotors",
  ylabel = "time of a step, reduced / unreduced", yrange = { 0, 1 } }, title = "Rotors on a sledge: what reduction saves", file = picture })
