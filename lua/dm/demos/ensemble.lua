-- ensembles in vector registers and threads
return {
  title = "Many at once: a cloud of pendulums",
  about = [[The same system from many starts: members go side by side through vector registers and
    over all cores, and each ends with the bits it would have alone. A cloud of starts keeps its
    area (Liouville), but winds itself up.]],
  numbers = { { name = "members", value = 2000, least = 10, most = 20000, what = "how many" },
    { name = "t", value = 40, least = 1, most = 2000, what = "how long" } },
  steps = {
    { "Starts in a disk, numbered random numbers: member i has the same ones in any order.", [[
pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
dice = dm.random(7)
function angle(i) return 2*math.pi*dice:uniform(i, 1) end
function radius(i) return 0.35*dice:uniform(i, 2)^0.5 end
function start_q(i) return {1.4 + radius(i)*math.cos(angle(i))} end
function start_v(i) return {radius(i)*math.sin(angle(i))} end
solver = pendulum:solver { rule = "verlet", h = 0.05 }]] },
    { "", [[
clock = dm.clock()
cloud = solver:ensemble { members = members, t = t, q = start_q, v = start_v }
took = dm.clock() - clock
print(cloud)
q, p = {}, {}
for i = 1, members do q[i], p[i] = cloud.q[i][1], cloud.p[i][1] end
dm.plot(q, p, { style = "points", width = 64, height = 18, xlabel = "q", ylabel = "p" })]] },
    { "One of them again, alone:", [[
i = members
alone = solver:run { q = start_q(i), v = start_v(i), t = t }
same = alone.q[#alone][1] == cloud.q[i][1] and alone.p[#alone][1] == cloud.p[i][1]
print("the same bits:", same)]] },
  },
  claim = function(e)
    local steps = e.members * e.t / 0.05
    return e.same,
      ([[%d members, %.3g steps in all, in %.3f s: %.2f ns a step, starts included. Member %d is,
      bit for bit, what a run of its own gives.]])
        :format(e.members, steps, e.took, 1e9 * e.took / steps, e.members)
  end,
}
