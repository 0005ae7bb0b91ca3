--- dmlua --machine IN,OUT: cells of a notebook. Requests are { op = "execute", code = },
-- { op = "complete", code = }, { op = "inspect", code =, at = }, { op = "whole", code = } and, as
-- an answer to { event = "input" }, { op = "input", text = }. Answers are { event = "result",
-- text = }, { event = "display", type =, content = }, { event = "error", name =, text =, lines = },
-- and at the end of each request { event = "done" } with what was asked.
local ask = require "dm.notebook.ask"
local cell = require "dm.notebook.cell"
local frames = require "dm.notebook.frames"

local M = {}

local out = {}
local silent  -- does the cell end in a semicolon?

---- what a cell reads ----

local function line_of_user()
  frames.write { event = "input" }
  local answer = frames.read()
  return answer and answer.op == "input" and answer.text or nil
end

local FORMATS = {
  n = function(line) return tonumber(line) end,
  a = function(line) return line end,
  l = function(line) return line end,
  L = function(line) return line .. "\n" end,
}

-- io.read of a notebook: every format asks for a line
local function read(...)
  local formats, results = table.pack(...), {}
  if formats.n == 0 then formats = { "l", n = 1 } end
  for i = 1, formats.n do
    local line = line_of_user()
    if not line then return table.unpack(results, 1, i) end
    local f = formats[i]
    if type(f) == "number" then
      results[i] = line:sub(1, f)
    else
      local known = FORMATS[tostring(f):match "^%*?(.)"]
      if not known then error(("bad argument #%d to 'read' (invalid format)"):format(i), 2) end
      results[i] = known(line)
    end
  end
  return table.unpack(results, 1, formats.n)
end

---- what it shows ----

local function show(kind, content)
  local text = kind:find "^image/png" and require "dm.base.base64".encode(content) or content
  frames.write { event = "display", type = kind, content = text }
end

local function keep(value)
  if value == nil then return end
  _G._ = value
  out[#out + 1] = value
end

-- the path of a run that was stopped is kept, else the failure itself
local function failed(failure)
  local stopped = failure.code == "stopped" and failure.path ~= nil
  keep(stopped and failure.path or failure)
  local kept = stopped and "_ is the path so far" or failure.path ~= nil
    and "_ is this failure, _.path what was computed before" or "_ is this failure"
  return tostring(failure.message or failure.code) .. "\n" .. kept, tostring(failure.code)
end

local function is_failure(value)
  local meta = type(value) == "table" and getmetatable(value)
  return meta and meta.__name == "dm.failure"
end

local function lines_of(text)
  local lines = {}
  for line in (text .. "\n"):gmatch "(.-)\n" do lines[#lines + 1] = line end
  return lines
end

local function show_error(value)
  local text, name = tostring(value), "error"
  if is_failure(value) then text, name = failed(value) end
  frames.write { event = "error", name = name, text = text:match "^[^\n]*", lines = lines_of(text) }
end

--- Called with what a cell gave, or with false and its error.
function M.done(fine, ...)
  if not fine then
    show_error((...))
  elseif select("#", ...) > 0 then
    keep((...))
    local texts = table.pack(require "dm.session.pretty".texts(...))
    if not silent then
      frames.write { event = "result", text = table.concat(texts, "\t", 1, texts.n) }
    end
  end
  frames.write { event = "done" }
end

---- what is asked ----

local answers = {
  complete = function(request) return ask.complete(request.code) end,
  inspect = function(request)
    return ask.inspect(request.code, math.tointeger(request.at) or #request.code)
  end,
  whole = function(request) return ask.is_complete(request.code) end,
}

local function answer(request)
  local f = type(request.code) == "string" and answers[request.op]
  if not f then
    return frames.write { event = "wrong", text = "no such request: " .. tostring(request.op) }
  end
  local fine, got = pcall(f, request)
  got = fine and got or {}
  got.event = "done"
  frames.write(got)
end

--- The function of the next cell, or nil at the end; other requests are answered on the way.
function M.next()
  for request in frames.read do
    if request.op == "execute" and type(request.code) == "string" then
      local f, why = cell.compile(request.code)
      silent = f and require "dm.session.complete".is_silent(request.code)
      if f then return f end
      show_error(why)
      frames.write { event = "done" }
    else
      answer(request)
    end
  end
end

--- Files of the io library: requests, answers. From now on pictures go into the notebook, and
-- io.read asks there.
function M.open(from, to)
  frames.open(from, to)
  require "dm.show.inline".show = show
  rawset(io, "read", read)
  _G.out = out
  require "dm.session.help".open()
end

return M
