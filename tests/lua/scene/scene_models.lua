-- Random models for scenes, with references by a program in C that is generated here, in long double, and shares nothing with dmlua: extrapolated
-- midpoint rules (Gragg, Bulirsch, Stoer) whose steps are halved until they agree.
local dm = require "dm"
local M = {}

local HEAD = [[
#include <math.h>
#include <stdio.h>
#include <string.h>
typedef long double R;
enum { MOST = 8, COLUMNS = 8 };
static int n;
static void (*slope)(R, const R *, R *);
static void midpoint(R t, const R *y, R H, int m, R *out) {
    R a[MOST], b[MOST], f[MOST], h = H / m;
    slope(t, y, f);
    for (int i = 0; i < n; i++) a[i] = y[i], b[i] = y[i] + h * f[i];
    for (int k = 1; k < m; k++) {
        slope(t + k * h, b, f);
        for (int i = 0; i < n; i++) { R c = a[i] + 2 * h * f[i]; a[i] = b[i]; b[i] = c; }
    }
    slope(t + H, b, f);
    for (int i = 0; i < n; i++) out[i] = (a[i] + b[i] + h * f[i]) / 2;
}
static void advance(R t, R *y, R H, int depth) {
    R T[COLUMNS][MOST], last[MOST], err = 0;
    for (int k = 0; k < COLUMNS; k++) {
        R fine[MOST];
        midpoint(t, y, H, 2 * (k + 1), fine);
        for (int i = 0; i < n; i++) {
            R now = fine[i];
            for (int j = 0; j < k; j++) {
                R r = (R)(k + 1) / (k - j), next = now + (now - T[j][i]) / (r * r - 1);
                T[j][i] = now; now = next;
            }
            last[i] = k ? T[k - 1][i] : now;
            T[k][i] = now;
            if (k == COLUMNS - 1) { R d = fabsl(now - last[i]) / (1 + fabsl(now)); if (d > err) err = d; }
        }
    }
    if (err > 1e-16L && depth < 40) { advance(t, y, H / 2, depth + 1); advance(t + H / 2, y, H / 2, depth + 1); }
    else memcpy(y, T[COLUMNS - 1], sizeof(R) * n);
}
]]

-- one random model: Lagrangian and accelerations are written side by side, by hand; r(a, b) is a random number
local function oscillators(r)
  local n = math.random(3)
  local m, w, a, c, f, o = {}, {}, r(0, 1), r(0, 0.4), r(0, 0.4), r(0.5, 3)
  local drag, pulse = math.random(3) == 1 and r(0.01, 0.1) or 0, math.random(2) == 1
  local at, width, push = r(2, 9), 10 ^ r(-4.5, -1.5), pulse and r(0.05, 0.3) or 0
  for i = 1, n do m[i], w[i] = r(0.5, 2), r(0.5, 2) end
  local c_text, q, v = {}, {}, {}
  for i = 1, n do
    q[i], v[i] = r(-1, 1), r(-0.5, 0.5)
    local near = {}
    if i > 1 then near[#near + 1] = ("y[%d]"):format(i - 2) end
    if i < n then near[#near + 1] = ("y[%d]"):format(i) end
    c_text[i] = ("(-%.17gL*y[%d] - %.17gL*y[%d]*y[%d]*y[%d] - %.17gL*sinl(y[%d]) - %.17gL*(%s)%s - %.17gL*y[%d])/%.17gL"):format(w[i], i - 1, a, i - 1, i - 1, i - 1,
      a / 2, i - 1, c, #near > 0 and table.concat(near, "+") or "0", i == 1 and (" + %.17gL*cosl(%.17gL*t) + %.17gL*expl(-((t-%.17gL)/%.17gL)*((t-%.17gL)/%.17gL))")
      :format(f, o, push / width, at, width, at, width) or "", drag, n + i - 1, m[i])
  end
  return { kind = "oscillators", n = n, q = q, v = v, T = 10, c = c_text, tolerance = 10 ^ -math.random(3, 6), L = function(x, y, t)
    local L = f * math.cos(o * t) * x[1] + push / width * math.exp(-((t - at) / width) ^ 2) * x[1]
    for i = 1, n do L = L + m[i] / 2 * y[i] ^ 2 - w[i] / 2 * x[i] ^ 2 - a / 4 * x[i] ^ 4 + a / 2 * math.cos(x[i]) end
    for i = 1, n - 1 do L = L - c * x[i] * x[i + 1] end
    return L
  end, force = drag > 0 and function(_, y) return -drag * y end or nil }
end

local function passages(r)
  local e, n = r(0, 0.95), 2
  local mu, weak = r(0.5, 2), r(0, 0.05)
  local text = "-(%.17gL)*y[%d]/(d*d*d) - %.17gL*y[%d]"
  return { kind = "close passages", n = n, q = { -(1 + e), 0 }, v = { 0, -math.sqrt(mu * (1 - e) / (1 + e)) }, T = r(5, 25), tolerance = 10 ^ -math.random(3, 6),
    before = "R d = sqrtl(y[0]*y[0] + y[1]*y[1]);", c = { text:format(mu, 0, weak, 0), text:format(mu, 1, 2 * weak, 1) },
    L = function(q, v) return v:dot(v) / 2 + mu / q:norm() - weak * (q[1] ^ 2 / 2 + q[2] ^ 2) end }
end

-- a rod: the reference is in its angle
local function rods(r)
  local g, th, om, o = r(1, 10), r(-2, 2), r(-1, 1), r(0, 0.5)
  return { kind = "a rod", n = 2, states = 1, q = { math.sin(th), -math.cos(th) }, v = { om * math.cos(th), om * math.sin(th) }, start = { th, om }, T = r(3, 10),
    tolerance = 10 ^ -math.random(3, 6), c = { ("-%.17gL*sinl(y[0]) + %.17gL*cosl(t)*cosl(y[0])"):format(g, o) }, watched = "sinl(y[0])",
    constraint = function(q) return q[1] ^ 2 + q[2] ^ 2 - 1 end, L = function(q, v, t) return v:dot(v) / 2 - g * q[2] + o * math.cos(t) * q[1] end }
end

local KINDS = { oscillators, oscillators, passages, rods }

--- `count` models by a seed.
function M.make(count, seed)
  math.randomseed(seed)
  local function r(a, b) return a + (b - a) * math.random() end
  local out = {}
  for k = 1, count do out[k] = KINDS[(k - 1) % #KINDS + 1](r) end
  return out
end

local function c_of(models, rows)
  local parts = { HEAD }
  for k, m in ipairs(models) do
    local n = m.states or m.n
    parts[#parts + 1] = ("static void f%d(R t, const R *y, R *f) { (void)t; %s"):format(k, m.before or "")
    for i = 1, n do parts[#parts + 1] = ("f[%d] = y[%d]; f[%d] = %s;"):format(i - 1, n + i - 1, n + i - 1, m.c[i]) end
    parts[#parts + 1] = "}"
  end
  parts[#parts + 1] = "int main(void) {"
  for k, m in ipairs(models) do
    local n, start = m.states or m.n, {}
    for i, x in ipairs(m.start or { table.unpack(m.q) }) do start[i] = ("%.17gL"):format(x) end
    if not m.start then for i = 1, m.n do start[m.n + i] = ("%.17gL"):format(m.v[i]) end end
    parts[#parts + 1] = ("{ R y[MOST] = {%s}; n = %d; slope = f%d; for (int k = 1; k <= %d; k++) { R t = (R)%.17gL*(k-1)/%d, u = (R)%.17gL*k/%d; advance(t, y, u - t, 0);"
      .. " printf(\"%%.17g\\n\", (double)(%s)); } }"):format(table.concat(start, ","), 2 * n, k, rows, m.T, rows, m.T, rows, m.watched or "y[0]")
  end
  parts[#parts + 1] = "return 0; }"
  return table.concat(parts, "\n")
end

--- Sets model.at, model.exact at so many times; false where there is no C compiler.
function M.solve(models, rows)
  local name = os.tmpname()
  local file = assert(io.open(name .. ".c", "w"))
  file:write(c_of(models, rows))
  file:close()
  local fine = os.execute(("cc -O2 -o %s.out %s.c -lm 2>/dev/null"):format(name, name))
  local pipe = fine and io.popen(name .. ".out")
  for _, m in ipairs(pipe and models or {}) do
    m.at, m.exact = {}, {}
    for k = 1, rows do m.at[k], m.exact[k] = k == rows and m.T or m.T * k / rows, pipe:read "n" end
  end
  if pipe then pipe:close() end
  for _, ending in ipairs { "", ".c", ".out" } do os.remove(name .. ending) end
  return pipe and true or false
end

-- largest distance of straight lines between the rows of a run from the exact values
local function off_lines(run, m)
  local t, x, i, worst = run.t, run:column "q1", 1, 0
  for k, time in ipairs(m.at) do
    while i + 1 < #t and t[i + 1] < time do i = i + 1 end
    local f = (time - t[i]) / (t[i + 1] - t[i])
    worst = math.max(worst, math.abs((1 - f) * x[i] + f * x[i + 1] - m.exact[k]))
  end
  return worst
end

--- One model through a scene: { refused = words } or { worst, tolerance, estimate, seconds }; worst
-- of rows at 10^4 times and of lines between those of a plain run.
function M.try(m, seconds)
  local began = dm.cpu()
  local scene = dm.scene { dm.system { Q = dm.R(m.n), L = m.L, force = m.force, constraint = m.constraint }, q = m.q, v = m.v, watch = { "q1" }, tolerance = m.tolerance,
    until_t = m.T, seconds = seconds }
  local fine, why = pcall(scene.why, scene)
  local spent = dm.cpu() - began
  if not fine then return { refused = tostring(why), seconds = spent } end
  local run, worst = scene:run { at = m.at }, 0
  local q1 = run:column "q1"
  for k = 1, #m.at do worst = math.max(worst, math.abs(q1[k] - m.exact[k])) end
  local kept = worst <= m.tolerance and worst <= 1.01 * run.error_estimate + 1e-12
  local plain, whole = pcall(scene.run, scene)
  if plain then
    local off = off_lines(whole, m)
    kept = kept and off <= m.tolerance and off <= 1.01 * whole.error_estimate + 1e-12
    worst = math.max(worst, off)
  else
    kept = kept and tostring(whole):find "10%^6" ~= nil -- a tolerance that asks for more rows
  end
  return { worst = worst, tolerance = m.tolerance, estimate = run.error_estimate, seconds = spent, scene = scene,
    kept = kept, plain = plain }
end

return M
