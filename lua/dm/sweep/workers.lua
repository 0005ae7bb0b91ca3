--- Members of dm.sweep by processes: ranges are handed out in ascending order, so that the first
-- member that fails is known whatever the processes are.
local core = require "dm.core"
local pace = require "dm.sweep.pace"

local M = {}

-- the worker's side: "first count" -> "ok" or "error", behind it the bytes or what was raised
local function serve(run)
  return function(channel)
    while true do
      local order = channel:receive()
      if not order then return end
      local first, count = ("<i8i8"):unpack(order)
      local fine, bytes = pcall(run, first, count)
      if not channel:send(fine and "y" .. bytes or "n" .. tostring(bytes)) then return end
    end
  end
end

local GOAL = 0.1 -- s of a range

-- ranges of what is missing, each as long as the last ones ask for
local function ranges(missing)
  local k, at = 1, missing[1] and missing[1][1]
  return function(size)
    local range = missing[k]
    if not range then return nil end
    local first, count = at, math.min(size, range[2] - at + 1)
    at = at + count
    if at > range[2] then
      k = k + 1
      at = missing[k] and missing[k][1]
    end
    return first, count
  end
end

--- Run what is missing with so many processes; keep(first, count, bytes) takes what is finished.
-- Raises what the least member raised.
function M.run(missing, count, run, keep)
  local workers, orders, next_range, size = {}, {}, ranges(missing), pace(1, GOAL)
  local failed
  local function fail_at(member, why)
    if not failed or member < failed.member then failed = { member = member, why = why } end
  end
  -- the next range for worker k, or its end
  local function give(k)
    local w, first, many = workers[k], nil, nil
    if not failed then first, many = next_range(size()) end
    if first then
      orders[w] = { first = first, count = many, began = core.clock() }
      w:send(("<i8i8"):pack(first, many))
    else
      w:close()
      table.remove(workers, k)
    end
  end
  local function take(k)
    local answer, was = workers[k]:receive(), orders[workers[k]]
    if not answer then
      fail_at(was.first, ("the process of members %d to %d has ended"):format(was.first,
        was.first + was.count - 1))
    elseif answer:sub(1, 1) == "y" then
      keep(was.first, was.count, answer:sub(2))
      if was.count == size() then size(core.clock() - was.began) end
    else
      fail_at(was.first, answer:sub(2))
    end
    give(k)
  end
  local fine, why = pcall(function()
    for k = 1, missing[1] and count or 0 do workers[k] = core.worker(serve(run)) end
    for k = #workers, 1, -1 do give(k) end
    while #workers > 0 do
      local k = core.wait(workers)
      if not k then error("interrupted!", 0) end
      take(k)
    end
  end)
  for _, w in ipairs(workers) do w:close() end
  if not fine then error(why, 0) end
  if failed then error(failed.why, 0) end
end

return M
