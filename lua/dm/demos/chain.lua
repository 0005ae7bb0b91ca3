-- long chains: dm.sum_over keeps sums as loops; a soliton of Toda's chain (1967)
return {
  title = "Chains: a soliton through a thousand bodies",
  about = [[Sums over equal bodies stay loops in the kernels, so a chain of thousands costs what its
    bodies cost. Toda's chain has waves that keep their shape: of height sinh(w)^2 they run at
    sinh(w)/w bodies a unit of time, high ones faster.]],
  numbers = { { name = "w", value = 0.8, least = 0.3, most = 1.5,
    what = "width parameter of the wave" },
    { name = "N", value = 1000, least = 400, most = 5000, what = "bodies" } },
  steps = {
    { "Each body feels the next one.", [[
chain = dm.system { Q = dm.R(N), L = function(q, v)
  return dm.sum_over(v, function(u) return u^2/2 end)
    - dm.sum_over(q, function(a, b) return math.exp(a - b) - (a - b) - 1 end, { shift = 1 })
end }
print(chain)]] },
    { "The soliton at body 60, exactly, and its motion until it is near body 300:", [[
function tau(n)
  local x = 2*w*(n - 60)
  return math.max(x, 0) + math.log(1 + math.exp(-math.abs(x)))
end
function rate(n) return -2*dm.sinh(w)/(1 + math.exp(-2*w*(n - 60))) end
q, v = dm.vector(N), dm.vector(N)
for n = 1, N do q[n], v[n] = tau(n - 1) - tau(n), rate(n - 1) - rate(n) end
t = 240*w/dm.sinh(w)
path = chain:solver { rule = "blanes-moan(6)", h = 0.1 }:run { q = q, v = v, at = {0, t} }
print(path)]] },
    { "Its strain at both times:", [[
function strain(row, n) return math.exp(row[n] - row[n+1]) - 1 end
x, before, after = {}, {}, {}
for n = 30, 330 do
  x[#x+1], before[#x+1], after[#x+1] = n, strain(path.q[1], n), strain(path.q[2], n)
end
lines = { { x = x, y = before, name = "at first" }, { x = x, y = after, name = "at the end" } }
dm.plot(lines, { height = 14, xlabel = "body", ylabel = "strain" })]] },
  },
  claim = function(e)
    local off = 0
    for k = 1, #e.x - 240 do off = math.max(off, math.abs(e.after[k + 240] - e.before[k])) end
    return off < 1e-5,
      ([[240 bodies on, the wave of height %.3f has its shape to %.0e: nothing was left behind.]])
        :format(e.dm.sinh(e.w) ^ 2, off)
  end,
}
