--- What sweeps add to methods of the core: solver:ensemble{journal =}, and ensembles that ranks
-- share out.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local lists = require "dm.base.lists"

local plain, doc, put = class.wraps("dm.sweep.methods", "dm.solver:ensemble")

-- ensemble -> { file, found, run }
local journals = setmetatable({}, { __mode = "k" })

-- several ranks, and work for them?
local function is_shared(options)
  local mpi, members = package.loaded["dm.mpi"], lists.whole(options.members)
  return mpi and members and require "dm.sweep.ranks".shares(members)
end

local function ensemble(solver, options)
  if type(options) == "table" and (options.journal ~= nil or is_shared(options)) then
    return require "dm.sweep.ensemble".ensemble(plain, solver, options, journals)
  end
  return plain(solver, options)
end

put(blame.relay(ensemble, "ensemble"),
  doc:gsub("project=}", "project=, journal=}", 1) .. [[

journal = "file": finished ranges of members are kept in this file; the same call goes on where it
stopped, and one that is finished is only read. The file is refused where the system, the rule, h,
steps or members are others, or where a member that is run again differs. ensemble.journal is
{ file, found, run }: members read from the file, members run now. dmlua --part k/n runs a part of
the members (docs/sweeps.md).]])

local index, _, put_index = class.wraps("dm.sweep.methods", "dm.ensemble:__index")
put_index(function(e, key)
  if key == "journal" then return journals[e] end
  return index(e, key)
end)

return {}
