--- Back to the group from a path of dm.euler_poincare.
local core = require "dm.core"
local option = require "dm.base.options"
local starts = require "dm.group.starts"

local M = {}

-- the system of it: (s g)^-1 (s a) is g^-1 a
local function system_from(path, place, shift)
  local reduced = place.reduced
  local a = reduced and reduced.carry and (path.a or reduced.a)
  return a and reduced.with(reduced.carry(place.element(shift), a)) or path.system
end

-- coordinates of the element that takes the first row, which need not be the identity, to g0
local function shift_to(place, g0, first)
  local back = place.flat(place.kit.inverse(place.element(first)))
  return place.right and place.carry(back, g0) or place.carry(g0, back)
end

--- The path over a reduced one that starts at the element q: s g_k, with the same momenta.
function M.reconstruct(path, options)
  local own, what = path.system.place, "path:reconstruct"
  option.check(options, { "q", "project" }, what, "{ q = g0 }")
  local g0 = starts.on_group(own, option.need(options, "q", what, "the element at the start"),
    options.project)
  local columns, n, d = { path:column "t" }, own.size, own.dimension
  local q = {}
  for i = 1, n do q[i] = path:column("q" .. i) end
  local rows, first = {}, {}
  for i = 1, n do first[i] = q[i][1] end
  local shift = shift_to(own, g0, first)
  for k = 1, #path do
    local here = {}
    for i = 1, n do here[i] = q[i][k] end
    rows[k] = own.right and own.carry(here, shift) or own.carry(shift, here)
  end
  for i = 1, n do
    local column = {}
    for k = 1, #path do column[k] = rows[k][i] end
    columns[1 + i] = core.vector(column)
  end
  for i = 1, d do columns[1 + n + i] = path:column("p" .. i) end
  return core.path { system = system_from(path, own, shift), h = path.h, rule = path.rule,
    steps = path.steps, columns = columns }
end

return M
