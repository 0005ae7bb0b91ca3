# bash completion of dmlua, made from the rows of dmlua --help
_dmlua() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} first=
    [[ $COMP_CWORD -gt 1 ]] && first=${COMP_WORDS[COMP_CWORD-2]}
    compopt +o nospace 2>/dev/null
    if [[ $before == --demo || $first$before == --demo= ]]; then
        COMPREPLY=($(compgen -W "lagrangian noether symplectic order chart curve constraint rolling stiff scales sem chaos ensemble chain drift routh frame elastica stability wrong scene top polhode holonomy forms holes sweep waves fields" -- "${word#=}"))
    elif [[ $before == --color || $before == = ]]; then
        COMPREPLY=($(compgen -W "auto always never" -- "${word#=}"))
    elif [[ $before == -e || $before == -l ]]; then
        COMPREPLY=()
    elif [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "-e -i -l -v -E -W -q -n --color= --demo= --part= --join= --where= --jupyter= --machine= --help --version" -- "$word"))
        [[ ${COMPREPLY[0]-} == *= ]] && compopt -o nospace 2>/dev/null
    else
        compopt -o filenames 2>/dev/null
        COMPREPLY=($(compgen -f -X '!*.lua' -- "$word") $(compgen -d -- "$word"))
    fi
}
complete -F _dmlua dmlua
