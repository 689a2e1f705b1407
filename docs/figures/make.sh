#!/usr/bin/env bash
# Makes the figures of README.md, docs/tutorial.md, docs/seeds.md, docs/viscoelastic_contact.md,
# docs/viscoelastic_sphere.md, docs/precision.md and docs/disc_and_pads.md anew; takes some minutes.
# The animated one of README.md is made by animate.py.
# Usage: docs/figures/make.sh [STRIDOR], by default build/release/stridor of this source tree.
set -euo pipefail
here=$(CDPATH='' cd -P -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
source_folder=$here/../..
stridor=${1:-$source_folder/build/release/stridor}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$stridor" run "$source_folder/scenes/beam_on_beam.yaml" -o "$work/beam_on_beam.h5" >/dev/null
"$stridor" spectrogram "$work/beam_on_beam.h5" -o "$here/beam_on_beam_spectrogram.png" --force
"$stridor" plot "$work/beam_on_beam.h5" --kind history -o "$here/beam_on_beam_history.png" --force

"$stridor" run "$source_folder/scenes/examples/ruler.yaml" -o "$work/ruler.h5" >/dev/null
"$stridor" plot "$work/ruler.h5" --kind history -o "$here/ruler_history.png" --force
"$stridor" spectrogram "$work/ruler.h5" -o "$here/ruler_spectrogram.png" --force
"$stridor" plot "$work/ruler.h5" --kind spectrum --channel ruler.free_end.y.acceleration \
  -o "$here/ruler_spectrum.png" --force
"$stridor" compare "$source_folder/scenes/beam_on_beam.yaml" -o "$work/compare" >/dev/null
cp "$work/compare/accelerations.png" "$here/compare_accelerations.png"

fast=(--set time.integrator=exact --set time.step=2.5e-6 --set time.retain.frequency=50kHz)
rough=(--set contact.roughness.rms=1nm --set contact.roughness.correlation_length=10um --set contact.roughness.seed=1)
leading=$source_folder/scenes/beam_on_beam_leading.yaml
"$stridor" run "$leading" -o "$work/polyline.h5" "${fast[@]}" >/dev/null
"$stridor" run "$leading" -o "$work/smooth.h5" "${fast[@]}" --set contact.surface=smooth >/dev/null
"$stridor" run "$leading" -o "$work/rough.h5" "${fast[@]}" --set contact.surface=smooth "${rough[@]}" >/dev/null
for surface in polyline smooth rough; do
  "$stridor" spectrogram "$work/$surface.h5" -o "$here/seeds_$surface.png" --force
done

"$stridor" sweep "$source_folder/scenes/beam_on_beam.yaml" --parameter contact.friction.coefficient \
  --from 0.1 --to 0.35 --points 21 --set time.integrator=exact --set time.step=5e-6 \
  --set time.retain.frequency=30kHz --figure "$here/sweep.png" --force >/dev/null

contact_scene=$source_folder/scenes/viscoelastic_contact.yaml
"$stridor" contact "$contact_scene" --speed 0.1 --indentation 0.01 --pressure "$here/contact_pressure.png" \
  --force >/dev/null
"$stridor" contact "$contact_scene" --speed 0,0.01,0.03,0.1,0.3,1,10 --indentation 0.01 \
  --edges "$here/contact_edges.png" --force >/dev/null
"$stridor" fit --figures "$work/fit" >/dev/null
for name in modulus cuts scatter; do cp "$work/fit/$name.png" "$here/fit_$name.png"; done

sphere=$source_folder/scenes/viscoelastic_sphere.yaml
for law in published_fit boundary_element; do
  "$stridor" map "$sphere" --x parameters.v 1e-6 1e2 161 --y parameters.tau0 1e-4 1 121 --scale log \
    --set contact.normal.form=$law --figure "$here/sphere_map_$law.png" --force >/dev/null
  "$stridor" cycle "$sphere" --set contact.normal.form=$law --figure "$here/sphere_cycle_$law.png" --force >/dev/null
done

"$stridor" precision "$source_folder/scenes/beam_on_beam_leading.yaml" --until "8 ms" \
  --set "measure.from=4 ms" --points 3 --retain 50kHz --assumptions subs_a --tune 0.2 --norm force \
  -o "$work/precision" >/dev/null
cp "$work/precision/precision.png" "$here/precision.png"

"$here/regularisation.sh" "$stridor" "$here/regularisation.png" >/dev/null
root_locus() {  # FIGURE SCENE FROM TO [OPTION...]
  local figure=$1 scene=$2 from=$3 to=$4
  shift 4
  "$stridor" locus "$source_folder/scenes/examples/$scene.yaml" --parameter parameters.load \
    --from "$from" --to "$to" --points 401 --history "$here/root_locus_$figure.png" --force "$@" >/dev/null
}
root_locus gyroscopic gyroscopic 0 1
root_locus flutter flutter 0 0.4
root_locus equal_damping flutter_equal_damping 0 0.4
root_locus uneven_damping flutter_ziegler 0 0.4 --set "substructures.oscillator.damping=[[0.1, 0], [0, 0.3]]"
root_locus ziegler flutter_ziegler 0 0.4
root_locus gyroscopic_flutter flutter_gyroscopic 0 0.4
"$stridor" locus "$source_folder/scenes/examples/elastic_pads.yaml" --parameter parameters.mu \
  --from 0 --to 0.6 --points 121 --below 3.6kHz --history "$here/root_locus_elastic_pads.png" --force >/dev/null
