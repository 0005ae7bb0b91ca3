-- The tree of the house as it is: folders, files, and who asks whom. C is read twice, by the
-- symbols of the objects (who defines, who calls) and by #include, Lua by require. test_floors looks
-- at the arrows; as a program it draws them:  build/dmlua tests/house/tree.lua [ROOT]
local tree = {}

local function lines(command)
  local pipe, list = assert(io.popen(command)), {}
  for line in pipe:lines() do list[#list + 1] = line end
  pipe:close()
  return list
end
local function folder(file) return file:match "^(.*)/" end

-- the files below some folders, with paths from the root
function tree.files(root, where)
  return lines(("cd '%s' && find %s -type f | LC_ALL=C sort"):format(root, where))
end

-- arrows[from][to] = { "who asks for what", ... } between folders; of itself a folder may ask
local function add(arrows, from, to, why)
  if from == to then return end
  arrows[from] = arrows[from] or {}
  local list = arrows[from][to] or {}
  arrows[from][to] = list
  list[#list + 1] = why
end

-- what the objects of sources that are there define and ask: rows { object, kind of nm, symbol };
-- the object of src/base/arena.c is "base/arena"
function tree.symbols(root, build)
  local there, rows = {}, {}
  for _, file in ipairs(tree.files(root, "src")) do
    there[file:match "^src/(.*)%.c$" or ""] = true
  end
  local command = "cd '%s' 2>/dev/null && find . -name '*.o' -not -path './tests/*' "
    .. "-not -path './san/*' -not -path './bench/*' | LC_ALL=C sort | xargs nm -A -g"
  for _, line in ipairs(lines(command:format(build))) do
    local object, kind, name = line:match "^%./(.-)%.o:.-(%a) (%S+)$"
    if there[object] then rows[#rows + 1] = { object, kind, name } end
  end
  return rows
end
function tree.asks(row) return row[2] == "U" or row[2] == "w" end

-- arrows between objects, as { from = { to = symbol } }
function tree.objects(root, build)
  local defined, between = {}, {}
  local rows = tree.symbols(root, build)
  for _, row in ipairs(rows) do
    if not tree.asks(row) then defined[row[3]] = row[1] end
  end
  for _, row in ipairs(rows) do
    local from, to = row[1], tree.asks(row) and defined[row[3]]
    if to and to ~= from then
      between[from] = between[from] or {}
      between[from][to] = row[3]
    end
  end
  return between
end

-- how many arrows there are
function tree.count(arrows)
  local n = 0
  for _, to in pairs(arrows) do for _ in pairs(to) do n = n + 1 end end
  return n
end

function tree.by_symbols(root, build)
  local arrows = {}
  for from, list in pairs(tree.objects(root, build)) do
    for to, symbol in pairs(list) do
      local why = ("%s.c calls %s of %s.c"):format(from, symbol, to)
      add(arrows, "src/" .. folder(from), "src/" .. folder(to), why)
    end
  end
  return arrows
end

function tree.by_includes(root)
  local arrows = {}
  for _, line in ipairs(lines(("cd '%s' && grep -rE '^ *# *include *\"' src"):format(root))) do
    local file, header = line:match '^(.-):.-"(.-)"'
    local to = folder("src/" .. header)
    if to ~= "src" then add(arrows, folder(file), to, ("%s includes %s"):format(file, header)) end
  end
  return arrows
end

-- "dm" itself is the door that all may use, lua/dm/init.lua the one that opens every room
function tree.by_requires(root)
  local place, arrows = {}, {}
  local files = tree.files(root, "lua")
  for _, file in ipairs(files) do
    local name = file:match "^lua/(.*)%.lua$"
    if name then place[name:gsub("/init$", ""):gsub("/", ".")] = folder(file) end
  end
  place.dm = nil
  for _, file in ipairs(files) do
    local f <close> = assert(io.open(root .. "/" .. file))
    local text = file == "lua/dm/init.lua" and "" or f:read "a"
    for name in text:gmatch "require%s*%(?%s*[\"']([%w_.]+)" do
      if place[name] then add(arrows, folder(file), place[name], file .. " requires " .. name) end
    end
  end
  return arrows
end

-- the cycles of a graph, each a sorted list of its nodes (Tarjan's strongly connected components)
function tree.cycles(arrows)
  local index, low, on, stack, count, found = {}, {}, {}, {}, 0, {}
  local function close(node)
    local cycle, last = {}, nil
    repeat
      last = table.remove(stack)
      on[last] = nil
      cycle[#cycle + 1] = last
    until last == node
    table.sort(cycle)
    if #cycle > 1 then found[#found + 1] = cycle end
  end
  local function visit(node)
    count = count + 1
    index[node], low[node], on[node] = count, count, true
    stack[#stack + 1] = node
    for to in pairs(arrows[node] or {}) do
      if not index[to] then visit(to) end
      if on[to] then low[node] = math.min(low[node], low[to]) end
    end
    if low[node] == index[node] then close(node) end
  end
  local nodes = {}
  for node in pairs(arrows) do nodes[#nodes + 1] = node end
  table.sort(nodes)
  for _, node in ipairs(nodes) do if not index[node] then visit(node) end end
  table.sort(found, function(a, b) return #a > #b end)
  return found
end

-- ---- the picture

local function sorted(set)
  local list = {}
  for name in pairs(set) do list[#list + 1] = name end
  table.sort(list)
  return list
end

-- files of every folder, and the folders above it
local function count(files)
  local n = {}
  for _, file in ipairs(files) do
    local at = folder(file)
    n[at] = (n[at] or 0) + 1
    while at:find "/" do at = folder(at); n[at] = n[at] or 0 end
  end
  return n
end

-- a folder as another one calls it: without the path that both have
local function called(to, top) return to == top and "(" .. top .. ")" or to:sub(#top + 2) end

-- one line a folder, with the folders that it asks; a star where the other one asks back
local function draw(top, n, arrows)
  print(("%-26s %5s   %s"):format("folder", "files", "asks"))
  for _, name in ipairs(sorted(n)) do
    if name == top or name:sub(1, #top + 1) == top .. "/" then
      local _, depth = name:sub(#top):gsub("/", "")
      local asks = {}
      for _, to in ipairs(sorted(arrows[name] or {})) do
        local back = arrows[to] and arrows[to][name]
        asks[#asks + 1] = called(to, top) .. (back and "*" or "")
      end
      local short = name == top and top or name:match "[^/]+$"
      local row = ("%-26s %5d  "):format(("  "):rep(depth) .. short, n[name])
      local width = 34
      for _, word in ipairs(asks) do
        if width + #word > 98 then row, width = row .. "\n" .. (" "):rep(34), 34 end
        row, width = row .. " " .. word, width + #word + 1
      end
      print((row:gsub("%s+$", "")))
    end
  end
end

local function say(cycles, unit)
  local most = cycles[1] and (", the largest of " .. #cycles[1]) or ""
  print(("cycles between %s: %d%s"):format(unit, #cycles, most))
end

function tree.main(root)
  local build = root .. "/build"
  local arrows, requires = tree.by_symbols(root, build), tree.by_requires(root)
  draw("src", count(tree.files(root, "src")), arrows)
  say(tree.cycles(arrows), "folders by symbols")
  say(tree.cycles(tree.by_includes(root)), "folders by #include")
  say(tree.cycles(tree.objects(root, build)), "objects")
  print()
  draw("lua/dm", count(tree.files(root, "lua")), requires)
  say(tree.cycles(requires), "folders by require")
end

if arg and arg[0] and arg[0]:find "tree%.lua$" then tree.main(arg[1] or ".") end
return tree
