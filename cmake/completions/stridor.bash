# Completion of stridor in bash: verbs, options, keys of scenes, channels of run files; else files of the kind wanted.
_stridor() {
  local IFS=$'\n' i word glued=0
  local -a words=() behind=() found
  # bash takes "key=value" and "a:b" apart: together again, up to the cursor and behind it.
  for ((i = 1; i < ${#COMP_WORDS[@]}; ++i)); do
    word=${COMP_WORDS[i]}
    if ((i > COMP_CWORD)); then behind+=("${word/#\~\//$HOME/}"); continue; fi
    if [[ $word == [=:] && ${#words[@]} -gt 0 ]]; then words[-1]+=$word; glued=1
    elif ((glued)); then words[-1]+=$word; glued=0
    else words+=("${word/#\~\//$HOME/}"); fi
  done
  local current=${words[-1]:-} before='' typed=${COMP_WORDS[COMP_CWORD]}
  if ((${#words[@]} > 1)); then before=${words[-2]}; fi
  if [[ $typed == [=:] ]]; then typed=; fi
  mapfile -t found < <("${COMP_WORDS[0]}" complete "${behind[@]}" -- "${words[@]}" 2>/dev/null | cut -f1)
  local taken=$((${#current} - ${#typed}))
  if [[ $current != "${COMP_WORDS[COMP_CWORD]}" && $current == *[=:]* ]]; then for i in "${!found[@]}"; do found[i]=${found[i]:taken}; done; fi
  COMPREPLY=("${found[@]}")
  if ((${#COMPREPLY[@]} == 1)) && [[ ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi
  if ((${#COMPREPLY[@]} > 0 || ${#words[@]} < 2)); then return; fi
  case ${current%%=*} in --set | --parameter | --x | --y | --channel | --input | --about | --kind) before=${current%%=*} ;; esac
  local ending=
  if [[ ${words[0]} == frf && ${current%%=*} == --output ]]; then before=--output; fi
  if [[ ${words[0]} == frf && $before == --output ]]; then before=--input; fi # a motion, else a file
  case $before in
    --set | --parameter | --x | --y | --channel | --input | --about | --kind)
      compopt +o default +o bashdefault 2>/dev/null # no file can stand there
      return ;;
    -*) return ;;
  esac
  case ${words[0]} in
    run | check | eig | locus | map | threshold | sweep | cycle | frf | draw | precision) ending='.@(yaml|yml)' ;;
    spectrogram | sound | plot | report) ending='.@(h5|hdf5)' ;;
    *) return ;;
  esac
  shopt -q extglob && local had_extglob=1 || { local had_extglob=0; shopt -s extglob; }
  mapfile -t COMPREPLY < <(compgen -f -X "!*$ending" -- "${COMP_WORDS[COMP_CWORD]}"; compgen -d -- "${COMP_WORDS[COMP_CWORD]}")
  ((had_extglob)) || shopt -u extglob
  compopt -o filenames 2>/dev/null
}
complete -o default -o bashdefault -F _stridor stridor
