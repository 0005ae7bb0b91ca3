-- dm.stability: limits against theory, classes by evidence, axes and parameters, pictures and files; then misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, abs, huge = math.sqrt, math.abs, math.huge

local function spring(k) return dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - k * q[1] ^ 2) / 2 end } end
local function with(base, more)
  local out = {}
  for key, value in pairs(base) do out[key] = value end
  for key, value in pairs(more) do out[key] = value end
  return out
end

-- limits of the oscillator within a thousandth, by three ways to name a parameter
local base = { system = spring, k = { 1e2, 1e6, 5, "log" }, h = { 1e-3, 1, 31, "log" }, q = { 1 }, v = { 0 }, steps = 2000 }
local map = dm.stability(with(base, { rule = "verlet" }))
for i, k in ipairs(map.k) do
  near(map:limit(i) * sqrt(k), 2, 0.004, ("Verlet, k = %.0f: h omega = 2"):format(k))
  near(map:theory(i) * sqrt(k), 2, 1e-5, "and so says the theory drawn beside it")
end
ok(#map.k == 5 and #map.h == 31 and #map.rows == 5 and map:limit { k = 1e2 } == map:limit(1), "axes, rows, a row by its value")
local _, told = map:limit(1)
ok(told:find "blow%-up from h = 0%.200", "the limit says what is beyond", told)
map = dm.stability(with(base, { rules = { "yoshida(4)", "suzuki(4)", "midpoint", "gauss(2)", "trapezoidal" }, k = { 1e4 }, h = { 1e-3, 10, 61, "log" } }))
near(map:limit { rule = "yoshida(4)" } * 100, 1.5734, 0.004, "Yoshida 4: the root of its trace, 1.5734")
near(map:limit { rule = "suzuki(4)" } * 100, 2.7210, 0.004, "Suzuki 4")
near(map:limit { rule = "trapezoidal" } * 100, 2, 0.004, "the trapezoidal discrete Lagrangian is Verlet")
ok(map:limit { rule = "midpoint" } == huge and map:limit { rule = "gauss(2)" } == huge, "midpoint and Gauss: none up to h omega = 1000")

-- the theory of one oscillation is not that of two that a magnetic field couples, but for rules that take linear systems apart
local charged = dm.system { Q = dm.R(2), params = { B = 0, k = 1 }, L = function(q, v, _, P)
  return v:dot(v) / 2 + P.B * (q[1] * v[2] - q[2] * v[1]) / 2 - P.k * q:dot(q) / 2
end }
local field = charged:stability { rules = { "symplectic-euler", "rk4", "yoshida(4, midpoint)" }, q = { 1, 0 }, v = { 0, 0.5 }, B = { 0, 2 },
  h = { 0.5, 3, 12, "log" }, steps = 300 }
near(field:theory { rule = "symplectic-euler", B = 0 }, 2, 1e-5, "without a field the theory of symplectic Euler")
local none, coupled = field:theory { rule = "symplectic-euler", B = 2 }
ok(none == nil and coupled:find "couples the oscillations", "with a field none", coupled)
near(field:limit { rule = "rk4", B = 2 }, field:theory { rule = "rk4", B = 2 }, 0.004, "but that of RK4 holds")
ok(field:theory { rule = "yoshida(4, midpoint)", B = 2 } ~= nil, "and of a composition of midpoint steps")
local panels, print_ = {}, print
_G.print = function(text) panels[#panels + 1] = text end
charged:stability({ rule = "verlet", q = { 1, 0 }, v = { 0, 0.5 }, B = { 0, 2, 13, "linear" }, k = { 1, 2 }, h = { 0.5, 1 }, steps = 9 }):plot()
_G.print = print_
ok(panels[#panels] == "(12 of 13 panels)", "a plot says of how many panels it is", panels[#panels])

local params = dm.system { Q = dm.R(1), params = { k = 1, m = 1 }, L = function(q, v, _, P) return (P.m * v[1] ^ 2 - P.k * q[1] ^ 2) / 2 end }
map = params:stability { k = { 1, 4 }, m = { 0.25, 1 }, rule = "verlet", h = { 0.1, 10, 21, "log" }, q = { 1 }, p = { 0 }, t = 300 }
for i, row in ipairs(map.rows) do
  near(map:limit(i) * sqrt(row.values.k / row.values.m), 2, 0.01, ("two parameters of the system: k = %g, m = %g"):format(row.values.k, row.values.m))
end
ok(#map.rows == 4, "a row for each pair")

-- classes, and why
local cell = map:at({ k = 1, m = 1 }, 0.2)
ok(cell.class == "wrong" and cell.k == 1 and cell.error > 0 and cell.error < 0.1, "bounded, with the energy error, and wrong", cell.why)
near(cell.error, 0.5 * (1 / (1 - cell.h ^ 2 / 4) - 1) * (1 - cell.h ^ 2 / 4), 0.01 * cell.error + 1e-12, "the energy error of Verlet on the oscillator, h^2/8")
cell = dm.stability(with(base, { rule = "verlet", k = 1e6 })):at(1, 31)
ok(cell.class == "blow-up" and cell.code == "not_finite" and cell.why:find "step %d+", "blow-up, with its step", cell.why)
local weak = dm.stability { system = spring(1), rule = "verlet", h = 2.0001, q = { 1 }, v = { 0 }, steps = 2000, refine = false }:at(1, 1)
local c = 2.0001 ^ 2 / 2 - 1
near(weak.growth, (c + sqrt(c * c - 1)) ^ 2, 5e-4, "the energy of a weak instability grows by the square of the root")
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local orbit = { q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 400 }
map = kepler:stability(with(orbit, { rules = { "verlet", "rk4" }, h = { 0.1 } }))
ok(map:at({ rule = "verlet" }, 0.1).class == "wrong", "Kepler: Verlet is bounded, and wrong", map:at({ rule = "verlet" }, 0.1).why)
local unjudged = kepler:stability(with(orbit, { rule = "verlet", h = 0.1, accuracy = false }))
ok(unjudged:at(1, 1).class == "bounded" and unjudged:at(1, 1).off == nil, "accuracy = false: nothing is compared", unjudged:at(1, 1).why)
cell = map:at({ rule = "rk4" }, 0.1)
local path = kepler:solver { rule = "rk4", h = 0.1 }:run(with(orbit, { t = 1600 }))
local drift = path:drift "energy"
ok(cell.class == "drifting" and abs(cell.slope) > 5 * cell.slope_error, "rk4 drifts", cell.why)
near(cell.slope, drift.per_time, 0.01 * abs(drift.per_time), "by the slope that path:drift fits to every step of a longer run")
map = kepler:stability(with(orbit, { rule = "verlet", h = { 0.1, 0.8, 8, "linear" }, inside = function(q) return 2 - q:norm() end, chaos = false }))
ok(map:limit(1) < 0.8 and select(2, map:limit(1)):find "left", "an orbit that leaves the region that it should stay in", select(2, map:limit(1)))
local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
map = henon:stability { y = { -0.016, 0.55 }, q = function(y) return { 0, y } end,
  p = function(y) return { sqrt(2 * (0.125 - y ^ 2 / 2 + y ^ 3 / 3)), 0 } end, rule = "verlet", h = 0.1, t = 3000 }
ok(map:at(1, 1).class == "chaotic" and map:at(1, 1).megno > 10, "Henon-Heiles at energy 1/8: a chaotic orbit", map:at(1, 1).why)
ok(map:at(1, 2).class == "wrong" and abs(map:at(1, 2).megno - 2) < 0.3, "and a regular one, MEGNO 2", map:at(1, 2).megno)
local lyapunov = henon:solver { rule = "verlet", h = 0.1 }:lyapunov { q = { 0, 0.55 }, p = { map:at(1, 2).y and sqrt(2 * (0.125 - 0.55 ^ 2 / 2 + 0.55 ^ 3 / 3)), 0 }, t = 3000, every = 469 }
near(map:at(1, 2).exponent, lyapunov.exponent, 0.2 * lyapunov.exponent, "the exponent is that of solver:lyapunov")
local cubic = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 end }
map = cubic:stability { rule = "midpoint", h = { 0.01, 10, 31, "log" }, q = { 1 }, v = { 0 }, steps = 1, chaos = false }
_, told = map:limit(1)
ok(told:find "no convergence" and map:limit(1) < 10, "a step equation without a solution", told)
local forced = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 + q[1] * math.cos(t / 3) end }
map = forced:stability { rule = "verlet", h = { 0.1, 10, 21, "log" }, q = { 1 }, v = { 0 }, steps = 500 }
near(map:limit(1), 2, 0.04, "a system without a conserved energy: the size of the state")
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end }
map = rod:stability { rules = { "rattle", "gauss(2)" }, h = { 0.05, 6, 15, "log" }, q = { 1, 0 }, v = { 0, 0 }, steps = 200 }
ok(map:limit(1) > 0.2 and map:limit(1) < 6, "RATTLE: too large a step has no multiplier", select(2, map:limit(1)))
local linear = dm.system { Q = dm.R(2), L = function(q, v) return (q[1] * v[2] - q[2] * v[1]) / 2 - q:dot(q) / 2 end }
map = linear:stability { rule = "degenerate(2)", h = { 0.1, 1 }, q = { 1, 0 }, steps = 100 }
ok(map:limit(1) == huge and map:at(1, 1).class == "bounded", "L linear in v needs no velocity", tostring(map))

-- told as text, file, picture
map = dm.stability(with(base, { rule = "verlet" }))
ok(tostring(map):find "155 cells" or tostring(map):find "bounded", "a map prints itself")
ok(select(2, map:csv():gsub("\n", "")) == 156 and map:csv():find '"verlet",100', "a line of csv for every cell")
raises("map:csv: cannot open", map.csv, map, "/absent/a.csv")
if io.open("/dev/full") then raises("cannot write /dev/full", map.csv, map, "/dev/full") end
ok(select(2, map:table(3):gsub("\n", "")) == 4, "a table of three rows", map:table(3))
local png = os.tmpname() .. ".png"
if pcall(map.plot, map, { file = png }) then
  local f = io.open(png, "rb")
  ok(f:read(8) == "\137PNG\r\n\26\n", "a picture")
  f:close()
  os.remove(png)
end

-- what the picture says of itself: name, step, units, four digits
do
  local named = dm.system { name = "clock", Q = dm.R(1), params = { k = 1 }, units = { t = "s", k = "N/m" }, L = function(q, v, _, P) return v[1] ^ 2 / 2 - P.k * q[1] ^ 2 / 2 end }
  local function drawn(o)
    o.rule, o.q, o.v, o.steps = "verlet", { 1 }, { 0 }, 50
    local file = os.tmpname() .. ".svg"
    local fine = pcall(function() named:stability(o):plot { file = file } end)
    local f = fine and io.open(file)
    local text = f and f:read "a"
    if f then f:close() os.remove(file) end
    return text
  end
  local text = drawn { h = 1 / 3, k = { 1, 100, 5, "log" } }
  ok(not text or text:find("clock: verlet, h = 0.3333 s, 50 steps", 1, true) and text:find("k (N/m)", 1, true), "title and units of a picture", text)
  text = drawn { h = 1e-3 }
  ok(not text or text:find ">bounded<" and text:find("h (s)", 1, true) and not text:find "0%.[56]<", "one cell has a legend, its own scale, and no numbers where nothing is drawn along", text)
  local path = named:solver({ rule = "verlet", h = 1 / 3 }):run { q = { 1 }, v = { 0 }, steps = 3 }
  ok(path.title == "clock: verlet, h = 0.3333 s", "so has that of a path", path.title)
end

-- starts where L has no value are cells of their own; functions that are not traced have no exponents
local centre = kepler:stability { rule = "verlet", h = 0.05, x = { -0.5, 0.5, 5, "linear" }, q = function(x) return { x, 0 } end, v = { 0, 1 }, steps = 50 }
ok(centre:at(1, 3).class == "no start" and centre:at(1, 2).class == "off" and centre:at(1, 5).class == "bounded", "a start at the centre of the force is lost alone", tostring(centre))
local first = kepler:stability { rule = "verlet", h = 0.05, x = { 0, 0.5, 5, "linear" }, q = function(x) return { x, 0 } end, v = { 0, 1 }, steps = 50 }
ok(first:at(1, 1).class == "no start" and first:at(1, 4).class ~= "no start", "also where it is the first", tostring(first))
raises("infinite at the start", function() kepler:stability { rule = "verlet", h = { 0.05, 0.1 }, q = { 0, 0 }, v = { 0, 1 }, steps = 50 } end)
local kinked = dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) return v[1] ^ 2 / 2 - (q[1] > 0 and q[1] ^ 2 or q[1] ^ 2 / 2) end }
ok(kinked:stability { rule = "verlet", h = { 0.05, 0.1 }, q = { 1 }, v = { 0 }, steps = 50 }:at(1, 1).class == "bounded", "a function that branches")

-- cells that have no start say why, whatever it is; the others have theirs
do
  local function why(map, i) return select(2, map:limit(i)) end
  local function tried(more) return dm.stability(with({ rule = "verlet", h = { 0.1, 0.5, 1 }, q = { 1 }, v = { 0 }, steps = 50 }, more)) end
  local some = tried { system = function(k) if k == 2 then error "bad k" end return spring(k) end, k = { 1, 2, 3 } }
  ok(some:at(1, 1).class == "bounded" and some:at(2, 1).class == "no start" and why(some, 2):find "bad k" and some:at(3, 1).class == "bounded", "a system that cannot be made", why(some, 2))
  local first = tried { system = function(m) return dm.system { Q = dm.R(2), L = function(q, v) return (m * v[1] ^ 2 + v[2] ^ 2 - q:dot(q)) / 2 end } end, m = { 0, 1 }, q = { 1, 1 }, v = { 0, 0 } }
  ok(first:at(1, 1).why:find "degenerate" and not first:at(1, 1).why:find "dm/stability" and first:at(2, 1).class == "bounded", "nor one without a mass, though it is the first", first:at(1, 1).why)
  some = tried { system = spring(1), a = { 1, 2 }, q = function(a) if a < 2 then return a end end }
  ok(why(some, 2):find("the function 'q' returns nothing at a = 2", 1, true) and some:at(1, 1).class == "bounded", "a start that is not there", why(some, 2))
  some = tried { system = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, force = function(_, v) return { -0.1 * v[1] } end }, rule = false, rules = { "blanes-moan(4)", "midpoint" } }
  ok(why(some, 1):find "it knows no forces" and some:at(2, 1).class == "bounded", "a rule that does not fit", why(some, 1))
  raises("bad k", tried, { system = function() error "bad k" end, k = { 1, 2 } })
  -- the domain of L ends on the way: no error of the energy grew there
  local fall = tried { system = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - dm.sqrt(q[1]) end }, h = { 0.3, 0.5 } }
  ok(fall:at(1, 1).class == "blow-up" and fall:at(1, 1).why:find "the domain of L", "a motion that leaves the domain of L", fall:at(1, 1).why)
  -- what is watched
  local watched = tried { system = spring(1), watch = function(q) return dm.sqrt(q[1]) end }
  ok(watched:at(1, 1).class == "no value", "what is watched has no value", watched:at(1, 1).why)
  watched = tried { system = spring(1), watch = function(q) return q[1] end }
  ok(watched:at(1, 1).why:find "what is watched" and not watched:at(1, 1).why:find "energy", "and is not called energy", watched:at(1, 1).why)
  -- parameters: without effect, with odd names
  local idle = tried { system = dm.system { Q = dm.R(1), params = { k = 1, z = 1 }, L = function(q, v, _, P) return (v[1] ^ 2 - P.k * q[1] ^ 2) / 2 end }, k = { 1, 2 }, z = { 1, 2, 3 } }
  ok(#idle.notes == 1 and idle.notes[1]:find("'z' changes no cell", 1, true), "a parameter without effect is noted", idle.notes[1])
  local odd = tried { system = spring(1), ['a,"b'] = { 1, 2 }, q = function(x) return { x } end }
  ok(odd:csv():find('rule,"a,""b",h,class', 1, true), "a name with commas in the file", odd:csv():match "^[^\n]*")
  raises("cannot be called 'class'", tried, { system = spring(1), class = { 1, 2 }, q = function(class) return { class } end })
  raises("(got table)", tried, { system = spring(1), steps = { 1, 2 } })
  raises("'threads' must be", tried, { system = spring(1), threads = 0 })
end

-- a map that was stopped tells what it has
local stopped = dm.stability(with(base, { rule = "verlet" }))
stopped.cells[2][9].class, stopped.borders[2] = require("dm.stability.cells").NUMBER["not run"], {}
ok(stopped:limit(2) == nil and select(2, stopped:limit(2)):find "stopped before" and tostring(stopped):find "not run", "rows that were not run have no limit")

-- misuse
local function given(more) return function() dm.stability(with(base, with({ rule = "verlet" }, more))) end end
raises("give 'steps' or 't'", given { t = 1 })
raises("'steps' must be a whole number", given { steps = 2.5 })
raises("axis 'k' must be", given { k = { 1, 0, 5, "log" } })
raises("the count must be a whole number", given { h = { 1, 2, 1, "log" } })
raises("begins above 0", given { k = { -1, 2, 5, "log" } })
raises("\"log\" or \"linear\" is needed", given { h = { 1, 2, 5, "cubic" } })
raises("larger than the one before", given { h = { 1, 1 } })
raises("at most two parameters", given { a = { 1 }, b = { 2 } })
raises("parameter 'a' changes nothing", given { a = { 1 }, system = function(k) return spring(k) end })
raises("option 'stepz' is not known", given { stepz = "x" })
raises("its arguments must have their names", given { m = { 1 }, system = function(x) return spring(x) end })
raises("must return a dm.system", given { system = function(k) return k end })
raises("the system is missing", given { system = 3, k = nil })
raises("give the start as q and v or as q and p", given { p = { 1 } })
raises("rule 'verlett'", given { rule = "verlett" })
raises("steps must be > 0", given { h = { -1, 1 } })
raises("a function of (q, v, t, p)", given { watch = "energy" })
raises("there are rows 1 to 5", map.limit, map, 9)
raises("there are columns 1 to 31", map.at, map, 1, 99)
raises("no row of rule 'rk4'", map.limit, map, { rule = "rk4" })
raises("cannot be called 'table'", given { table = { 1 } })
-- rows in beat with the orbit: the kinetic energy of the first of them is small by chance, and nothing has gone anywhere
do
  local springs = function(k) return dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - k * q[1] ^ 2) / 2 end } end
  for _, count in ipairs { 30, 40 } do
    local beat = dm.stability { system = springs, rule = "verlet", q = { 1 }, v = { 0 }, h = { 0.01, 1, count, "log" }, k = { 100 }, steps = 1000 }
    tap.ok(math.abs(beat:limit(1) - 0.2) < 0.001, "the limit of Verlet is not moved by rows in beat with the orbit", beat:limit(1))
  end
end

-- what is lost in the first step: no cell beside it is needed to see that
do
  local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  local thrown = kepler:stability { rule = "verlet", q = { 0.1, 0 }, v = { 0, 19 ^ 0.5 }, h = { 0.005, 1, 6 }, steps = 2000 }
  tap.ok(thrown:at(1, 1).class == "bounded" and thrown:at(1, 2).class == "off" and thrown:at(1, 3).class == "off", "a planet that the first step throws out", tostring(thrown))
  -- a = 0.1: neighbouring orbits part by e^1500, more than a number holds
  local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }
  for _, a in ipairs { 0.1, 3 } do
    local wild = pendulum:stability { rule = "verlet", q = { a }, v = { 0 }, h = { 0.1, 3, 10 }, steps = 1000 }
    local cell = wild:at(1, 2)
    -- p walks at random by kicks of h sin q, 50 far in 1000 steps: one that ends much farther is off as well
    local far = cell.class == "off" and cell.error > 9 / 4 * 1000
    tap.ok(wild:at(1, 1).class == "bounded" and (cell.class == "chaotic" or far) and math.abs(cell.exponent * 3 - math.log(4.5)) < 0.2, "strong chaos", cell.why)
  end
end

-- parameters of one system against systems made for each: one kernel or many, the same map; from starts that are small enough for borders that are none
-- of a chaotic sea, where the last bits decide
do
  local function map_of(system, more)
    return dm.stability(with({ system = system, q = { 0.5, 0.1 }, v = { 0, 0.05 }, h = { 0.05, 4, 12, "log" }, steps = 300 }, more))
  end
  local function same(a, b)
    for i, row in ipairs(a.rows) do
      local x, y = a:limit(i), b:limit(i)
      if x ~= y and not (abs(x - y) <= 0.01 * y) then return false, i, 0 end
      for j = 1, #a.column do
        local one, other = a:at(i, j), b:at(i, j)
        if one.class ~= other.class or one.code == "ok" and one.steps ~= other.steps or row.rule ~= b.rows[i].rule then return false, i, j, one.class .. " " .. other.class end
      end
    end
    return true
  end
  local function made(L) return function(a, k) return dm.system { Q = dm.R(2), L = function(q, v, t) return L(q, v, t, { a = a, k = k }) end } end end
  for name, L in pairs {
    ["of the potential"] = function(q, v, _, P) return v:dot(v) / 2 - P.k * q[1] ^ 2 / 2 - q[2] ^ 2 - P.a * q[1] ^ 2 * q[2] ^ 2 end,
    ["of the mass, zero among them"] = function(q, v, _, P) return (P.a * v[1] ^ 2 + v[2] ^ 2) / 2 - P.k * q:dot(q) / 2 end,
    ["that end the dependence on time"] = function(q, v, t, P) return v:dot(v) / 2 - P.k * q:dot(q) / 2 + P.a * q[1] * math.cos(t) end,
    ["that are compared"] = function(q, v, _, P) return v:dot(v) / 2 - (P.k == 4 and 9 or P.k) * q:dot(q) / 2 - P.a * q[1] ^ 4 end } do
    local axis = { a = { 0, 0.5 }, k = { 4, 16 }, rules = { "verlet", "yoshida(4)", "midpoint" } }
    local fine, i, j, what = same(map_of(dm.system { Q = dm.R(2), params = { a = 0.3, k = 2 }, L = L }, axis), map_of(made(L), axis))
    ok(fine, "parameters " .. name, fine or ("%d, %d: %s"):format(i, j, what))
  end
end

-- columns step over a tongue of instability that linear theory tells of: few of them find the limit that many do. Verlet turns by a third of a
-- circle at h = sqrt 3, where cubic forces make it unstable however small the amplitude
do
  local function henon_heiles(eps)
    return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 - eps * (q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
  end
  local limits = {}
  for k, count in ipairs { 4, 30, 300 } do
    local it = dm.stability { system = henon_heiles, eps = { 0.1 }, rule = "verlet", q = { 0.1, 0 }, v = { 0, 0.2 }, t = 100, h = { 0.05, 2.5, count, "log" } }
    local why
    limits[k], why = it:limit(1)
    ok(limits[k] < sqrt(3) and limits[k] > 0.96 * sqrt(3), count .. " columns find the tongue at sqrt 3", limits[k])
    if count == 30 then ok(why:find "a tongue of instability: at h = [%d.]+ it is not lost", "and say what it is", why) end
  end
  near(limits[1], limits[3], 1e-3 * limits[3], "as many do"); near(limits[2], limits[3], 1e-3 * limits[3], "and some")
  -- a stop between the columns leaves the map as it was, and the next question finds the limit
  local whole = dm.stability { system = henon_heiles(0.1), rule = "verlet", q = { 0.1, 0 }, v = { 0, 0.2 }, t = 100, h = { 0.05, 2.5, 30, "log" } }
  local cells = require "dm.stability.cells"
  for stop_at = 1, 2 do
    local it, run, count = dm.stability { system = henon_heiles(0.1), rule = "verlet", q = { 0.1, 0 }, v = { 0, 0.2 }, t = 100, h = { 0.05, 2.5, 30, "log" } }, cells.run, 0
    cells.run = function(...)
      count = count + 1
      if count == stop_at then error("stopped there", 0) end
      return run(...)
    end
    raises("stopped there", it.limit, it, 1)
    cells.run = run
    ok(it:limit(1) == whole:limit(1) and it:limit(1, "right") == whole:limit(1, "right"), "after a stop the same limits", it:limit(1, "right"))
  end
  -- closed forms: Lobatto 3 loses an oscillation from h omega = sqrt 8 to sqrt 12, Verlet from 2 on; columns at 1 and 3.6
  local two = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - q[2] ^ 2 / 50 end }
  for omega, system in pairs { [1] = two, [3] = spring(9) } do
    local q = omega == 1 and { 1, 1 } or { 1 }
    local few = dm.stability { system = system, rule = "lobatto(3)", q = q, v = 0 * dm.vector(q), h = { 1 / omega, 3.6 / omega }, steps = 2000 }
    near(few:limit(1) * omega, sqrt(8), 2e-3 * sqrt(8), "Lobatto 3: the window between two columns")
  end
  -- a step that turns by a quarter of a circle shows the motion at rest at every other row: nothing is lost there
  for _, n in ipairs { 3, 4, 5, 6, 8, 12 } do
    local h = 2 * math.sin(math.pi / n) / 10
    local it = dm.stability { system = spring(100), rule = "verlet", h = { h, 1.9 / 10 }, q = { 1 }, v = { 0 }, steps = 2000, refine = false }
    ok(it:limit(1) == huge and it:at(1, 1).class == "bounded", "Verlet at 2 pi/" .. n, it:at(1, 1).why)
  end
end

-- the same map on every road
local dmlua = os.getenv "DMLUA" or arg[-1]
local script = [[
  local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
  local m = henon:stability { rules = { "verlet", "gauss(2)" }, h = { 0.1, 3, 5, "log" }, y = { -0.3, 0.5, 3, "linear" },
    q = function(y) return { 0, y } end, v = { 0.3, 0 }, steps = 200, threads = tonumber(os.getenv "THREADS") }
  io.write(m:csv(), m:limit(1), m:limit(6))]]
local function under(environment)
  local pipe = io.popen(("%s %s -e '%s' 2>&1"):format(environment, dmlua, script))
  local text = pipe:read "a"
  pipe:close()
  return text
end
local plain = under "THREADS=1"
ok(#plain > 1000 and plain == under "THREADS=3 DMLUA_LANES=0" and plain == under "THREADS=2 DMLUA_BACKEND=tape", "threads, lanes and backends change no digit of a map", plain:sub(1, 200))
-- what a reader should know
local spring = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local function notes(o)
  o.system, o.rule, o.t, o.refine = spring, "verlet", 20, false
  return dm.stability(o)
end
local still, moving = notes { h = { 0.1, 0.5 }, q = { 0 }, v = { 0 } }, notes { h = { 1e-4, 0.1 }, q = { 1e-3 }, v = { 0 } }
tap.ok(tostring(still):find("note: the start is an equilibrium", 1, true), "a start at an equilibrium is told", tostring(still))
tap.ok(#moving.notes == 0 and #notes { h = { 0.1, 0.2, 0.3 }, q = { 0 }, v = { 1 } }.notes == 0, "nothing is told of others")
tap.ok(#notes { h = { 0.5, 1, 5 }, q = { 1 }, v = { 0 } }.notes == 1 and #notes { h = { 1, 2, 5 }, q = { 1 }, v = { 0 } }.notes == 0,
  "a count as third number is told where the first is none")
tap.ok(tostring(notes { h = { 0.1, 1, 30 }, q = { 1 }, v = { 0 } }):find("h = {0.1, 1, 30} is a list of three numbers; the range is written {0.1, 1, 30, \"log\"}", 1, true),
  "what looks like a range but is a list is told")


-- Ctrl-C, wherever it comes, leaves what is there
do
  local shell = io.popen "echo $PPID"
  local own, asked = shell:read "n", false
  shell:close()
  -- pressed a second after the map has asked for its first system, and long before its cells could end on any machine
  local function spring(k)
    if not asked then os.execute(("(sleep 1.2; kill -INT %d) &"):format(own)) end
    asked = true
    return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
  end
  local start = { q = { math.sin(1), -math.cos(1) }, v = { 0, 0 } }
  local _, failure = pcall(dm.stability, { system = spring, rule = "verlet", k = { 1e2, 1e6, 12, "log" }, h = { 1e-4, 1, 200, "log" },
    q = start.q, v = start.v, steps = 10 ^ 9 })
  tap.ok(failure and type(failure) ~= "string" and failure.code == "stopped" and tostring(failure.map):find "not run", "a map that is interrupted", tostring(failure))
  tap.ok(failure and failure.map and not failure.map.orbits, "prints itself without a look along orbits that were not run")
end
-- among the first instructions, where cells are laid out, too; what the hook does here Ctrl-C does
do
  local spring = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, P) return v[1] ^ 2 / 2 - P.k * q[1] ^ 2 / 2 end }
  for _, count in ipairs { 20000, 200000, 600000 } do
    debug.sethook(function() debug.sethook() error("interrupted!", 0) end, "", count)
    local _, failure = pcall(dm.stability, { system = spring, rule = "verlet", k = { 1, 2, 100, "linear" }, h = { 0.01, 1, 100, "log" }, q = { 1 }, v = { 0 }, steps = 20 })
    debug.sethook()
    local map = type(failure) ~= "string" and failure.map
    tap.ok(map and failure.code == "stopped" and map:csv() and tostring(map):find "not run" and map:limit(100) == nil and map:at(100, 100).class == "not run",
      ("a map that is stopped at its instruction %d"):format(count), map and tostring(map) or failure)
  end
end
-- few steps from near the top of a pendulum: the motion grows by itself, and its energy error with it
local hill = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }
for _, rule in ipairs { "verlet", "midpoint", "rk4" } do
  local lost = 0
  for _, q in ipairs { 3, 3.1, 3.13, 3.14 } do
    for _, steps in ipairs { 8, 10, 20, 50 } do
      local map = dm.stability { system = hill, rule = rule, q = { q }, v = { 0 }, h = { 0.01, 0.1, 0.2, 0.5 }, steps = steps, refine = false }
      if map:limit(1) < math.huge then lost = lost + 1 end
    end
  end
  ok(lost == 0, rule .. " loses no motion that leaves the top of a hill", lost)
end
-- a small part of the first swing: the energy error has not turned, for no drift is there yet; that of rk4 on a circle is one, however early
local swing = dm.stability { system = hill, rule = "verlet", q = { 1 }, v = { 0 }, h = { 1e-4, 2e-4, 4e-4 }, steps = 300, refine = false }
ok(swing:at(1, 1).class == "bounded" and swing:at(1, 2).class == "bounded" and swing:at(1, 3).class == "bounded", "no drift before the motion has turned", swing:at(1, 2).why)
local circle = dm.stability { system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, rule = "rk4", q = { 1, 0 }, v = { 0, 1 },
  h = { 0.3, 0.5 }, steps = 100, refine = false }
ok(circle:at(1, 1).class == "drifting" and circle:at(1, 2).class == "drifting", "rk4 on a circle drifts", circle:at(1, 1).why)
-- a planet that one step throws out of its orbit: its energy is another and stays
local thrown = dm.stability { system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, rule = "rk4", q = { 0.9, 0 },
  v = { 0, math.sqrt(1.1 / 0.9) }, h = { 0.1, 6 }, steps = 1000, refine = false }
ok(thrown:at(1, 1).class == "bounded" and thrown:at(1, 2).class == "off", "an escape is off, however small its energy", thrown:at(1, 2).class)
-- a parameter that functions read from a table outside never reaches them
do
  local outside, K = { k = 1 }, dm.mesh { grid = 2 }
  local line = dm.field { x = { 0, 1, 8 }, params = outside, L = function(_, ut, ux) return (ut ^ 2 - outside.k * ux ^ 2) / 2 end }
  local field = K:field { params = outside,
    L = function(u, ut) return ut:dot(ut) / 2 - outside.k * u:d():dot(u:d()) / 2 end }
  local point = dm.system { Q = dm.R(1), params = outside, L = function(q, v) return (v[1] ^ 2 - outside.k * q[1] ^ 2) / 2 end }
  local function map(system, rule, more)
    local o = { system = system, rule = rule, steps = 10, h = { 0.1, 1, 3 }, k = { 1, 2 } }
    for key, value in pairs(more) do o[key] = value end
    return dm.stability(o)
  end
  local why = "parameter 'k' changes nothing: 'L' reads it elsewhere, from a table"
  raises(why, map, point, "verlet", { q = { 1 }, v = { 0 } })
  raises(why, map, field, "verlet", { q = function(x) return x end, v = function() return 0 end })
  raises(why, map, line, "cell(gauss(2))", { q = function(x) return x end, v = function() return 0 end })
  local partly = dm.system { Q = dm.R(1), params = outside, force = function(_, v) return -outside.k * v end,
    L = function(q, v, _, p) return (v[1] ^ 2 - p.k * q[1] ^ 2) / 2 end }
  raises("parameter 'k' changes a part only: 'force' reads it elsewhere", map, partly, "midpoint", { q = { 1 }, v = { 0 } })
end
tap.done()
