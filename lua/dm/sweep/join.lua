--- dmlua --join OUT FILE ...: journals of one sweep as one file, whose bytes do not depend on how
-- the work was split.
local blame = require "dm.base.blame"
local journal = require "dm.data.journal"
local option = require "dm.base.options"

local M = {}

local WHERE = "--join"
local EACH = 256 -- members of a record

local fail = option.failing(WHERE)

local function open_all(names)
  local files = {}
  for k, name in ipairs(names) do
    local j, why = journal.read(name)
    if not j then fail("%s: %s", name, why) end
    local key, was, is = journal.difference(files[1] and files[1].head or j.head, j.head)
    if key then
      fail("%s and %s are of different sweeps: %s is %s and %s", names[1], name, key, was, is)
    end
    files[k] = j
  end
  return files
end

-- numbers and bytes of all members, ascending; raises where some are missing
local function all_members(records, members)
  return coroutine.wrap(function()
    local next_one = 1
    for _, x in ipairs(records) do
      if x.r.first > next_one then break end
      if x.r.first + x.r.count > next_one then
        for i, bytes in journal.members(x.r, journal.bytes(x.j, x.r)) do
          if i == next_one then
            coroutine.yield(i, bytes)
            next_one = i + 1
          end
        end
      end
    end
    if next_one <= members then
      local gap = journal.gaps(records, next_one, members)[1]
      fail("members %d to %d are missing: run the script without --part, it runs only these",
        gap[1], gap[2])
    end
  end)
end

--- join(out, files ...): writes the file `out`.
function M.join(out, ...)
  local names = { ... }
  if type(out) ~= "string" or #names == 0 then fail "write --join OUT FILE ..." end
  for _, name in ipairs(names) do
    if name == out then fail("%s is one of the files that are read", out) end
  end
  local files = open_all(names)
  local head = files[1].head
  local handle, why = io.open(out, "wb")
  if not handle then fail("%s", why) end
  handle:close()
  local to, reason = journal.read(out, true)
  if not to then fail("%s: %s", out, reason) end
  to.where = WHERE
  local fine, wrong = pcall(journal.write, to, head, EACH,
    all_members(journal.ordered(files), math.tointeger(tonumber(head.members))))
  to.file:close()
  for _, j in ipairs(files) do j.file:close() end
  if not fine then
    os.remove(out)
    error(type(wrong) == "string" and blame.bare(wrong) or wrong, 0)
  end
end

M.command = M.join

return M
