-- fields on meshes: what field, model and solver hold beside the mesh, in bytes an unknown, and that it is as much an
-- unknown on a mesh four times as large
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end

local function held()
  collectgarbage() collectgarbage()
  return 1024 * collectgarbage "count"
end

-- bytes behind a run whose rows are gone, and of them what stays with the mesh; unknowns
local function bytes(size, options, threads)
  local K = dm.mesh { hex_torus = size }
  local q = {}
  for i = 1, K:count(options.form) * (options.values or options.on and 3 or 1) do q[i] = options.on and (i % 3 == 0 and 1 or 0) or 0.1 end
  q = dm.vector(q)
  local v, n = 0 * q, #q
  K:star_weights(options.form)
  local before = held()
  local field = K:field(options)
  local solver = field:solver { rule = options.on and "rattle" or "verlet", h = 1e-4, threads = threads }
  solver:run { q = q, v = v, steps = 3, every = 3 }
  local behind = held()
  field, solver = field and nil, solver and nil
  return behind - before, held() - before, n
end

-- what an unknown more takes, on meshes of size^2 and 4 size^2 vertices, in all and beside what stays with the mesh
local function more(size, options, threads)
  local few, stays_few, small = bytes(size, options, threads)
  local many, stays_many, large = bytes(2 * size, options, threads)
  local all = (many - few) / (large - small)
  return all, all - (stays_many - stays_few) / (large - small), many / large
end

for _, case in ipairs {
  { "Maxwell", 60, { form = 1, L = wave } }, { "waves", 90, { form = 0, L = wave } },
  { "three values", 60, { form = 0, L = wave, values = 3 } }, { "unit vectors", 60, { form = 0, L = wave, on = dm.S(2) } },
} do
  local name, size, options = table.unpack(case)
  bytes(6, options, 2) -- modules and kernels that are kept
  local all, beside, mean = more(size, options)
  ok(mean <= 160, name .. ": at most 160 bytes an unknown, with what stays with the mesh", mean)
  ok(all <= mean and beside <= 60, name .. ": one more takes no more than those before, at most 60 beside the mesh", beside)
  all, beside = more(size, options, 2)
  ok(beside <= 160, name .. ", two threads: at most 160 beside what stays with the mesh", beside)
end
tap.done()
