--- What solves a sparse symmetric system: Cholesky factors where the matrix is positive definite,
-- LU where it is not, and without dm/sparse.so conjugate gradients or dense elimination. It says
-- which.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local fail = option.fail

local NAMES = { cholesky = "Cholesky factors (CHOLMOD)", lu = "LU factors (UMFPACK)",
  gradients = "conjugate gradients, diagonal preconditioner", dense = "dense LU factors" }
M.ways = { "cholesky", "lu", "gradients", "dense" }
M.MOST_DENSE = 1200
local SMALL = 300 -- unknowns up to which dense elimination takes the place of factors

local PACKAGES = "with the packages libsuitesparse-dev and libarpack2-dev, and dmlua built again, "
  .. "it is solved"

local function indefinite(S, where)
  local _, why = core.solvers()
  fail(where, "the matrix of %d unknowns is not positive definite, and %s; %s", S.rows,
    why or "conjugate gradients were asked for", PACKAGES)
end

local SINGULAR = 1e-14 -- of pivots, the least over the largest: less is a singular matrix

local function regular(factor) return factor and factor.condition > SINGULAR and factor or nil end

-- the factor and why it is this one
local function choose(S, wish, where)
  if wish == "dense" and S.rows > M.MOST_DENSE then
    fail(where, "dense elimination is for up to %d unknowns, not %d; %s", M.MOST_DENSE, S.rows,
      select(2, core.solvers()) or "leave solver = out")
  end
  if wish and S.rows > 0 then return regular(S:factor(wish)) end -- LU has none of an empty matrix
  if not core.solvers() and S.rows > SMALL then return S:factor "gradients" end
  if not core.solvers() then return regular(S:factor "dense") end
  local factor = regular(S:factor "cholesky")
  if factor then return factor end
  return regular(S:factor "lu"), "the matrix is not positive definite"
end

local function singular(S, where, rest)
  fail(where, "the matrix of %d unknowns is singular%s; negative or zero stars can do that: "
    .. "K:quality() counts them, dual = \"barycentric\" has none", S.rows, rest or "")
end

--- A solver of S x = b: s:solve(b) -> x; s.kind, s.name (for reports), s.note, s.unknowns,
-- s.condition. Raises where S is singular.
local Solver = {}
Solver.__index = Solver

function M.new(S, wish, where)
  local s = setmetatable({ S = S, where = where, unknowns = S.rows }, Solver)
  local factor, note = choose(S, wish, where)
  if not factor then singular(S, where, wish == "cholesky" and ", or not positive definite") end
  s:take(factor, note)
  return s
end

function Solver:take(factor, note)
  self.factor, self.kind, self.name = factor, factor.kind, NAMES[factor.kind]
  self.note, self.condition = note, factor.condition
end

function Solver:solve(b)
  local x, iterations = self.factor:solve(b)
  if not x then -- conjugate gradients met a direction in which the matrix bends down
    if self.unknowns > M.MOST_DENSE then indefinite(self.S, self.where) end
    local factor = regular(self.S:factor "dense")
    if not factor then singular(self.S, self.where) end
    self:take(factor, "the matrix is not positive definite")
    x, iterations = factor:solve(b)
  end
  self.iterations = iterations > 0 and iterations or nil
  return x
end

--- What a report says of it.
function Solver:report()
  return core.result { solver = self.name, note = self.note, unknowns = self.unknowns,
    iterations = self.iterations }
end

---- kept for the next time ----

local kept = setmetatable({}, { __mode = "k" })

--- make() the first time, the same again for the same mesh and key.
function M.once(K, key, make)
  local all = kept[K] or {}
  kept[K] = all
  if not all[key] then all[key] = make() end
  return all[key]
end

return M
