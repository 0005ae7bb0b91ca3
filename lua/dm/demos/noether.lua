-- Noether's theorem for discrete Lagrangians (Marsden & West 2001, 1.3.3)
return {
  title = "Noether: a symmetry keeps a momentum",
  about = [[When turning everything changes nothing, angular momentum stays. A variational method
    has the symmetries of its Lagrangian, so it keeps the momentum exactly, whatever its step. A
    method that does not come from an action has no such reason.]],
  numbers = { { name = "squash", value = 0.0, least = 0, most = 0.5,
    what = "how much the attraction lacks its symmetry" },
    { name = "h", value = 0.15, least = 0.001, most = 0.3, what = "step" } },
  steps = {
    { "A planet. With squash = 0 the potential depends on the distance alone.", [[
planet = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v)/2 + 1/(q[1]^2 + (1 + squash)*q[2]^2)^0.5
end }
start = { q = {0.5, 0}, v = {0, 1.7}, steps = 3000 }]] },
    { "The same coarse step by a variational rule, and by RK4.", [[
variational = planet:solver { rule = "verlet", h = h }:run(start)
rk4 = planet:solver { rule = "rk4", h = h }:run(start)
J, K = variational:momentum(dm.SO(2)), rk4:momentum(dm.SO(2))
lines = { variational:series("t", J, "verlet"), rk4:series("t", K, "RK4") }
dm.plot(lines, { height = 14, title = "angular momentum" })]] },
    { "How far each went from where it began:", [[
function change(x)
  local worst = 0
  for i = 1, #x do worst = math.max(worst, math.abs(x[i] - x[1])) end
  return worst
end
print("verlet", change(J))
print("RK4", change(K))]] },
  },
  claim = function(e)
    local kept, lost = e.change(e.J), e.change(e.K)
    if e.squash == 0 then
      return kept < 1e-12 and lost > 1e-4,
        ([[Verlet keeps the angular momentum to %.0e, which is round-off; RK4, of twice the order,
        loses %.1e of it. Give squash a value: without the symmetry nothing is kept, and
        nothing should be.]]):format(kept, lost)
    end
    return kept > 1e-3,
      ([[With squash = %g there is no symmetry, and the angular momentum moves by %.2g. It is not
      the method that keeps it, it is the symmetry.]]):format(e.squash, kept)
  end,
}
