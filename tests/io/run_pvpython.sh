#!/bin/sh
# Runs a script with ParaView's Python: the command in SIGMAFLOW_PVPYTHON (it may have several words,
# e.g. "xvfb-run -a pvpython"), or pvpython. Exit code 77 if there is none.
command=${SIGMAFLOW_PVPYTHON:-pvpython}
if ! command -v "${command%% *}" > /dev/null; then
    echo "skipped: no ${command%% *}; set SIGMAFLOW_PVPYTHON"
    exit 77
fi
exec $command "$@"
