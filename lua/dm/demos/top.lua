-- rigid bodies on SO(3): a heavy top, nutation from its closed form, momenta to rounding
return {
  title = "A spinning top",
  about = [[Its configuration is a rotation, so that is its space: dm.SO(3), with the velocity of
    the body. No angles, no poles; a Gauss method steps the unit quaternion behind it and keeps
    energy and both momenta. How far it nods is a root of a cubic.]],
  numbers = { { name = "spin", value = 1.6, least = 0.5, most = 6,
    what = "momentum about its axis" },
    { name = "tilt", value = 0.5, least = 0.1, most = 1.4,
      what = "of its axis at the start, rad" } },
  steps = {
    { "L of the rotation R and the velocity w in the axes of the body.", [[
G = dm.SO(3)
top = dm.system { Q = G,
  L = function(R, w) return (w[1]^2 + w[2]^2 + 0.4*w[3]^2)/2 - R[3][3] end }]] },
    { "Spun and let go: where the end of its axis goes, from above.", [[
solver = top:solver { rule = "gauss(6)", h = 0.05 }
path = solver:run { q = G:exp {tilt, 0, 0}, p = {0, 0, spin}, t = 40,
  events = { nod = function(R, w) return R[3][1]*w[2] - R[3][2]*w[1] end } }
path:plot("R13", "R23", { width = 60, height = 20, equal = true })]] },
    { "How far it nods, and the root of 2 (1 - u^2) = spin^2 (cos tilt - u).", [[
c = math.cos(tilt)
theory = (spin^2 - (spin^4 - 8*spin^2*c + 16)^0.5)/4
lowest = 1
for _, event in ipairs(path.events) do lowest = math.min(lowest, event.q[3][3]) end
print("lowest", lowest, "theory", theory)
print("vertical momentum", path:drift(path:momentum(dm.SO(2))).largest)
print("energy", path:drift "energy".largest)]] },
  },
  claim = function(e)
    local off = math.abs(e.lowest - e.theory)
    local J = e.path:drift(e.path:momentum(require "dm".SO(2))).largest
    return off < 1e-8 and J < 1e-12,
      ([[It nods down to cos theta = %.6f, theory says %.6f; the vertical momentum moved by %.0e.
      Faster spin, smaller nod. path:animate "top.html" shows it in a browser.]])
        :format(e.lowest, e.theory, J)
  end,
}
