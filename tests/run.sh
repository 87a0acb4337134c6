#!/usr/bin/env bash
# Installs what is missing, builds, and runs the quick tests. Options go to ctest, e.g. -R Json.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_MORE_PACKAGES="python3" bash "$here/../workflows/setup.sh"
cd "$here/.."
exec ctest --preset quick --output-on-failure --parallel "$(nproc)" "$@"
