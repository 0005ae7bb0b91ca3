--- dm.journal: what is in a journal.
local blame = require "dm.base.blame"
local core = require "dm.core"
local journal = require "dm.data.journal"
local option = require "dm.base.options"
local parts = require "dm.sweep.part"

local M = {}

local Journal = core.class({ __name = "dm.journal" }, [[
dm.journal: what is in the file of a sweep, made by dm.journal(file)
fields: file, kind, members (of the sweep), finished, missing (list of {first, last}), damaged
(bytes that are no record), files (it and its parts), head (key -> text: what decides the
result)]])

local function ranges_text(ranges)
  local out = {}
  for k = 1, math.min(#ranges, 6) do
    local a, b = ranges[k][1], ranges[k][2]
    out[k] = a == b and tostring(a) or ("%d to %d"):format(a, b)
  end
  if #ranges > 6 then out[7] = ("and %d more ranges"):format(#ranges - 6) end
  return table.concat(out, ", ")
end

function Journal.__tostring(x)
  local lines = { ("journal %s: %s of %d members, %d finished"):format(x.file, x.kind, x.members,
    x.finished) }
  if #x.missing > 0 then lines[#lines + 1] = "missing: " .. ranges_text(x.missing) end
  if x.damaged > 0 then
    lines[#lines + 1] = ("damaged: %d bytes, whose members are run again"):format(x.damaged)
  end
  if #x.files > 1 then lines[#lines + 1] = "files: " .. table.concat(x.files, ", ") end
  for _, entry in ipairs(x.head) do lines[#lines + 1] = ("  %s = %s"):format(entry[1], entry[2]) end
  return table.concat(lines, "\n")
end

M.journal = blame.caller(function(file)
  if type(file) ~= "string" then
    option.fail("dm.journal", "a file name is needed (got %s)", option.got(file))
  end
  local names, damaged, head, first_why = { file }, 0, nil, nil
  for _, p in ipairs(parts.files(file)) do names[#names + 1] = p.name end
  local read, files = {}, {}
  for _, name in ipairs(names) do
    local j, why = journal.read(name)
    if j then
      head, read[#read + 1] = head or j.head, name
      damaged = damaged + j.damaged
      files[#files + 1] = j
      j.file:close()
    else
      first_why = first_why or why
    end
  end
  if not head then option.fail("dm.journal", "%s: %s", file, first_why) end
  local members = math.tointeger(tonumber(head.members))
  local missing = journal.gaps(journal.ordered(files), 1, members)
  return setmetatable({ file = file, kind = head.kind, members = members,
    finished = members - journal.count_in(missing), missing = missing, damaged = damaged,
    files = read, head = head }, Journal)
end)

core.docs[M.journal] = [[
dm.journal(file) -> dm.journal
What is finished, missing and damaged in the journal of a sweep and in its parts beside it, and what
decided the result. Printed in full; raises where the file is none.]]

return M
