--- A sum over the cells of a mesh as a function of the values of forms: what K:stationary makes
-- stationary, with gradient and sparse Hessian.
local cochain = require "dm.dec.fields.cochain"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

--- The action of term(A) for a form A of degree `degree` with `values` numbers a cell. held: a
-- vector with an entry for every number, not 0 where it is held (gradient and Hessian are 0
-- there), or nil; data: forms by name, for the cells of K:sum. Has value(x), gradient(x) and
-- hessian(x) (a dm.sparse) of a dm.vector x, cell after cell.
function M.new(K, degree, values, term, held, data)
  local n = values * K:count(degree)
  local marks = held and core.marks(held)
  -- q: nil while it is traced, numbers while it is compared
  local function of(q)
    local around = { n = n, held = marks, data = data, q = q }
    local value = term(cochain.leaf(K, degree, values, 1, around))
    if cochain.is_cochain(value) then
      option.fail("the term", "must be a number: a:dot(b) is the product of two forms (got a form)")
    end
    return value
  end
  -- the columns of its sums point into what the mesh and the marks keep
  return setmetatable({ n = n, mesh = K, marks = marks, of = of,
    traced = core.cell_action(n, of) }, { __index = M })
end

--- Raises where the term is not what its trace says, as == with a symbol makes it, at x.
function M.check(a, x) a.traced:check(a.of, x) end

function M.value(a, x) return a.traced:value(x) end
function M.gradient(a, x) return a.traced:gradient(x) end
function M.hessian(a, x) return a.traced:hessian(x) end

return M
