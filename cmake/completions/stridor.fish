# Completion of stridor in fish: verbs, options, keys of scenes with their units, channels of run files.
complete -c stridor -a '(stridor complete -- (commandline -opc)[2..-1] (commandline -ct) 2>/dev/null)'
