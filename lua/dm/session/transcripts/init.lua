--- Examples of functions, methods and classes: what is typed at a prompt and what is answered, by
-- the names under which help knows them. tests/lua/session/test_transcripts.lua types all of them
-- again.
local M = {}

for _, name in ipairs { "functions", "values", "runs" } do
  for of, text in pairs(require("dm.session.transcripts." .. name)) do M[of] = text end
end

return M
