--- Frames of a session that a program drives: one JSON object a line, on two descriptors of their
-- own, so that what a cell and its child processes print stays apart.
local blame = require "dm.base.blame"
local json = require "dm.base.json"

local M = {}

local EINTR = 4
local input, output

--- Files of the io library: where requests come from, where answers go.
function M.open(from, to)
  input, output = from, to
end

--- The next request, or nil at the end of them.
function M.read()
  while true do
    local line, _, code = input:read "L"
    if line then
      local fine, request = blame.try(json.decode, line)
      if fine and type(request) == "table" then return request end
      M.write { event = "wrong", text = fine and "a frame is an object" or request }
    elseif code ~= EINTR then
      return nil
    end
  end
end

--- Everything that was printed before goes out first.
function M.write(answer)
  io.stdout:flush()
  io.stderr:flush()
  output:write(json.encode(answer), "\n")
  output:flush()
end

return M
