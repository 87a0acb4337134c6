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
 "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 8}, {"step": "plot"}]}
END
swept="--sweep /steps/1/stress=1,2,4,8"
"$sigmaflow" sweep flow.json $swept --out here -q || fail "the sweep without snakemake"
"$sigmaflow" sweep flow.json $swept --out there --engine snakemake --jobs 2 \
    --checkpoint-interval 0.1 | tee said || fail "writing the Snakefile"
command=$(tail -n 1 said)
[ "${command%% *}" = snakemake ] || fail "it is not said how to run it"

# the whole process group gets SIGINT, as from a terminal
mkdir -p there/points/stress_8 && echo mine >there/points/stress_8/notes.txt
setsid bash -c "trap - INT; exec $command" >first.log 2>&1 &
for ((k = 0; k < 600; ++k)); do [ -e there/points/stress_1/shear/series.csv ] && break; sleep 0.1; done
leader=$!
kill -INT -- -"$leader" || fail "nothing to interrupt: $(tail -n 5 first.log)"
wait "$leader" && fail "snakemake took an interrupted run for a complete one"
[ -e there/points/stress_1.done ] && fail "stress_1 is not done"
grep -q "exit code 3" there/points/stress_1.log || fail "stress_1 was not interrupted"

eval "$command" >second.log 2>&1 && fail "a failed point is not told"
for point in stress_1 stress_2 stress_4; do
    [ -e there/points/$point.done ] || fail "$point: $(tail -n 20 second.log)"
done
grep -q "goes on from strain" there/points/stress_1.log || fail "stress_1 began anew"
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
