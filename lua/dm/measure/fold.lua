--- Where a step ends to exist: folds of implicit step equations by continuation in h.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local option = require "dm.base.options"
local starts = require "dm.base.start"

local M = {}

local abs, min, huge = math.abs, math.min, math.huge

local START = "{ q =, v = } or { q =, p = }"

-- the time of a step, for discrete Lagrangians of a system; formulas have none
local function time_of(solver, t0)
  return not solver.system.Ld and t0 or nil
end

-- the discrete Lagrangian of a solver with another step
local function with_step(solver, h)
  local system = solver.system
  if system.Ld then
    return core.discrete_lagrangian { Q = system.Q, h = h, Ld = system.Ld, params = system.params }
  end
  return core.discrete_lagrangian(system, { rule = solver.rule, h = h })
end

-- how positions move: plus(q, d), minus(a, b) with plus(b, minus(a, b)) = a, size(q0, q1); elements
-- of a group by translations from the right, as Ld:two_form has them
local function moves_of(system)
  local G = system.Q
  if not system.place then
    return { plus = function(q, d) return q + d end, minus = function(a, b) return a - b end,
      size = function(q0, q1) return 1e-300 + q1:norm() + q0:norm() end }
  end
  return { plus = function(g, d) return G:compose(g, G:exp(d)) end,
    minus = function(a, b) return G:log(G:compose(G:inverse(b), a)) end,
    size = function() return 1 end }
end

-- q1 with p0 + D1 Ld(q0, q1) = 0 from a guess, and det(-h D1D2 Ld), which tends to that of the mass
-- with h; nil: none was found
local function solve(solver, moves, start, guess, h)
  local q0, p0, t = start.q, start.p, start.t
  local Ld, q1, last = with_step(solver, h), guess, huge
  for _ = 1, 30 do
    local fine, r = blame.try(Ld.legendre_minus, Ld, q0, q1, t)
    local also, W = blame.try(Ld.two_form, Ld, q0, q1, t)
    if not (fine and also) then return nil end
    local solved, d = blame.try(W.solve, W, p0 - r)
    if not solved then return nil end
    local moved, there = blame.try(moves.plus, q1, d)
    if not moved then return nil end
    q1 = there
    local size = d:norm() / moves.size(q0, q1)
    if size ~= size or size > 1e3 then return nil end
    if size < 1e-14 or (size < 1e-11 and size >= 0.5 * last) then
      fine, W = blame.try(Ld.two_form, Ld, q0, q1, t)
      if not fine then return nil end
      return q1, (W * h):det()
    end
    last = size
  end
end

local CLOSE = 1e-9  -- relative distance of the last step with a solution from the first without

-- where det^2, which is linear in h near a fold, vanishes
local function extrapolate(a, b)
  local slope = (b.det ^ 2 - a.det ^ 2) / (b.h - a.h)
  return slope < 0 and b.h - b.det ^ 2 / slope or huge
end

-- follow the solution from a small step; the last two points with one, and whether the end `up_to`
-- was reached
local function follow(solver, moves, start, from, up_to)
  local before, here = nil, { h = 0, q1 = start.q }
  local h, grow = from, 1.25
  while true do
    local guess = moves.plus(start.q, start.v * h)
    if before then
      local ratio = (h - here.h) / (here.h - before.h)
      guess = moves.plus(here.q1, moves.minus(here.q1, before.q1) * ratio)
    end
    local q1, det = solve(solver, moves, start, guess, h)
    local sign = q1 and (here.det == nil or det * here.det > 0)
    if sign then
      before, here = here, { h = h, q1 = q1, det = det }
      if h >= up_to then return before, here, true end
      local fold = before.det and extrapolate(before, here) or huge
      h = min(h * grow, up_to, fold < h * grow and h + 0.9 * (fold - h) or huge)
    else
      if here.h == 0 then return nil end
      h = here.h + 0.5 * (h - here.h)
      grow = 1 + 0.5 * (grow - 1)
    end
    if h - here.h < CLOSE * here.h then return before, here, false end
  end
end

local SMALL = 0.05  -- of det: the matrix is singular at the end

-- is the step of this solver one equation for q1, from the start as it is given?
local function check_start(solver, options, what, rule)
  local given = solver.system.given or solver.system
  for _, key in ipairs { "constraint", "rolling", "force" } do
    if given[key] ~= nil then
      error(("%s: for steps without constraints and forces (this one has '%s')")
        :format(what, key), 0)
    end
  end
  if solver.system.Ld then
    if options.p then return end
    error(what .. ": a discrete Lagrangian knows no velocity: give the momentum p", 0)
  end
  starts.check_one(options, what)
  if not options.v and not options.p then
    error(what .. ": give the start as q and v or as q and p", 0)
  end
  local step = { rule = solver.rule, h = solver.h }
  local fine, why = blame.try(core.discrete_lagrangian, solver.system, step)
  if not fine then
    error(("%s: the step of '%s' is not one equation for q1: it is explicit, or composed of "
      .. "steps (%s)"):format(what, rule, tostring(why):match "^[^\n]*"), 0)
  end
end

-- q, p, the velocity and the time of the start
local function start_of(solver, options)
  local system = solver.system
  local t = time_of(solver, options.t0 or 0)
  local p = core.vector(options.p or system:legendre(options.q, options.v, t))
  local v = options.v and core.vector(options.v)
    or not system.Ld and system:velocity(options.q, p, t) or p * 0
  local place = system.place
  return { q = place and place.kit.element(options.q) or core.vector(options.q), p = p, v = v,
    t = t }
end

local FOLD = "%s: fold at h = %.8g: two solutions of the step equation meet there, its matrix is "
  .. "singular (determinant %.1g of that of a small step), and beyond there is none"
local LEFT = "%s: Newton's method finds no solution beyond h = %.8g, although the matrix of the "
  .. "step is regular there (determinant %.2g of that of a small step): the solution leaves the "
  .. "domain of L, or is further than Newton's method reaches"

-- what the end of the solutions is: `before` and `here` are the last two of them, `first` the
-- determinant at a small step
local function describe_end(rule, before, here, first)
  local ratio = abs(here.det / first)
  local fold = ratio < SMALL
  local h = here.h
  if before.det and fold then h = min(extrapolate(before, here), here.h * (1 + 1e-4)) end
  local why = (fold and FOLD or LEFT):format(rule, h, ratio)
  return core.result { h = h, fold = fold, q1 = here.q1, why = why }
end

M.fold = blame.caller(function(solver, options)
  if solver.system.place and solver.system.place.right then
    error("solver:fold: on groups with the left trivialization only", 0)
  end
  if solver.system and solver.system.field then
    error("solver:fold: not of fields, whose second derivatives are no full matrix; a step that "
      .. "has no solution ends the run with a dm.failure", 0)
  end
  options, solver = starts.lists(options, solver)
  local what, rule = "solver:fold", tostring(solver.rule or "del")
  option.check(options, { "q", "v", "p", "t0", "up_to" }, what, START)
  option.need(options, "q", what, START)
  option.number(options, "t0", what)
  check_start(solver, options, what, rule)
  local up_to = option.positive(options, "up_to", what, "a step", 256 * solver.h)
  local start = start_of(solver, options)
  local least, moves = min(solver.h, up_to) / 64, moves_of(solver.system)
  local before, here, reached = follow(solver, moves, start, least, up_to)
  if not here then
    error(("%s: not even h = %g has a solution near q + h v"):format(what, least), 0)
  end
  if reached then
    local why = "%s: the step equation is solvable up to h = %.6g, without a fold"
    return core.result { h = huge, fold = false, q1 = here.q1, why = why:format(rule, up_to) }
  end
  local small = here.h / 512
  local found, det = solve(solver, moves, start, moves.plus(start.q, start.v * small), small)
  return describe_end(rule, before, here, found and det or here.det)
end)

class.method("dm.solver", "fold", M.fold, [[
solver:fold{q=, v= | p=, t0=, up_to=} -> {h, fold, q1, why}
Up to which step does an implicit step from this state have a solution? The solution q1 of p + D1
Ld(q, q1) = 0 is followed from small h to up_to (default 256 steps of the solver) and the fold,
where two solutions meet, found where det D1D2 Ld vanishes; h is infinite when there is none. fold =
false with a finite h: Newton's method gives up although the matrix is regular, as where the chart
of a group ends, at half a turn. Stage rules and discrete Lagrangians, without constraints and
forces; lie(s) on groups. t0: the time of the start (0).]])

return M
