#!/usr/bin/env bash
# Runs the extreme scenes and says whether each ends as its head says.
#
#   table.sh PROGRAM            all of them, as the page docs/stability.md on stdout
#   table.sh PROGRAM SCENE      one of them
#
# In the head of a scene, `Outcome` is `done` (then the `expect:` block must hold), or `refused` (exit
# 2) or `fails` (exit 3) with words that the message must hold; `Copes` names settings with which the
# same scene runs to its end. Exits 1 where anything ends otherwise.
set -uo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
program=${1:?program}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

# head SCENE NAME: a line of the head of a scene.
head_of() { sed -n "s/^# $2: //p" "$1"; }

# number NAME: a number of the JSON object of the last run, shortened; the first one of that name.
number() {
  local value
  value=$(sed -n "s/^ *\"$1\": \(-\?[0-9][^,]*\),\?$/\1/p" "$work/out" | sed -n 1p)
  if [[ -n $value ]]; then LC_ALL=C printf '%.5g' "$value"; else printf -- '-'; fi
}

# run_once SCENE [OPTION...]: its exit code.
run_once() {
  local scene=$1
  shift
  "$program" run "$scene" -o "$work/run.h5" --force --json "$@" >"$work/out" 2>"$work/err"
}

wrong=0
objection() {
  wrong=1
  printf '%s: %s\n' "$1" "$2" >&2
  cat -- "$work/err" >&2
}

# check SCENE: runs it and prints its row of the table.
check() {
  local scene=$1 name outcome words code wanted numbers copes='-' settings options=() setting
  name=$(basename -- "$scene" .yaml)
  outcome=$(head_of "$scene" Outcome)
  settings=$(head_of "$scene" Copes)
  words=${outcome#*: }
  case $outcome in
    done) wanted=0 words= ;;
    refused:*) wanted=2 ;;
    fails:*) wanted=3 ;;
    *) objection "$name" "its head names no outcome"; return ;;
  esac
  run_once "$scene" --verify
  code=$?
  if ((code != wanted)); then objection "$name" "exit $code, expected $wanted"; fi
  if [[ -n $words ]] && ! grep -qF -- "$words" "$work/err"; then
    objection "$name" "its message lacks '$words'"
  fi
  numbers="$(number min) … $(number max) | $(number energy_error) | $(number wall_s)"
  if [[ -n $settings ]]; then
    for setting in $settings; do options+=(--set "$setting"); done
    run_once "$scene" "${options[@]}" || objection "$name" "does not cope with $settings"
    copes="\`$settings\`: $(number min) … $(number max) N"
  fi
  printf '| `%s` | %s | %s | %s | %s |\n' "$name" "$(head_of "$scene" Stresses)" "$outcome" "$numbers" "$copes"
}

if (($# > 1)); then
  check "$2"
  exit "$wrong"
fi

cat <<'TEXT'
# Extreme cases

Made by `scenes/extreme/table.sh build/release/stridor > docs/stability.md`; do not edit. The scenes
stand in [`scenes/extreme/`](../scenes/extreme). Each differs from `plain` by what it stresses, and is
held to its outcome and its `expect:` block by a test of its name (`ctest -R Extreme`).

*Outcome*: `done`, or how the program refuses (before the run, exit 2) or stops (exit 3) and the words
in its message. *Force*: smallest and largest contact force of the window of `measure`; most of these
scenes start in sliding equilibrium under the load of 0.2 N, at which it should stay. *Energy*: largest
error of the energy balance over the energy turned over. *Copes*: a setting with which the same scene
runs to its end.

| scene | stresses | outcome | force, N | energy | time, s | copes |
|---|---|---|---|---|---|---|
TEXT
for scene in "$here"/*.yaml; do check "$scene"; done
cat <<'TEXT'

`ten_million_steps` was run for a billion steps once (`--set time.end=2000 --set record.interval=0.1 --set
measure.from=1000`, 315 s beside other work): over its second half the force stays between 0.19999999962 and
0.19999999963 N, 4e-12 N apart.
TEXT
exit "$wrong"
