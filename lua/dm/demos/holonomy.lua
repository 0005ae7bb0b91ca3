-- discrete connections and their holonomy (Leok 4)
return {
  title = "Holonomy: a turn that no momentum made",
  about = [[A cat that is dropped without spin bends, twists, straightens, and has turned. What
    moves is its shape; that the angular momentum stays zero says how the body follows: a
    connection. Its discrete form takes two shapes to a turn. Round a loop of shapes the turns
    do not cancel, and what is left is the holonomy: for a small loop, minus its area times
    the curvature.]],
  numbers = { { name = "radius", value = 0.7, least = 0.05, most = 1,
      what = "of the loop in the plane of the two joints" },
    { name = "points", value = 32, least = 8, most = 256, what = "points of the loop" } },
  steps = {
    { "Three rods, two joints. No momentum is ever there, theta is cyclic.", [[
cat = dm.system { Q = dm.R(3), coordinates = {"theta", "a1", "a2"}, L = function(q, v)
  local w1, w2 = v[1] + v[2], v[1] + v[3]
  local u = dm.vector { -0.4*dm.sin(q[2])*w1, v[1]/2 + 0.4*dm.cos(q[2])*w1 }
  local w = dm.vector { 0.4*dm.sin(q[3])*w2, -v[1]/2 - 0.4*dm.cos(q[3])*w2 }
  return 0.3*(u:dot(u) + w:dot(w)) - 0.36/4.4*(u + w):dot(u + w) + v[1]^2/24 + 0.016*(w1^2 + w2^2)
end }
A = dm.discrete_lagrangian(cat, { rule = "midpoint", h = 0.1 }):connection { cyclic = {"theta"} }
print(A)]] },
    { "A loop of shapes, and where it leads: the lift of the loop from theta = 0.", [[
loop = {}
for i = 0, points do
  local s = 2*math.pi*i/points
  loop[i + 1] = { 0.5 + radius*math.cos(s), -0.4 + radius*math.sin(s) }
end
lifted = A:multi_lift(loop, { 0, loop[1][1], loop[1][2] })
at, theta = {}, {}
for i = 1, #lifted do at[i], theta[i] = i - 1, lifted[i][1] end
turn = A:holonomy(loop)[1]
dm.plot(at, theta, { height = 12, xlabel = "point of the loop", ylabel = "theta" })]] },
    { "The same loop by the continuous connection, and by curvature times area.", [[
exact = cat:routh { cyclic = "theta", mu = 0 }:holonomy(function(s)
  return { 0.5 + radius*dm.cos(2*math.pi*s), -0.4 + radius*dm.sin(2*math.pi*s) }
end)[1]
flat = -A:curvature({ 0.5, -0.4 }, 1, 2)[1]*math.pi*radius^2
print(("turn %.6f   continuous %.6f   -curvature x area %.6f"):format(turn, exact, flat))]] },
    { "A mesh has a connection of its own: a vector carried round a vertex turns by 2 pi less the "
      .. "sum of its angles. All of them make 4 pi on a sphere, however it is bent.", [[
potato = dm.mesh { icosphere = 3, map = function(x, y, z)
  return { x*(1 + 0.3*math.sin(3*z)), y, z }
end }
total = 0
for _, deficit in ipairs(potato:levi_civita():angle()) do total = total + deficit end
print(total/(4*math.pi))]] },
  },
  claim = function(e)
    local off = math.abs(e.turn - e.exact)
    local allowed = 2.5 * math.abs(e.exact) * (32 / e.points) ^ 2 / 30 + 1e-12
    return off < allowed and math.abs(e.total - 4 * math.pi) < 1e-10,
      ([[Round the loop of %d points the cat has turned by %.6f rad, with no momentum at any time:
      within %.0e of the continuous connection, and four times nearer with twice the points.]])
        :format(e.points, e.turn, off)
  end,
}
