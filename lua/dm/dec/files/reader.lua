--- A mesh file line by line, none of it trusted: numbers are finite, indices are checked where they
-- stand, and lists grow by what is read, never by what a header claims. Errors name file and line.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local Reader = {}
Reader.__index = Reader

--- The file, to be read from its first line; comment: the character that begins a comment.
function M.open(file, comment)
  local handle, why = core.open_file(file)
  if not handle then option.fail("dm.mesh", "%s", why) end
  return setmetatable({ file = file, handle = handle, comment = comment, line = 0, words = {} },
    Reader)
end

--- Raises "file, line N: text".
function Reader:fail(text, ...)
  if self.handle then self.handle:close() end
  self.handle = nil
  option.fail("dm.mesh", "%s, line %d: %s", self.file, self.line, text:format(...))
end

local LONGEST = 2 ^ 20 -- characters of a line

--- One simplex more, of the line that was read last.
function Reader:add(simplices, vertices)
  local lines = simplices.lines or {}
  simplices[#simplices + 1], simplices.lines = vertices, lines
  lines[#simplices] = self.line
end

-- the next line, or nil at the end
local function next_line(self)
  local text = self.handle and self.handle:read "L"
  if not text then return nil end
  self.line = self.line + 1
  if self.line == 1 then text = text:gsub("^\xEF\xBB\xBF", "") end -- what some editors put first
  if #text > LONGEST then self:fail("the line is too long for a mesh file") end
  if text:find "[%z\1-\8\14-\31]" then self:fail("this is binary; meshes are read as text") end
  return text
end

--- The words of the next line that has any, or nil at the end of the file.
function Reader:next()
  repeat
    local text = next_line(self)
    if not text then return nil end
    if self.comment then text = text:gsub(self.comment .. ".*", "") end
    self.words = {}
    for word in text:gmatch "%S+" do self.words[#self.words + 1] = word end
  until #self.words > 0
  return self.words
end

--- The same, where the file may not end: `what` is read, i of n.
function Reader:need(what, i, n)
  if self:next() then return self.words end
  self.line = self.line + 1
  if i then self:fail("the file ends, %d of %.0f %s are there", i - 1, n, what) end
  return self:fail("the file ends where %s should stand", what)
end

--- The list of `what` ends here: where more than the n stand that the header counts, one is wrong.
function Reader:ends(what, n, closing)
  local words = self:next()
  if words and words[1] == closing or not words and not closing then return end
  if not words then self:need(closing) end
  return self:fail("more %s stand here than the %.0f that are counted", what, n)
end

--- The next word, over the ends of lines, for files that are streams of words.
function Reader:word(what)
  self.at = (self.at or 0) + 1
  while not self.words[self.at] do
    if not self:next() then
      if not what then return nil end
      self.line = self.line + 1
      self:fail("the file ends where %s should stand", what)
    end
    self.at = 1
  end
  return self.words[self.at]
end

--- A word as a finite number.
function Reader:number(word, what)
  local x = word and word:find "^[-+]?%.?%d" and tonumber(word)
  if not x or word:find "[xX]" or not (x - x == 0) then
    self:fail("%s must be a finite number (got %s)", what, option.got(word))
  end
  return x + 0.0
end

--- A word as a whole number from least to most.
function Reader:whole(word, what, least, most)
  local x = word and word:find "^[-+]?%d+$" and math.tointeger(tonumber(word))
  if not x or x < least or x > (most or x) then
    self:fail("%s must be a whole number %s (got %s)", what,
      most and ("from %d to %d"):format(least, most) or ">= " .. least, option.got(word))
  end
  return x
end

--- Numbers from words first .. last of this line, as a point.
function Reader:point(first, last, what)
  local p = {}
  for i = first, last do p[#p + 1] = self:number(self.words[i], what) end
  return p
end

function Reader:close()
  if self.handle then self.handle:close() end
  self.handle = nil
end

---- what formats have in common ----

--- Points whose third coordinate is the same everywhere lie in the plane.
function M.flattened(points)
  if #points == 0 or #points[1] ~= 3 then return points end
  for _, p in ipairs(points) do
    if p[3] ~= points[1][3] then return points end
  end
  for _, p in ipairs(points) do p[3] = nil end
  return points
end

--- The simplices with the most vertices, and the points that they have, numbered anew in the order
-- of the file: boundary pieces and corners that a mesher adds are left out.
function M.top(points, simplices)
  local most, top, is_used, lines, of = 0, {}, {}, {}, simplices.lines
  for _, s in ipairs(simplices) do most = math.max(most, #s) end
  for i, s in ipairs(simplices) do
    if #s == most then
      top[#top + 1] = s
      lines[#top] = of[i]
      for _, v in ipairs(s) do is_used[v] = true end
    end
  end
  local kept, number = {}, {}
  for v, p in ipairs(points) do
    if is_used[v] then
      kept[#kept + 1] = p
      number[v] = #kept
    end
  end
  for _, s in ipairs(top) do
    for j, v in ipairs(s) do s[j] = number[v] end
  end
  top.lines = lines
  return M.given(kept, top)
end

--- What dm.complex takes, and the line of every simplex, simplices.lines[i].
function M.given(points, simplices)
  local lines = simplices.lines
  simplices.lines = nil
  if #points == 0 then return { simplices = simplices }, lines end
  return { points = core.matrix(M.flattened(points)), simplices = simplices, vertices = #points },
    lines
end

return M
