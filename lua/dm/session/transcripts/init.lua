--- Examples of functions, methods and classes: what is typed at a prompt and what is answered, by
-- the names under which help knows them. tests/lua/session/test_transcripts.lua types all of them
-- again.
local M = {}

local wings = {
  "discrete",
  "elementary",
  "equations",
  "flows",
  "forms",
  "functions",
  "geometry",
  "groups",
  "lines",
  "mesh",
  "modules",
  "path",
  "results",
  "routh",
  "runs",
  "sizes",
  "solver",
  "space",
  "system",
  "topology",
  "traced",
  "values",
  "waves",
  "workings",
}

for _, wing in ipairs(wings) do
  for name, text in pairs(require("dm.session.transcripts." .. wing)) do M[name] = text end
end

return M
