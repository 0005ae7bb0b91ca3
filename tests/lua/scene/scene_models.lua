-- Random models for scenes, with references by a program in C that is generated here, in long double, and shares nothing with dmlua: extrapolated
-- midpoint rules (Gragg, Bulirsch, Stoer) whose steps are halved until they agree.
local dm = require "dm"
local kinds = require "scene_kinds"
local M = { make = kinds.make }

local HEAD = [[
#include <math.h>
#include <stdio.h>
#include <string.h>
typedef long double R;
enum { MOST = 8, COLUMNS = 8, MOST_WINDOWS = 64 };
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
static int windows;
static R from[MOST_WINDOWS], to[MOST_WINDOWS]; /* where something is narrow: steps are a 24th of it */
static int is_narrow(R t, R H) {
    for (int i = 0; i < windows; i++) if (t < to[i] && t + H > from[i] && H > (to[i] - from[i]) / 24) return 1;
    return 0;
}
static void advance(R t, R *y, R H, int depth) {
    if (is_narrow(t, H)) { advance(t, y, H / 2, depth); advance(t + H / 2, y, H / 2, depth); return; }
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
    for i, window in ipairs(m.windows or {}) do
      parts[#parts + 1] = ("from[%d] = %.17gL; to[%d] = %.17gL;"):format(i - 1, window[1], i - 1, window[2])
    end
    parts[#parts + 1] = ("windows = %d;"):format(#(m.windows or {}))
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
  local t, x, i, worst = run.t, run:column(m.name), 1, 0
  for k, time in ipairs(m.at) do
    while i + 1 < #t and t[i + 1] < time do i = i + 1 end
    local f = (time - t[i]) / (t[i + 1] - t[i])
    worst = math.max(worst, math.abs((1 - f) * x[i] + f * x[i + 1] - m.exact[k]))
  end
  return worst
end

--- One model through a scene: { refused = words } or { worst, tolerance, estimate, seconds }; worst
-- of rows at those times and of lines between those of a plain run.
function M.try(m, seconds)
  m.name = m.watch and next(m.watch) or "q1"
  local began = dm.cpu()
  local scene = dm.scene { dm.system { Q = dm.R(m.n), L = m.L, force = m.force, constraint = m.constraint }, q = m.q, v = m.v, watch = m.watch or { "q1" }, tolerance = m.tolerance,
    until_t = m.T, seconds = seconds }
  local fine, why = pcall(scene.why, scene)
  local spent = dm.cpu() - began
  if not fine then return { refused = tostring(why), seconds = spent } end
  local run, worst = scene:run { at = m.at }, 0
  local q1 = run:column(m.name)
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
