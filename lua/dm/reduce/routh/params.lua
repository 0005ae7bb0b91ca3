--- Parameters of a reduced system: the numbers among the params of the system it was made from, and
-- the momentum as mu (mu1, mu2, ...), so that members of ensembles and cells of maps vary them. At
-- other values the reduction is made again from L with these; where they are symbols (inputs of
-- kernels: one trace for all members) derivatives take them as arguments.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"

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

--- The params of the shape; info.numbers = { name = value now } and info.mu_names are set.
function M.of(info)
  local given = info.params
  local out = lists.copy(type(given) == "table" and given or {})
  info.mu_names = names_of_mu(info, out)
  for a, name in ipairs(info.mu_names) do out[name] = info.mu[a] end
  info.numbers = {}
  for key, value in pairs(out) do
    if type(key) == "string" and type(value) == "number" then info.numbers[key] = value end
  end
  return out
end

-- the params of the unreduced system with these values among them
local function merged(info, p)
  local out = lists.copy(type(info.params) == "table" and info.params or {})
  for key in pairs(info.numbers) do
    if out[key] ~= nil then out[key] = p[key] end
  end
  return out
end

-- a copy of the reduction with other functions
local function variant(info, p)
  local out, given = lists.copy(info), info.full.given
  out.shown, out.variants, out.derived, out.general, out.mu, out.own = {}, nil, nil, nil, {}, nil
  for a, name in ipairs(info.mu_names) do out.mu[a] = p[name] end
  if info.params ~= nil then
    out.params = merged(info, p)
    out.L, out.g, out.F = bound(given.L, out.params), bound(given.constraint, out.params),
      bound(given.force, out.params)
    out.rolling, out.reaction = bound(given.rolling, out.params), bound(given.reaction, out.params)
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
  info.own = info.own or {}
  if not info.own[system] then
    local given = lists.copy(system.given)
    given.params = info.params
    info.own[system] = core.system(given)
  end
  return info.own[system]
end

--- The unreduced system in the coordinates theta and x, and as it was given.
function M.full(info) return with_params(info, info.full) end
function M.unreduced(info)
  return with_params(info, info.ambient and info.ambient.system or info.full)
end

-- do only momenta differ, so that L and its derivatives are the same?
local function is_same_system(info, p)
  for key, value in pairs(info.numbers) do
    if type(info.params) == "table" and info.params[key] ~= nil and not rawequal(p[key], value) then
      return false
    end
  end
  return true
end

-- at other numbers
local function at_numbers(info, p)
  local out = variant(info, p)
  if is_same_system(info, p) then
    out.params, out.L, out.g, out.F, out.derived = info.params, info.L, info.g, info.F,
      model.derived(info)
  end
  out.numbers = {}
  for key in pairs(info.numbers) do out.numbers[key] = p[key] end
  if info.root then out.root = require "dm.reduce.routh.quadratic".root(out) end
  return out
end

-- names of the numbers, in their order; dL/d(q, v) and dp_theta/d(q, v) as functions of the values
-- too
local function general(info)
  if info.root then error("parameters of an implicit reduction are numbers", 0) end
  local n, names, L = info.n, {}, info.full.given.L
  for key in pairs(info.numbers) do names[#names + 1] = key end
  table.sort(names)
  local slope = core.derivative(function(q, v, t, all)
    local now = {}
    for i, key in ipairs(names) do now[key] = all[i] end
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
  for i, key in ipairs(made.names) do values[i] = p[key] end
  local all = core.vector(values)
  out.fixed = { slope = function(q, v, t) return made.slope(q, v, t, all) end,
    rows = function(q, v, t) return made.rows(q, v, t, all) end }
  return out
end

-- plain calls at other values, of which a check of many members makes one each: derivatives are
-- made again where L has changed
local function plain(info, p)
  local now = info.L(info.sample.q, info.sample.v, info.sample.t)
  if not info.general or info.general.value ~= now then
    info.general = general(info)
    info.general.value = now
  end
  return by_general(info, p, info.general)
end

-- Raises where the system has other numbers by now: they are seen, but not beside those that vary.
local function check_unchanged(info)
  for name, value in pairs(type(info.params) == "table" and info.numbers or {}) do
    local now = info.params[name]
    if now ~= nil and not rawequal(now, value) then
      error(("params.%s of the unreduced system is %s by now, and was %s where it was reduced: "
        .. "reduce it again for other params or momenta"):format(name, now, value), 0)
    end
  end
end

local MOST = 16  -- reductions that are kept, of the last values

--- The reduction with these params; p may hold symbols. x: where it is wanted, numbers or symbols.
function M.at(info, p, x)
  if p == nil or not info.numbers then return info end
  local same, key = true, {}
  for name, value in pairs(info.numbers) do same = same and rawequal(p[name], value) end
  if same then return info end
  check_unchanged(info)
  for name in pairs(info.numbers) do
    local value = p[name]
    if type(value) ~= "number" then return by_general(info, p, general(info)) end
    key[#key + 1] = ("%s=%a"):format(name, value)
  end
  if x and type(x[1]) == "number" and not info.root then return plain(info, p) end
  table.sort(key)
  local text = table.concat(key, " ")
  local kept = info.variants
  if not kept or not kept[text] and kept.count >= MOST then kept = { count = 0 } end
  if not kept[text] then kept[text], kept.count = at_numbers(info, p), kept.count + 1 end
  info.variants = kept
  return kept[text]
end

return M
