#!/usr/bin/env bash
# What each crate promises not to know, on any platform, directly or through another crate (see ARCHITECTURE.md).
# Prints one sentence for each broken promise, and exits 1 if there is any.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

broken=0
fail() {
    printf 'broken promise: %s\n' "$*" >&2
    broken=1
}

# The lines after `crate NAME` say what NAME does not know, by the names of the crates that would tell it.
crate() {
    crate=$1
    below=$(cargo tree --quiet -e normal --target all -p "$crate" --prefix none --format '{p}' | cut -d' ' -f1)
}
knows_no() {
    local what=$1 name
    shift
    for name in "$@"; do
        if grep -qx -- "$name" <<<"$below"; then
            fail "$crate knows no $what, but depends on $name; see:" \
                "cargo tree -e normal --target all -p $crate -i $name"
        fi
    done
}

gpu='wgpu wgpu-core wgpu-hal naga ash glow'
models='gltf tobj ply-rs-bw stl_io'
files="$models image png flate2 serde_json toml csv"
dates='jiff chrono time'
clocks="$dates web-time"
windows='winit eframe egui rfd'

# shellcheck disable=SC2086 # the lists above are meant to be split into names
{
    crate umbrae-core
    knows_no 'GPU' $gpu
    knows_no 'file' $files
    knows_no 'clock' $clocks
    knows_no 'window' $windows
    knows_no 'other crate of ours' umbrae-formats umbrae-render umbrae-study umbrae

    crate umbrae-formats
    knows_no 'GPU' $gpu
    knows_no 'window' $windows
    knows_no 'other crate of ours than core' umbrae-render umbrae-study umbrae

    crate umbrae-render
    knows_no 'model format' $models
    knows_no 'window' $windows
    knows_no 'date' $dates
    knows_no 'other crate of ours than core' umbrae-formats umbrae-study umbrae

    crate umbrae-study
    knows_no 'GPU' $gpu
    knows_no 'file format' $models image png tiff
    knows_no 'window' $windows
    knows_no 'other crate of ours than core' umbrae-formats umbrae-render umbrae
}

# A crate exists to promise something. Only the app may know everything.
for manifest in crates/*/Cargo.toml; do
    name=$(sed -n 's/^name = "\(.*\)"/\1/p' "$manifest" | head -n 1)
    [[ $name == umbrae ]] || grep -qx " *crate $name" scripts/crate-promises.sh ||
        fail "$name promises nothing: say in scripts/crate-promises.sh what it does not know"
done

# The standard library is in no tree of crates, so its clocks and files are looked for by name, outside comments.
names_in() { grep -rnE --include='*.rs' "$@" | grep -vE '^[^:]+:[0-9]+: *//' || true; }
while IFS= read -r line; do
    fail "umbrae-core knows no clock and no file, but names those of std: $line"
done < <(names_in '\bstd::(\{.*)?\b(time|fs|net)\b' crates/core/src)
while IFS= read -r line; do
    fail "clocks come from web_time, which a browser has too, but here is the one of std: $line"
done < <(names_in '\btime::(\{[^}]*)?\b(Instant|SystemTime)\b' crates/*/src)

exit "$broken"
