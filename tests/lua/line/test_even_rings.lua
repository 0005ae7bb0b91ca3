-- KdV on rings of an even number of nodes: a row that averages a component does not tell (-1)^i of it; starts on their rows are taken,
-- others moved there or refused, as on odd rings
local dm, tap = require "dm", require "tap"
local ok, raises = tap.ok, tap.raises
local abs, max = math.abs, math.max
local function kdv(N)
  return dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, x = { -20, 20, N, periodic = true },
    M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
    S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }
end
local function u(x) return 2 / dm.cosh(x) ^ 2 end
local function v(x) return -4 * dm.tanh(x) / dm.cosh(x) ^ 2 end              -- u_x
local function run(N, z, steps) return kdv(N):solver { h = 0.02 }:run { z = z, steps = steps or 20 } end
local function apart(a, b) local w = 0 for i = 1, #a do w = max(w, abs(a[i] - b[i])) end return w end
local function off_row(r, k)                                                -- of v = u_x, between means and differences
  local w, N, dx = 0, #r.nodes, r.nodes[2] - r.nodes[1]
  for i = 1, N do local j = i % N + 1 w = max(w, abs((r.v[k][i] + r.v[k][j]) / 2 - (r.u[k][j] - r.u[k][i]) / dx)) end
  return w
end

-- a start that satisfies all rows to round-off: u without (-1)^i, v from its differences
local N, U, V = 128, {}, {}
local dx, alt, kink = 40 / N, 0, 0
for i = 1, N do U[i] = u(-20 + (i - 1) * dx) alt = alt + (-1) ^ i * U[i] / N end
for i = 1, N do U[i] = U[i] - (-1) ^ i * alt end
V[1] = 0
for i = 2, N do V[i] = 2 * (U[i] - U[i - 1]) / dx - V[i - 1] end
for i = 1, N do kink = kink + (-1) ^ i * V[i] / N end
for i = 1, N do V[i] = V[i] - (-1) ^ i * kink end
local exact, left_out = run(N, { u = U, v = V }), run(N, { u = U })
ok(next(exact.moved) == nil and apart(exact.v[1], dm.vector(V)) < 1e-13, "a start on all rows is taken as it is")
ok(apart(exact.u[21], left_out.u[21]) < 1e-12, "u does not depend on whether v is given")
ok(off_row(left_out, 1) < 1e-11 and off_row(left_out, 21) < 1e-9, "v that is left out begins on its row, and stays there", off_row(left_out, 1))
ok(apart(left_out.v[1], exact.v[1]) < 1e-5, "near to the one that is given", apart(left_out.v[1], exact.v[1]))
local again = run(N, { u = left_out.u[1], v = left_out.v[1], w = left_out.w[1] })
ok(next(again.moved) == nil and apart(again.v[21], left_out.v[21]) < 1e-9, "the first row of a run is such a start")

-- v of the equation, sampled: moved as on a ring of one node more, and no level goes to and fro by more than there
local even, odd = run(128, { u = u, v = v }), run(129, { u = u, v = v })
ok(abs(even.moved.v - odd.moved.v) < 0.1 * odd.moved.v, "v at nodes is moved onto its row", even.moved.v)
local function roughness(r)
  local w = 0
  for k = 2, #r - 1 do w = max(w, apart(r.v[k + 1] + r.v[k - 1], 2 * r.v[k])) end
  return w
end
ok(roughness(even) < 1.3 * roughness(odd), "and does not go to and fro", roughness(even) / roughness(odd))
for _, cells in ipairs { 128, 129 } do
  raises("leave 'v' out", function() run(cells, { u = u, v = 0 }, 1) end)
  raises("leave 'v' out", function() run(cells, { u = u, v = function(x) return 1.6 * v(x) end }, 1) end)
end
tap.done()
