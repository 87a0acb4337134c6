#!/usr/bin/env bash
# Installs what is missing, builds, runs the fuzzers, a minute each, and then the quick tests.
# Options go to ctest, e.g. -R Json, and leave the fuzzers out.
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
SIGMAFLOW_MORE_PACKAGES="python3 clang libclang-rt-dev libomp-dev" bash "$here/../workflows/setup.sh"
cd "$here/.."

can_fuzz() {
    clang++ -x c++ -fsyntax-only -include omp.h /dev/null 2>/dev/null &&
        echo 'extern "C" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }' |
        clang++ -x c++ -fsanitize=fuzzer,address,undefined -o /dev/null - 2>/dev/null
}

if [ $# -gt 0 ]; then
    echo "run.sh: only the chosen tests are run, no fuzzers"
elif can_fuzz; then
    cmake --preset fuzz
    cmake --build --preset fuzz --parallel "$(nproc)"
    ctest --preset fuzz --parallel "$(nproc)"
else
    echo "run.sh: FUZZING IS LEFT OUT: it needs clang with libFuzzer, its sanitizers and OpenMP" >&2
    echo "    (Debian: clang libclang-rt-dev libomp-dev)" >&2
fi
exec ctest --preset quick --output-on-failure --parallel "$(nproc)" "$@"
