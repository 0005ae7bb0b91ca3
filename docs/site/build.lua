-- make site: build/dmlua docs/site/build.lua OUT - the docs as pages for a browser, with their
-- pictures, demonstrations, three labs and a search of the reference. No page asks the network.
-- Markdown goes through pandoc, formulas become MathML with the STIX font (fonts-stix).
local out = arg[1] or "build/site"
local here = "docs/site"

local function quote(text) return "'" .. text:gsub("'", "'\\''") .. "'" end
local function run(command)
  if not os.execute(command) then error("site: this failed: " .. command, 0) end
end
local function answer_of(command)
  local pipe = io.popen(command)
  local text = pipe:read "a"
  pipe:close()
  return text
end
local function read(name)
  local file <close> = assert(io.open(name, "rb"))
  return file:read "a"
end
local function write(name, text)
  run("mkdir -p " .. quote(name:match "^(.*)/"))
  local file <close> = assert(io.open(name, "wb"))
  file:write(text)
end

local FONT = "/usr/share/fonts/opentype/stix-word/STIXMath-Regular.otf"
local function check()
  local found = answer_of "command -v pandoc"
  if found == "" then error("site: pandoc is missing (Debian, Ubuntu: apt install pandoc)", 0) end
  local font = io.open(FONT)
  if not font then error("site: the STIX font is missing (Debian, Ubuntu: apt install fonts-stix)", 0) end
  font:close()
end

---- which pages ----

-- the sections of the menu: title, and pages in their order, else all of a folder
local MENU = {
  { "Start", "README.md", "docs/tour.md", "docs/examples.md", "docs/notebooks.md", "docs/publishing.md" },
  { "Theory", folder = "docs/theory" },
  { "Figures", "docs/charts.md", "docs/failures.md", "docs/benchmarks.md", folder = "docs/benchmarks" },
  { "Reference", "docs/reference.md", "docs/conventions.md", "docs/sweeps.md", "docs/changelog.md" },
  { "The house", "docs/architecture.md", "docs/extending.md", folder = "docs/design" },
  { "Lab book", folder = "docs/lab" },
}
local FIRST = { ["docs/theory"] = { "docs/theory/errata.md" } }

local function exists(name)
  local file = io.open(name)
  if file then file:close() end
  return file ~= nil
end

-- docs/theory/lie.md -> theory/lie.html
local function target_of(source)
  if source == "README.md" then return "index.html" end
  return (source:gsub("^docs/", ""):gsub("%.md$", ".html"))
end

local function title_of(source) return read(source):match "^#%s*([^\n]*)" or source end

local function pages_of(section)
  local list, seen = {}, {}
  local function add(source)
    if exists(source) and not seen[source] then
      seen[source] = true
      list[#list + 1] = source
    end
  end
  for i = 2, #section do add(section[i]) end
  for name in answer_of("ls " .. (section.folder or "/dev/null") .. " 2>/dev/null"):gmatch "[^\n]+%.md" do
    add(section.folder .. "/" .. name)
  end
  for _, source in ipairs(section.folder and FIRST[section.folder] or {}) do add(source) end
  return list
end

-- "../" for every folder of the target
local function root_of(target) return ("../"):rep(select(2, target:gsub("/", ""))) end

local EXTRA = { { "Labs", { "labs/kepler.html", "Kepler: step, eccentricity, rule" },
  { "labs/pendulum.html", "A stiff pendulum: step, stiffness" }, { "labs/rk4.html", "RK4 against Verlet" } },
  { "Demonstrations", { "demos.html", "All demonstrations" } } }

local function menu_of(target)
  local root, lines = root_of(target), {}
  local function entry(to, title)
    local mark = to == target and ' class="here"' or ""
    lines[#lines + 1] = ('<li%s><a href="%s%s">%s</a></li>'):format(mark, root, to, title)
  end
  for i, section in ipairs(MENU) do
    lines[#lines + 1] = "<h2>" .. section[1] .. "</h2><ul>"
    for _, source in ipairs(pages_of(section)) do entry(target_of(source), title_of(source):gsub("[`<>&]", "")) end
    lines[#lines + 1] = "</ul>"
    if i == 1 then
      for _, extra in ipairs(EXTRA) do
        lines[#lines + 1] = "<h2>" .. extra[1] .. "</h2><ul>"
        for k = 2, #extra do entry(extra[k][1], extra[k][2]) end
        lines[#lines + 1] = "</ul>"
      end
    end
  end
  return table.concat(lines, "\n")
end

---- one page ----

local template = read(here .. "/page.html")

local function page(target, title, body)
  local parts = { TITLE = title, ROOT = root_of(target), MENU = menu_of(target), BODY = body,
    SEARCH = target == "reference.html" and read(here .. "/search.html") or "" }
  write(out .. "/" .. target, (template:gsub("@(%u+)@", parts)))
end

local function markdown(source)
  local target = target_of(source)
  local command = ("pandoc -f gfm+tex_math_dollars-emoji -t html5 --mathml --lua-filter %s/links.lua -M source=%s %s")
    :format(here, source, source)
  local body = answer_of(command)
  if body == "" then error("site: pandoc made nothing of " .. source, 0) end
  page(target, title_of(source):gsub("[`<>&]", ""), body)
end

---- demonstrations ----

local ENTITIES = { ["<"] = "&lt;", [">"] = "&gt;", ["&"] = "&amp;" }
local function escaped(text) return (text:gsub("[<>&]", ENTITIES)) end

-- what a demonstration says, and a moving picture of its first path that has one
local function demonstration(name)
  local said = answer_of(("TERM=dumb LC_ALL=C.UTF-8 %s --demo %s </dev/null 2>&1"):format(arg[-1], name))
  local moving = "demos/" .. name .. ".html"
  local script = ([[
    local demo, e = require("dm.demos.%s"), setmetatable({}, { __index = _G })
    for _, number in ipairs(demo.numbers or {}) do e[number.name] = number.value end
    print, io.write = function() end, function() end
    for _, step in ipairs(demo.steps) do if step[2] then pcall(load(step[2], "=demo", "t", e)) end end
    for _, path in pairs(e) do
      if type(path) == "userdata" and pcall(path.animate, path, "%s/%s", { title = demo.title }) then os.exit(true) end
    end
    os.exit(false)]]):format(name, out, moving)
  local fine = os.execute(("mkdir -p %s/demos && %s -e %s >/dev/null 2>&1"):format(quote(out), arg[-1], quote(script)))
  return said, fine and moving or nil
end

local function demonstrations()
  local body = { "<h1>Demonstrations</h1>\n<p>Each runs with <code>dmlua --demo name</code>, and again with other numbers.</p>" }
  for _, name in ipairs(require "dm.demos") do
    local said, moving = demonstration(name)
    body[#body + 1] = ('<h2 id="%s">%s</h2>'):format(name, name)
    if moving then body[#body + 1] = ('<p><a href="%s">It moves</a></p>'):format(moving) end
    body[#body + 1] = "<pre>" .. escaped(said) .. "</pre>"
  end
  page("demos.html", "Demonstrations", table.concat(body, "\n"))
end

---- the whole ----

check()
run("rm -rf " .. quote(out) .. " && mkdir -p " .. quote(out .. "/labs"))
run(("cp -r docs/images %s/images && cp -r examples %s/examples && cp %s/style.css %s && cp %s %s/math.otf")
  :format(quote(out), quote(out), here, quote(out), FONT, quote(out)))
run(("cp -r docs/notebooks %s && cp LICENSE %s/LICENSE.txt"):format(quote(out), quote(out)))
for _, section in ipairs(MENU) do
  for _, source in ipairs(pages_of(section)) do markdown(source) end
end
for lab in answer_of("ls " .. here .. "/labs"):gmatch "[^\n]+%.lua" do
  run(("%s %s/labs/%s %s/labs"):format(arg[-1], here, lab, quote(out)))
end
demonstrations()
print("site: " .. out .. "/index.html")
