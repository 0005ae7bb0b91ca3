--- Back to the group from a path of dm.euler_poincare.
local core = require "dm.core"
local option = require "dm.base.options"
local starts = require "dm.group.starts"

local M = {}

-- the system of it: (g0 g)^-1 (g0 a) is g^-1 a
local function system_from(path, place, g0)
  local reduced = place.reduced
  local a = reduced and reduced.carry and (path.a or reduced.a)
  return a and reduced.with(reduced.carry(place.element(g0), a)) or path.system
end

--- The path over a reduced one that starts at the element q: g0 g_k, with the same momenta.
function M.reconstruct(path, options)
  local own, what = path.system.place, "path:reconstruct"
  option.check(options, { "q", "project" }, what, "{ q = g0 }")
  local g0 = starts.on_group(own, option.need(options, "q", what, "the element at the start"),
    options.project)
  local columns, n, d = { path:column "t" }, own.size, own.dimension
  local q = {}
  for i = 1, n do q[i] = path:column("q" .. i) end
  local rows = {}
  for k = 1, #path do
    local here = {}
    for i = 1, n do here[i] = q[i][k] end
    rows[k] = own.right and own.carry(here, g0) or own.carry(g0, here)
  end
  for i = 1, n do
    local column = {}
    for k = 1, #path do column[k] = rows[k][i] end
    columns[1 + i] = core.vector(column)
  end
  for i = 1, d do columns[1 + n + i] = path:column("p" .. i) end
  return core.path { system = system_from(path, own, g0), h = path.h, rule = path.rule,
    steps = path.steps, columns = columns }
end

return M
