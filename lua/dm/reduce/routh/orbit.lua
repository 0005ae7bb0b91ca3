--- Where the orbit of a point of Q meets the section: theta and the shape x with Phi(theta, x) = q,
-- by Newton's method. Sections of polar coordinates and angles are met several times, at r and at
-- -r half a turn on: of these the shape of least norm is taken, of equal norms the one whose first
-- entry is positive; or the one nearest to a shape that is known.
local blame = require "dm.base.blame"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local abs, max, pi = math.abs, math.max, math.pi

---- one root ----

--- J^-1 b; raises where J is singular, up to round-off.
function M.solve(J, b)
  local x = J:solve(b)
  for i = 1, #x do
    if not (abs(x[i]) < math.huge) then error("singular", 0) end
  end
  return x
end

local MOST = 50

-- y = (theta, x) with Phi(y) = q, or nothing
local function invert(Phi, q, start)
  local y = core.vector(start)
  for _ = 1, MOST do
    local fine, step = blame.try(M.solve, Phi:jacobian(y), Phi(y) - q)
    if not fine then return nil end
    local size = 0
    for i = 1, #q do y[i] = y[i] - step[i]; size = max(size, abs(step[i])) end
    if not (size < 1e8) then return nil end
    if size < 1e-14 * max(1, y:norm()) then return y end
  end
  return (Phi(y) - q):norm() < 1e-12 and y or nil
end

local TRIES, BLOCK = 32, 8

-- starts of that: theta anywhere, the shape that is known, or of entries of q
local function start_of(S, q, try)
  local start, m = {}, S.m
  for a = 1, m do start[a] = (try % BLOCK) * pi / 4 end
  for i = m + 1, S.n do
    local j = i - m
    start[i] = try < 8 and (S.home and S.home[j] or max(0.1, abs(q[j])))
      or try < 16 and q[j + m] or try < 24 and q[j] or 0.5 + 0.1 * try % 1
  end
  return start
end

---- which root ----

local SAME = 1e-9 -- of the size of q, or of a shape: they are the same

local function leads_to(S, y, q)
  local fine, there = blame.try(S.Phi, y)
  return fine and (there - q):norm() <= SAME * max(1, q:norm())
end

-- how far the shape of y is from the one that is known, or from 0
local function distance(S, y)
  local sum = 0
  for i = S.m + 1, S.n do sum = sum + (y[i] - (S.home and S.home[i - S.m] or 0)) ^ 2 end
  return math.sqrt(sum)
end

-- is y liked better than the other one?
local function is_better(S, y, other)
  if not other then return true end
  local a, b = distance(S, y), distance(S, other)
  local close = SAME * max(1, a)
  if abs(a - b) > close then return a < b end
  for i = S.m + 1, S.n do
    if abs(y[i] - other[i]) > close then return y[i] > other[i] end
  end
  return false
end

local function is_on_branch(S, y)
  if not S.branch then return true end
  local x = lists.part(y, S.m, S.n - S.m)
  local values = table.pack(S.branch(x))
  if values.n == 1 then values = lists.entries(values[1]) end
  for _, value in ipairs(values) do
    if not (value > 0) then return false end
  end
  return true
end

-- whole turns taken off theta, and off entries of the shape, where they bring q back
local function unwound(S, q, y)
  for i = 1, S.n do
    local home = i > S.m and S.home and S.home[i - S.m] or 0
    local turns, less = math.floor((y[i] - home) / (2 * pi) + 0.5), core.vector(y)
    less[i] = y[i] - 2 * pi * turns
    if turns ~= 0 and leads_to(S, less, q) then y = less end
  end
  return y
end

-- entries that another root may have in place of y[i]: the mirrored one (r), and of an angle half a
-- turn more or less
local function others(S, q, y, i)
  local value, turned = y[i], core.vector(y)
  local half = value > 0 and pi or -pi
  turned[i] = value + 2 * pi
  local is_angle = leads_to(S, turned, q)
  if i <= S.m then return is_angle and { value, value - half } or { value } end
  return is_angle and { value, -value, value - half, half - value } or { value, -value }
end

local IMAGES = 4096 -- of a root, that are looked at

-- all images of a root y that lead to q too: a point of polar coordinates is met at r, and half a
-- turn on at -r
local function images_of(S, q, y)
  local out, image, choices, count = {}, core.vector(y), {}, 1
  for i = 1, S.n do
    choices[i] = others(S, q, y, i)
    count = count * #choices[i]
    if count > IMAGES then choices[i] = { y[i] } end
  end
  local function vary(i)
    if i > S.n then
      if leads_to(S, image, q) then out[#out + 1] = unwound(S, q, core.vector(image)) end
      return
    end
    for _, value in ipairs(choices[i]) do
      image[i] = value
      vary(i + 1)
    end
  end
  vary(1)
  return out
end

local function is_among(list, y)
  for _, other in ipairs(list) do
    if (other - y):norm() <= SAME * max(1, y:norm()) then return true end
  end
  return false
end

-- the best of y, its images and the one before; near a known shape y is enough
local function best_of(S, q, y, best, seen)
  y = unwound(S, q, y)
  if is_among(seen, y) then return best end
  for _, image in ipairs(S.home and { y } or images_of(S, q, y)) do
    seen[#seen + 1] = image
    if is_on_branch(S, image) and is_better(S, image, best) then best = image end
  end
  return best
end

local NONE = "the point %s is not on an orbit through the section: no theta and shape were found "
  .. "for "
  .. "it%s. Does the group move it, and does its orbit meet the section?"

--- (theta, x) of q; S = { Phi =, m = dim G, n = dim Q, home = a shape to be near or nil, branch = a
-- function of the shape that is positive, or nil }.
function M.find(S, q)
  local best, seen = nil, {}
  for try = 0, TRIES - 1 do
    local fine, y = blame.try(invert, S.Phi, q, start_of(S, q, try))
    if fine and y then best = best_of(S, q, y, best, seen) end
    local exact = best and S.home and distance(S, best) <= SAME
    if best and (try % BLOCK == BLOCK - 1 or exact) then
      return invert(S.Phi, q, best) or best
    end
  end
  error(NONE:format(check.text(q), S.branch and " with branch > 0" or ""), 0)
end

return M
