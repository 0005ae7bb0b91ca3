--- Multisymplectic equations M z_t + K z_x = grad S(z) on a ring by Preissman's box (Bridges, Reich
-- 2001; Leok 5.1): dm.multisymplectic.
local algebra = require "dm.line.box_algebra"
local blame = require "dm.base.blame"
local box_run = require "dm.line.box_run"
require "dm.line.box_laws"
local checkpoint = require "dm.data.checkpoint"
local core = require "dm.core"
local grids = require "dm.line.grid"
local lacking = require "dm.base.lacking"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local strips = require "dm.line.box_strip"

local M = {}

local KNOWN = { "M", "K", "S", "names", "gain", "x" }
local fail = option.failing "dm.multisymplectic"

local Boxes = core.class({ __name = "dm.boxes" }, [[
dm.boxes: M z_t + K z_x = grad S(z) on a ring, made by dm.multisymplectic
fields: M, K, S, names, from, to, cells, dx]])

local Solver = core.class({ __name = "dm.box_solver" }, [[
dm.box_solver: boxes with a height, made by boxes:solver
fields: boxes, h, held (names of components with a gauge mode, whose first node is held)]])
lacking.refuse(Solver, { fellow = "dm.solver", what = "solver of boxes", reasons = {
  ensemble = "a member is a run of its own: call solver:run for each start",
  step = "run { steps = 1 } makes one step",
  symplecticity = "run:balance \"multisymplectic\" is the residual of its law",
  tangent = "run:balance \"multisymplectic\" follows first variations",
} })

---- what is given ----

local function square(given, key, d)
  local fine, matrix = blame.try(core.matrix, given)
  if not fine or #matrix ~= #matrix[1] or d and #matrix ~= d then
    fail("option '%s' must be a matrix of %s numbers (got %s)", key,
      d and ("%d x %d"):format(d, d) or "d x d", option.got(given))
  end
  for i = 1, #matrix do
    for j = 1, #matrix do
      if matrix[i][j] ~= -matrix[j][i] then
        fail("option '%s' must be antisymmetric, but its entries (%d, %d) and (%d, %d) are %g and "
          .. "%g", key, i, j, j, i, matrix[i][j], matrix[j][i])
      end
    end
  end
  return matrix
end

-- Raises where no row has a derivative by t.
local function check_moves(matrix)
  for i = 1, #matrix do
    for j = 1, #matrix do
      if matrix[i][j] ~= 0 then return end
    end
  end
  fail "option 'M' is 0: nothing moves in time"
end

local function names_of(given, d)
  local names, seen = {}, {}
  if given ~= nil and lists.count(given) ~= d then
    fail("option 'names' must list %d names (got %s)", d, lists.count(given) or option.got(given))
  end
  for c = 1, d do
    local name = given and given[c] or "z" .. c
    if type(name) ~= "string" or not name:match "^[%a_][%w_]*$" or seen[name]
      or box_run.reserved[name] then
      fail("option 'names': %s is no name for a component%s", option.got(name),
        box_run.reserved[name] and ", a run has a field of that name" or "")
    end
    names[c], seen[name] = name, c
  end
  return names, seen
end

local function gain_of(given, number)
  local gain, count = {}, given == nil and 0 or lists.count(given)
  if not count or count == 0 and given ~= nil and next(given) ~= nil then
    fail("option 'gain' must list names of components (got %s)", option.got(given))
  end
  for i = 1, count do
    local c = number[given[i]]
    if not c then fail("option 'gain': there is no component %s", option.got(given[i])) end
    gain[c] = true
  end
  return gain
end

-- S, with z as a table of its components by number and by name where S does not take vectors: z.u
local function by_names(S, names)
  local function named(z)
    local out = {}
    for c, name in ipairs(names) do out[c], out[name] = z[c], z[c] end
    return S(out)
  end
  local z = core.zeros(#names)
  for c = 1, #names do z[c] = 0.2 + 0.6 / c end
  return not blame.try(S, z) and blame.try(named, z) and named or S
end

--- The boxes of options.
M.multisymplectic = blame.caller(function(options)
  option.check(options, KNOWN, "dm.multisymplectic")
  for _, key in ipairs { "M", "K", "S", "x" } do
    option.need(options, key, "dm.multisymplectic", "M z_t + K z_x = grad S(z) on x = { from, to, "
      .. "nodes, periodic = true }")
  end
  local K = square(options.K, "K")
  local d = #K
  local MM = square(options.M, "M", d)
  check_moves(MM)
  option.callable(options, "S", "dm.multisymplectic", "z")
  local grid = grids.read(options.x, "dm.multisymplectic")
  if not grid.periodic then
    fail("boxes stand on a ring: give x = { from, to, cells, periodic = true } (dm.field has open "
      .. "lines)")
  end
  local names, number = names_of(options.names, d)
  local gain = gain_of(options.gain, number)
  local boxes = setmetatable({ M = MM, K = K, S = by_names(options.S, names), names = names,
    number = number, gain = gain, from = grid.from, to = grid.to, cells = grid.cells, dx = grid.dx,
    grid = grid, d = d }, Boxes)
  strips.derive(boxes)
  return boxes
end)

core.docs[M.multisymplectic] = [[
dm.multisymplectic{M=, K=, S=, x = {from, to, cells, periodic = true}, names=, gain=} -> dm.boxes
The equations M z_t + K z_x = grad S(z) for z with d components, by Preissman's box: one equation a
box and component, between means and differences of its four corners. M, K: antisymmetric d x d
matrices; S(z): a function of the vector z, or of its components by their names, z.u; names: of the
components (default z1, z2, ...); gain: names of those that gain a constant round the ring (S must
not depend on them).
So Klein-Gordon, sine-Gordon, KdV, Schroedinger and Zakharov equations are written; boxes:solver{h=}
steps them.]]

function Boxes.__tostring(b)
  return ("boxes for %s on a ring of %d cells from %g to %g"):format(table.concat(b.names, ", "),
    b.cells, b.from, b.to)
end

---- solvers ----

core.method("dm.boxes", "solver", blame.caller(function(boxes, options)
  local where = "boxes:solver"
  option.check(options, { "h" }, where)
  option.need(options, "h", where, "the height of a box")
  local h = option.positive(options, "h", where, "a height")
  if boxes.cells % 2 == 0 and algebra.is_singular(boxes.K) then
    option.fail(where, "the ring has an even number of cells (%d), and det K = 0: z = (-1)^i w "
      .. "with K w = 0 has no mean and no difference, so no step determines it; take %d cells",
      boxes.cells, boxes.cells + 1)
  end
  local solver = { boxes = boxes, h = h }
  strips.follow(solver)
  return setmetatable(solver, Solver)
end), [[
boxes:solver{h=} -> dm.box_solver
h: the height of a box. Refused where the step is singular since the ring has an even number of
cells and det K = 0. A component whose constant nothing determines (a gauge mode, as of KdV's
potential) is held at the first node: solver.held names it.]])

core.method("dm.boxes", "resume", blame.caller(function(boxes, from)
  return checkpoint.resume(require "dm.line.checkpoint".boxes, boxes, from)
end), [[
boxes:resume(file | run) -> dm.box_solver
A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
solver:run{steps=}, without z, gives the bits of a run that never stopped. Raises when the file is
not a whole checkpoint or the boxes are other ones.]])

function Solver.__tostring(s)
  local held = #s.held > 0 and (": the constant of %s is a gauge mode, held at the first node")
    :format(table.concat(s.held, ", ")) or ""
  return ("solver of %s, h = %.4g%s"):format(tostring(s.boxes), s.h, held)
end

core.method("dm.box_solver", "run", blame.caller(box_run.run), [[
solver:run{z = {name = f, ...}, steps= | t=, every=, t0=, file=, checkpoint=} -> dm.box_run
z: functions of x, or lists of a number for every node, for the components that have a z_t; others
follow, where they are left out, from rows without z_t, and where none tells them they start where
their means over the first two steps point to (only their means over steps occur in the equations).
What is given beside is moved onto its row without z_t (run.moved, and the text of a run, tell by
how much), or refused where it is off by a quarter of its size: at every level it would be off by
the same, with alternating signs. Where the kernel of M lies along no component y (K z_x - grad S) =
0 is solved for all y with y M = 0: what is left out follows, what is given is moved along the
kernel. file: a NumPy file that the rows go to as they come (t and the
components; dm.load reads it); the run keeps the first and the last one. checkpoint: a file for
where it ended, also where it was stopped (run:checkpoint).]])

return M
