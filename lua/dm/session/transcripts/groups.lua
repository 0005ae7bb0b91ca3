--- Examples of groups, actions, moving frames and what is invariant.
local M = {}

M["dm.GL"] = [=[
> G = dm.GL(2)
> G.dimension
4
> G:exp { 0, 1, 0, 0 }
[[1, 1],
 [0, 1]]]=]

M["dm.Heisenberg"] = [=[
> H = dm.Heisenberg(1)
> H:compose({ 1, 0, 0 }, { 0, 1, 0 })
[1, 1, 0.5]
> H:ad({ 1, 0, 0 }, { 0, 1, 0 })
[0, 0, 1]]=]

M["dm.S"] = [=[
> S = dm.S(2)
> S.dimension
2
> S:log({ 1, 0, 0 }, { 0, 1, 0 })
[0, 1.5707963267949, 0]]=]

M["dm.SL"] = [=[
> G = dm.SL(2)
> G:exp { 0, 1, 0 }
[[1, 1],
 [0, 1]]
> G:exp { 0.7, 0.2, -0.4 }:det()
1.0]=]

M["dm.SU"] = [=[
> G = dm.SU(2)
> G:exp({ 0, 0, 2*math.pi })[1], G:exp({ 0, 0, 4*math.pi })[1]
-1.0	1.0]=]

M["dm.Sp"] = [=[
> dm.Sp(2).dimension, dm.Sp(4).dimension
3	10
> dm.Sp(2):exp { 0, 1, 0 }
[[1, 1],
 [0, 1]]]=]

M["dm.T"] = [=[
> T = dm.T(2)
> s = dm.system { Q = T, L = function(q, v) return v:dot(v)/2 + math.cos(q[1] - q[2]) end }
> s
system on T^2: separable, constant mass, 7 operations, derivatives exact]=]

M["dm.group"] = [=[
> H = dm.group { name = "Heisenberg", basis = {
>>   { { 0, 1, 0 }, { 0, 0, 0 }, { 0, 0, 0 } },
>>   { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 } },
>>   { { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 0 } } } }
> H:ad({ 1, 0, 0 }, { 0, 1, 0 })
[0, 0, 1]]=]

M["dm.product"] = [=[
> G = dm.product(dm.SO(2), dm.R(2))
> G.dimension
3
> G:exp { 0.5, 1, 2 }
{ 0.5, [1, 2] }]=]

M["dm.semidirect"] = [=[
> E2 = dm.semidirect(dm.SO(2), dm.R(2))
> g = { math.pi/2, { 0, 0 } }
> E2:compose(g, { 0, { 0, 1 } })[2][1]
-1.0]=]

M["dm.action"] = [=[
> turns = dm.action { group = dm.SO(2), on = dm.R(2) }
> turns(math.pi, { 1, 2 })
[-1, -2]
> turns:momentum({ 1, 0 }, { 0, 3 })
[3]]=]

M["action.act"] = [=[
> turns = dm.action { group = dm.SO(2), on = dm.R(2) }
> turns:act(math.pi, { 1, 2 })
[-1, -2]]=]

M["action.cotangent"] = [=[
> stretch = dm.action { group = dm.R(1), on = dm.R(1),
>>   map = function(g, z) return { math.exp(g[1])*z[1] } end }
> stretch:cotangent()({ math.log(2) }, { 3, 5 })
[6, 2.5]]=]

M["action.free"] = [=[
> turns = dm.action { group = dm.SO(2), on = dm.R(2) }
> turns:free { 1, 2 }, turns:free { 0, 0 }
true	false]=]

M["action.generator"] = [=[
> turns = dm.action { group = dm.SO(2), on = dm.R(2) }
> turns:generator { 3, 4 }
[[-4],
 [ 3]]]=]

M["action.invariant"] = [=[
> turns = dm.action { group = dm.SO(2), on = dm.R(2) }
> (turns:invariant(function(z) return z[1]^2 + z[2]^2 end))
true
> found, violation = turns:invariant(function(z) return z[1] end)
> found
false]=]

M["action.isotropy"] = [=[
> turns = dm.action { group = dm.SO(3), on = dm.R(3) }
> turns:isotropy { 0, 0, 2 }
{ basis = { [0, 0, 1] }, dimension = 1, orbit_dimension = 2 }]=]

M["action.jet"] = [=[
> shifts = dm.action { group = dm.R(2), on = dm.R(2) }
> shifts:jet(2, { independent = 1 })({ 1, 10 }, { 0, 0, 3, 4 })
[1, 10, 3, 4]]=]

M["action.momentum"] = [=[
> turns = dm.action { group = dm.SO(3), on = dm.R(3) }
> turns:momentum({ 1, 0, 0 }, { 0, 2, 0 })
[0, 0, 2]]=]

M["action.on_pairs"] = [=[
> shifts = dm.action { group = dm.R(1), on = dm.R(1) }
> shifts:on_pairs()({ 1 }, { 3, 4 })
[4, 5]]=]

M["action.on_points"] = [=[
> shifts = dm.action { group = dm.R(2), on = dm.R(2) }
> three = shifts:on_points(3)
> three.points, three.dimension
3	6
> three({ 1, 10 }, { 0, 0, 1, 1, 2, 2 })
[1, 10, 2, 11, 3, 12]]=]

M["action.tangent"] = [=[
> stretch = dm.action { group = dm.R(1), on = dm.R(1),
>>   map = function(g, z) return { math.exp(g[1])*z[1] } end }
> stretch:tangent()({ math.log(2) }, { 3, 5 })
[6, 10]]=]

M["action.transitive"] = [=[
> dm.action { group = dm.SO(2), on = dm.R(2) }:transitive { 1, 0 }
false
> dm.action { group = dm.SE(2), on = dm.R(2) }:transitive { 1, 0 }
true]=]

M["dm.moving_frame"] = [=[
> rho = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:invariants({ 1, 1 }, { 4, 5 })[2][1]
5.0]=]

M["dm.frame"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho
moving frame of SE(2) on 2 points of R^2, solved for
> rho({ 1, 1 }, { 1, 3 })
[-1, 1, -1.5707963267949]]=]

M["frame.check"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:check { samples = 3 } < 1e-9
true]=]

M["frame.correction"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:correction({ 0, 0 }, { 1, 0 }, { 2, 0 })
[-1, 0, 0]]=]

M["frame.derivative_correction"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> C, changes = rho:derivative_correction({ { 0, 0 }, { 2, 0 } }, { { 0, 0 }, { 1, 3 } })
> changes
{ [0, 0], [1, 0] }]=]

M["frame.invariantize"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> f = rho:invariantize(function(a, b) return b[1] end)
> f({ 1, 1 }, { 4, 5 })
5.0]=]

M["frame.invariants"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:invariants({ 1, 1 }, { 4, 5 }, { 1, 6 })[3]
[4, 3]]=]

M["frame.phantom"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:phantom()
{ { 0, 0 }, { false, 0 } }]=]

M["frame.syzygies"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:syzygies { { 1, 1 }, { 4, 5 }, { 6, 6 } }.shift < 1e-12
true]=]

M["frame.tangent"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> rho:tangent({ 0, 0 }, { 2, 0 })
[[ 0,  0,  0,  0],
 [ 0,  0,  0,  0],
 [-1,  0,  1,  0],
 [ 0,  0,  0,  0]]]=]

M["frame.transversality"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> rho = dm.moving_frame { action = moves, points = 2,
>>   cross_section = function(a, b) return { a[1], a[2], b[2] } end,
>>   branch = function(a, b) return b[1] end }
> J, condition = rho:transversality({ 0, 0 }, { 1, 0 })
> J
[[1, 0, 0],
 [0, 1, 0],
 [0, 1, 1]]]=]

M["dm.differential_invariants"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d
differential invariants of the left action of SE(2) on R^2: kappa = iota(u_xx)
> d:euler_lagrange(function(I) return I.kappa[1]^2/2 end)
kappa_ss + kappa^3/2]=]

M["dm.calculus"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d.names
{ "kappa" }]=]

M["calculus.conservation_law"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> law = d:conservation_law(function(I) return I.kappa[1]^2/2 end)
> law
v_1 = -kappa^2/2
v_2 = -kappa_s
v_3 = kappa]=]

M["calculus.euler_lagrange"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:euler_lagrange(function(I) return I.kappa[1]^2/2 end)
kappa_ss + kappa^3/2]=]

M["calculus.extremal"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> circle = d:extremal { L = function(I) return I.kappa[1]^2/2 + 1/2 end, length = math.pi,
>>   start = { kappa = { 1, 0 } }, steps = 40 }
> circle.points[#circle.points][2]
2.0]=]

M["calculus.invariants"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:invariants { 0, 0, 0, 1/2 }
{ kappa = { 0.5 } }]=]

M["calculus.iota"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:iota(6)
kappa_ss + 3 kappa^3]=]

M["calculus.maurer_cartan"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:maurer_cartan()
R^1 = -1
R^2 = 0
R^3 = -kappa]=]

M["calculus.operator"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> H, adjoint = d:operator()
> H
kappa: D^2 + kappa^2]=]

M["calculus.recurrence"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:recurrence()
D iota(x) - 1 = -1
D iota(u) - iota(u_x) = 0
D iota(u_x) - iota(u_xx) = -kappa
D iota(u_xx) - iota(u_xxx) = 0]=]

M["calculus.syzygies"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:syzygies()
no syzygies: the invariants are free, nothing relates them and their derivatives]=]

M["dm.formula"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> E = d:euler_lagrange(function(I) return I.kappa[1]^2/2 end)
> #E, E == d:euler_lagrange(function(I) return I.kappa[1]^2/2 end)
1	true]=]

M["formula.tex"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> d:euler_lagrange(function(I) return I.kappa[1]^2/2 end):tex()
\kappa_{ss} + \frac{\kappa^{3}}{2}]=]

M["formula.value"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> E = d:euler_lagrange(function(I) return I.kappa[1]^2/2 end)
> E:value { kappa = { 2, 0, 0 } }
[4]]=]

M["dm.invariant_operator"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> H = d:operator()
> H.rows, H.columns
1	1]=]

M["invariant_operator.coefficient"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> H = d:operator()
> H:coefficient(1, 1, 0), H:coefficient(1, 1, 2)
kappa^2	1]=]

M["invariant_operator.tex"] = [=[
> moves = dm.action { group = dm.SE(2), on = dm.R(2) }
> d = dm.differential_invariants { action = moves, independent = 1,
>>   cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
> H = d:operator()
> H:tex()
\mathcal{D}^{2} + \kappa^{2}]=]

M["dm.pair"] = [=[
> g, h = dm.pair(1, 2), dm.pair(2, 5)
> g*h, g:inverse()
(1, 5)	(2, 1)]=]

return M
