--- The axioms of a group that a script defines, tested at random elements that are always the same.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local abs, max = math.abs, math.max

local POINTS, TOLERANCE = 9, 1e-9
local SIZES = { 0.05, 0.3, 0.8 }

local function written(x)
  if type(x) == "number" then return ("%.6g"):format(x) end
  local out = {}
  for i = 1, #x do out[i] = written(x[i]) end
  return "{" .. table.concat(out, ", ") .. "}"
end

-- largest difference of two elements or vectors, over their size; NaN is infinite
local function apart(a, b)
  local worst, size = 0, 1
  for i = 1, #a do
    local off = abs(a[i] - b[i])
    worst, size = off ~= off and math.huge or max(worst, off), max(size, abs(b[i]))
  end
  return worst / size
end

-- axiom, the sentence of what fails, a function of a sample that gives what must be equal
local AXIOMS = {
  { "identity", "e a is not a", function(k, s) return k.compose(k.identity(), s.a), s.a end, "a" },
  { "identity", "a e is not a", function(k, s) return k.compose(s.a, k.identity()), s.a end, "a" },
  { "inverse", "a a^-1 is not e", function(k, s)
    return k.compose(s.a, k.inverse(s.a)), k.identity()
  end, "a" },
  { "inverse", "a^-1 a is not e", function(k, s)
    return k.compose(k.inverse(s.a), s.a), k.identity()
  end, "a" },
  { "associativity", "(a b) c is not a (b c)", function(k, s)
    return k.compose(k.compose(s.a, s.b), s.c), k.compose(s.a, k.compose(s.b, s.c))
  end, "a", "b", "c" },
  { "exp", "exp(0) is not e", function(k) return k.exp(core.zeros(k.dimension)), k.identity() end },
  { "exp", "exp(xi) exp(xi/2) is not exp(3 xi/2)", function(k, s)
    return k.compose(k.exp(s.xi), k.exp(s.xi * 0.5)), k.exp(s.xi * 1.5)
  end, "xi" },
  { "log", "log(exp(xi)) is not xi", function(k, s) return k.log(k.exp(s.xi)), s.xi end, "xi" },
  { "Ad", "exp(Ad(a, xi)) is not a exp(xi) a^-1", function(k, s)
    return k.exp(k.Ad(s.a, s.xi)), k.compose(k.compose(s.a, k.exp(s.xi)), k.inverse(s.a))
  end, "a", "xi" },
  { "ad", "it is not the derivative of Ad: Ad(exp(xi), eta) is not the series of ad",
    function(k, s)
      local sum, term = s.eta, s.eta
      for n = 1, 24 do
        term = k.ad(s.xi, term) * (1 / n)
        sum = sum + term
      end
      return k.Ad(k.exp(s.xi), s.eta), sum
    end, "xi", "eta" },
}

-- elements as products of exponentials, which are not exponentials of one vector
local function sample_of(kit, stream, i)
  local size, r = SIZES[i % #SIZES + 1], kit.dimension
  local function vector(k) return kits.normals(stream, 16 * i + k, r, size / math.sqrt(r)) end
  local function element(k) return kit.compose(kit.exp(vector(k)), kit.exp(vector(k + 1))) end
  return { a = element(0), b = element(2), c = element(4), xi = vector(6), eta = vector(7) }
end

local function flat_list(kit, x)
  return kits.class_of(x) == "dm.matrix" and kit.entries(x) or x
end

local function where(axiom, sample)
  local out = {}
  for k = 4, #axiom do out[#out + 1] = axiom[k] .. " = " .. written(sample[axiom[k]]) end
  return #out > 0 and " at " .. table.concat(out, ", ") or ""
end

local function test(kit, name, axiom, sample)
  local fine, x, y = blame.try(axiom[3], kit, sample)
  if not fine then
    error(("dm.group '%s': the axiom of %s cannot be tested%s: %s")
      :format(name, axiom[1], where(axiom, sample), x), 0)
  end
  local off = apart(flat_list(kit, x), flat_list(kit, y))
  if off <= TOLERANCE then return end
  error(("dm.group '%s': the axiom of %s fails: %s%s (they differ by %.3g)")
    :format(name, axiom[1], axiom[2], where(axiom, sample), off), 0)
end

--- Raise where an axiom fails, the first of the list at the first point.
function M.check(kit, name)
  local stream, samples = core.random(20261), {}
  for i = 1, POINTS do
    local fine, sample = blame.try(sample_of, kit, stream, i)
    if not fine then
      error(("dm.group '%s': mul and exp fail at small elements: %s"):format(name, sample), 0)
    end
    samples[i] = sample
  end
  for _, axiom in ipairs(AXIOMS) do
    for _, sample in ipairs(samples) do test(kit, name, axiom, sample) end
  end
end

return M
