--- Matrix groups of a basis of their algebra, for dm.group: hat, vee, brackets, and the flat
-- coordinates, which are as many entries of a matrix as tell all of it.
local blame = require "dm.base.blame"
local acts = require "dm.group.acts"
local branches = require "dm.group.own.branches"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local matrices = require "dm.group.matrices"

local M = {}

local abs, max = math.abs, math.max

local TINY = 1e-10  -- of what is zero but for round-off, over the size of the basis

local function fail(text, ...) error(("dm.group: " .. text):format(...), 0) end

---- the basis ----

local function check_basis(basis)
  if type(basis) ~= "table" or #basis == 0 then
    fail("option 'basis' must be a list of square matrices { E1, ... }")
  end
  local E, n = {}, nil
  for i, m in ipairs(basis) do
    local fine, matrix = blame.try(core.matrix, m)
    if not fine or not linear.is_plain(matrix) or matrix.rows ~= matrix.columns then
      fail("entry %d of the basis must be a square matrix of numbers", i)
    end
    n = n or matrix.rows
    if matrix.rows ~= n then
      fail("entry %d of the basis is of %d x %d, the first of %d x %d", i, matrix.rows, matrix.rows,
        n, n)
    end
    if not (linear.largest(matrix) < math.huge) then
      fail("entry %d of the basis is not finite", i)
    end
    E[i] = matrix
  end
  return E, n
end

-- sum_kl a_kl b_kl
local function inner(a, b)
  local sum = 0
  for k = 1, a.rows do
    for l = 1, a.columns do sum = sum + a[k][l] * b[k][l] end
  end
  return sum
end

-- matrices D_i with <D_i, E_j> = 1 for i = j, else 0
local function dual_of(E)
  local r = #E
  local gram = linear.fill(r, r, function(i, j) return inner(E[i], E[j]) end)
  local rows = gram:totable()
  if not linear.choose_rows(rows, r, TINY * linear.largest(gram)) then
    fail("the matrices of the basis depend on each other")
  end
  local inverse, D = gram:inverse(), {}
  for i = 1, r do
    local sum = E[1] * inverse[i][1]
    for j = 2, r do sum = sum + E[j] * inverse[i][j] end
    D[i] = sum
  end
  return D
end

-- entries of a matrix that are not zero, as { row, column, value }
local function entries_of(m)
  local out, least = {}, 1e-15 * linear.largest(m)
  for k = 1, m.rows do
    for l = 1, m.columns do
      if abs(m[k][l]) > least then out[#out + 1] = { k, l, m[k][l] } end
    end
  end
  return out
end

local function hat_of(E, n)
  local places = {}
  for i, m in ipairs(E) do places[i] = entries_of(m) end
  return function(xi)
    local out = core.zeros(n, n):totable()
    for i, list in ipairs(places) do
      for _, e in ipairs(list) do out[e[1]][e[2]] = out[e[1]][e[2]] + e[3] * xi[i] end
    end
    return core.matrix(out)
  end
end

local function vee_of(D)
  local places = {}
  for i, m in ipairs(D) do places[i] = entries_of(m) end
  return function(m)
    local out = {}
    for i, list in ipairs(places) do
      local sum = 0
      for _, e in ipairs(list) do sum = sum + e[3] * m[e[1]][e[2]] end
      out[i] = sum
    end
    return core.vector(out)
  end
end

--- [e_i, e_j] as vectors c[i][j]; raises where one is no combination of the basis.
local function brackets(E, kit)
  local c = {}
  for i = 1, #E do c[i] = {} end
  for i = 1, #E do
    for j = 1, #E do
      local m = E[i] * E[j] - E[j] * E[i]
      c[i][j] = kit.vee(m)
      local off = linear.largest(m - kit.hat(c[i][j]))
      if off > TINY * max(linear.largest(E[i]) * linear.largest(E[j]), linear.largest(m)) then
        fail("the basis is not closed under brackets: E%d E%d - E%d E%d is no combination of it "
          .. "(it is off by %.3g)", i, j, j, i, off)
      end
    end
  end
  return c
end

---- the form ----

-- J with g^T J g = J: E^T J + J E = 0
local function check_form(form, E, n)
  local fine, J = blame.try(kits.matrix, form, n, "option 'form'")
  if not fine then fail("%s", J) end
  if not linear.is_plain(J) or not blame.try(J.inverse, J) then
    fail("option 'form' must be a regular matrix of numbers")
  end
  for i, e in ipairs(E) do
    local off = linear.largest(e:transpose() * J + J * e)
    if off > TINY * linear.largest(J) * max(1, linear.largest(e)) then
      fail("E%d^T J + J E%d is not zero (it is off by %.3g): exp of it does not keep the form", i,
        i, off)
    end
  end
  return J
end

-- is the group all that keeps the form? then it is a level set of quadratic functions
local function is_whole(J, r, n)
  local odd = linear.largest(J + J:transpose()) <= TINY * linear.largest(J)
  local even = linear.largest(J - J:transpose()) <= TINY * linear.largest(J)
  return odd and r == n * (n + 1) // 2 or even and r == n * (n - 1) // 2
end

---- flat coordinates ----

-- rows of numbers reduced to echelon form, with unit pivots and zeros above and below: a new row is
-- added where it is independent
local function add_row(rows, row, least)
  row = { table.unpack(row) }
  for _, known in ipairs(rows) do
    local factor = row[known.pivot]
    for k = 1, #row do row[k] = row[k] - factor * known[k] end
  end
  local best, at = least, nil
  for k = 1, #row do
    if abs(row[k]) > best then best, at = abs(row[k]), k end
  end
  if not at then return false end
  local scale = 1 / row[at]
  for k = 1, #row do row[k] = row[k] * scale end
  row[at], row.pivot = 1, at
  for _, known in ipairs(rows) do
    local factor = known[at]
    for k = 1, #row do known[k] = known[k] - factor * row[k] end
    known[at] = 0
  end
  rows[#rows + 1] = row
  return true
end

-- the matrices that sums of products of the basis make: g - 1 is one of them
local function hull_of(E, n)
  local rows, found = {}, {}
  local function add(m)
    local size = linear.largest(m)
    if size > 0 and add_row(rows, matrices.entries(m * (1 / size)), TINY) then
      found[#found + 1] = m * (1 / size)
    end
  end
  for _, e in ipairs(E) do add(e) end
  local k = 1
  while k <= #found and #rows < n * n do
    for _, e in ipairs(E) do add(found[k] * e) end
    k = k + 1
  end
  table.sort(rows, function(a, b) return a.pivot < b.pivot end)
  for _, row in ipairs(rows) do
    for i = 1, n * n do
      if abs(row[i]) < TINY then row[i] = 0 end
    end
  end
  return rows
end

-- flat and unflat: entries at the pivots, all others by 1 + sum (flat_k - 1_k) row_k
local function coordinates(kit, E, n)
  local rows = hull_of(E, n)
  local function unit(place) return (place - 1) // n == (place - 1) % n and 1 or 0 end
  function kit.flat(g)
    local out = {}
    for k, row in ipairs(rows) do
      out[k] = g[(row.pivot - 1) // n + 1][(row.pivot - 1) % n + 1]
    end
    return out
  end
  function kit.unflat(list)
    return linear.fill(n, n, function(i, j)
      local place = (i - 1) * n + j
      local sum = unit(place)
      for k, row in ipairs(rows) do
        if place == row.pivot then return list[k] end
        if row[place] ~= 0 then sum = sum + (list[k] - unit(row.pivot)) * row[place] end
      end
      return sum
    end)
  end
end

---- exp and log where hat(xi) is nilpotent ----

local function is_nilpotent(kit, n)
  local x = kit.hat(kits.normals(core.random(7), 0, kit.dimension, 1))
  x = x * (1 / max(linear.size(x), 1e-300))
  local power = x
  for _ = 2, n do power = power * x end
  return linear.largest(power) <= TINY
end

-- the sum of w(k) x^k, k < n
local function polynomial(x, w, n)
  local sum = core.identity(n) * w(n - 1)
  for k = n - 2, 0, -1 do sum = sum * x + core.identity(n) * w(k) end
  return sum
end

local function nilpotent_maps(kit, n)
  local factorial = { [0] = 1 }
  for k = 1, n do factorial[k] = factorial[k - 1] * k end
  function kit.exp(xi)
    return polynomial(kit.hat(xi), function(k) return 1 / factorial[k] end, n)
  end
  function kit.log(g)
    local x = g - core.identity(n)
    return kit.vee(polynomial(x, function(k) return k == 0 and 0 or (-1) ^ (k + 1) / k end, n))
  end
end

---- is a matrix on the group? ----

local function is_traceless(kit)
  for k = 1, kit.dimension do
    if abs(kit.hat(linear.unit(kit.dimension, k)):trace()) > TINY then return false end
  end
  return true
end

-- that of its logarithm from the algebra; from the form, from the hull
local function defects(kit, J)
  local traceless = is_traceless(kit)
  function kit.defect(g)
    local size = max(1, linear.largest(g))
    local off = linear.largest(g - kit.unflat(kit.flat(g))) / size
    if off > 1e-9 then return off, ("entries that the basis does not reach are off by %.3g")
      :format(off) end
    if J then
      off = linear.largest(g:transpose() * J * g - J) / size ^ 2
      if off > 1e-9 then return off, ("g^T J g is off J by %.3g"):format(off) end
    end
    local det = g:det()
    if not (abs(det) > 1e-14 * linear.size(g) ^ g.rows) then return 1, "it is singular" end
    if traceless and abs(det - 1) > 1e-9 * size ^ g.rows then
      return abs(det - 1) / size ^ g.rows, ("its determinant is %.9g, not 1"):format(det)
    end
    return max(off, branches.defect(kit, g))
  end
  function kit.project(g) return branches.project(kit, g) end
end

-- groups of other than quadratic relations may lose them by the Cayley map
local function try_cayley(kit)
  for i = 1, 3 do
    local fine, g = blame.try(kit.cayley, kits.normals(core.random(11), i, kit.dimension, 0.3))
    if not fine or kit.defect(g) > 1e-9 then
      for _, key in ipairs { "cayley", "cayleyinv", "dcay", "dcayinv" } do kit[key] = nil end
      kit.no_cayley = true
      return
    end
  end
end

-- are the last rows of the algebra zero, so that those of the group are (0, 1)?
local function is_affine(E, n)
  for _, m in ipairs(E) do
    for j = 1, n do
      if m[n][j] ~= 0 then return false end
    end
  end
  return n > 1
end

--- The kit, and the brackets of the basis; kit.finish() completes it.
function M.kit(options)
  local E, n = check_basis(options.basis)
  local kit = { dimension = #E }
  local D = dual_of(E)
  kit.hat, kit.vee = hat_of(E, n), vee_of(D)
  local c = brackets(E, kit)
  local J = options.form ~= nil and check_form(options.form, E, n)
  coordinates(kit, E, n)
  if J then
    local inverse = J:inverse()
    kit.liftable = is_whole(J, #E, n)
    function kit.inverse(g) return inverse * g:transpose() * J end
  end
  if is_nilpotent(kit, n) then nilpotent_maps(kit, n) end
  kit.acts = { linear = acts.linear(kit, n), projective = acts.projective(kit, n),
    affine = is_affine(E, n) and acts.affine(kit, n - 1) or nil }
  kit.sample = matrices.from_exponentials(kit)
  defects(kit, J)
  function kit.finish()
    matrices.complete(kit, n)
    kit.principal = kit.log
    function kit.log(g) return branches.log(kit, g) end
    try_cayley(kit)
    return kit
  end
  return kit, c
end

return M
