--- What a run of a field on a mesh that failed may come from: a step beyond the limit of stability,
-- a cell that has turned inside out.
local blame = require "dm.base.blame"
local core = require "dm.core"
local images = require "dm.dec.fields.images"

local M = {}

local LARGE = 20000 -- values of fields whose limit is not looked for

-- the cell of the largest value of a row
local function largest_text(f, x)
  local at, most = 1, 0
  for i = 1, #x do
    if math.abs(x[i]) > most then at, most = i, math.abs(x[i]) end
  end
  local cell = f.mesh:simplices(f.degree)[(at - 1) // f.values + 1]
  return ("; the values are largest, %.3g, at the cell {%s}"):format(most, table.concat(cell, ", "))
end

-- the limit about the first row or the last one, where h is beyond it
local function beyond(system, rule, h, path)
  local f, rows = system.field, { { #path, "the last row" } }
  if not path.file then table.insert(rows, 1, { 1, "the start" }) end
  if rule:find "^prismal" then rule = "verlet" end -- what its slices are stepped by
  for _, row in ipairs(rows) do
    local fine, limit = blame.try(system.stability_limit, system, rule, { q = path.q[row[1]],
      t = path.t[row[1]] })
    if fine and h > limit * (1 + 1e-9) then
      return ("h = %.6g is beyond the limit of stability, %.6g about %s (field:stability_limit)")
        :format(h, limit, row[2]) .. largest_text(f, path.q[#path])
    end
  end
end

local FAR = 1e100 -- values that are larger have left by themselves

-- the cell that is inside out at x, and by which L has no value there
local function inverted(system, x)
  local cell = x:norm() < FAR and images.inverted(system.field, x)
  if not cell then return nil end
  local fine = blame.try(system.energy, system, x, 0 * x)
  return not fine and cell or nil
end

-- the cell that is inside out at the last row, or where its velocity takes it in a step
local function turned(system, h, path)
  local f, x, p = system.field, 1 * path.q[#path], path.p[#path]
  local masses = f.masses
  local drifted = x:map(function(q, i) return f.held[i] and q or q + h * p[i] / masses[i] end)
  local cell = inverted(system, x) or inverted(system, drifted)
  return cell and ("cell {%s} turns inside out there: try a smaller step (h = %.6g), or a slower "
    .. "start"):format(table.concat(cell, ", "), h / 2)
end

local function reason(system, rule, h, path)
  local f = system.field
  if f.sphere or f.n > LARGE or #path == 0 then return nil end
  return turned(system, h, path) or beyond(system, rule, h, path)
end
M.reason = reason

local TOLD = { not_finite = true, no_convergence = true, singular = true }

-- L is NaN at the start: of which cell is it?
local function at_start(f, message, q)
  if not message:find "L is NaN at the start" then return message end
  local fine, x = blame.try(function() return core.vector(f.start(q, "q")) end)
  local cell = fine and #x == f.n and images.inverted(f, x)
  return cell and ("%s (the image of cell {%s} is inverted or degenerate)"):format(message,
    table.concat(cell, ", ")) or message
end

---- growth without end ----

local GROWN = 2 ^ 104 -- energy over that of the start: no digit of it is left

-- kinetic energy of a row
local function kinetic(f, p)
  local sum, masses = 0, f.masses
  for i = 1, f.n do
    if p[i] ~= 0 then sum = sum + p[i] ^ 2 / (2 * masses[i]) end
  end
  return sum
end

-- q, p of the start: the first row, or, where rows are in a file, what the run was given
local function first_of(f, path, options)
  if #path > 1 then return path.q[1], path.p[1] end
  if not options.q or not (options.v or options.p) then return nil end
  local q = core.vector(f.start(options.q, "q"))
  local x = core.vector(f.start(options.p or options.v, options.p and "p" or "v"))
  if options.p then return q, x end
  local masses = f.masses
  return q, x:map(function(v, i) return masses[i] * v end)
end

-- Has the energy of a closed system grown as no motion makes it? What leaves an unstable rest has
-- errors that are far below its kinetic energy.
local function has_grown(system, path, options)
  local f, last = system.field, #path
  if f.force or f.absorbing or last < 1 or not system:structure().autonomous then return false end
  local q, p = first_of(f, path, options)
  if not q then return false end
  local q1, p1 = path.q[last], path.p[last]
  if not (q1:norm() + p1:norm() > GROWN ^ 0.4 * (q:norm() + p:norm())) then return false end
  local first, moving, still = kinetic(f, p), kinetic(f, p1), core.constant(f.n, 0)
  local before = system:energy(q, still) -- of the potential
  local finite, after = blame.try(system.energy, system, q1, still)
  if not finite or moving == math.huge then return true end -- its squares overflow
  local off = math.abs(after + moving - before - first)
  return off > GROWN * (first + math.abs(before)) and off > 0.1 * moving
end

--- Raises for a path whose energy has grown so; options: of its run; h: the largest step; why: what
-- it comes from, where that is known.
function M.check_growth(system, path, options, h, why)
  local seen, grown = blame.try(has_grown, system, path, options)
  if not seen or not grown then return end
  local rule = tostring(path.rule)
  why = why and why .. largest_text(system.field, path.q[#path]) or beyond(system, rule, h, path)
    or ("a smaller step (h = %.6g) may be stable"):format(h / 2)
      .. largest_text(system.field, path.q[#path])
  core.strip_fail({ code = "blow_up", done = path.steps, time = path.t[#path], h = h }, rule, path,
    why)
end

--- solver:run of a field by `plain`; h: the largest step. Failures say what they come from; an
-- energy that has outgrown the start is one.
function M.run(plain, solver, system, options, h)
  local fine, path = blame.try(plain, solver, options)
  if fine then
    M.check_growth(system, path, options, h)
    return path
  end
  local failure, f = path, system.field
  if type(failure) == "string" then
    error(at_start(f, failure, type(options) == "table" and options.q), 0)
  end
  if TOLD[failure.code] and failure.path then
    local told, why = blame.try(reason, system, failure.rule, h, failure.path)
    if told and why then
      failure.message = failure.message:gsub("(at step %d+ %(t = [^)]*%)); .*$",
        function(head) return head .. "; " .. why end)
    end
  end
  error(failure, 0)
end

return M
