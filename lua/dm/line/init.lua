--- Fields on a line by cells of space and time (Leok 5.1): dm.field. docs/theory/fields.md tells
-- the theory.
local blame = require "dm.base.blame"
local checkpoint = require "dm.data.checkpoint"
local core = require "dm.core"
local grids = require "dm.line.grid"
local option = require "dm.base.options"
local rules = require "dm.line.rule"
local sample = require "dm.line.sample"
local solver = require "dm.line.solver"
require "dm.line.laws"

local M = {}

local KNOWN = { "x", "L", "values", "fixed", "absorbing", "params" }
local SIDES = { "left", "right", "ends" }
local fail = option.failing "dm.field"

local Field = core.class({ __name = "dm.line_field" }, [[
dm.line_field: a field u(t, x) on a line with a Lagrangian L(u, ut, ux, x, t), made by dm.field
fields: from, to, cells, nodes, dx, periodic, values (numbers of u), params]])

-- the ends that an option names: { left =, right = }
local function sides_of(given, key, grid)
  if given == nil then return {} end
  if grid.periodic then fail("option '%s': a ring has no ends", key) end
  option.one_of({ [key] = given }, key, "dm.field", SIDES)
  return { left = given ~= "right", right = given ~= "left" }
end

-- c of the force -c u_t at either end
local function absorbing_of(given, grid)
  if type(given) ~= "table" then
    local sides = sides_of(type(given) == "number" and "ends" or given, "absorbing", grid)
    local c = type(given) == "number" and given or 1
    return { left = sides.left and c, right = sides.right and c }
  end
  if grid.periodic then fail "option 'absorbing': a ring has no ends" end
  option.check(given, { "left", "right" }, "dm.field's absorbing")
  return { left = option.number(given, "left", "dm.field's absorbing"),
    right = option.number(given, "right", "dm.field's absorbing") }
end

local function check_absorbing(absorbing, fixed)
  for _, side in ipairs { "left", "right" } do
    local c = absorbing[side]
    if c and not (c > 0) then
      fail("option 'absorbing': the force -c u_t takes c > 0 (got %g on the %s)", c, side)
    end
    if c and fixed[side] then fail("the %s end is both fixed and absorbing", side) end
  end
end

-- a number for every number of a level, f(side) at the ends
local function at_ends(grid, n, f)
  local out = core.zeros(grid.nodes * n)
  for k = 1, n do
    out[k] = f "left"
    out[(grid.nodes - 1) * n + k] = f "right"
  end
  return out
end

-- Has L a derivative by ut[k] at one of the samples? Beside large terms its value does not tell.
local function has_slope(L, n, grid, k)
  local random = core.random(3)
  for row = 1, 5 do
    local u, ut, ux = sample.of(random, row, n)
    local fine, slope = blame.try(function()
      local by = core.derivative(function(w)
        return L(u, n == 1 and w[1] or w, ux, grid.from + 0.3 * grid.dx, 0.1 * row)
      end, n)
      return by(n == 1 and { ut } or ut)[k]
    end)
    if fine and slope ~= 0 then return true end
  end
  return false
end

-- Raises where L does not know the speed of a value: its equation then moves nothing. What L
-- refuses at numbers is left to the trace.
local function check_speeds(L, n, grid)
  local random = core.random(3)
  for k = 1, n do
    local seen, moves = false, false
    for row = 1, 5 do
      local function at(u, ut, ux) return L(u, ut, ux, grid.from + 0.3 * grid.dx, 0.1 * row) end
      local fine, a, b = blame.try(function()
        return at(sample.of(random, row, n)), at(sample.of(random, row, n, k))
      end)
      if not fine and tostring(a):find "must return" then error(a, 0) end
      if not fine then return end
      seen = seen or a == a
      moves = moves or a ~= b and a == a and b == b
    end
    if seen and not moves and not has_slope(L, n, grid, k) then
      fail("L does not depend on ut%s: its equation determines no motion", n > 1
        and ("[%d]"):format(k) or "")
    end
  end
end

local ARGUMENTS = { [4] = "x", [5] = "t" } -- of L, behind u, ut and ux

-- Raises where an argument of L is called like something that it is not: a second derivative, or a
-- parameter; it would be taken for that without a word.
local function check_arguments(L, params)
  local u = debug.getlocal(L, 1)
  for k = 4, 5 do
    local name = debug.getlocal(L, k)
    local rest = name and u and name:sub(1, #u) == u and name:sub(#u + 1) or ""
    if rest:find "^_?[xt][xt]+$" then
      fail("argument %d of L is %s, but is called %s like a second derivative: L knows u, u_t and "
        .. "u_x alone", k, ARGUMENTS[k], name)
    end
    if name and name ~= ARGUMENTS[k] and type(params) == "table" and params[name] ~= nil then
      fail("argument %d of L is %s, but is called like the parameter '%s': params are a table "
        .. "behind it, L(u, ut, ux, x, t, params), and the parameter is params.%s", k, ARGUMENTS[k],
        name, name)
    end
  end
end

-- L with the params as its last argument
local function with_params(options)
  local L, params = rules.guarded(options.L, "dm.field"), options.params
  if params == nil then return L end
  if type(params) ~= "table" then
    fail("option 'params' must be a table of numbers by name (got %s)", option.got(params))
  end
  return function(u, ut, ux, x, t) return L(u, ut, ux, x, t, params) end
end

--- The field of options.
M.field = blame.caller(function(options)
  option.check(options, KNOWN, "dm.field")
  local grid = grids.read(option.need(options, "x", "dm.field", "{ from, to, cells, periodic = }"),
    "dm.field")
  option.callable(options, "L", "dm.field", "(u, ut, ux, x, t)")
  check_arguments(option.need(options, "L", "dm.field", "a function of (u, ut, ux, x, t)"),
    options.params)
  local n = option.whole(options, "values", "dm.field", 1, 20, 1)
  local fixed = sides_of(options.fixed, "fixed", grid)
  local absorbing = absorbing_of(options.absorbing, grid)
  check_absorbing(absorbing, fixed)
  local field = setmetatable({ from = grid.from, to = grid.to, cells = grid.cells, dx = grid.dx,
    nodes = grid.nodes, periodic = grid.periodic, values = n, fixed = fixed,
    absorbing = absorbing, L = with_params(options), params = options.params or {}, grid = grid,
    given = options }, Field)
  field.check = function() check_speeds(field.L, n, grid) end
  field.check()
  field.held = at_ends(grid, n, function(side) return fixed[side] and 1 or 0 end)
  solver.trace(field)
  return field
end)

core.docs[M.field] = "dm.field{x = {from, to, cells, periodic=}, L=, values=, fixed=, absorbing=, "
  .. "params=} -> dm.line_field\n" .. [[
A field on a line: L(u, ut, ux, x, t) is its Lagrangian density; u is a number, or with values = n a
vector; params: a table that L gets as its last argument. Cells of space and time are bilinear, and
their action is made stationary (Leok 5.1.2). fixed = "ends", "left", "right": u stays there as at
the start. Other ends are natural: the momentum of the field flows out of none. absorbing = "ends",
"left", "right", c for both or { left = c, right = c }: the force -c u_t at the end node, c = 1 by
default, lets waves out whose impedance c is; field:reflection() says how much of others comes back.
See solver, stability_limit, resume.]]

---- what it says of itself ----

-- an end that absorbs; c that is not the impedance of the line sends a part back
local function absorbing_text(c, back)
  local part = back and math.abs(back) or 0
  return ("absorbing (c = %g%s)"):format(c, part > 0.005
    and (", %.2g of a wave comes back"):format(part) or "")
end

local function ends_text(field)
  if field.periodic then return "a ring" end
  local out, known, back = {}, blame.try(solver.reflection, field)
  for _, side in ipairs { "left", "right" } do
    local c = field.absorbing[side]
    out[#out + 1] = field.fixed[side] and "fixed"
      or c and absorbing_text(c, known and back[side] or nil) or "natural"
  end
  return out[1] == out[2] and out[1] .. " ends" or out[1] .. " and " .. out[2] .. " end"
end

function Field.__tostring(field)
  return ("field%s on [%g, %g]: %d cells of %.4g, %s"):format(
    field.values > 1 and (" of %d values"):format(field.values) or "", field.from, field.to,
    field.cells, field.dx, ends_text(field))
end

---- solvers ----

core.method("dm.line_field", "solver", blame.caller(solver.new), [[
field:solver{rule=, h=, free=} -> dm.line_solver
rule: "cell(gauss(r))" (default r = 2) or "cell(corners)", where L is looked at in a cell; h: the
height of a slab. free = "t": each slab's height is unknown, its energy that of the first one, whose
height is h (Leok 5.5, 5.6); free = "x": the nodes move, too, ends stay; free = {"t", "x"}: both.]])

core.method("dm.line_field", "resume", blame.caller(function(field, from)
  return checkpoint.resume(require "dm.line.checkpoint".field, field, from)
end), [[
field:resume(file | run) -> dm.line_solver
A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
solver:run{steps=} gives the bits of a run that never stopped. Raises when the file is not a whole
checkpoint or the field is another one.]])

core.method("dm.line_field", "stability_limit", blame.caller(function(field, rule, options)
  return solver.limit(field, rule, options)
end), [[
field:stability_limit(rule, {u=, t=}) -> number
The height h at which the fastest oscillation about the level u (a function of x, nodes; default: 0)
begins to grow: (-1)^k v becomes a motion there. math.huge where there is none: also of an elliptic
L, as that of minimal surfaces, whose waves grow at any h. t: the time that L is looked at, needed
where it depends on it. L must not depend on the sign of ut.]])

core.method("dm.line_field", "reflection", blame.caller(function(field, options)
  return solver.reflection(field, options)
end), [[
field:reflection({u=}) -> {left=, right=}
The part of a wave that comes back from absorbing ends, (Z - c) / (Z + c) with the impedance Z^2 = -
L_utut L_uxux at u = 0 or at the number u. Waves in a medium with dispersion come back more.]])

return M
