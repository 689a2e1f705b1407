# Completion of stridor in fish: verbs, options, keys of scenes with their units, channels of run files; else files.
function __stridor_candidates
  set -l before (commandline -opc)
  set -l typed (commandline -ct)
  # What stands behind the word tells the scene where that is written last and fish gives it.
  set -l all (commandline -op)
  set -l first (math (count $before) + 1)
  if test -n "$typed"
    set first (math $first + 1)
  end
  set -l behind
  if test $first -le (count $all)
    set behind $all[$first..-1]
  end
  set -l program $before[1]
  set -e before[1]
  command $program complete $behind -- $before "$typed" 2>/dev/null
end
complete -c stridor -n 'count (__stridor_candidates) >/dev/null' -f -a '(__stridor_candidates)'
function __stridor_takes_no_file
  set -l before (commandline -opc)
  string match -qr -- '^--(set|parameter|x|y|channel|input|about|kind)$' "$before[-1]"
  or test "$before[2]" = frf -a "$before[-1]" = --output
end
complete -c stridor -n __stridor_takes_no_file -f
