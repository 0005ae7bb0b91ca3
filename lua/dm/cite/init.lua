--- dm.cite: what to cite for a rule, a function or a method.
local blame = require "dm.base.blame"
local core = require "dm.core"
local papers = require "dm.cite.papers"

local M = {}

local SPLITTING = { "hlw-2006" }

-- of the rules of dm.solver, by name
local OF_RULES = {
  verlet = { "verlet-1967", "hlw-2006" }, midpoint = { "hlw-2006", "marsden-west-2001" },
  trapezoidal = { "hlw-2006", "marsden-west-2001" }, gauss = { "hlw-2006", "marsden-west-2001" },
  lobatto = { "hlw-2006" }, galerkin = { "marsden-west-2001", "leok-2004" },
  sem = { "kane-marsden-ortiz-1999", "leok-2004" },
  lie = { "leok-2004", "bou-rabee-marsden-2009" }, rotations = { "mclachlan-1993", "reich-1994" },
  rkmk4 = { "munthe-kaas-1999" }, ["crouch-grossman3"] = { "crouch-grossman-1993" },
  sprk = { "hlw-2006" }, ["symplectic-euler"] = SPLITTING, degenerate = { "rowley-marsden-2002" },
  del = { "marsden-west-2001" }, map = { "jalnapurkar-2006", "leok-2004" },
  step = { "marsden-west-2001" }, trial = { "marsden-west-2001", "leok-2004" },
  curve = { "cuell-patrick-2009" },
  yoshida = { "yoshida-1990" }, suzuki = { "suzuki-1990" }, mclachlan = { "mclachlan-1995" },
  ["kahan-li"] = { "kahan-li-1997" }, ["suzuki-umeno"] = { "suzuki-umeno-1993" },
  ["sofroniou-spaletta"] = { "sofroniou-spaletta-2005" },
  ["blanes-moan"] = { "blanes-moan-2002" },
  ["log-hamiltonian"] = { "mikkola-tanikawa-1999", "preto-tremaine-1999" },
  rk4 = { "hnw-1993", "gsl" }, rkf45 = { "fehlberg-1969", "gsl" },
  rk8pd = { "prince-dormand-1981", "gsl" }, rk8 = { "hnw-1993" }, rattle = { "andersen-1983" },
  shake = { "ryckaert-1977" }, avi = { "lew-2003" }, cell = { "marsden-patrick-shkoller-1998" },
  strang = { "strang-1968" }, multiscale = { "leok-2004" }, prismal = { "leok-2004" },
  box = { "bridges-reich-2001" },
}

-- of functions and methods, by the last word of their name; also of classes
local OF_WORDS = {
  routh = { "jalnapurkar-2006", "marsden-scheurle-1993" },
  relative_equilibria = { "marsden-scheurle-1993" }, curve = { "cuell-patrick-2009" },
  discrete_lagrangian = { "marsden-west-2001" }, mesh = { "desbrun-2005", "hirani-2003" },
  field = { "leok-2004", "desbrun-2005" }, multisymplectic = { "bridges-reich-2001" },
  connection = { "leok-marsden-weinstein-2005", "leok-2004" },
  lagrange_poincare = { "leok-2004" }, levi_civita = { "leok-2004" },
  moving_frame = { "fels-olver-1999", "bogfjellmo-2011" },
  action = { "fels-olver-1999", "bogfjellmo-2011" },
  invariant_problem = { "kogan-olver-2003", "bogfjellmo-2011" },
  differential_invariants = { "kogan-olver-2003", "bogfjellmo-2011" },
  galerkin = { "marsden-west-2001", "leok-2004" }, multiscale = { "leok-2004" },
  schroedinger = { "strang-1968", "leok-2004" }, msfem = { "leok-2004" },
  lyapunov = { "benettin-1980", "cincotta-simo-2000" },
  euler_poincare = { "bou-rabee-marsden-2009" }, noether = { "marsden-west-2001" },
}

-- what a value is called: of a solver its rule, of a function the last word of its doc's name
local function name_of(x)
  if type(x) == "string" then return x end
  if type(x) == "function" then
    local line = core.docs[x] and core.docs[x]:match "^[^\n({]*"
    return line and line:match "([%w_]+)%s*$"
  end
  local fine, rule = blame.try(function() return x.rule end)
  if fine and type(rule) == "string" then return rule end
  local meta = getmetatable(x)
  return type(meta) == "table" and type(meta.__name) == "string" and meta.__name:match "[%w_]+$"
end

local function add(out, seen, list)
  for _, key in ipairs(list or {}) do
    if not seen[key] then out[#out + 1], seen[key] = papers.bibtex(key), true end
  end
end

-- all rules that stand in a name: kahan-li(6, midpoint)
local function add_rules(out, seen, name)
  for word in name:gmatch "[%a][%w-]*" do add(out, seen, OF_RULES[word]) end
end

local doc = [[
dm.cite([x]) -> string
BibTeX of what stands behind x: a rule ("gauss(2)", "kahan-li(6, midpoint)"), a solver, a function
or method (dm.moving_frame, "routh"), an action; without x of dmlua itself. Raises where nothing is
known, with the names that are.]]

M.cite = blame.caller(function(x)
  if x == nil then return papers.bibtex "dmlua" end
  local name, out, seen = name_of(x), {}, {}
  if name then
    add(out, seen, OF_WORDS[name:match "[%w_]+$"] or OF_WORDS[name])
    if #out == 0 or type(x) == "string" then add_rules(out, seen, name) end
  end
  if #out > 0 then return table.concat(out, "\n\n") end
  local known = {}
  for word in pairs(OF_WORDS) do known[#known + 1] = word end
  table.sort(known)
  error(("dm.cite: nothing is known behind %s: give a rule of dm.rules(), a solver, or one of %s")
    :format(type(x) == "string" and ("%q"):format(x) or type(x), table.concat(known, ", ")), 0)
end)

core.docs[M.cite] = doc

return M
