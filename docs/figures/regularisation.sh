#!/usr/bin/env bash
# What regularised friction does to threshold and cycle of scenes/viscoelastic_sphere.yaml, against
# set-valued friction: a table on stdout and a figure, for docs/viscoelastic_sphere.md.
# Usage: docs/figures/regularisation.sh STRIDOR FIGURE.png
set -euo pipefail
here=$(CDPATH='' cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
stridor=$1
figure=$2
scene=$here/../../scenes/viscoelastic_sphere.yaml
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
laws=(atan square_root tanh linear)

# Upper threshold in shear strength at v = 4e-4; period and r.m.s. of the cycle at v = 5e-3.
measure() {
  "$stridor" threshold "$scene" --set parameters.v=4e-4 --parameter parameters.tau0 --from 1e-3 --to 0.05 \
    --json "$@" >"$work/threshold.json"
  "$stridor" cycle "$scene" --json "$@" >"$work/cycle.json"
  python3 -c '
import json, sys
root = json.load(open(sys.argv[1]))["roots"][-1]["value"]
cycle = json.load(open(sys.argv[2]))
assert cycle["status"] == "periodic", cycle["status"]
print(root, 40*cycle["period"], cycle["x"]["rms"]/2e-3)  # in units of the paper' "$work/threshold.json" "$work/cycle.json"
}

read -r threshold period rms < <(measure)
echo "| law | v_ε/v_d | threshold | period | x r.m.s. |"
echo "|---|---|---|---|---|"
printf '| set-valued | | %.6e | %.6f | %.7f |\n' "$threshold" "$period" "$rms"
for law in "${laws[@]}"; do
  for speed in 0.3 0.1 0.03 0.01 0.003 0.001; do
    read -r t p r < <(measure --set "contact.friction.regularisation={law: $law, speed: =$speed*v*R/tau}")
    awk -v law="$law" -v e="$speed" -v t="$t" -v p="$p" -v r="$r" -v t0="$threshold" -v p0="$period" \
      -v r0="$rms" -v file="$work/$law" 'BEGIN {
        printf "| %s | %s | %.6e (%+.2g %%) | %.6f (%+.2g %%) | %.7f (%+.2g %%) |\n",
               law, e, t, 100*(t/t0-1), p, 100*(p/p0-1), r, 100*(r/r0-1)
        print e, 100*(t/t0-1), 100*(1-p/p0), 100*(1-r/r0) >> file }'
  done
done

cat >"$work/plot.gp" <<END
set terminal pngcairo size 1500,520 font 'DejaVu Sans,11'
set output '$figure'
set multiplot layout 1,3
set logscale xy
set format xy '10^{%T}'
set xlabel 'v_ε/v_d'
set xrange [7e-4:0.5]
set yrange [1e-4:1000]
set key bottom right
set ylabel 'threshold too high by (%)'
plot for [law in '${laws[*]}'] '$work/'.law using 1:(\$2 > 1e-4 ? \$2 : NaN) with linespoints lw 2 title law noenhanced
set ylabel 'period too short by (%)'
plot for [law in '${laws[*]}'] '$work/'.law using 1:3 with linespoints lw 2 title law noenhanced
set ylabel 'x r.m.s. too small by (%)'
plot for [law in '${laws[*]}'] '$work/'.law using 1:4 with linespoints lw 2 title law noenhanced
unset multiplot
END
gnuplot "$work/plot.gp"
