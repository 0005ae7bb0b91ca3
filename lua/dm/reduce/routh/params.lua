--- Parameters of a reduced system: the params of the system it was made from, and the momentum as
-- mu (mu1, mu2, ...), so that members of ensembles and cells of maps vary them. At other values the
-- reduction is made again from L with these; where they are symbols (inputs of kernels: one trace
-- for all members) derivatives take them as arguments.
--   What is changed in the system changes in the shape too, unless the shape was given a value of
-- its own: the table of the shape follows that of the system (M.refresh).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local params = require "dm.base.params"

local M = {}

-- mu, or mu1, mu2, ...; with _ in front of the number where a parameter has that name
local function names_of_mu(info, taken)
  local out = {}
  for a = 1, info.m do
    local name = info.m == 1 and "mu" or "mu" .. a
    while taken[name] ~= nil do name = name .. "_" .. info.names[info.cyclic[a]] end
    out[a] = name
  end
  return out
end

-- the params of the system, or none
local function given(info) return type(info.params) == "table" and info.params or {} end

--- The params of the shape. info.values is this table, info.seen what it had when the system was
-- last looked at, { name = value }; info.mu_names are set.
function M.of(info)
  params.refresh(info.params) -- they may be those of a shape
  local values = lists.copy(given(info))
  info.mu_names = names_of_mu(info, values)
  for a, name in ipairs(info.mu_names) do values[name] = info.mu[a] end
  info.values, info.seen = values, lists.copy(values)
  params.follow(values, function() M.refresh(info) end)
  return values
end

--- What has changed in the system goes to the shape; derivatives and reductions at other values are
-- made again.
function M.refresh(info)
  params.refresh(info.params)
  local changed = false
  for name, now in pairs(given(info)) do
    local before = info.seen[name]
    if not rawequal(now, before) then
      if rawequal(info.values[name], before) then info.values[name] = now end
      info.seen[name], changed = now, true
    end
  end
  if changed then info.variants, info.general, info.derived, info.shown = {}, nil, nil, {} end
end

-- the params of the unreduced system with these values in their place
local function merged(info, p)
  local out = lists.copy(given(info))
  for name in pairs(out) do out[name] = p[name] end
  return out
end

-- a copy of the reduction with other functions
local function variant(info, p)
  local out, full = lists.copy(info), info.full.given
  out.shown, out.derived, out.mu = {}, nil, {}
  out.seen, out.variants, out.general, out.systems = nil, nil, nil, nil -- these are info's alone
  for a, name in ipairs(info.mu_names) do out.mu[a] = p[name] end
  if info.params ~= nil then
    out.params = merged(info, p)
    out.L, out.g, out.F = bound(full.L, out.params), bound(full.constraint, out.params),
      bound(full.force, out.params)
    out.rolling, out.reaction = bound(full.rolling, out.params), bound(full.reaction, out.params)
  end
  return out
end

-- do two tables of params have the same numbers?
local function has_same(a, b)
  for key, value in pairs(a) do
    if not rawequal(b[key], value) then return false end
  end
  return true
end

-- a system with the params of the reduction: itself, unless they are others
local function with_params(info, system)
  if type(info.params) ~= "table" or has_same(info.params, system.given.params) then
    return system
  end
  info.systems = info.systems or {}
  if not info.systems[system] then
    local options = lists.copy(system.given)
    options.params = info.params
    info.systems[system] = core.system(options)
  end
  return info.systems[system]
end

--- The unreduced system in the coordinates theta and x, and as it was given.
function M.full(info) return with_params(info, info.full) end
function M.unreduced(info)
  return with_params(info, info.ambient and info.ambient.system or info.full)
end

-- which values differ from those of the reduction: momenta, numbers, symbols for numbers, or others
local function differences(info, p)
  local out = {}
  for name, value in pairs(info.seen) do
    local other = p[name]
    if not rawequal(other, value) then
      local kind = type(value) ~= "number" and "others" or type(other) ~= "number" and "symbols"
        or given(info)[name] == nil and "momenta" or "numbers"
      out[kind] = true
    end
  end
  return out
end

-- at other values, none of them a symbol
local function at_values(info, p, differ)
  local out = variant(info, p)
  if not (differ.numbers or differ.others) then -- L and its derivatives are the same
    out.params, out.L, out.g, out.F, out.derived = info.params, info.L, info.g, info.F,
      model.derived(info)
  end
  if info.root then out.root = require "dm.reduce.routh.quadratic".root(out) end
  return out
end

-- names of the numbers, in their order; dL/d(q, v) and dp_theta/d(q, v) as functions of the values
-- too
local function general(info, p)
  if info.root then error("parameters of an implicit reduction are numbers", 0) end
  local n, names, L, others = info.n, {}, info.full.given.L, {}
  for name, value in pairs(info.seen) do
    if type(value) == "number" then names[#names + 1] = name else others[name] = p[name] end
  end
  table.sort(names)
  local slope = core.derivative(function(q, v, t, all)
    local now = lists.copy(others)
    for i, name in ipairs(names) do now[name] = all[i] end
    return L(q, v, t, info.params ~= nil and merged(info, now) or nil)
  end, n, n, "number", #names)
  local rows = core.derivative(function(q, v, t, all)
    local g, some = slope(q, v, t, all), {}
    for a, i in ipairs(info.cyclic) do some[a] = g[n + i] end
    return core.vector(some)
  end, n, n, "number", #names)
  return { names = names, slope = slope, rows = rows }
end

-- the reduction at values, symbols or numbers, by such derivatives
local function by_general(info, p, made)
  local out, values = variant(info, p), {}
  for i, name in ipairs(made.names) do values[i] = p[name] end
  local fine, all = blame.try(core.vector, values)
  if not fine then error(all, 0) end
  out.fixed = { slope = function(q, v, t) return made.slope(q, v, t, all) end,
    rows = function(q, v, t) return made.rows(q, v, t, all) end }
  return out
end

-- plain calls at other numbers, of which a check of many members makes one each: derivatives are
-- made again where L has changed
local function plain(info, p)
  local now = info.L(info.sample.q, info.sample.v, info.sample.t)
  if not info.general or info.general.value ~= now then
    info.general = general(info, p)
    info.general.value = now
  end
  return by_general(info, p, info.general)
end

local MOST = 16  -- reductions that are kept, of the last values

-- the reduction at these values that is kept, or a new one
local function kept(info, p, differ)
  for _, each in ipairs(info.variants) do
    local same = true
    for name, value in pairs(each.values) do same = same and rawequal(p[name], value) end
    if same then return each.info end
  end
  if #info.variants >= MOST then info.variants = {} end
  local each = { values = {}, info = at_values(info, p, differ) }
  for name in pairs(info.seen) do each.values[name] = p[name] end
  info.variants[#info.variants + 1] = each
  return each.info
end

--- The reduction with these params; p may hold symbols. x: where it is wanted, numbers or symbols.
function M.at(info, p, x)
  if p == nil or not info.seen then return info end
  M.refresh(info)
  local differ = differences(info, p)
  if not next(differ) then return info end
  if differ.symbols then return by_general(info, p, general(info, p)) end
  if x and type(x[1]) == "number" and not info.root and not differ.others then
    return plain(info, p)
  end
  return kept(info, p, differ)
end

return M
