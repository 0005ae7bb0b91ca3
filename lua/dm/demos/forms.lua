-- forms on a mesh: Stokes without an error, Laplace with one of order 2 (Leok, chapter 3)
return {
  title = "Forms: calculus on triangles, exact where it can be",
  about = [[A k-form has a number on every k-cell of a mesh: functions at vertices, work along
    edges, flux through faces. d adds up what is around a cell, so Stokes' theorem holds without
    any error. Only the star, which needs lengths, approximates.]],
  numbers = { { name = "N", value = 8, least = 3, most = 40, what = "triangles along a side" } },
  steps = {
    { "A mesh, a function on it, and its slope along every edge:", [[
K = dm.mesh { triangle = N }
f = K:form(0, function(x, y) return math.exp(x) * math.cos(y) end)
df = f:d()
print(K, df:d():max())]] },
    { "The field (-y, x) has curl 2: its work round the triangle is twice the area, exactly:", [[
swirl = K:form(1, function(x, y) return { -y, x } end)
inside = K:fundamental()
round, area = swirl:pair(inside:boundary()), dm.vector(K:volume(2)):sum()
print(round, 2 * area)]] },
    { "f is harmonic, so its Laplacian is 0; that of the mesh is small, and smaller with N:", [[
laplacian = K:laplace_beltrami() * f
on_rim = {}
for _, v in ipairs(K:boundary_cells(0)) do on_rim[v] = true end
worst = 0
for v = 1, #laplacian do
  if not on_rim[v] then worst = math.max(worst, math.abs(laplacian[v])) end
end
print(worst)
f:plot()]] },
  },
  claim = function(e)
    return e.df:d():max() < 1e-14 and math.abs(e.round - 2 * e.area) < 1e-12
      and e.worst < 0.02 / e.N ^ 4,
      ([[dd = %.0e and Stokes holds to %.0e; the Laplacian of a harmonic function is off by %.1e,
      which falls like 1/N^2: try N = %d.]])
        :format(e.df:d():max(), math.abs(e.round - 2 * e.area), e.worst, 2 * e.N)
  end,
}
