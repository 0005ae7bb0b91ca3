-- invariant discrete variational problems (Bogfjellmo 5 and 6): Euler's elastica
return {
  title = "Invariants: Euler's elastic wire",
  about = [[A wire that resists bending and keeps its length does not care where it lies: its
    Lagrangian is a function of the invariants of the Euclidean group, here of three neighbouring
    points, the chord lambda and the bend sigma. The equations are written in the invariants, and
    points come back from the frame.]],
  numbers = { { name = "bend", value = 200.0, least = 20, most = 400,
    what = "growth of the curvature at the start" },
    { name = "n", value = 300, least = 100, most = 2000, what = "points a unit of length" } },
  steps = {
    { "The frame puts the first point at the origin and the second on the axis; what is left of "
      .. "the third is the bend.", [[
se2 = dm.action { group = dm.SE(2), on = dm.R(2) }
frame = dm.moving_frame { action = se2, points = 2,
  cross_section = function(a, b) return { a[1], a[2], b[2] } end,
  branch = function(a, b) return b[1] end,
  invariants = { lambda = {2, 1}, sigma = {3, 2} } }
print(frame)]] },
    { "The energy of bending, and the length of a chord as a constraint:", [[
wire = dm.invariant_problem { frame = frame,
  L = function(I) return I.sigma^2/I.lambda^3 end,
  constraint = function(I) return I.lambda - 1/n end }
print(wire)]] },
    { "Five points of a wire that begins straight and bends more and more; the equations do the "
      .. "rest.", [[
first, x, y = { {0, 0} }, 0, 0
for i = 1, 4 do
  local angle = bend/2*((i - 0.5)/n)^2
  x, y = x + math.cos(angle)/n, y + math.sin(angle)/n
  first[i + 1] = {x, y}
end
curve = wire:solve { points = first, n = n }
x, y = curve.points:column(1), curve.points:column(2)
dm.plot(x, y, { equal = true, height = 20, width = 64 })]] },
    { "Its chords, and its largest curvature, which for kappa'' = -kappa^3/2 is the root of 2 "
      .. "bend.", [[
chords, curvature = 0, 0
lambda, sigma = curve.invariants.lambda, curve.invariants.sigma
for i = 1, #sigma do
  chords = math.max(chords, math.abs(n*lambda[i] - 1))
  curvature = math.max(curvature, n^2*sigma[i])
end
theory = (2*bend)^0.5
print("chords off by", chords)
print("largest curvature", curvature, "theory", theory)]] },
  },
  claim = function(e)
    return e.chords < 1e-9 and math.abs(e.curvature / e.theory - 1) < 0.01,
      ([[The wire curls to and fro, as Euler drew it in 1744: largest curvature %.3f, theory %.3f;
      chords equal to %.0e. Rotations and shifts were never divided out by hand.]])
        :format(e.curvature, e.theory, e.chords)
  end,
}
