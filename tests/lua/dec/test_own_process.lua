-- factors of large matrices are made in a process of its own: they solve here, cost CPU time that is counted, leave nothing behind
-- that a forked process would wait for, and a child that is ended from outside is an error and no more
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local matrices = require "dm.dec.equations"

if not core.solvers() then
  tap.ok(true, "factors in a process of its own # SKIP dm/sparse.so is not there")
  return tap.done()
end

local K = dm.mesh { bcc = 10 } -- factors of bcc = 8 are made in this process still
local stars = K:dual_volume(0)
local A = K:laplacian(0).stiffness + matrices.diagonal(stars)

-- (L + M) 1 = M 1, since L 1 = 0
for _, kind in ipairs { "cholesky", "lu" } do
  local before = dm.cpu()
  local factor = A:factor(kind)
  local took, worst = dm.cpu() - before, 0
  collectgarbage()
  for _, x in ipairs(factor:solve(stars)) do worst = math.max(worst, math.abs(x - 1)) end
  tap.ok(worst < 1e-10, kind .. " of a large matrix solves", worst)
  tap.ok(took > 0.02, kind .. ": its CPU time counts", took)
end
tap.ok(A:negatives() == 0, "no negative eigenvalue of L + M")
local below = 0
for _, value in ipairs(K:laplacian(0):eigen(20).values) do below = below + (value < 1 and 1 or 0) end
local signs = (A - 2 * matrices.diagonal(stars)):negatives()
tap.ok(signs == below and below > 0, "signs of L - M count the eigenvalues of M^-1 L below 1", signs)

local worker = core.worker(function(channel) channel:send(tostring(A:factor "cholesky" ~= nil)) end)
tap.ok(worker:receive() == "true", "a forked process makes factors after this one has made some")

-- a limit of CPU time is one of each process: it ends the child, which needs ten seconds, and not the parent
local script = os.tmpname()
local out = assert(io.open(script, "w"))
out:write [[
local dm = require "dm"
local K = dm.mesh { bcc = 18 }
local A = K:laplacian(0).stiffness + require "dm.dec.equations.matrices".diagonal(K:dual_volume(0))
print(pcall(A.factor, A, "lu"))]]
out:close()
local pipe = assert(io.popen(("ulimit -t 2; %s %s 2>&1"):format((os.getenv "B" or "build") .. "/dmlua", script)))
local said = pipe:read "a"
pipe:close()
os.remove(script)
tap.ok(said:find "false\ta factorization: not enough memory", "a child that was ended is an error", said)
tap.done()
