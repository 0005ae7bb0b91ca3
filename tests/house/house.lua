-- A house check is a sentence and the list of what offends against it; no offender, no failure.
local M = {}

local count, failed = 0, 0
M.build = os.getenv("B") or "build"
M.dmlua = os.getenv("DMLUA") or M.build .. "/dmlua"
M.under = os.getenv("UNDER") or ""

function M.check(sentence, offenders)
  count = count + 1
  if #offenders > 0 then failed = failed + 1 end
  print(("%sok %d - %s"):format(#offenders > 0 and "not " or "", count, sentence))
  for i = 1, math.min(#offenders, 20) do print("#   " .. offenders[i]) end
  if #offenders > 20 then print(("#   ... and %d more"):format(#offenders - 20)) end
end

-- a check has to look at something: n things, at least so many
function M.enough(sentence, n, least) M.check(sentence, n >= least and {} or { n .. " found" }) end

-- What is let pass, rows { place, names in one text, why }. owed(place, name): is it? idle(): those
-- that were not asked for, which fail a test too, so that no exception outlives its reason.
function M.exceptions(rows)
  local unused, E = {}, {}
  for _, row in ipairs(rows) do
    for name in row[2]:gmatch "%S+" do unused[row[1] .. " " .. name] = true end
  end
  function E.owed(place, name)
    local key = place .. " " .. name
    local known = unused[key] ~= nil
    if known then unused[key] = false end
    return known
  end
  function E.idle()
    local list = {}
    for key, idle in pairs(unused) do
      if idle then list[#list + 1] = key .. ": take its exception out" end
    end
    return list
  end
  return E
end

function M.skip(sentence, why)
  count = count + 1
  print(("ok %d - %s # SKIP %s"):format(count, sentence, why))
end

function M.finish()
  print("1.." .. count)
  os.exit(failed == 0, true)
end

-- the lines that a command writes
function M.lines(command)
  local pipe, list = assert(io.popen(command)), {}
  for line in pipe:lines() do list[#list + 1] = line end
  pipe:close()
  return list
end

-- everything that a command writes, and whether it succeeded
function M.output(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read "a"
  return text, (pipe:close())
end

function M.read(file)
  local f <close> = assert(io.open(file))
  return f:read "a"
end

function M.is_there(file)
  local f = io.open(file)
  if f then f:close() end
  return f ~= nil
end

-- the files of the project, whether it is a clone or an unpacked archive
function M.files(pattern)
  local list = M.lines "git ls-files 2>/dev/null"
  if #list == 0 then list = M.lines "find . -type f -not -path './build/*' | sed 's,^./,,'" end
  local some = {}
  for _, file in ipairs(list) do
    local f = file:find(pattern) and io.open(file)
    if f then
      f:close()
      some[#some + 1] = file
    end
  end
  return some
end

return M
