#!/usr/bin/env bash
# Installs what is missing, builds, and makes the Debian package build/release/sigmaflow.deb.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_MORE_PACKAGES="dpkg-dev file" bash "$here/setup.sh" manual
cd "$here/../build/release"
exec cpack
