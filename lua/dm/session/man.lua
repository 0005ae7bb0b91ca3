--- The man page and the completions of bash, zsh and fish, made from the rows that --help prints
-- (src/cli/manual.def); `make docs` writes them.
local M = {}

local function manual() return require "dm.manual" end

---- man page ----

local function roff(text)
  text = text:gsub("\\", "\\e"):gsub("%-", "\\-"):gsub("^([.'])", "\\&%1")
  return text
end

local function sentence(text)
  text = text:sub(1, 1):upper() .. text:sub(2)
  return text:find "%.$" and text or text .. "."
end

-- a tagged paragraph per row
local function paragraphs(out, rows)
  for _, row in ipairs(rows) do
    local gap = row.argument == "" and "" or row.name:find "^%-%-" and "=" or " "
    local argument = row.argument ~= "" and "\\fI" .. roff(row.argument) .. "\\fR" or ""
    out[#out + 1] = ".TP"
    out[#out + 1] = "\\fB" .. roff(row.name) .. "\\fR" .. gap .. argument
    out[#out + 1] = roff(sentence(row.what) .. (row.more ~= "" and " " .. row.more or ""))
  end
end

local function section(out, title, text, rows)
  out[#out + 1] = ".SH " .. title
  if text then out[#out + 1] = text end
  if rows then paragraphs(out, rows) end
end

--- The man page dmlua(1).
function M.page()
  local m = manual()
  local out = { ('.TH DMLUA 1 "" "dmlua %s" "User Commands"'):format(m.version) }
  section(out, "NAME", "dmlua \\- interpreter for discrete mechanics: Lua 5.4 with step kernels "
    .. "in C")
  section(out, "SYNOPSIS", ".B dmlua\n[\\fIoptions\\fR] [\\fIscript\\fR [\\fIargs\\fR]]")
  section(out, "DESCRIPTION", [[
.B dmlua
executes Lua scripts as lua(1) does, with the same options, and has the library
.B dm
loaded: mechanical systems given by Lagrangians that are written in Lua and stepped by variational
integrators in C. Without a script, and on a terminal, it reads and evaluates what is typed.]])
  section(out, "OPTIONS", "Options are handled in their order, before the script.", m.options)
  section(out, "SESSION", "In an interactive session an expression is evaluated and printed.",
    m.keys)
  section(out, "ENVIRONMENT", nil, m.variables)
  section(out, "FILES", nil, m.files)
  section(out, "EXIT STATUS", nil, m.statuses)
  section(out, "SEE ALSO", ".BR lua (1)\n.br\nIn a session: ? and help(dm).")
  return table.concat(out, "\n") .. "\n"
end

---- completions of shells ----

-- every way of writing the options, without - and --
local function spellings()
  local list, seen = {}, {}
  for _, row in ipairs(manual().options) do
    local dashes = row.name == "-" or row.name == "--"
    if not dashes and not seen[row.name] then
      seen[row.name] = true
      list[#list + 1] = row
    end
  end
  return list
end

function M.bash()
  local words = {}
  for _, row in ipairs(spellings()) do
    words[#words + 1] = row.name:find "^%-%-" and row.argument ~= "" and row.name .. "=" or row.name
  end
  local text = ([==[
# bash completion of dmlua, made from the rows of dmlua --help
_dmlua() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} first=
    [[ $COMP_CWORD -gt 1 ]] && first=${COMP_WORDS[COMP_CWORD-2]}
    compopt +o nospace 2>/dev/null
    if [[ $before == --demo || $first$before == --demo= ]]; then
        COMPREPLY=($(compgen -W "@DEMOS@" -- "${word#=}"))
    elif [[ $before == --color || $before == = ]]; then
        COMPREPLY=($(compgen -W "auto always never" -- "${word#=}"))
    elif [[ $before == -e || $before == -l ]]; then
        COMPREPLY=()
    elif [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "%s" -- "$word"))
        [[ ${COMPREPLY[0]-} == *= ]] && compopt -o nospace 2>/dev/null
    else
        compopt -o filenames 2>/dev/null
        COMPREPLY=($(compgen -f -X '!*.lua' -- "$word") $(compgen -d -- "$word"))
    fi
}
complete -F _dmlua dmlua
]==]):format(table.concat(words, " "))
  return (text:gsub("@DEMOS@", table.concat(require "dm.demos", " ")))
end

function M.zsh()
  local lines = {}
  for _, row in ipairs(spellings()) do
    local what = row.what:gsub("[%[%]']", ""):gsub(":", "\\:")
    local name, tail = row.name, ""
    if name == "--color" then
      name, tail = "--color=", ":when:(auto always never)"
    elseif name == "--demo" then
      name, tail = "--demo=", ":name:(" .. table.concat(require "dm.demos", " ") .. ")"
    elseif row.argument ~= "" then
      name, tail = "*" .. name .. "+", ":" .. row.argument .. ":"
    end
    lines[#lines + 1] = ("    '%s[%s]%s' \\"):format(name, what, tail)
  end
  return ([[
#compdef dmlua
# zsh completion of dmlua, made from the rows of dmlua --help
_arguments -S \
%s
    '1:script:_files -g "*.lua(-.)"' \
    '*:argument:_files'
]]):format(table.concat(lines, "\n"))
end

function M.fish()
  local lines = { "# fish completion of dmlua, made from the rows of dmlua --help" }
  local values = { ["--color"] = "auto always never",
    ["--demo"] = table.concat(require "dm.demos", " ") }
  for _, row in ipairs(spellings()) do
    local long = row.name:find "^%-%-"
    local line = ("complete -c dmlua %s %s -d '%s'"):format(long and "-l" or "-s",
      row.name:gsub("^%-+", ""), (row.what:gsub("'", "")))
    if values[row.name] then
      line = line .. (" -x -a '%s'"):format(values[row.name])
    elseif row.argument ~= "" then
      line = line .. (row.name == "--join" and " -r" or " -x")
    end
    lines[#lines + 1] = line
  end
  return table.concat(lines, "\n") .. "\n"
end

--- Write the four files under `folder`.
function M.write(folder)
  for name, text in pairs { ["dmlua.1"] = M.page(), ["completion/dmlua.bash"] = M.bash(),
    ["completion/_dmlua"] = M.zsh(), ["completion/dmlua.fish"] = M.fish() } do
    local file = assert(io.open(folder .. "/" .. name, "w"))
    file:write(text)
    file:close()
  end
end

return M
