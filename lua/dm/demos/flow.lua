-- a flow on a sphere: a wave that turns as a whole, and three integrals that stay to the last digit
return {
  title = "Flow: a wave on a turning planet",
  about = [[The vorticity of an ideal fluid is carried by its own flow. On a mesh of the sphere a
    Rossby-Haurwitz wave, which ought to turn as a whole, is off by the size of the triangles; but
    energy, enstrophy and circulation stay to round-off, on any mesh.]],
  numbers = { { name = "level", value = 2, least = 1, most = 4,
    what = "times that the triangles of an icosahedron are split" } },
  steps = {
    { "A sphere, and a wave of degree 4 in a rotation about its axis:", [[
K = dm.mesh { icosphere = level // 1 | 0 }
function wave(t)
  local c, s = math.cos(0.9*t), math.sin(0.9*t)
  return K:form(0, function(x, y, z)
    local a, b = c*x + s*y, c*y - s*x
    return 2*z + 6*z*(a^3 - 3*a*b^2)
  end)
end
print(K)]] },
    { "Its flow: w' = -*(d psi ^ d w), div grad psi = w, by the implicit midpoint rule.", [[
flow = K:euler { vorticity = wave(0) }:solver { h = 0.1 }:run { t = 2 }
print(flow)]] },
    { "It turns by 0.9 a unit of time. How far off is it at t = 2?", [[
off = (flow:form(#flow) - wave(2)):norm()/wave(2):norm()
print(off)]] },
    { "And what changes of the three integrals?", [[
for _, what in ipairs { "energy", "enstrophy", "circulation" } do
  print(what, flow:column(what)[1], flow:drift(what).largest)
end]] },
    { "The same mesh for light: Maxwell's equations in a cavity keep Gauss's law.", [[
cavity = dm.mesh { triangle = 6 }
A = cavity:form(1, function(x, y) return { y*(1 - x), x*y } end)
light = cavity:field { form = 1, fixed = "boundary",
  L = function(A, V) return V:dot(V)/2 - A:d():dot(A:d())/2 end }
path = light:solver { rule = "verlet", h = 0.02 }:run { q = A, v = 0*A, steps = 500 }
gauss = path:drift("gauss").largest
print(gauss, path:drift("energy").largest)]] },
  },
  claim = function(e)
    local kept = e.flow:drift("energy").largest
    return kept < 1e-12 and e.gauss < 1e-12 and e.off < 1.5,
      ("Energy off by %.0e, Gauss's law by %.0e, the wave by %.2f. Try level = %g.")
        :format(kept, e.gauss, e.off, e.level < 3 and e.level + 1 or e.level - 1)
  end,
}
