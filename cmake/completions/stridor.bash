# Completion of stridor in bash: verbs, options, keys of scenes, channels of run files.
_stridor() {
  local IFS=$'\n' word=${COMP_WORDS[COMP_CWORD]}
  # bash takes "key=value" apart: the value is completed as a file.
  if [[ $word == = || ${COMP_WORDS[COMP_CWORD-1]:-} == = ]]; then return; fi
  local -a found
  mapfile -t found < <("${COMP_WORDS[0]}" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null | cut -f1)
  COMPREPLY=("${found[@]}")
  if ((${#COMPREPLY[@]} == 1)) && [[ ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi
}
complete -o default -o bashdefault -F _stridor stridor
