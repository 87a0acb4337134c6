#!/usr/bin/env bash
# Installs what is missing, builds, and runs workflows/quickstart.json into out/quickstart.
# Options go to `sigmaflow run`, e.g. --out DIR.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
bash "$here/setup.sh" sigmaflow
cd "$here/.."
exec build/release/sigmaflow run workflows/quickstart.json "$@"
