--- require "dm": the C core, and the Lua modules, each loaded when first used.
local class = require "dm.base.class"
local core = require "dm.core"

-- What modules add, and the module: "plot" is dm.plot, "path:plot" a method of dm.path. A module
-- returns a table that has the functions of dm by name, and defines its methods by class.method.
local rows = {
  -- functions
  action = "dm.action",
  adapt = "dm.line.adapt",
  amplification = "dm.stability.linear",
  animate = "dm.show.animate",
  apropos = "dm.session.help",
  chart = "dm.chart",
  cite = "dm.cite",
  commute = "dm.reduce.commute",
  connection = "dm.connection",
  compare = "dm.data.compare",
  demo = "dm.session.demo",
  diffeo = "dm.dec.dynamics.diffeo",
  differential_invariants = "dm.frame.calculus",
  embeddable = "dm.dec.parts",
  example = "dm.session.example",
  exact = "dm.dec.homology.exact",
  euler_poincare = "dm.reduce.euler_poincare",
  figure = "dm.show.plot",
  filon = "dm.trial",
  five_lemma = "dm.dec.homology.exact",
  group = "dm.group.own",
  field = "dm.line",
  help = "dm.session.help",
  invariant_problem = "dm.frame.invariant",
  lagrange_poincare = "dm.reduce.lagrange_poincare",
  load = "dm.data.load",
  mesh = "dm.dec",
  multisymplectic = "dm.line.boxes",
  moving_frame = "dm.frame",
  multiscale = "dm.trial",
  pair = "dm.dec.dynamics.pair",
  palette = "dm.show.palette",
  msfem = "dm.elements",
  plot = "dm.show.plot",
  prismal = "dm.dec.fields.prismal",
  polynomial_roots = "dm.measure.recurrence",
  pretty = "dm.session.pretty",
  multigrid = "dm.dec.dynamics.multigrid",
  recurrence = "dm.measure.recurrence",
  remesh = "dm.dec.dynamics.remesh",
  resume = "dm.data.resume",
  scaling = "dm.measure.scaling",
  scene = "dm.scene",
  schroedinger = "dm.wave",
  simplicial_map = "dm.dec.homology.map",
  smith = "dm.dec.homology.smith",
  journal = "dm.sweep",
  lab = "dm.show.animate.lab",
  part = "dm.sweep",
  stability = "dm.stability",
  stability_limit = "dm.stability.linear",
  sweep = "dm.sweep",
  bench = "dm.measure.time",
  time = "dm.measure.time",
  who = "dm.session.help",
  -- methods of systems
  ["system:acceleration"] = "dm.measure.multipliers",
  ["system:chart"] = "dm.chart",
  ["system:mechanical_connection"] = "dm.reduce.mechanical",
  ["system:independent"] = "dm.measure.independent",
  ["system:linearize"] = "dm.measure.linearize",
  ["system:multipliers"] = "dm.measure.multipliers",
  ["system:modes"] = "dm.dec.fields.modes",
  ["system:stability"] = "dm.stability",
  ["system:stability_limit"] = "dm.dec.fields.modes",
  -- of systems and what becomes of them by reduction
  ["system:amended_potential"] = "dm.reduce.routh.shape",
  ["system:at_momentum"] = "dm.reduce.routh",
  ["system:connection"] = "dm.reduce.routh.shape",
  ["system:continue"] = "dm.reduce.equilibria.continue",
  ["system:curvature"] = "dm.reduce.routh.shape",
  ["system:discrete"] = "dm.reduce.discrete",
  ["system:holonomy"] = "dm.reduce.run.reconstruct",
  ["system:level"] = "dm.reduce.lagrange_poincare.level",
  ["system:lift"] = "dm.reduce.routh.shape",
  ["system:locked_inertia"] = "dm.reduce.routh.shape",
  ["system:magnetic_momentum"] = "dm.reduce.routh.shape",
  ["system:reduce"] = "dm.reduce.lagrange_poincare",
  ["system:reduction"] = "dm.reduce.routh.shape",
  ["system:relative_equilibria"] = "dm.reduce.equilibria",
  ["system:routh"] = "dm.reduce.routh",
  ["system:routhian"] = "dm.reduce.routh.shape",
  ["system:rsprk"] = "dm.reduce.discrete.rsprk_step",
  ["system:slice"] = "dm.reduce.routh.slice",
  ["system:start"] = "dm.reduce.routh.shape",
  ["system:symplectic_form"] = "dm.reduce.routh.shape",
  -- of discrete Lagrangians, solvers, paths and ensembles
  ["discrete_lagrangian:connection"] = "dm.reduce.mechanical",
  ["discrete_lagrangian:against_exact"] = "dm.measure.against_exact",
  ["discrete_lagrangian:average"] = "dm.measure.average",
  ["discrete_lagrangian:order"] = "dm.measure.order",
  ["solver:backward_error"] = "dm.measure.tangent",
  ["solver:fold"] = "dm.measure.fold",
  ["solver:lyapunov"] = "dm.measure.lyapunov",
  ["solver:measured_order"] = "dm.measure.measured_order",
  ["solver:modified_energy"] = "dm.measure.modified_energy",
  ["solver:multipliers"] = "dm.measure.linearize",
  ["solver:reversal"] = "dm.measure.tangent",
  ["solver:section"] = "dm.measure.poincare",
  ["solver:singularities"] = "dm.measure.singularities",
  ["solver:solvability"] = "dm.sem.solvability",
  ["solver:symplecticity"] = "dm.measure.tangent",
  ["solver:tangent"] = "dm.measure.tangent",
  ["path:animate"] = "dm.dec.pictures.of_fields",
  ["path:form"] = "dm.dec.fields.path",
  ["path:csv"] = "dm.data.export",
  ["path:frequency"] = "dm.measure.frequency",
  ["path:multipliers"] = "dm.measure.multipliers",
  ["path:noether"] = "dm.reduce.run.noether",
  ["path:npy"] = "dm.dec.pictures.of_fields",
  ["path:phases"] = "dm.reduce.run.reconstruct",
  ["path:plot"] = "dm.dec.pictures.of_fields",
  ["path:reconstruct"] = "dm.reduce.run.reconstruct",
  ["path:series"] = "dm.show.path",
  -- of meshes and what lives on them
  ["mesh:betti"] = "dm.dec.homology",
  ["mesh:chain"] = "dm.dec.chain",
  ["mesh:cone"] = "dm.dec.homology.cone_rules",
  ["mesh:animate"] = "dm.dec.pictures.animate",
  ["mesh:form"] = "dm.dec",
  ["mesh:plot"] = "dm.dec.pictures.plot",
  ["mesh:fundamental"] = "dm.dec.chain",
  ["mesh:boundary"] = "dm.dec.parts",
  ["mesh:link"] = "dm.dec.parts",
  ["mesh:make_delaunay"] = "dm.dec.parts",
  ["mesh:open_star"] = "dm.dec.parts",
  ["mesh:save"] = "dm.dec.save",
  ["mesh:skeleton"] = "dm.dec.parts",
  ["mesh:subcomplex"] = "dm.dec.parts",
  ["mesh:vector_field"] = "dm.dec.field",
  ["mesh:levi_civita"] = "dm.dec.curvature",
  ["mesh:generators"] = "dm.dec.homology",
  ["mesh:homology"] = "dm.dec.homology",
  ["mesh:potential"] = "dm.dec.homology.potential",
  ["mesh:d"] = "dm.dec.equations",
  ["mesh:star"] = "dm.dec.equations",
  ["mesh:laplacian"] = "dm.dec.equations",
  ["mesh:laplace_beltrami"] = "dm.dec.equations",
  ["mesh:harmonic"] = "dm.dec.equations",
  ["mesh:poisson"] = "dm.dec.equations",
  ["mesh:darcy"] = "dm.dec.equations",
  ["mesh:field"] = "dm.dec.fields",
  ["mesh:sum"] = "dm.dec.fields.sum",
  ["mesh:euler"] = "dm.dec.flow",
  ["path:vtk"] = "dm.dec.pictures.motion",
  ["mesh:stationary"] = "dm.dec.dynamics.stationary",
  ["ensemble:plot"] = "dm.show.fan",
}

-- what a group can do: methods of spaces
local OF_GROUPS = { "Ad", "ad", "bonds", "cayley", "cayleyinv", "coAd", "coad", "compose", "dcay",
  "dcayinv", "dexp", "dexpinv", "distance", "exp", "flat", "hat", "identity", "inverse", "left",
  "left_tangent", "log", "matrix", "project", "random", "right", "right_tangent", "unflat",
  "valid", "vee" }

-- methods and metamethods of the core that modules wrap: the first module first
local WRAPPED = { ["dm.solver"] = { run = { "dm.dec.fields.methods", "dm.reduce.methods" },
    ensemble = { "dm.sweep.methods", "dm.reduce.methods" } },
  ["dm.system"] = { solver = { "dm.dec.fields.methods", "dm.reduce.methods" } },
  ["dm.ensemble"] = { failures = { "dm.reduce.methods" }, __tostring = { "dm.reduce.methods" },
    __index = { "dm.sweep.methods" } },
  ["dm.path"] = { momentum = { "dm.group.methods.momentum" },
    checkpoint = { "dm.dec.fields.methods" } },
  ["dm.discrete_lagrangian"] = { momentum = { "dm.group.methods.momentum" } } }

local dm = {}

-- functions: name -> module; a session completes these names before they are loaded
local M = { __name = "dm", lazy = {} }

function M.__index(t, name)
  local module = M.lazy[name]
  if not module then
    core.miss("dm", name)
    return nil
  end
  local value = require(module)[name]
  rawset(t, name, value)
  return value
end

function M.__tostring() return "dm: discrete mechanics; help(dm) lists what it has" end

local function sorted_keys(t)
  local keys = {}
  for key in pairs(t) do keys[#keys + 1] = key end
  table.sort(keys)
  return keys
end

-- every function, method and class, loaded in one order, so that help and the reference see them
function M.load_all()
  for _, name in ipairs(sorted_keys(M.lazy)) do local _ = dm[name] end
  for _, name in ipairs(sorted_keys(rows)) do require(rows[name]) end
  require "dm.group.discrete" -- the class of what dm.discrete_lagrangian makes on groups
  return dm
end

for name, module in pairs(rows) do
  local owner, method = name:match "^([%w_]+):([%w_]+)$"
  if owner then class.later("dm." .. owner, method, module) else M.lazy[name] = module end
end
for _, name in ipairs(OF_GROUPS) do class.later("dm.space", name, "dm.group.methods") end
for owner, methods in pairs(WRAPPED) do
  for name, modules in pairs(methods) do
    for _, module in ipairs(modules) do class.wrapped_later(owner, name, module) end
  end
end
for name, module in pairs { semidirect = "dm.group", discrete_lagrangian = "dm.group.discrete" } do
  class.function_later(name, module)
  M.lazy[name] = module
end
class.function_later("resume", "dm.dec.fields.methods")
class.function_later("resume", "dm.group.discrete")
-- asked for where an error speaks of a nil: the module puts its own functions here
local registry = debug.getregistry()
for name, own in pairs { dm_explain = "explain", dm_noted = "noted", dm_argument = "argument" } do
  registry[name] = function(...) return require "dm.session.missing"[own](...) end
end
for name, own in pairs { dm_params = "shown", dm_unread = "unread",
  dm_out_of_reach = "out_of_reach", dm_outside = "outside", dm_param_names = "names" } do
  registry[name] = function(...) return require "dm.base.params"[own](...) end
end
-- what is noted is forgotten before a function is called whose nil is looked into
function registry.dm_forget()
  local note = registry.dm_missed
  if note then note.of = nil end
end
-- what stands for modules alone is not seen in dm: its doc begins with "core."
for name, value in pairs(core) do
  local doc = not M.lazy[name] and core.docs[value]
  if doc and not doc:find "^core%." then dm[name] = value end
end
setmetatable(dm, M)

-- Lua names a function in messages and tracebacks by the module in whose table it finds it: dm.R,
-- not dm.core.R
package.loaded["dm.core"] = setmetatable({}, { __index = core })

return dm
