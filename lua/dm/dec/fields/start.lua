--- Starts of a field: q, v and p as forms, functions of the position, or lists of all values.
local core = require "dm.core"
local form = require "dm.dec.form"
local held = require "dm.dec.fields.held"
local images = require "dm.dec.fields.images"
local option = require "dm.base.options"

local M = {}

-- one value a cell: the integrals of f over cells
local function integrated(f, of)
  return f.mesh:form(f.degree, of).values
end

-- several values a cell: those of f at the centre; f returns a list
local function sampled(f, of, key)
  local out, at = core.constant(f.n, 0), 0
  of = core.one(of, ("the function of field '%s'"):format(key))
  for i, p in ipairs(held.centres(f.mesh, f.degree)) do
    local x = of(table.unpack(p))
    if type(x) ~= "table" and type(x) ~= "userdata" or #x ~= f.values then
      option.fail(("field '%s'"):format(key), "the function must return a list of %d numbers at "
        .. "every cell (got %s at cell %d)", f.values, option.got(x), i)
    end
    for c = 1, f.values do out[at + c] = x[c] end
    at = at + f.values
  end
  return out
end

local function of_form(f, a, key)
  local where = ("field '%s'"):format(key)
  if not rawequal(a.mesh, f.mesh) then option.fail(where, "the form is of another mesh") end
  if a.degree ~= f.degree or a.side ~= "primal" or f.values ~= 1 then
    option.fail(where, "a primal %d-form with %d number%s a cell is needed (got a %s)", f.degree,
      f.values, f.values == 1 and "" or "s", form.name(a))
  end
  return a.values
end

local function of_forms(f, list, key)
  local out = core.constant(f.n, 0)
  for c = 1, f.values do
    local a = of_form({ mesh = f.mesh, degree = f.degree, values = 1 }, list[c], key)
    for i = 1, #a do out[(i - 1) * f.values + c] = a[i] end
  end
  return out
end

local function is_list(x)
  return type(x) == "table" or type(x) == "userdata" and option.got(x) == "dm.vector"
end

-- a list of a cell's values for every cell, a matrix with a row for each
local function of_rows(f, rows, key)
  local out, at = core.constant(f.n, 0), 0
  for i = 1, f.cells do
    local row = rows[i]
    if not is_list(row) or #row ~= f.values then
      option.fail(("field '%s'"):format(key), "a list of %d numbers is needed for every cell (got "
        .. "%s for cell %d)", f.values, option.got(row), i)
    end
    for c = 1, f.values do out[at + c] = row[c] end
    at = at + f.values
  end
  return out
end

-- Has x a row for every cell?
local function has_rows(f, x)
  if type(x) == "userdata" then return option.got(x) == "dm.matrix" and #x == f.cells end
  return type(x) == "table" and #x == f.cells and is_list(x[1])
end

---- values on a sphere ----

local OFF = 1e-8 -- as far from the sphere, or across it, a start may be; it is then moved there

-- unit vectors, to round-off
local function normalized(f, x, key)
  local out = core.constant(f.n, 0)
  for i = 0, f.n - 1, f.values do
    local square = 0
    for c = 1, f.values do square = square + x[i + c] ^ 2 end
    local r = math.sqrt(square)
    if not (math.abs(r - 1) <= OFF) then
      option.fail(("field '%s'"):format(key), "the values of cell %d must be a unit vector (its "
        .. "length is %g)", i // f.values + 1, r)
    end
    for c = 1, f.values do out[i + c] = x[i + c] / r end
  end
  return out
end

-- vectors across q have no business in a rate
local function tangent(f, x, q, key)
  local out = core.constant(f.n, 0)
  for i = 0, f.n - 1, f.values do
    local across, size = 0, 0
    for c = 1, f.values do
      across, size = across + x[i + c] * q[i + c], size + math.abs(x[i + c])
    end
    if math.abs(across) > OFF * size then
      option.fail(("field '%s'"):format(key), "the values of cell %d must be tangent to the sphere "
        .. "(%g of them points along its position)", i // f.values + 1, across)
    end
    for c = 1, f.values do out[i + c] = x[i + c] - across * q[i + c] end
  end
  return out
end

-- q is read before v and p
local function on_sphere(f, x, key)
  if type(x) ~= "userdata" and type(x) ~= "table" or #x ~= f.n then return x end
  if key == "q" or key == "q0" or key == "q1" then
    f.last = normalized(f, x, key)
    images.check_opposite(f, f.last, ("field '%s'"):format(key))
    return f.last
  end
  return f.last and tangent(f, x, f.last, key) or x
end

local plain

--- What solver:run takes in the place of x: a form (where there are several values a list of forms,
-- or of lists, one for every cell, or a matrix with such rows), a function, or a list.
function M.read(f, x, key)
  x = plain(f, x, key)
  return f.sphere and on_sphere(f, x, key) or x
end

function plain(f, x, key)
  if form.is_form(x) then return of_form(f, x, key) end
  if type(x) == "function" then
    return f.values == 1 and integrated(f, x) or sampled(f, x, key)
  end
  if type(x) == "table" and #x == f.values and form.is_form(x[1]) then
    return of_forms(f, x, key)
  end
  return f.values > 1 and has_rows(f, x) and of_rows(f, x, key) or x
end

return M
