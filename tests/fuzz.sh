#!/usr/bin/env bash
# Installs what is missing, builds the readers with clang and sanitizers, and fuzzes each for a minute.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_PRESET=fuzz SIGMAFLOW_MORE_PACKAGES="clang libclang-rt-dev libomp-dev" \
    bash "$here/../workflows/setup.sh" fuzzers
cd "$here/.."
exec ctest --preset fuzz --parallel "$(nproc)" "$@"
