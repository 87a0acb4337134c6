#!/bin/bash
# A sweep run by snakemake: one point fails and stops no other, an interrupted run goes on, and all
# points end with the bytes of the same sweep without snakemake.
# Usage: sweep_on_snakemake.sh SIGMAFLOW   exit code 77: snakemake is not installed
# (apt-get install snakemake)
set -u
sigmaflow=$(realpath "$1")
command -v snakemake >/dev/null || { echo "snakemake is not installed"; exit 77; }
folder=$(mktemp -d /tmp/sigmaflow_snakemake_XXXXXX)
trap 'code=$?; [ $code = 0 ] && rm -rf "$folder" || echo "left for inspection: $folder"; exit $code' EXIT
fail() { echo "FAILED: $*"; exit 1; }

cd "$folder"
export XDG_CACHE_HOME=$folder/cache
cat >flow.json <<END
{"suspension": {"particles": 40, "volume_fraction": 0.5, "seed": 7},
 "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 20}, {"step": "plot"}]}
END
swept="--sweep /steps/1/stress=1,2,4,8"
"$sigmaflow" sweep flow.json $swept --out here -q || fail "the sweep without snakemake"
"$sigmaflow" sweep flow.json $swept --out there --engine snakemake --jobs 2 \
    --checkpoint-interval 0.1 | tee said || fail "writing the Snakefile"
command=$(tail -n 1 said)
[ "${command%% *}" = snakemake ] || fail "it is not said how to run it"

mkdir -p there/points/stress_8 && echo mine >there/points/stress_8/notes.txt  # this point fails
# its whole process group gets SIGINT, as from a terminal; a shell would start it with SIGINT ignored
python3 -c 'import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.setsid()
os.execvp(sys.argv[1], sys.argv[1:])' $command >first.log 2>&1 &
leader=$!
for ((k = 0; k < 600; ++k)); do
    running=$(ls there/points/*/shear/series.csv 2>/dev/null | head -n 1)
    [ -n "$running" ] && break
    sleep 0.1
done
kill -INT -- -"$leader" || fail "nothing to interrupt: $(tail -n 5 first.log)"
wait "$leader" && fail "snakemake took an interrupted run for a complete one"
point=$(basename "$(dirname "$(dirname "$running")")")
[ -e "there/points/$point.done" ] && fail "$point is not done"
grep -q "^sigmaflow: interrupted" "there/points/$point.log" || fail "$point was not interrupted"
"$sigmaflow" collect there | grep -q interrupted || fail "collect does not see that"

eval "$command" >second.log 2>&1 && fail "a failed point is not told"
grep -q "goes on from strain" "there/points/$point.log" || fail "$point began anew"
"$sigmaflow" collect there | tee said
grep -q "^3 complete, 1 failed" said || fail "collect"
rm -r there/points/stress_8
eval "$command" >third.log 2>&1 || fail "the last point: $(tail -n 20 third.log)"

files() { (cd "$1/points" && find . -type f ! -name manifest.json ! -path '*/.sigmaflow/*' ! -name '*.log' ! -name '*.done' | sort); }
[ "$(files here)" = "$(files there)" ] || fail "other files: $(diff <(files here) <(files there))"
for file in $(files here); do
    cmp "here/points/$file" "there/points/$file" || fail "$file differs"
done
cmp here/table.csv there/table.csv || fail "the tables differ"
echo "all points have the same bytes as without snakemake"
