--- Fields of several sizes: what is compared at the end of their runs, of each kind of field.
local blame = require "dm.base.blame"
local core = require "dm.core"
local form = require "dm.dec.form"
local grids = require "dm.line.grid"
local lists = require "dm.base.lists"

local M = {}

local fail = require "dm.base.options".failing "dm.chart"

-- of the cells of a mesh: (volume / their number)^(1/n)
local function width_of(K)
  local sum, volumes = 0, K:volume(K.dimension)
  for i = 1, #volumes do sum = sum + volumes[i] end
  return (sum / #volumes) ^ (1 / K.dimension)
end

-- f(..., t) at one time
local function at(f, t)
  return function(...)
    local list = { ... }
    list[#list + 1] = t
    return f(table.unpack(list))
  end
end

-- number of vertices of K by their places, to nine digits
local function places_of(K)
  local points, out = K:points(), {}
  for i = 1, #points do
    local text = {}
    for c = 1, #points[i] do
      text[c] = ("%.9f"):format(points[i][c] + 0.0):gsub("^%-(0%.0+)$", "%1")
    end
    out[table.concat(text, " ")] = i
  end
  return out, points
end

-- values on the vertices of K of those of a finer mesh that are at the same places
local function at_vertices(fine, K, values, each)
  local finer, out = places_of(fine), core.zeros(K:count(0) * each)
  local coarse, points = places_of(K)
  for place, i in pairs(coarse) do
    local j = finer[place]
    if not j then
      fail("the meshes are not of one set, and vertex %d of the coarser one, at (%s), is none of "
        .. "the finest: give exact = a function of the position and t", i,
        table.concat(lists.part(points[i], 0, #points[i]), ", "))
    end
    for c = 1, each do out[(i - 1) * each + c] = values[(j - 1) * each + c] end
  end
  return out
end

-- values of k-forms of a finer mesh on K: by dm.remesh, component by component
local function transferred(fine, K, degree, values, each)
  local remesh = require "dm.dec.dynamics.remesh".remesh
  local fine_cells, out = fine:count(degree), core.zeros(K:count(degree) * each)
  local moved, why = blame.try(function()
    local T = remesh(fine, K)
    for c = 1, each do
      local part = core.zeros(fine_cells)
      for i = 1, fine_cells do part[i] = values[(i - 1) * each + c] end
      local a = T(form.new(fine, degree, "primal", part)).values
      for i = 1, #a do out[(i - 1) * each + c] = a[i] end
    end
  end)
  if moved then return out end
  if not tostring(why):find "not of one set" or degree > 0 then error(why, 0) end
  return at_vertices(fine, K, values, each)
end

---- kinds ----

-- keys of a start; values of the last row of a run; weights of their squares; width of a cell;
-- values of a function of the position and t; values of those of a finer field
local kinds = {}

kinds.mesh = {
  keys = { "q", "v", "p" },
  values = function(_, path) return path.q[#path] end,
  weights = function(field) return field.field.masses end,
  width = function(field) return width_of(field.field.mesh) end,
  exact = function(field, f, t) return field.field.start(at(f, t), "exact") end,
  from = function(field, fine, values)
    local f = field.field
    return transferred(fine.field.mesh, f.mesh, f.degree, values, f.values)
  end,
}

kinds.line = {
  keys = { "u", "ut", "p" },
  values = function(_, run) return run.u[#run] end,
  weights = function(field) return core.constant(field.nodes * field.values, field.dx) end,
  width = function(field) return field.dx end,
  exact = function(field, f, t)
    return grids.values(field.grid, at(f, t), field.values, "exact", "dm.chart")
  end,
  from = function(field, fine, values)
    local ratio, n = fine.cells // field.cells, field.values
    if fine.cells % field.cells ~= 0 or fine.from ~= field.from or fine.to ~= field.to then
      fail("the nodes of a line of %d cells are none of those of %d: sizes must divide the finest "
        .. "one, or give exact = f(x, t)", field.cells, fine.cells)
    end
    local out = core.zeros(field.nodes * n)
    for i = 0, field.nodes - 1 do
      for c = 1, n do out[i * n + c] = values[i * ratio * n + c] end
    end
    return out
  end,
}

kinds.boxes = {
  keys = { "z" },
  values = function(field, run, component)
    local name = component or field.names[1]
    for _, known in ipairs(field.names) do
      if known == name then return run[name][#run] end
    end
    fail("option 'component' must be one of %s (got %s)", table.concat(field.names, ", "),
      tostring(name))
  end,
  weights = function(field) return core.constant(field.cells, field.dx) end,
  width = function(field) return field.dx end,
  exact = function(field, f, t)
    local out = core.zeros(field.cells)
    for i = 1, field.cells do out[i] = f(field.from + (i - 1) * field.dx, t) end
    return out
  end,
  from = function(field, fine, values)
    local ratio, out = fine.cells // field.cells, core.zeros(field.cells)
    if fine.cells % field.cells ~= 0 then
      fail("the nodes of %d boxes are none of those of %d: sizes must divide the finest one, or "
        .. "give exact = f(x, t)", field.cells, fine.cells)
    end
    for i = 0, field.cells - 1 do out[i + 1] = values[i * ratio + 1] end
    return out
  end,
}

kinds.flow = {
  keys = { "vorticity" },
  values = function(_, run) return run.w[#run] end,
  weights = function(field) return field.mesh:dual_volume(0) end,
  width = function(field) return width_of(field.mesh) end,
  exact = function(field, f, t) return field.mesh:form(0, at(f, t)).values end,
  from = function(field, fine, values) return transferred(fine.mesh, field.mesh, 0, values, 1) end,
}

local OF = { ["dm.line_field"] = "line", ["dm.boxes"] = "boxes", ["dm.euler"] = "flow" }

--- The kind of a field, nil where it is none.
function M.kind(field)
  local meta = getmetatable(field)
  local name = meta and meta.__name
  if name == "dm.system" then return field.field and kinds.mesh or nil end
  return kinds[OF[name]]
end

return M
