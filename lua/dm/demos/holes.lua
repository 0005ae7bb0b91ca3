-- holes, counted in integers and heard in fields: homology, harmonic forms, potentials (Leok 3.11)
return {
  title = "Holes: how a mesh knows them, in integers",
  about = [[A field without curl is a slope, unless it goes round a hole. Homology counts the holes
    in integers, a harmonic form goes round each, and the Poincare lemma gives the potential where
    there is none.]],
  numbers = { { name = "rings", value = 3, least = 1, most = 12, what = "rings of the annulus" },
    { name = "m", value = 16, least = 5, most = 48, what = "vertices of a ring" } },
  steps = {
    { "A ring, a Klein bottle, and how many holes they have:", [[
ring, klein = dm.mesh { annulus = { rings, m }, ratio = 2 }, dm.mesh { klein = 4 }
print(ring:betti())
print(klein:betti(), klein:homology(1).torsion)]] },
    { "The loop round the hole, and the field that goes round it without swirl or source:", [[
loop, h = ring:generators(1)[1], ring:harmonic(1)[1]
print(loop)
period = h:pair(loop)
print(h:d():max(), h:delta():max(), period)]] },
    { "It has no potential: that number is in the way.", [[
fine, why = pcall(ring.potential, ring, h)
print(why)]] },
    { "A disc has potentials for all that is closed, by a cone in integers:", [[
disc = dm.mesh { shells = { 2, 3 } }
p = disc:cone()
a = disc:form(0, function(x, y) return x * x - 3 * y end):d()
b = disc:potential(a)
print(p, p:check(), (b:d() - a):max())]] },
  },
  claim = function(e)
    local betti = e.ring:betti()
    return betti[1] == 1 and betti[2] == 1 and betti[3] == 0 and not e.fine and e.p:check() == 0
      and (e.b:d() - e.a):max() < 1e-12,
      ([[the ring has one hole, and the period of its field round it is %.4f; on the disc d p + p d
      = 1 without an error, and a potential was found to %.0e.]])
        :format(e.period, (e.b:d() - e.a):max())
  end,
}
