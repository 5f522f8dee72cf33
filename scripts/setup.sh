#!/usr/bin/env bash
# Installs what umbrae needs besides Rust, and says nothing when all of it is there.
#
#   scripts/setup.sh            install what is missing (Debian and its relatives)
#   scripts/setup.sh --check    only say what is missing; exit 1 if anything is
set -euo pipefail

say() { printf '%s\n' "$*" >&2; }

has() { command -v "$1" >/dev/null; }

# Files that tell the Vulkan loader about a driver, in the places where it looks for them.
driver_manifests() {
    local chosen=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}
    if [[ -n $chosen ]]; then
        tr ':' '\n' <<<"$chosen"
    else
        printf '%s\n' {/usr/share,/usr/local/share,/etc,"${XDG_DATA_HOME:-${HOME:-}/.local/share}"}/vulkan/icd.d/*.json
    fi
}

has_graphics_card() { [[ -e /dev/nvidiactl ]] || compgen -G '/dev/dri/renderD*' >/dev/null; }

# A driver in software (lavapipe, "lvp") draws anywhere; every other one needs its graphics card.
has_vulkan_driver() {
    local present
    present=$(driver_manifests | while read -r manifest; do [[ ! -e $manifest ]] || echo "$manifest"; done)
    [[ $present == *lvp* ]] || { [[ -n $present ]] && has_graphics_card; }
}

has_vulkan_loader() { PATH=$PATH:/sbin:/usr/sbin ldconfig -p 2>/dev/null | grep 'libvulkan\.so\.1' >/dev/null; }

# Where the files lie elsewhere than on Debian, Vulkan's own tool knows better.
vulkan_answers() { has vulkaninfo && vulkaninfo >/dev/null 2>&1; }

action=${1:-install}
if [[ $action != install && $action != --check ]]; then
    say "error: unknown argument '$action': the only one is --check"
    exit 2
fi

if ! has cargo; then
    say 'missing: Rust 1.95 or newer; https://rustup.rs tells how to install it'
    exit 1
fi

packages='' # as Debian names them
need() {
    say "missing: $1"
    packages="$packages $2"
}
has cc || need 'a C compiler, with which Rust links' 'gcc libc6-dev'
has make || need 'make' make
# Elsewhere the system brings its own graphics: Metal on macOS, Direct3D 12 on Windows.
if [[ $(uname -s) == Linux ]]; then
    has_vulkan_loader || vulkan_answers || need 'the Vulkan loader' libvulkan1
    has_vulkan_driver || vulkan_answers || need 'a Vulkan driver' mesa-vulkan-drivers
fi

[[ -n $packages ]] || exit 0
[[ $action == install ]] || exit 1

if ! has apt-get; then
    say 'error: there is no apt-get here to install this with; use your own package manager:'
    say '  Fedora: gcc make vulkan-loader mesa-vulkan-drivers'
    say '  Arch: gcc make vulkan-icd-loader vulkan-swrast'
    exit 1
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
    if ! has sudo; then
        say "error: only root can install packages; as root, run: apt-get install$packages"
        exit 1
    fi
    # Where nobody can type a password, fail rather than wait for one.
    if [[ -t 0 ]]; then as_root=(sudo); else as_root=(sudo -n); fi
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -qq "$@" >>"$log" 2>&1; }
# shellcheck disable=SC2086 # a list of names, meant to be split
install() { apt install --no-install-recommends $packages; }

say "installing:$packages"
# The lists of packages are fetched only where those at hand are missing or too old. A source that does not answer is no
# reason to stop: whether the packages can be installed then is what counts.
if ! install && ! { apt update || true; install; }; then
    say "error: could not install$packages; is there a network? apt-get ended with:"
    tail -n 5 "$log" >&2
    exit 1
fi
