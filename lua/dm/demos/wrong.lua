-- bounded, and wrong: Verlet keeps its energy and loses its phase
return {
  title = "Wrong: bounded is not right",
  about = [[A symplectic rule keeps the energy in a band for ever, and may yet be at the wrong
    place: its oscillations are a little too fast. A map over a duration knows the difference. It
    compares every cell with a flow on which two unlike rules agree.]],
  numbers = { { name = "h", value = 0.1, least = 0.02, most = 0.5, what = "step" },
    { name = "t", value = 100, least = 10, most = 1000, what = "duration" } },
  steps = {
    { "An oscillator, and Verlet with a step that looks small:", [[
oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2)/2 end }
path = oscillator:solver { rule = "verlet", h = h }:run { q = {1}, v = {0}, t = t }
print(path:drift "energy")]] },
    { "Its energy is fine. Its position?", [[
cell = oscillator:stability { q = {1}, v = {0}, rule = "verlet", h = h, t = t }:at(1, 1)
print(cell.why)]] },
    { "Up to which step is it right, to a hundredth of the range, and up to which bounded?", [[
map = oscillator:stability { q = {1}, v = {0}, rule = "verlet", h = {0.01, 2.1, 30, "log"}, t = t }
map:plot()
right, bounded = map:limit(1, "right"), map:limit(1)
print(right, bounded)]] },
  },
  claim = function(e)
    local ahead = e.t * (2 / e.h * math.asin(e.h / 2) - 1)
    return math.abs(e.cell.phase - ahead) < 1e-6 and e.right < e.bounded,
      ([[Verlet is ahead by %.7f after %g; its frequency is 2 asin(h/2)/h in place of 1, which makes
      %.7f. It is right to a hundredth up to h = %.4f, and bounded up to %.4f.]])
        :format(e.cell.phase, e.t, ahead, e.right, e.bounded)
  end,
}
