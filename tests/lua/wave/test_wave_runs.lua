-- runs of waves: orders of all rules, starts, checkpoints, limits, notes, and what is refused
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local cos, sin, exp = math.cos, math.sin, math.exp

local function packet(x) local a = exp(-x ^ 2 / 2) return a * cos(x), a * sin(x) end
local function V(x) return x ^ 2 / 4 + cos(x) end

---- orders ----

local ORDERS = { ["symplectic-euler"] = 1, strang = 2, ["yoshida(4)"] = 4, ["suzuki(4)"] = 4, ["mclachlan(4)"] = 4,
  ["kahan-li(6)"] = 6, ["blanes-moan(4)"] = 4, ["gauss(1)"] = 2, ["gauss(2)"] = 4, ["gauss(3)"] = 6, midpoint = 2 }
for _, given in ipairs { { g = 0, hbar = 0.8, m = 1.5 }, { g = -1 }, { g = 1.5, boundary = "walls", N = 120 } } do
  local wave = dm.schroedinger { x = { -8, 8, given.N or 64 }, V = V, g = given.g, hbar = given.hbar, m = given.m, boundary = given.boundary }
  local function last(rule, h) return wave:solver({ rule = rule, h = h }):run({ psi = packet, t = 0.5, every = 1000 }).psi[2] end
  local exact = last("gauss(6)", 1 / 64)
  for rule, order in pairs(ORDERS) do
    local h = (order >= 6 or rule:find "blanes") and 1 / 16 or 1 / 64
    local function off(step) return (last(rule, step) - exact):norm() end
    local measured = math.log(off(h) / off(h / 2)) / math.log(2)
    -- between walls modes of great energy resonate with steps that are long for them
    if not (given.boundary and (rule:find "kahan" or rule:find "blanes" or rule:find "mclachlan" or rule:find "suzuki")) then
      ok(math.abs(measured - order) < 0.4, ("%s: order %d, g = %g, %s"):format(rule, order, given.g, wave.boundary), measured)
    end
  end
end
for _, rule in ipairs { "kahan-li(8)", "suzuki-umeno(8)", "sofroniou-spaletta(10)", "blanes-moan(6)", "yoshida(6)" } do
  local wave = dm.schroedinger { x = { -8, 8, 64 }, V = V, g = -1 }
  local p = wave:solver({ rule = rule, h = 1 / 64 }):run { psi = packet, t = 0.5, every = 1000 }
  local q = wave:solver({ rule = "gauss(6)", h = 1 / 64 }):run { psi = packet, t = 0.5, every = 1000 }
  ok((p.psi[2] - q.psi[2]):norm() < 1e-9, rule .. " against gauss(6)", (p.psi[2] - q.psi[2]):norm())
end

-- a ring of more points than dense modes: the rest of V by iteration
local wide = dm.schroedinger { x = { -8, 8, 1250 }, V = V }
local small = dm.schroedinger { x = { -8, 8, 50 }, V = V }
local a = wide:solver({ rule = "gauss(3)", h = 0.05 }):run { psi = packet, steps = 4 }
local b = small:solver({ rule = "gauss(3)", h = 0.05 }):run { psi = packet, steps = 4 }
ok(math.abs(a:column("x")[5] - b:column("x")[5]) < 1e-9, "gauss(3) by iteration on 1250 points", a:column("x")[5] - b:column("x")[5])
raises("up to 1200", function() wide:solver { rule = "two-step", h = 1e-6 } end)

if require "dm.core".solvers() then
  local e, off = dm.schroedinger({ x = { -10, 10, 1250 }, V = function(x) return x ^ 2 / 2 end }):eigen(4), 0
  for k = 1, 4 do off = math.max(off, math.abs(e.values[k] - k + 0.5)) end
  ok(off < 1e-10 and math.abs(e.psi[1]:norm() - 1) < 1e-12 and #e.psi == 4, "levels on 1250 points, by Lanczos", off)
  raises("4096", function() dm.schroedinger({ x = { -10, 10, 5000 }, V = V }):eigen(2) end)
end

-- plans by timing are kept: the next run has the same bits
local wisdom = os.tmpname()
local function measured(x)
  local s = dm.schroedinger({ x = { -8, 8, 90 }, V = x }):solver { rule = "strang", h = 0.1, plan = "measure", wisdom = wisdom }
  return s:run({ psi = packet, steps = 20 }).psi[21]
end
ok(measured(V) == measured(V), "a plan that was measured is used again")
ok(io.open(wisdom):read "a":find "fftw" or dm.schroedinger { x = { 0, 1, 8 } }:equation().fft ~= "FFTW", "wisdom is in its file")
os.remove(wisdom)
raises("goes with", function() small:solver { rule = "strang", h = 0.1, wisdom = "x" } end)
local by_fftw = small:equation().fft == "FFTW"
raises(by_fftw and "written" or "no such", function() small:solver { rule = "strang", h = 0.1, plan = "measure", wisdom = "/no/such/folder/x" }
  if not by_fftw then error "no such" end
end)

---- rows, starts, going on ----

local wave = dm.schroedinger { x = { -8, 8, 64 }, V = V }
local solver = wave:solver { rule = "strang", h = 0.1 }
local path = solver:run { psi = packet, steps = 25, every = 10, t0 = 3 }
ok(#path == 4 and path.t[2] == 4 and path.t[4] == 5.5 and path.steps == 25, "rows of every 10 and the last", path.t[4])
ok(#path.psi == 4 and path.psi[5] == nil and #path.psi[1] == 64 and path:column("norm")[1] > 0, "rows are counted")
-- sizes whose squares overflow or vanish are told
for _, size in ipairs { 1e-200, 1e200 } do
  raises("scale it", function() return wave:solver({ rule = "strang", h = 0.1 }):run { psi = function(x) return size * cos(x) end, steps = 1 } end)
end
raises("1 to 4", function() return path.psi[7] end)
raises("no column", function() return path:column "q1" end)
local again = solver:run { psi = path.psi[4], steps = 0 }
ok((again.psi[1] - path.psi[4]):norm() < 1e-15, "a state is a start")
again = solver:run { psi = { re = path.psi[4].re, im = path.psi[4].im }, steps = 0 }
ok((again.psi[1] - path.psi[4]):norm() < 1e-15, "so are two lists")
ok(path.psi[1]:arg()[33] == math.atan(path.psi[1].im[33], path.psi[1].re[33]), "arg")
local v = path.psi[1]:times(0, 1)
local re, im = path.psi[1]:dot(v)
ok(math.abs(re) < 1e-15 and math.abs(im - path:column("norm")[1]) < 1e-13, "dot is linear in the second", im)

local file = os.tmpname()
local nls = dm.schroedinger { x = { -8, 8, 64 }, V = V, g = -1 }
for _, case in ipairs { { wave, "strang" }, { nls, "yoshida(4)" }, { wave, "gauss(2)" }, { nls, "gauss(2)" }, { wave, "two-step" } } do
  local w, rule = case[1], case[2]
  local h = rule == "two-step" and 0.005 or 0.05
  local whole = w:solver({ rule = rule, h = h }):run { psi = packet, steps = 60, every = 7 }
  local part = w:solver({ rule = rule, h = h }):run { psi = packet, steps = 23, checkpoint = file }
  local rest = w:resume(file):run { steps = 37 }
  ok(rest.psi[#rest] == whole.psi[#whole] and rest.t[#rest] == whole.t[#whole], rule .. ": goes on from a file bit for bit")
  rest = w:resume(part):run { steps = 37 }
  ok(rest.psi[#rest] == whole.psi[#whole], "  and from a path")
end
raises("its V was", function() dm.schroedinger({ x = { -8, 8, 64 }, V = cos }):resume(file) end)
raises("its N", function() dm.schroedinger({ x = { -8, 8, 32 }, V = V }):resume(file) end)
raises("goes on", function() wave:resume(path):run { psi = packet, steps = 1 } end)
local text = io.open(file):read "a"
io.open(file, "w"):write((text:gsub("\nh ", "\nh 0"))):close()
raises("checksum", function() wave:resume(file) end)
os.remove(file)

local fine, failure = pcall(solver.run, solver, { psi = packet, steps = 10 ^ 9, every = 10 ^ 8, seconds = 0.05 })
ok(not fine and failure.code == "out_of_time" and failure.path.steps > 0, "seconds end a run, with its path", failure)
raises("half of this machine", solver.run, solver, { psi = packet, steps = 10 ^ 12 })

---- what is told ----

local function notes(w, rule, h, psi, t) return table.concat(w:solver({ rule = rule, h = h }):run({ psi = psi, t = t }).notes, "\n") end
local function quick(x) local r = exp(-x ^ 2) return r * cos(5 * x), r * sin(5 * x) end
local line = dm.schroedinger { x = { -10, 10, 128 } }
ok(notes(line, "strang", 0.05, quick, 1) == "", "nothing to tell of a packet that is resolved")
ok(notes(line, "strang", 0.05, quick, 4):find "round the ring", "a packet that meets itself is told")
ok(notes(dm.schroedinger { x = { -10, 10, 32 } }, "strang", 0.05, quick, 1):find "aliasing", "aliasing is told")
ok(notes(dm.schroedinger { x = { -10, 10, 128 }, g = -1 }, "strang", 0.05, quick, 1):find "resonate", "resonant steps are told")
ok(notes(dm.schroedinger { x = { 0, 2 * math.pi, 16 } }, "two-step", 0.05, function(x) return cos(7 * x), sin(7 * x) end, 1):find "parasitic",
  "a parasitic mode is told")
raises("no multiplier", function() dm.schroedinger({ x = { 0, 2 * math.pi, 16 }, V = -1 }):solver { rule = "two-step", h = 0.04, norm = true }:run {
  psi = function(x) return cos(2 * x) + 1, sin(2 * x) end, steps = 1000 } end)

---- rows that go to a file ----

do
  local file = os.tmpname() .. ".npy"
  local ring = dm.schroedinger { x = { -10, 10, 64 }, V = function(x) return x ^ 2 / 2 end }
  for _, rule in ipairs { "strang", "gauss(2)", "two-step" } do
    local options = { psi = packet, steps = 6007, every = 3 } -- more rows than one block takes
    local function run() return ring:solver({ rule = rule, h = 0.005 }):run(options) end
    local kept = run()
    options.file = file
    local sent, off = run(), 0
    for _, name in ipairs { "t", "norm", "energy", "noether" } do
      local a, b = kept:column(name), sent:column(name)
      for i = 1, #kept do off = off + math.abs(a[i] - b[i]) end
    end
    local a, b = kept.psi[#kept], sent.psi[#sent]
    for j = 1, 64 do off = off + math.abs(a.re[j] - b.re[j]) + math.abs(a.im[j] - b.im[j]) end
    ok(#sent == 2004 and off == 0, "file: the same bits by " .. rule, off)
    local handle = io.open(file, "rb")
    local text = handle:read "a"
    handle:close()
    local size = 8 * (6 + 2 * 64)
    local head = #text - 2004 * size
    local row = kept.psi[1001]
    ok(text:sub(2, 6) == "NUMPY" and head % 64 == 0 and ("<d"):unpack(text, head + 1000 * size + 49)
      == row.re[1] and ("<d"):unpack(text, head + 1001 * size - 7) == row.im[64], "  and rows")
    raises("keeps the last one", function() return sent.psi[3] end)
  end
  os.remove(file)
  raises(".npy", function() ring:solver({ rule = "strang", h = 0.1 }):run { psi = packet, steps = 1, file = "rows.csv" } end)
end

---- what is refused ----

local function ring(t) t.x = t.x or { 0, 1, 16 } return function() return dm.schroedinger(t) end end
-- what systems have and waves have not
do
  local of_g = dm.schroedinger { x = { 0, 1, 16 }, g = -1 }
  local s = of_g:solver { rule = "strang", h = 1e-4 }
  local run = s:run { psi = function() return 1, 0 end, steps = 4 }
  raises("solver of a wave has no 'ensemble': a member is a run of its own", s.ensemble, s, { members = 2 })
  raises("coordinates q", s.tangent, s)
  raises("path:column \"energy\"", run.energy, run)
  raises("wave:eigen(k) has the energies", of_g.modes, of_g)
  raises("an energy for every norm", of_g.eigen, of_g, 2)
  raises("linear equation (g = 0)", of_g.stability_limit, of_g, "two-step")
  ok(s.nothing == nil and run.nothing == nil and of_g.nothing == nil, "what nothing has stays nil")
end

raises("even", ring { x = { 0, 1, 15 } })
raises("no interval", ring { x = { 1, 0, 16 } })
raises("{ from, to, N }", ring { x = { 0, 1 } })
raises("whole number", ring { x = { 0, 1, 16.5 } })
raises("finite number", ring { V = function(x) return 1 / x end })
raises("time", ring { V = function(x, t) return x * t end })
raises("list of N = 16", ring { V = { 1, 2 } })
raises("hbar", ring { hbar = 0 })
raises("'m'", ring { m = -1 })
raises("linear", ring { space = "galerkin", g = 1 })
raises("ring", ring { space = "galerkin", boundary = "walls" })
raises("did you mean", ring { hbarr = 1 })
raises("1200", ring { x = { 0, 1, 1300 }, boundary = "walls" })
for _, rule in ipairs { "lobatto(2)", "lobatto(4)", "galerkin(2, gauss(3))", "trapezoidal" } do
  raises("unitary", function() wave:solver { rule = rule, h = 0.1 } end)
end
raises("no rule for waves", function() wave:solver { rule = "rk4", h = 0.1 } end)
raises("did you mean 'strang'", function() wave:solver { rule = "stang", h = 0.1 } end)
raises("goes with", function() wave:solver { rule = "strang", h = 0.1, norm = true } end)
raises("psi", function() solver:run { steps = 1 } end)
raises("psi is 0", function() solver:run { psi = function() return 0 end, steps = 1 } end)
raises("two finite numbers", function() solver:run { psi = function() return "a" end, steps = 1 } end)
raises("how long", function() solver:run { psi = packet } end)
raises("walls", function() dm.schroedinger({ x = { 0, 1, 16 }, boundary = "walls" }):solver({ rule = "strang", h = 0.1 }):run { psi = cos, steps = 1 } end)
raises("smaller step", function() dm.schroedinger({ x = { -8, 8, 64 }, g = 80 }):solver({ rule = "gauss(2)", h = 1 }):run { psi = packet, steps = 5 } end)
raises("degree", function() dm.schroedinger({ x = { -8, 8, 256 } }):solver { rule = "slab", h = 50 } end)
tap.done()
