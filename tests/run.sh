#!/usr/bin/env bash
# Installs what is missing, builds, fuzzes the readers for two minutes and runs the quick tests.
# Options go to ctest, e.g. -R Json; with options there is no fuzzing.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_MORE_PACKAGES="python3 python3-h5py python3-jsonschema clang libclang-rt-dev libomp-dev" bash "$here/../workflows/setup.sh"
cd "$here/.."
if [ "$#" -eq 0 ]; then
    cmake --preset fuzz
    cmake --build --preset fuzz --parallel "$(nproc)"
    ctest --preset fuzz --parallel "$(nproc)"
fi
exec ctest --preset quick --output-on-failure --parallel "$(nproc)" "$@"
