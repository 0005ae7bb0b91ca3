--- How help lays out a doc on the terminal.
local core = require "dm.core"

local M = {}

function M.first_line(doc) return doc:match("^[^\n]*") end

function M.write(...) print(table.concat({ ... })) end

function M.width() return math.min(core.terminal().width, 100) - 2 end

function M.sorted(list)
  table.sort(list)
  return list
end

--- A long line of prose in lines of at most `width` characters.
function M.wrapped(text, width, indent)
  local lines, line = {}, nil
  for word in text:gmatch "%S+" do
    if line and #line + 1 + #word > width then
      lines[#lines + 1], line = line, nil
    end
    line = line and line .. " " .. word or indent .. word
  end
  lines[#lines + 1] = line
  return table.concat(lines, "\n")
end

-- the lines of a doc, a sentence that goes on in the next line in one
local function paragraphs(doc)
  local lines = {}
  for line in (doc .. "\n"):gmatch "(.-)\n" do
    local before = lines[#lines]
    if #lines > 1 and before:find "[%w,;=%)%]]$" and not before:find("->", 1, true) then
      lines[#lines] = before .. " " .. line
    else
      lines[#lines + 1] = line
    end
  end
  return lines
end

--- The signature, then the rest wrapped to the terminal.
function M.doc(doc)
  local width, lines = M.width(), paragraphs(doc)
  for i = 2, #lines do lines[i] = M.wrapped(lines[i], width, "  ") end
  return table.concat(lines, "\n")
end

return M
