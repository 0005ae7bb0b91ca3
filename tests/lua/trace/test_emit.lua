-- C text of systems and functions, and kernels by the compiler of the system: the bits of the tape
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local model = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 * (1 + q[1] ^ 2) + math.cos(q[2]) + dm.where(q[1], q[1] ^ 3, math.exp(q[1])) + math.max(q[1], v[2]) - math.atan(q[1], 2)
end }
local source = model:emit_c()
ok(source:find("void lagrangian%(const double %*in, double %*out%)") and source:find "void slope" and source:find "void energy", "three functions")
ok(source:find "const double q1 = in%[0%]", "inputs by their names")

-- the same path by every backend that this machine has
local ends = {}
for _, backend in ipairs { "tape", "jit", "cc" } do
  local solver = model:solver { rule = "gauss(2)", h = 0.05, backend = backend }
  local path = solver:run { q = { 0.3, 0.1 }, v = { 0.2, 0.4 }, steps = 200, every = 200 }
  ends[#ends + 1] = path.q[2]
end
ok(ends[1] == ends[2], "native code has the bits of the tape")
ok(ends[1] == ends[3], "the C compiler has the bits of the tape")
-- masses whose kernels have sums and differences of products side by side, which gcc 12 would fuse into vfmaddsub
for _, seed in ipairs { 7, 12, 14 } do
  math.randomseed(seed)
  local n, c, q, v = 3 + seed % 2, {}, {}, {}
  local function draw() return 2 * math.random() - 1 end
  for i = 1, 4 * n do c[i] = draw() end
  local chain = dm.system { Q = dm.R(n), L = function(x, u)
    local sum = 0
    for k = 1, n do
      local s, r = 0, 0
      for j = 1, n do
        s = s + c[k * j % (4 * n) + 1] * u[j]
        r = r + c[n + (k + 2 * j) % (3 * n)] * x[j]
      end
      sum = sum + s * s / 6 + (1.5 + r * r) * u[k] ^ 2 / 2 - dm.cos(r)
    end
    return sum
  end }
  for i = 1, n do q[i], v[i] = draw(), draw() end
  local function run(backend)
    return chain:solver({ rule = "midpoint", h = 0.04, backend = backend }):run { q = q, v = v, steps = 9 }
  end
  local a, b, same = run "tape", run "cc", true
  for k = 1, 10 do same = same and a.q[k] == b.q[k] and a.p[k] == b.p[k] end
  ok(same, "the C compiler fuses nothing by itself, masses " .. seed)
end

local f = dm.trace(function(x) return { x[1] / x[2], -math.abs(x[1]) } end, 2)
ok(f:emit_c("g"):find "void g%(" and f:emit_c():find "void f%(", "a function under a name")
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b) return (b[1] - a[1]) ^ 2 / 0.2 end }
ok(Ld:emit_c():find "void Ld" and Ld:emit_c():find "q1_1 = in%[1%]", "a discrete Lagrangian")
local tied = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, constraint = function(q, t) return q:dot(q) - t end,
  force = function(_, v) return -v end }:emit_c()
ok(tied:find "void constraint" and tied:find "void force" and tied:find "const double v2 = in%[3%]" and not tied:find "void rolling",
  "constraints and forces", tied)
raises("hyper-dual", function() dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) return v[1] ^ 2 end }:emit_c() end)
raises("dm.sum_over", function()
  dm.system { Q = dm.R(40), L = function(q, v)
    return dm.sum_over(v, function(a) return a ^ 2 / 2 end) - dm.sum_over(q, function(a, b) return math.exp(a - b) end, { shift = 1 })
  end }:emit_c()
end)
local function text_of(V) return dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - V(q) end }):emit_c() end
local quartic, kepler = text_of(function(q) return q[1] ^ 4 + q[2] ^ 2 end), text_of(function(q) return -1 / q:norm() end)
tap.ok(not quartic:find "reciprocal_root" and kepler:find "double reciprocal_root%(" ~= nil, "a file has the helpers that it calls, and no others")

-- the name becomes C text: letters, digits and _, no word of C
for _, name in ipairs { "f(void) { } //", "", "2f", "double", "_Bool", "main", "a b", "f\0g", "f-g" } do
  raises("name of a C function", f.emit_c, f, name)
end
-- and none that the text, or a program that it is linked with, has already
for name, why in pairs { sin = "math.h", expf = "math.h", NAN = "math.h", M_PI = "math.h", double_t = "math.h", y1 = "math.h", isnan = "math.h",
  printf = "C library", exit = "C library", reciprocal_root = "helper", bool = "word of C", asm = "word of C", __f = "reserved", _F = "reserved" } do
  raises(why, f.emit_c, f, name)
end
for _, name in ipairs { "sins", "sinus", "si", "nanny", "Sin", "t3", "x1", "in", "force", "f1", "ml", "l", "energy" } do
  ok(f:emit_c(name):find("void " .. name .. "(", 1, true) ~= nil, name .. " is free")
end
ok(f:emit_c("_f2"):find("void _f2(", 1, true) ~= nil, "a name that C takes")
-- all that a compiler knows of the library's headers: their macros, and of <math.h> every word that its text has
local function run(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read "a"
  pipe:close()
  return text
end
local cc = os.getenv "CC" or "cc"
local HEADERS = "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdatomic stdbool stddef stdint stdio stdlib "
  .. "stdnoreturn string tgmath threads time uchar wchar wctype"
local includes = HEADERS:gsub("%S+%s*", function(name) return "#include <" .. name:match "%S+" .. ".h>\\n" end)
-- those of one system alone: more errors, signals and locales than C has, which are words of a program as well
local SYSTEMS = { "^E[A-Z0-9]+$", "^SIG[A-Z0-9]+$" }
local free, tried = {}, 0
local function try(name)
  for _, pattern in ipairs(SYSTEMS) do
    if name:find(pattern) then return end
  end
  tried = tried + 1
  if pcall(f.emit_c, f, name) then free[#free + 1] = name end
end
for name in run(("printf '%s' | %s -std=c17 -dM -E -"):format(includes, cc)):gmatch "#define ([%a_][%w_]*)" do try(name) end
for _, standard in ipairs { "-std=c17", "-std=gnu17 -D_GNU_SOURCE" } do
  local math = run(("printf '#include <math.h>\\n' | %s %s -E -P -"):format(cc, standard))
  for name in math:gmatch "[%a_][%w_]*" do try(name) end
end
ok(#free == 0 and tried > 500, "no name of the library's headers is taken", table.concat(free, " "))
for name, why in pairs { NULL = "C library", errno = "C library", size_t = "C library", INT_MAX = "C library", uint8_t = "C library", EDOM = "C library",
  sinf64x = "math.h", creal = "complex.h", f32addf64 = "math.h", M_PIf128 = "math.h" } do raises(why, f.emit_c, f, name) end
for _, name in ipairs { "E", "EKIN", "SIGMA", "K_t", "int8", "INTEGRAL", "fl", "M_P", "dsum", "LC_circuit", "TIME_of_flight", "FP_map" } do ok(pcall(f.emit_c, f, name), name .. " is free, too") end
tap.done()
