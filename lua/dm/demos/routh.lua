-- discrete Routh reduction (Leok 2)
return {
  title = "Reduction: a symmetry makes a system smaller",
  about = [[Where L does not depend on an angle, the momentum of that angle is a number mu, and the
    rest moves by itself: the classical Routhian, with an amended potential, on one dimension
    less. The discrete theory keeps the promise exactly: reduce and step, or step and reduce, it
    is the same path.]],
  numbers = { { name = "J2", value = 0.05, least = 0, most = 0.2,
    what = "how oblate the planet is" },
    { name = "h", value = 0.1, least = 0.01, most = 0.4, what = "step" } },
  steps = {
    { "A satellite, by its angle and the radii r, z. theta is cyclic.", [[
satellite = dm.system { Q = dm.R(3), coordinates = {"theta", "r", "z"}, L = function(q, v)
  local r, z = q[2], q[3]
  local R = (r^2 + z^2)^0.5
  return (v[2]^2 + r^2*v[1]^2 + v[3]^2)/2 + 1/R - J2/R^3*(1.5*z^2/R^2 - 0.5)
end }
print(satellite)]] },
    { "Reduced: two dimensions, and the centrifugal force of mu in the potential.", [[
shape = satellite:routh { cyclic = {"theta"}, mu = 0.96 }
print(shape)
x, y = {}, {}
for i = 1, 100 do x[i] = 0.45 + 0.02*i; y[i] = shape:amended_potential { x[i], 0 } end
dm.plot(x, y, { height = 12, xlabel = "r", ylabel = "amended potential at z = 0" })]] },
    { "It moves in that well, up and down through the equator:", [[
reduced = shape:solver { rule = "gauss(2)", h = h }:run { q = {1, 0}, v = {0, 0.28}, t = 200 }
reduced:plot("r", "z", { height = 14, width = 60 })]] },
    { "The angle comes back by sums over the stages. Beside it, the whole system without "
      .. "reduction:", [[
full = reduced:reconstruct()
start = { q = {0, 1, 0}, v = {0.96, 0, 0.28}, t = 200 }
direct = satellite:solver { rule = "gauss(2)", h = h }:run(start)
apart = dm.compare(full, direct)
print(apart)
off = (full.q[#full] - direct.q[#direct]):norm()]] },
  },
  claim = function(e)
    return e.off < 1e-9,
      ([[After %d steps the two are %.0e apart, in an angle that has turned %.0f times round:
      round-off. The reduced system has two unknowns in place of three.]])
        :format(e.reduced.steps, e.off, e.full.q[#e.full][1] / (2 * math.pi))
  end,
}
