#!/usr/bin/env bash
# Installs what is missing (Debian packages), configures and builds the preset "release", or the one that
# SIGMAFLOW_PRESET names. Called by the other scripts here and in tests/; nothing else is downloaded.
# An argument names the one target to build; SIGMAFLOW_MORE_PACKAGES names packages beside those of the build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ cmake make libvtk9-dev libeigen3-dev libsuitesparse-dev libopenblas-serial-dev
          libhdf5-dev libxxhash-dev nlohmann-json3-dev libcli11-dev libgtest-dev libegl-dev libpng-dev
          libfreetype-dev fonts-dejavu-core fonts-dejavu-extra ${SIGMAFLOW_MORE_PACKAGES:-})

is_installed() {
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

install_packages() {
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "setup: packages are missing and neither root nor sudo is available. As root, run" >&2
            echo "    apt-get install --no-install-recommends $*" >&2
            exit 1
        fi
        as_root=(sudo)
    fi
    echo "setup: installing $*"
    "${as_root[@]}" apt-get update
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y --no-install-recommends "$@"
}

if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
    missing=()
    for package in "${packages[@]}"; do
        is_installed "$package" || missing+=("$package")
    done
    if [ "${#missing[@]}" -gt 0 ]; then
        install_packages "${missing[@]}"
    fi
else
    echo "setup: this is not a Debian system, so no package is installed. Debian 12 needs:" >&2
    echo "    ${packages[*]}" >&2
    echo "Trying to build with what is there." >&2
fi

command -v cmake >/dev/null || { echo "setup: cmake is missing" >&2; exit 1; }
preset="${SIGMAFLOW_PRESET:-release}"
cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$1"}
