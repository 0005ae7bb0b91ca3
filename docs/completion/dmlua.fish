# fish completion of dmlua, made from the rows of dmlua --help
complete -c dmlua -s e -d 'execute string stat' -x
complete -c dmlua -s i -d 'enter interactive mode after executing script'
complete -c dmlua -s l -d 'require library mod into global mod' -x
complete -c dmlua -s v -d 'show version information'
complete -c dmlua -s E -d 'ignore environment variables'
complete -c dmlua -s W -d 'turn warnings on'
complete -c dmlua -s q -d 'quiet: no banner in interactive mode'
complete -c dmlua -s n -d 'no start-up file'
complete -c dmlua -l color -d 'colour the output: auto, always or never' -x -a 'auto always never'
complete -c dmlua -l demo -d 'run a guided demonstration; without a name: list them' -x -a 'lagrangian noether symplectic order chart curve constraint rolling stiff scales sem chaos ensemble chain drift routh frame elastica stability wrong scene top polhode holonomy forms holes sweep waves fields'
complete -c dmlua -l part -d 'run part k of n of every sweep that has a journal' -x
complete -c dmlua -l join -d 'write the journals that follow as one file' -r
complete -c dmlua -l where -d 'print the folder of meta, lua, python or examples' -x
complete -c dmlua -l jupyter -d 'install the kernel of Jupyter notebooks' -x
complete -c dmlua -l machine -d 'answer a program: frames of JSON on two descriptors' -x
complete -c dmlua -l help -d 'show this help and exit'
complete -c dmlua -l version -d 'show the version and exit'
