--- Examples of functions, methods and classes: what is typed at a prompt and what is answered, by
-- the names under which help knows them. tests/lua/session/test_transcripts.lua types all of them
-- again.
local M = {}

local wings = {
  "discrete",
  "elementary",
  "flows",
  "forms",
  "functions",
  "geometry",
  "groups",
  "modules",
  "results",
  "runs",
  "sizes",
  "traced",
  "values",
  "workings",
}

for _, wing in ipairs(wings) do
  for name, text in pairs(require("dm.session.transcripts." .. wing)) do M[name] = text end
end

return M
