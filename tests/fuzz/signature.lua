--- What the signature at the head of a doc says of arguments: "K:form(k, values | f, {dual=}) ->"
-- is read as a list of items, an item as { key = name or nil, { choice, ... } }, a choice as
-- { word = }, { text = } or { items = } (a table of options).
local M = {}

-- names, quoted texts and punctuation, one by one
local function tokens(text)
  local out, at = {}, 1
  while at <= #text do
    local word = text:match("^[%a_][%w_]*", at)
    local quoted = text:match('^"[^"]*"', at)
    out[#out + 1] = word or quoted or text:sub(at, at)
    at = at + #out[#out]
    at = text:find("%S", at) or #text + 1
  end
  return out
end

local read_items

-- one item, up to a comma or an end of its list
local function read_item(s)
  local item = {}
  while s[s.at] and not s[s.at]:find "^[,})]$" do
    local token = s[s.at]
    s.at = s.at + 1
    if token == "{" or token == "(" then
      item[#item + 1] = { items = read_items(s) }
    elseif token:find '^"' then
      item[#item + 1] = { text = token:sub(2, -2) }
    elseif token:find "^[%a_]" and s[s.at] == "=" then
      if item.key then item[#item + 1] = { word = token } else item.key = token end
      s.at = s.at + 1
    elseif token:find "^[%a_]" then
      item[#item + 1] = { word = token }
    end
  end
  if #item == 0 and item.key then item[1] = { word = item.key } end
  return item
end

read_items = function(s)
  local items = {}
  while s[s.at] do
    local item = read_item(s)
    if #item > 0 then items[#items + 1] = item end
    local token = s[s.at]
    s.at = s.at + 1
    if token ~= "," then break end
  end
  return items
end

--- The ways to call what the doc is of: lists of items, one a way.
function M.ways(doc)
  local ways = {}
  local line = doc and doc:match "^[^\n]*" or ""
  for way in (line .. "   or   "):gmatch "(.-)%s+or%s+" do
    local call = way:gsub("%->.*", ""):match "[%w_.:]+(%s*[({].*)$"
    if call then
      local s = tokens(call:gsub("^%s+", ""))
      s.at = 2
      local items = read_items(s)
      ways[#ways + 1] = call:find "^%s*{" and { { { items = items } } } or items
    end
  end
  return ways
end

return M
