-- a filter of pandoc: links among the docs lead to pages; what the site does not have is plain text
local source
local KEPT = { png = true, svg = true, html = true, lua = true, ipynb = true }

-- "docs/theory" and "../tour.md" -> "docs/tour.md"
local function joined(folder, link)
  local parts = {}
  for part in (folder .. "/" .. link):gmatch "[^/]+" do
    if part == ".." then table.remove(parts) elseif part ~= "." then parts[#parts + 1] = part end
  end
  return table.concat(parts, "/")
end

local function exists(name)
  local file = io.open(name)
  if file then file:close() end
  return file ~= nil
end

-- a file of the project as a page of the site, or nil
local function page_of(file)
  if file == "README.md" then return "index.html" end
  if file == "LICENSE" then return "LICENSE.txt" end
  if not exists(file) then return nil end
  local ending = file:match "%.(%w+)$"
  if file:find "^docs/" and ending == "md" then return (file:gsub("^docs/", ""):gsub("md$", "html")) end
  if KEPT[ending] and (file:find "^docs/images/" or file:find "^examples/" or file:find "^docs/notebooks/") then
    return (file:gsub("^docs/", ""))
  end
end

local function target(link)
  if link:find "^%a+:" or link:find "^#" then return link end
  local path, mark = link:match "^([^#]*)(.*)$"
  local page = page_of(joined(source:match "^(.*)/[^/]*$" or ".", path))
  local depth = source == "README.md" and 0 or select(2, source:gsub("^docs/", ""):gsub("/", ""))
  return page and ("../"):rep(depth) .. page .. mark
end

local function meta(m) source = pandoc.utils.stringify(m.source) end

local function link(l)
  local to = target(l.target)
  if not to then return l.content end
  l.target = to
  return l
end

local function image(i)
  i.src = target(i.src) or i.src
  return i
end

return { { Meta = meta }, { Link = link, Image = image } }
