-- orders of convergence of operators on smooth nonlinear data, on equilateral triangles bent by a smooth map, in L2 over a fixed inner region:
-- what is central in regular meshes is of order 2, what takes a side or a value at one place of a cell of order 1
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos, exp, pi, log = math.sin, math.cos, math.exp, math.pi, math.log

local function bend(x, y)
  return { x + 0.05 * sin(pi * x) * sin(pi * y), y + 0.05 * sin(2 * pi * x) * sin(pi * y) }
end

-- a = f dx + g dy, its derivative, a field X with its derivatives, all by hand
local function f(x, y) return sin(2 * x + y) end
local function g(x, y) return exp(x) * cos(y) end
local function a(x, y) return { f(x, y), g(x, y) } end
local function da(x, y) return exp(x) * cos(y) - cos(2 * x + y) end
local function X(x, y) return { sin(2 * y) + x, cos(3 * x) * y } end
local function turned(x, y) -- i_X of w dx dy
  local v, w = X(x, y), da(x, y)
  return { -w * v[2], w * v[1] }
end
local function along(x, y)
  local v = X(x, y)
  return f(x, y) * v[1] + g(x, y) * v[2]
end
local function product(x, y)
  local v = X(x, y)
  return { f(x, y) * v[2] - g(x, y) * v[1] }
end
local function divergence(x) return 1 + cos(3 * x) end
local function rotation(x, y) return -3 * sin(3 * x) * y - 2 * cos(2 * y) end
local function lie(x, y) -- i_X da + d (a.X)
  local v, w = X(x, y), da(x, y)
  local fx, fy, gx, gy = 2 * cos(2 * x + y), cos(2 * x + y), exp(x) * cos(y), -exp(x) * sin(y)
  local px = fx * v[1] + f(x, y) + gx * v[2] - g(x, y) * 3 * sin(3 * x) * y
  local py = fy * v[1] + f(x, y) * 2 * cos(2 * y) + gy * v[2] + g(x, y) * cos(3 * x)
  return { -w * v[2] + px, w * v[1] + py }
end

-- cells of degree k in the inner region of the mesh
local function region(K, k)
  local centres, out = K:circumcentres(k), {}
  for i = 1, #centres do
    local x, y = centres[i][1], centres[i][2]
    if y > 0.22 and y < 0.5 and x > 0.38 and x < 0.62 then out[#out + 1] = i end
  end
  return out
end
-- |e| of a primal or dual form, by its primal cells
local function norm(e, cells)
  local K, k = e.mesh, e.side == "dual" and e.mesh.dimension - e.degree or e.degree
  local volume, dual, sum = K:volume(k), K:dual_volume(k), 0
  for _, i in ipairs(cells[k]) do
    sum = sum + e[i] ^ 2 * (e.side == "dual" and volume[i] / dual[i] or dual[i] / volume[i])
  end
  return sum ^ 0.5
end
local function apart(U, F, cells)
  local W, sum, k = U.mesh:vector_field(F, { on = U.on }), 0, U.on == "cells" and 2 or 0
  local weight = U.on == "cells" and U.mesh:volume(2) or U.mesh:dual_volume(0)
  for _, i in ipairs(cells[k]) do
    local e = U.values[i] - W.values[i]
    sum = sum + weight[i] * e:dot(e)
  end
  return sum ^ 0.5
end

-- errors by name: { error, least order, most }
local function errors(N)
  local K = dm.mesh { triangle = N, map = bend }
  local cells, out = { [0] = region(K, 0), region(K, 1), region(K, 2) }, {}
  local one, two = K:form(1, a), K:form(2, da)
  local function add(name, got, want, least, most) out[name] = { norm(got - want, cells), least, most } end
  for _, on in ipairs { "vertices", "cells" } do
    local U = K:vector_field(X, { on = on })
    for _, row in ipairs { { { side = "central" }, 1.6, 2.5 }, { { side = "forward" }, 0.85, 1.25 },
      { { side = "backward" }, 0.85, 1.25 }, { { method = "algebraic" }, 1.6, 2.5 } } do
      local name = (row[1].side or row[1].method) .. ", X on " .. on
      add("i_X of a 1-form, " .. name, one:contract(U, row[1]), K:form(0, along), row[2], row[3])
      add("i_X of a 2-form, " .. name, two:contract(U, row[1]), K:form(1, turned), row[2], row[3])
      add("L_X of a 1-form, " .. name, one:lie(U, row[1]), K:form(1, lie), row[2] - 0.1, row[3])
    end
    add("divergence, X on " .. on, U:div(), K:form(0, divergence), 1.6, 2.5)
    add("flat, X on " .. on, U:flat(), K:form(1, X), 1.6, 2.5)
    add("flat to the dual, X on " .. on, U:flat { to = "dual" }, K:form(1, X, { dual = true }), 1.6, 3.5)
  end
  add("curl", K:vector_field(X):curl(), K:form(0, rotation, { dual = true }), 0.85, 1.3)
  out["sharp to vertices"] = { apart(one:sharp(), a, cells), 1.6, 2.5 }
  out["sharp to cells"] = { apart(one:sharp { to = "cells" }, a, cells), 0.85, 1.3 }
  local dual = K:form(1, a, { dual = true })
  out["sharp of a dual form"] = { apart(dual:sharp(), a, cells), 0.85, 1.3 }
  add("star", one:star(), K:form(1, function(x, y) return { -g(x, y), f(x, y) } end, { dual = true }), 1.6, 2.5)
  add("dual product", dual:wedge(K:form(1, X, { dual = true })), K:form(2, product, { dual = true }), 1.6, 2.5)
  add("natural product", one:wedge(K:form(1, X)), K:form(2, product), 0.85, 1.3)
  add("metric product", one:wedge(K:form(1, X), { rule = "metric" }), K:form(2, product), 0.85, 1.3)
  return out
end

local first, last = errors(12), errors(48)
local names = {}
for name in pairs(first) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
  local order = log(first[name][1] / last[name][1], 4)
  ok(order > first[name][2] and order < first[name][3], ("%s: order %.2f"):format(name, order), last[name][1])
end

-- the printed metric product has no Leibniz rule: its defect, by area, falls with the mesh only
local function defect(N, rule)
  local K = dm.mesh { triangle = N, map = bend }
  local u, b = K:form(0, function(x, y) return sin(x + 2 * y) end), K:form(1, a)
  local e = u:wedge(b, { rule = rule }):d() - u:d():wedge(b, { rule = rule }) - u:wedge(b:d(), { rule = rule })
  local worst, area = 0, K:volume(2)
  for i = 1, #e do worst = math.max(worst, math.abs(e[i] / area[i])) end
  return worst
end
ok(defect(4, "metric") > 1e-3 and defect(32, "metric") < defect(16, "metric") and defect(8, "natural") < 1e-11,
  "Leibniz: natural products, not metric ones", defect(4, "metric"))
near(defect(4, "cup"), 0, 1e-11, "and cup products")

-- the de Rham map: polynomials up to its order are integrated exactly, others to that order
local T = dm.mesh { points = { { 0.1, 0.2 }, { 1.3, 0.4 }, { 0.5, 1.1 } }, simplices = { { 1, 2, 3 } } }
for order = 1, 9, 2 do
  local function power(x, y) return { (x + y / 3) ^ order } end
  near(T:form(2, power, { order = order })[1] / T:form(2, power, { order = 21 })[1], 1, 1e-11, "exact for degree " .. order)
  local function higher(x, y) return { (x + y / 3) ^ (order + 2) } end
  ok(math.abs(T:form(2, higher, { order = order })[1] / T:form(2, higher, { order = 21 })[1] - 1) > 1e-12 * 10 ^ -order,
    "and not beyond")
end
-- Stokes for nonlinear forms, to the order of quadrature
local S = dm.mesh { shells = { 3, 1 } }
local curved = S:form(1, function(x, y, z) return { y * z, x * x, x * y * z } end, { order = 9 })
local derivative = S:form(2, function(x, y, z) return { 2 * x - z, y * z - y, x * z } end, { order = 9 })
near((curved:d() - derivative):max(), 0, 1e-13, "the integral of da over a cell is that of a over its boundary")

-- barycentric duals: a linear u is not found, on any refinement, and the report says so
local function linear(x, y) return x + 2 * y end
local function bent(x, y)
  return { x + 0.08 * math.sin(2 * math.pi * x) * math.sin(math.pi * y), y + 0.06 * math.sin(math.pi * x) * math.sin(2 * math.pi * y) }
end
for dual, wrong in pairs { circumcentric = false, barycentric = true } do
  local K = dm.mesh { grid = 16, dual = dual, map = bent }
  local u, report = K:poisson { f = 0, fixed = { boundary = linear } }
  local off, note = (u - K:form(0, linear)):max(), report.note or ""
  tap.ok((off > 0.05) == wrong and (off < 1e-12) ~= wrong and (note:find "does not converge" ~= nil) == wrong, dual .. " duals: a linear u", off .. note)
  tap.ok((K:laplacian(0, { fixed = "boundary" }):eigen(1).note ~= nil) == wrong, "  its eigenvalues")
end
local regular = dm.mesh { triangle = 6, dual = "barycentric" }
tap.ok(select(2, regular:poisson { f = 1, fixed = { boundary = 0 } }).note == nil, "equal triangles have one centre")

tap.done()
