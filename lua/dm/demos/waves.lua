-- a packet at a hill: what gets through, what is kept, what the step costs
return {
  title = "Waves: a packet meets a hill that it cannot climb",
  about = [[i psi_t = -psi_xx/2 + V psi on a ring of 256 points, by Fourier transforms. Strang's
    splitting gives psi half a kick by V, a drift, and half a kick: each is exact, and keeps the
    norm.]],
  numbers = { { name = "k", value = 2, least = 1, most = 4, what = "wave number; the hill is 4" } },
  steps = {
    { "The equation, with V as a function of x:", [[
wave = dm.schroedinger { x = {-40, 40, 256}, V = function(x) return 4 * math.exp(-x^2) end }
print(wave)]] },
    { "A packet from the left; psi returns its real and its imaginary part.", [[
function packet(x)
  local a = math.exp(-(x + 12)^2/8)
  return a * math.cos(k*x), a * math.sin(k*x)
end
path = wave:solver { rule = "strang", h = 0.02 }:run { psi = packet, t = 24/k, every = 10 }
path:plot("density", { height = 16 })]] },
    { "x across, t up:", [[
path:spacetime()]] },
    { "Norm and energy, and what is behind the hill at the end:", [[
kept = path:drift("norm").largest
last, behind = path.psi[#path]:abs2(), 0
for j = 129, 256 do behind = behind + last[j] * wave.weight[j] end
through = behind / path:column("norm")[1]
print(kept, path:drift("energy").largest, through)]] },
    { "Crank and Nicolson keep the energy, too, but turn the phases by other angles:", [[
other = wave:solver { rule = "crank-nicolson", h = 0.02 }:run { psi = packet, t = 24/k, every = 10 }
print(other:drift("energy").largest, (other.psi[#other] - path.psi[#path]):norm())]] },
  },
  claim = function(e)
    return e.kept < 1e-11 and e.through > 0 and e.through < 1
      and e.other:drift("energy").largest < 1e-11,
      ("The norm stays to %.0e; %.3f of the wave is behind the hill. Try k = %g.")
        :format(e.kept, e.through, e.k < 3 and e.k + 1 or e.k - 1)
  end,
}
