--- The CPU time that a chart may take: calls that end when it is over, what was left out.
local core = require "dm.core"

local M = {}

local Clock = {}
Clock.__index = Clock

--- A clock for so many seconds from now; nil: no end.
function M.clock(seconds)
  return setmetatable({ seconds = seconds, began = core.cpu(), since = core.clock(), left_out = {},
    order = {} }, Clock)
end

local QUIET = 2  -- s before anything is told

--- A line on stderr, where that is a terminal, that says how far the chart is; without text it is
-- erased.
function Clock:tell(text)
  if not (text and core.clock() - self.since > QUIET or not text and self.told_line) then return end
  if not core.terminal "stderr".tty then return end
  self.told_line = text ~= nil
  io.stderr:write("\r", text or "", "\27[K")
  io.stderr:flush()
end

--- As f(...) where there is no end; else, in a share of the time that is left: true and its
-- results, or nil and the seconds where these were not enough. Errors pass.
function Clock:call(share, f, ...)
  if not self.seconds then
    if f == core.until_stop then return f(...) end
    return true, f(...)
  end
  local left = share * (self.seconds - (core.cpu() - self.began))
  if left <= 0 then return nil, 0 end
  local start = core.cpu()
  local out = table.pack(core.within(left, f, ...))
  local late = core.cpu() - start >= left
  if not out[1] or f == core.until_stop and late and not out[2] then return nil, left end
  return table.unpack(out, f == core.until_stop and 2 or 1, out.n)
end

--- Note a point of a rule that was not measured.
function Clock:leave_out(name)
  if not self.left_out[name] then self.order[#self.order + 1] = name end
  self.left_out[name] = (self.left_out[name] or 0) + 1
end

--- What was left out, as a sentence; false where nothing was, nil without an end.
function Clock:told()
  if not self.seconds then return nil end
  if #self.order == 0 then return false end
  local parts = {}
  for i, name in ipairs(self.order) do
    local count = self.left_out[name]
    parts[i] = ("%d step%s of %s"):format(count, count == 1 and "" or "s", name)
  end
  return ("left out after %g s of CPU time: %s"):format(self.seconds, table.concat(parts, ", "))
end

return M
