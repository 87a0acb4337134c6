#!/usr/bin/env bash
# Installs what is missing, builds, and runs the quick tests. Options go to ctest, e.g. -R Json.
# The fuzzers need a build of their own: tests/fuzz.sh.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_MORE_PACKAGES="python3 python3-h5py python3-jsonschema" bash "$here/../workflows/setup.sh"
cd "$here/.."
exec ctest --preset quick --output-on-failure --parallel "$(nproc)" "$@"
