--- Parts of a sweep: dmlua --part k/n, and what an array of SLURM or mpirun says.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local part -- { k =, n = } of this process, or nothing

local function fail(...) option.fail("--part", ...) end

-- a whole number of the environment, or nothing
local function number(name)
  local text = os.getenv(name)
  return text and math.tointeger(tonumber(text))
end

-- task of the array (from 0) and how many there are
local function array_task()
  local id, count = number "SLURM_ARRAY_TASK_ID", number "SLURM_ARRAY_TASK_COUNT"
  if not id then return 0, 1, false end
  local least, most = number "SLURM_ARRAY_TASK_MIN", number "SLURM_ARRAY_TASK_MAX"
  local step = number "SLURM_ARRAY_TASK_STEP" or 1
  if not (count and least and most) or step < 1 or (most - least) // step + 1 ~= count
    or (id - least) % step ~= 0 then
    fail("this array has gaps: a task cannot tell which part it is. Submit --array=0-%d, or write "
      .. "--part k/n for every task yourself", (count or 2) - 1)
  end
  return (id - least) // step, count, true
end

-- process of the task (from 0) and how many there are; SLURM_PROCID is 0 in a batch script, too
local function process()
  local rank, size = number "OMPI_COMM_WORLD_RANK", number "OMPI_COMM_WORLD_SIZE"
  if rank and size then return rank, size, true end
  size = number "SLURM_STEP_NUM_TASKS"
  if size and number "SLURM_PROCID" then return number "SLURM_PROCID", size, true end
  return 0, 1, false
end

local function automatic()
  local task, tasks, in_array = array_task()
  local rank, ranks, in_step = process()
  if not (in_array or in_step) then
    fail("auto is for arrays of SLURM, srun and mpirun; none of their variables is set. Write "
      .. "--part k/n")
  end
  if rank < 0 or rank >= ranks then
    fail("the environment says rank %d of %d, from 0 on. Write --part k/n", rank, ranks)
  end
  return { k = task * ranks + rank + 1, n = tasks * ranks }
end

--- What stood behind --part: "k/n" or "auto".
function M.set(text)
  if text == "auto" then
    part = automatic()
    return
  end
  local k, n = tostring(text):match "^(%d+)/(%d+)$"
  k, n = math.tointeger(tonumber(k)), math.tointeger(tonumber(n))
  if not k or not n then fail("part %s: write k/n, for instance 2/8, or auto", text) end
  if k < 1 or k > n then fail("part %s: there are parts 1/%d to %d/%d", text, n, n, n) end
  part = { k = k, n = n }
end

--- This process' part, or nothing.
function M.of_process() return part end

--- Members first to last of `members` that part k of n runs; last < first: none.
function M.share(members, k, n)
  return (k - 1) * members // n + 1, k * members // n
end

---- files ----

function M.name(file, k, n) return ("%s.%d-of-%d"):format(file, k, n) end

--- Files of parts beside a journal, in their order.
function M.files(file)
  local folder, base = file:match "^(.*/)([^/]*)$"
  folder, base = folder or "./", base or file
  local out = {}
  for _, name in ipairs(core.names_in(folder)) do
    local k, n = name:sub(#base + 1):match "^%.(%d+)%-of%-(%d+)$"
    if k and name:sub(1, #base) == base then
      out[#out + 1] = { name = (folder == "./" and "" or folder) .. name, k = tonumber(k),
        n = tonumber(n) }
    end
  end
  table.sort(out, function(a, b) return a.n < b.n or a.n == b.n and a.k < b.k end)
  return out
end

--- The script ends here: what comes after needs all members of a sweep.
function M.leave(file, members, found)
  io.stderr:write(("dmlua: part %d/%d of %s is done; %d of %d members are there. When all parts "
    .. "are, run the script without --part\n"):format(part.k, part.n, file, found, members))
  core.end_process(0)
end

M.part = blame.caller(function()
  if part then return part.k, part.n end
  return 1, 1
end)

core.docs[M.part] = [[
dm.part() -> integer, integer
k and n of dmlua --part k/n, the part of every sweep that this process runs; 1 and 1 without it.]]

return M
