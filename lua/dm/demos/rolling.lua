-- nonholonomic constraints: the discrete Lagrange-d'Alembert principle (Bloch 2003, 1.7)
return {
  title = "Rolling: a sleigh on one skate",
  about = [[The skate cannot slip sideways: a condition on velocities that no condition on positions
    replaces. Spun on the spot, the sleigh turns its spin into a glide, and ends up turned by pi
    k / (2 a), whatever the spin; a is the distance from the skate to the centre of mass.]],
  numbers = { { name = "spin", value = 1.0, least = 0.2, most = 4, what = "spin at the start" },
    { name = "a", value = 0.5, least = 0.2, most = 1, what = "skate to centre of mass" } },
  steps = {
    { "Position of the skate and heading; rolling = what must vanish.", [[
sleigh = dm.system { Q = dm.R(3), coordinates = {"x", "y", "heading"},
  L = function(q, v)
    local x, y = v[1] - a*v[3]*math.sin(q[3]), v[2] + a*v[3]*math.cos(q[3])
    return (x*x + y*y)/2 + 0.75*v[3]^2/2
  end,
  rolling = function(q, v) return math.cos(q[3])*v[2] - math.sin(q[3])*v[1] end }]] },
    { "Spun and let go. The track of the skate:", [[
solver = sleigh:solver { rule = "gauss(3)", h = 0.05 }
track = solver:run { q = {0, 0, 0}, v = {0, 0, spin}, t = 60/spin }
track:plot("x", "y", { width = 64, height = 18, equal = true, xrange = {-4, 1} })]] },
    { "Where it ended up, and where theory says:", [[
turned = track.q[#track][3]
theory = math.pi*(a^2 + 0.75)^0.5/(2*a)
print("turned by", turned, "theory", theory)
print("slipped by", track:worst "rolling")]] },
  },
  claim = function(e)
    return math.abs(e.turned - e.theory) < 1e-3 and e.track:worst "rolling" < 1e-13,
      ([[It turned by %.4f, theory says %.4f, and the skate never slipped (%.0e). Another spin
      ends in the same turn; another a does not.]])
        :format(e.turned, e.theory, e.track:worst "rolling")
  end,
}
