--- Laws of a run on a line: the multisymplectic form formula (Marsden, Patrick, Shkoller 1998; Leok
-- 5.1.3) and discrete Noether's theorem, as sums over the boundary of the cells around each node.
local blame = require "dm.base.blame"
local core = require "dm.core"
local grids = require "dm.line.grid"
local lists = require "dm.base.lists"
local moving = require "dm.line.moving"
local option = require "dm.base.options"
local sample = require "dm.line.sample"

local M = {}

local MOST = 3e8  -- numbers of all levels

-- all levels and their times, taken again where rows were left out
local function all_levels(run, where)
  if run.steps < 1 then option.fail(where, "a run of at least one slab is needed") end
  if run.every == 1 and not run.file then return run.levels, run.t end
  local solver, level = run.solver, run.level
  if run.steps * #level.u > MOST then
    option.fail(where, "all %d levels of %d numbers are needed at once: ask a shorter run",
      run.steps, #level.u)
  end
  local again = level.strip:run { u = level.u, p = level.p, guess = level.guess,
    from = level.from, t0 = run.t0, h = solver.h, steps = run.steps, every = 1,
    free = solver.stretches }
  return again.u, again.t
end

-- nodes without a law: fixed ones, where the equation is missing, and those that a force acts on
local function left_out(run, held)
  local field = run.field
  local out, n = core.zeros(field.nodes), #held // field.nodes
  for i = 1, field.nodes do
    for k = 1, n do
      if held[(i - 1) * n + k] ~= 0 then out[i] = 1 end
    end
  end
  if field.absorbing.left then out[1] = 1 end
  if field.absorbing.right then out[field.nodes] = 1 end
  return out
end

-- marks of all numbers of a level that stay
local function held_of(run)
  local field = run.field
  if not run.solver.moves then return field.held end
  return moving.joined(field.held, run.level.frozen, field.nodes, field.values)
end

---- the form formula ----

-- entries uniform in [-1, 1], 0 where held
local function random_level(seed, row, held)
  local random, out = core.random(seed), core.zeros(#held)
  for k = 1, #held do
    if held[k] == 0 then out[k] = 2 * random:uniform(row, k) - 1 end
  end
  return out
end

core.method("dm.line_run", "multisymplectic", blame.caller(function(run, options)
  local where = "run:multisymplectic"
  options = option.check(options or {}, { "seed" }, where)
  local seed = option.whole(options, "seed", where, 0, 1 << 53, 1)
  local u, t = all_levels(run, where)
  local held, strip = held_of(run), run.level.strip
  local function variation(row)
    return (strip:vary { u = u, t = t, v = random_level(seed, row, held),
      dp = random_level(seed, row + 1, held) })
  end
  return strip:residual { u = u, t = t, v = variation(1), w = variation(3),
    leave = left_out(run, run.field.held), area = 1 }
end), [[
run:multisymplectic({seed=}) -> number, number
The largest residual of the multisymplectic form formula: two first variations V, W of the run, from
random variations of u and p at the start (entries uniform in [-1, 1]), and around each node the sum
of dS_i(V) W_i - dS_i(W) V_i over the boundary of the cells that meet there (Leok 5.1.3). Round-off
for every L; nodes that are fixed or absorb have no law. With free heights the times of the levels
are held. The second number is the largest sum of such terms without signs that a cell's corner has:
round-off is some 1e-16 of it. It is large where V and W grow, as with free nodes, which have hardly
any mass of their own where u is nearly straight.]])

---- Noether ----

-- xi at all nodes of all levels
local function currents(run, u, t, generator, where)
  local field = run.field
  local n, total = field.values, #u[1]
  local each = total // field.nodes
  local out, text = core.zeros(#u, total), "the generator must give %s (got %s)"
  for j = 1, #u do
    local level, row = u[j], out[j]
    for i = 1, field.nodes do
      local first = (i - 1) * each
      local x = grids.x(field.grid, i) + (each > n and level[first + n + 1] or 0)
      local xi = generator(n == 1 and level[first + 1] or lists.part(level, first, n), x, t[j])
      if type(xi) == "number" then xi = { xi } end
      if lists.count(xi) ~= n then
        option.fail(where, text, n == 1 and "a number" or ("%d numbers"):format(n),
          option.got(xi))
      end
      for k = 1, n do row[first + k] = xi[k] end
    end
  end
  return out
end

local function mean_area(run, t)
  return (t[#t] - t[1]) / run.steps * run.field.dx
end

local function of_values(run, generator, where)
  local u, t = all_levels(run, where)
  return (run.level.strip:residual { u = u, t = t, xi = currents(run, u, t, generator, where),
    leave = left_out(run, run.field.held), area = mean_area(run, t) })
end

-- shifts of x: every node moves by 1; on fixed nodes by the cells of moving ones, all at rest
local function of_place(run, where)
  local field, solver = run.field, run.solver
  local u, t = all_levels(run, where)
  local strip, n = run.level.strip, field.values
  if not solver.moves then
    if sample.of_L(field) ~= run.level.law then
      option.fail(where, "L is not that of the run any more: what it reads has changed")
    end
    local zeros = core.zeros(field.nodes * (n + 1))
    strip = core.strip(moving.action(field.L, solver.points, n, field.dx), { values = n + 1,
      cells = field.cells, ring = field.periodic, held = zeros, absorbs = { 0, 0 },
      place = grids.lefts(field.grid) })
    local all = core.zeros(#u, field.nodes * (n + 1))
    for j = 1, #u do
      local row = moving.joined(u[j], nil, field.nodes, n)
      for k = 1, #row do all[j][k] = row[k] end
    end
    u = all
  end
  local xi = core.zeros(#u, field.nodes * (n + 1))
  for j = 1, #u do
    for i = 1, field.nodes do xi[j][i * (n + 1)] = 1 end
  end
  local leave = left_out(run, field.held)
  for i = 1, field.nodes do
    local is_end = not field.periodic and (i == 1 or i == field.nodes)
    if is_end or solver.moves and run.level.frozen[i] ~= 0 then leave[i] = 1 end
  end
  return (strip:residual { u = u, t = t, xi = xi, leave = leave, area = mean_area(run, t) })
end

-- shifts of t: the energy of a slab less that of the one before, a unit of time and length
local function of_time(run, where)
  local u, t = all_levels(run, where)
  local energy, power = run.level.strip:energies { u = u, t = t }
  local largest, field = 0, run.field
  for k = 2, #energy do
    local lost = 0
    for side, c in pairs(field.absorbing) do -- half of the force of either slab
      for v = 1, c and field.values or 0 do
        local at = (side == "left" and 0 or field.nodes - 1) * (#u[1] // field.nodes) + v
        for s = k - 1, k do
          lost = lost + c * (u[s + 1][at] - u[s][at]) ^ 2 / (t[s + 1] - t[s]) / 2
        end
      end
    end
    local h = (t[k + 1] - t[k - 1]) / 2
    largest = math.max(largest, math.abs(energy[k] + power[k] - energy[k - 1] + lost) / h)
  end
  return largest / (field.to - field.from)
end

core.method("dm.line_run", "conservation", blame.caller(function(run, generator)
  local where = "run:conservation"
  if generator == "x" then return of_place(run, where) end
  if generator == "t" then return of_time(run, where) end
  if type(generator) ~= "function" then
    option.fail(where, "takes a function(u, x, t), the generator of a symmetry, \"t\" or \"x\" "
      .. "(got %s)", option.got(generator))
  end
  return of_values(run, generator, where)
end), [[
run:conservation(function(u, x, t) | "t" | "x") -> number
The largest residual of a discrete conservation law, a unit of time and length. A generator xi(u, x,
t): around each node the sum of S_i . xi_i over the boundary of the cells that meet there, which is
round-off where every cell has the symmetry (shifts, rotations of u). "x": the same for shifts of
the nodes, round-off with free = "x". "t": the energy of each slab against that of the one before,
round-off with free = "t". Else their order, 2. Nodes that are fixed, absorb, or do not move with
the others have no law of their own.]])

return M
