--- Completion: of a map F with the axioms (i) and (ii), the connection whose horizontal pairs are
-- those with F = e. A_d(q0, q1) is the g with F(q0, g^-1 q1) = e, so that (iii) holds as well.
local bundles = require "dm.connection.bundle"
local core = require "dm.core"

local M = {}

--- The local form A(x0, x1) = exp(xi) with log F((x0, e), (x1, exp(-xi))) = 0, d unknowns.
function M.local_form(B, F)
  local kit = B.kit
  local function defect(xi, x0, x1)
    return kit.log(F(bundles.at_section(B, x0), { x1, kit.exp(-xi) }))
  end
  local root = core.root { name = "the completed connection", unknowns = B.d,
    start = function(x0, x1) return defect(core.zeros(B.d), x0, x1) end,
    equations = function(xi, x0, x1) return defect(core.vector(xi), x0, x1) end,
    failure = "are x0 and x1 near each other?" }
  return function(x0, x1) return kit.exp(core.vector(root(x0, x1))) end
end

return M
