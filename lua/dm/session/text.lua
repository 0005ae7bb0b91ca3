--- How help lays out a doc on the terminal.
local core = require "dm.core"

local M = {}

function M.first_line(doc) return doc:match("^[^\n]*") end

local held = nil  -- what is written, while M.collected waits for all of it

--- Print a text that the parts make, or keep it for M.collected.
function M.write(...)
  local text = table.concat({ ... })
  if not held then return print(text) end
  held[#held + 1] = text
end

--- What f(...) writes as one text, and what it returns; what it raises is raised.
function M.collected(f, ...)
  local before = held
  held = {}
  local results = table.pack(pcall(f, ...))
  local text = table.concat(held, "\n")
  held = before
  if not results[1] then error(results[2], 0) end
  return text, table.unpack(results, 2, results.n)
end

function M.width() return math.min(core.terminal().width, 100) - 2 end

function M.sorted(list)
  table.sort(list)
  return list
end

--- A long line of prose in lines of at most `width` characters; `first` begins the first of them,
-- `indent` (the same where first is left out) the others.
function M.wrapped(text, width, indent, first)
  local lines, line = {}, nil
  for word in text:gmatch "%S+" do
    if line and #line + 1 + #word > width then
      lines[#lines + 1], line = line, nil
    end
    line = line and line .. " " .. word or (#lines == 0 and first or indent) .. word
  end
  lines[#lines + 1] = line
  return table.concat(lines, "\n")
end

local WIDE = 100 -- columns of the sources

-- the lines of a doc, a sentence that goes on in the next line in one: one that does not look like
-- an end, or that had no room for the next word
local function paragraphs(doc)
  local lines, last = {}, ""
  for line in (doc .. "\n"):gmatch "(.-)\n" do
    local before, word = lines[#lines], line:match "^%S+"
    local goes_on = word and #last + 1 + #word > WIDE
      or before and before:find "[%w,;=%)%]]$" and not before:find("->", 1, true)
    if #lines > 1 and goes_on then
      lines[#lines] = before .. " " .. line
    else
      lines[#lines + 1] = line
    end
    last = line
  end
  return lines
end

-- up to the full stop that ends it
local function first_sentence(text)
  text = text:gsub("%s+", " ")
  return text:match "^.-%S%.%f[%s\0]%f[^.]%s*%f[%u\0]" or text
end

--- The name that a doc is of, and the first sentence of what it says.
function M.headline(doc)
  local first, rest = doc:match "^([^\n]*)\n?(.*)$"
  local class, what = first:match "^(dm%.[%w_]+): (.*)$"
  if class then
    what = (what .. " " .. rest):gsub("%s+", " ")
    return class, what:match "^(.-), made by " or what:match "^(.-) fields: "
      or first_sentence(what)
  end
  return first:match "^[%w_.:]+" or first, first_sentence(rest)
end

--- The signature, then the rest wrapped to the terminal.
function M.doc(doc)
  local width, lines = M.width(), paragraphs(doc)
  for i = 2, #lines do lines[i] = M.wrapped(lines[i], width, "  ") end
  return table.concat(lines, "\n")
end

return M
