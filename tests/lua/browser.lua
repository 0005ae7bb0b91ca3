-- browser.lua - chromium, where it is: what a page has become when its script has run
local M = {}

--- is there one?
function M.there() return (os.execute "command -v chromium >/dev/null 2>&1") == true end

--- The DOM of file (or file#part) as text. Each try has a profile of its own: browsers that run beside each other take
-- no page from each other. One that a busy machine ends before it has a page is started again.
function M.dom(file, options)
  local dom
  for _ = 1, 3 do
    local pipe = io.popen(("profile=$(mktemp -d); timeout 300 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage"
      .. " --user-data-dir=$profile %s --dump-dom 'file://%s' 2>/dev/null; rm -rf $profile"):format(options or "", file))
    dom = pipe:read "a"
    pipe:close()
    if dom:find "<body" then break end
  end
  return dom
end

return M
