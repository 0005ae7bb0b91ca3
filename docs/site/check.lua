-- dmlua docs/site/check.lua OUT - after `make site`: no link is broken, no page asks the network, and
-- in a browser (chromium, where there is one) pages open without an error and every formula has a size
package.path = "tests/lua/?.lua;" .. package.path
local browser = require "browser"
local out = arg[1] or "build/site"

local function lines_of(command)
  local list, pipe = {}, io.popen(command)
  for line in pipe:lines() do list[#list + 1] = line end
  pipe:close()
  return list
end
local function read(name)
  local file <close> = assert(io.open(name, "rb"))
  return file:read "a"
end
local wrong = 0
local function complain(...)
  wrong = wrong + 1
  print("site: " .. string.format(...))
end
local function exists(name)
  local file = io.open(name)
  if file then file:close() end
  return file ~= nil
end

local function check_links(name, text)
  local folder = name:match "^(.*)/"
  text = text:gsub("<script.-</script>", "")
  for kind, link in text:gmatch '(%a+)="([^"#]+)' do
    if kind == "src" and link:find "^%a+://" then complain("%s asks %s", name, link) end
    if (kind == "src" or kind == "href") and not link:find "^%a+:" and not exists(folder .. "/" .. link) then
      complain("%s: broken link %s", name, link)
    end
  end
end

local PROBE = [[<script>window.onerror = e => { document.title = "error " + e; };
window.addEventListener("load", () => {
  const flat = [...document.querySelectorAll("math")].filter(m => m.getBoundingClientRect().width < 2);
  document.title = "flat " + flat.length;
  const s = document.getElementById("search");
  if (!s) return;
  s.value = "gauss lobatto";
  s.dispatchEvent(new Event("input"));
  document.title += " " + document.getElementById("found").textContent;
});</script>]]

-- the page's title after the probe
local function opened(name)
  local copy = name:gsub("%.html$", "") .. "_probe.html"
  local file <close> = assert(io.open(copy, "wb"))
  file:write(read(name), PROBE)
  file:close()
  local dom = browser.dom(copy:find "^/" and copy or os.getenv "PWD" .. "/" .. copy, "--virtual-time-budget=3000")
  os.remove(copy)
  return dom:match "<title>(.-)</title>" or "nothing"
end

local pages, formulas = lines_of("find '" .. out .. "' -name '*.html'"), {}
for _, name in ipairs(pages) do
  local text = read(name)
  check_links(name, text)
  if text:find "<math" then formulas[#formulas + 1] = name end
end
if #pages < 20 then complain("%d pages", #pages) end
if #formulas < 3 then complain("%d pages with formulas", #formulas) end
if browser.there() then
  for _, name in ipairs(formulas) do
    local title = opened(name)
    if title ~= "flat 0" then complain("%s: %s", name, title) end
  end
  local found = opened(out .. "/reference.html")
  if not found:find "^flat 0 [1-9]%d* entries$" then complain("search of the reference: %s", found) end
end
print(("site: %d pages, %d with formulas, %d complaints"):format(#pages, #formulas, wrong))
os.exit(wrong == 0)
