#!/bin/bash
# A sweep on a real Slurm of one node: munged, slurmctld and slurmd with files of their own, stopped
# by their process ids at the end. One task is asked to stop with SIGUSR1 as at the end of its time,
# one is put back into the queue by Slurm, one point fails. All others must end with the bytes of
# the same sweep without Slurm.
# Usage: sweep_on_slurm.sh SIGMAFLOW   exit code 77: not root, or Slurm is not installed
# (apt-get install slurm-wlm munge)
set -u
sigmaflow=$(realpath "$1")
export PATH=$PATH:/usr/sbin:/sbin
[ "$(id -u)" = 0 ] || { echo "needs root"; exit 77; }
for program in munged slurmctld slurmd sbatch scontrol scancel squeue; do
    command -v $program >/dev/null || { echo "$program is not installed"; exit 77; }
done

folder=$(mktemp -d /tmp/sigmaflow_slurm_XXXXXX)
chmod 755 "$folder"
daemons=()
finish() {
    code=$?
    scancel --user=root --full --signal=KILL 2>/dev/null
    scancel --user=root 2>/dev/null
    for ((k = ${#daemons[@]} - 1; k >= 0; --k)); do
        kill "${daemons[k]}" 2>/dev/null && wait "${daemons[k]}" 2>/dev/null
    done
    [ $code = 0 ] && rm -rf "$folder" || echo "left for inspection: $folder"
    exit $code
}
trap finish EXIT
trap 'exit 1' INT TERM
fail() { echo "FAILED: $*"; exit 1; }

# --- Slurm
cd "$folder" && mkdir spool state munge run && chmod 755 munge
host=$(hostname -s)
port=$((20000 + RANDOM % 10000))
memory=$(awk '/MemTotal/ {print int($2 / 2048)}' /proc/meminfo)
head -c 1024 /dev/urandom >munge/key && chmod 400 munge/key
cat >slurm.conf <<END
ClusterName=sigmaflow
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket,cred_expire=5
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
ReturnToService=2
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmdSpoolDir=$folder/spool
StateSaveLocation=$folder/state
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobRequeue=1
KillWait=30
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=$memory State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
printf 'CgroupPlugin=cgroup/v1\nConstrainCores=no\nConstrainRAMSpace=no\n' >cgroup.conf
export SLURM_CONF=$folder/slurm.conf
munged --foreground --force --key-file=munge/key --socket="$folder/munge/socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" \
    >munge.out 2>&1 &
daemons+=($!)
for ((k = 0; k < 100; ++k)); do [ -S munge/socket ] && break; sleep 0.1; done
slurmctld -D -f "$SLURM_CONF" >slurmctld.out 2>&1 &
daemons+=($!)
sleep 1
slurmd -D -f "$SLURM_CONF" -N "$host" >slurmd.out 2>&1 &
daemons+=($!)
for ((k = 0; k < 300; ++k)); do
    [ "$(sinfo -h -o %T 2>/dev/null)" = idle ] && break
    sleep 0.2
done
[ "$(sinfo -h -o %T)" = idle ] || fail "Slurm does not start: $(tail -n 5 slurmctld.out slurmd.out)"

# --- the sweep
cat >flow.json <<END
{"suspension": {"particles": 60, "volume_fraction": 0.5, "seed": 7},
 "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 40}, {"step": "plot"}]}
END
swept="--sweep /steps/1/stress=1,2,4,8"
"$sigmaflow" sweep flow.json $swept --out here -q || fail "the sweep without Slurm"

mkdir -p there/points/stress_8 && echo mine >there/points/stress_8/notes.txt
# a folder that was there before is refused, so the sweep begins elsewhere
"$sigmaflow" sweep flow.json $swept --out there --engine slurm -q 2>/dev/null && fail "foreign folder"
rm -r there
"$sigmaflow" sweep flow.json $swept --out there --engine slurm --no-submit || fail "--no-submit"
mkdir -p there/points/stress_8 && echo mine >there/points/stress_8/notes.txt  # this point fails
"$sigmaflow" sweep there --engine slurm --checkpoint-interval 0.2 --slurm-options "--time=10" |
    tee submitted || fail "submit"
job=$(sed -n 's/^job \([0-9]*\) .*/\1/p' submitted)
[ -n "$job" ] || fail "no job number"

state() { squeue -h -r -j "$1" -o %T 2>/dev/null; }
await() { # TASK STATE: for a minute
    for ((k = 0; k < 600; ++k)); do [ "$(state "$1")" = "$2" ] && return; sleep 0.1; done
    fail "task $1 is $(state "$1"), not $2: $(tail -n 3 there/slurm/*.out)"
}
await "${job}_1" RUNNING
await "${job}_2" RUNNING
for ((k = 0; k < 200; ++k)); do  # both have begun to shear
    [ -e there/points/stress_1/shear/series.csv ] && [ -e there/points/stress_2/shear/series.csv ] && break
    sleep 0.1
done
"$sigmaflow" collect there | tee said
grep -q "2 running, 2 waiting" said || fail "collect does not see the queue"
"$sigmaflow" sweep there | tee said
grep -q "no point is left" said || fail "points are submitted twice"
"$sigmaflow" sweep there --engine local -q 2>said && fail "runs what is in the queue"
grep -q "wait or run in Slurm" said || fail "wrong reason: $(cat said)"

# scancel tries again while the task is on its way back to the queue, and then complains
timeout 3 scancel --signal=USR1 --batch "${job}_1" 2>/dev/null
for ((k = 0; k < 300; ++k)); do grep -q "^exit code 3" there/points/stress_1.log && break; sleep 0.1; done
grep -q "^exit code 3" there/points/stress_1.log || fail "task 1 has no checkpoint: $(cat there/slurm/*_1.out)"
await "${job}_2" RUNNING
scontrol requeue "${job}_2" || fail "requeue"

for ((k = 0; k < 1200; ++k)); do [ -z "$(squeue -h -j "$job" 2>/dev/null)" ] && break; sleep 0.5; done
"$sigmaflow" collect there | tee said
grep -q "^3 complete, 1 failed" said || fail "not all tasks ended well: $(tail -n 4 there/points/*.log)"
grep -q "^failed: stress_8: exit code 73" said || fail "the failed point is not told"
for point in stress_1 stress_2; do
    grep -q "goes on from strain" there/points/$point.log || fail "$point began anew"
done

# --- what is left is submitted again
rm -r there/points/stress_8
"$sigmaflow" sweep there | tee said
grep -q "with 1 points submitted" said || fail "the failed point is not submitted again"
job=$(sed -n 's/^job \([0-9]*\) .*/\1/p' said)
for ((k = 0; k < 600; ++k)); do [ -z "$(squeue -h -j "$job" 2>/dev/null)" ] && break; sleep 0.5; done
"$sigmaflow" collect there | grep -q "^4 complete" || fail "the failed point did not end well"

files() { (cd "$1/points" && find . -type f ! -name manifest.json ! -path '*/.sigmaflow/*' ! -name '*.log' | sort); }
[ "$(files here)" = "$(files there)" ] || fail "other files: $(diff <(files here) <(files there))"
for file in $(files here); do
    cmp "here/points/$file" "there/points/$file" || fail "$file differs"
done
cmp here/table.csv there/table.csv || fail "the tables differ"
# --- a cancelled job stays so, and what it leaves can be run here
"$sigmaflow" sweep there --sweep /steps/1/stress=16 --checkpoint-interval 0.2 >said || fail "one more value"
job=$(sed -n 's/^job \([0-9]*\) .*/\1/p' said)
[ "$(grep -c -- --time=10 there/slurm/job.sh)" = 1 ] || fail "the options were forgotten"
await "${job}_1" RUNNING
for ((k = 0; k < 200; ++k)); do [ -e there/points/stress_16/shear/series.csv ] && break; sleep 0.1; done
scancel "$job"
for ((k = 0; k < 600; ++k)); do [ -z "$(squeue -h -j "$job" 2>/dev/null)" ] && break; sleep 0.1; done
"$sigmaflow" collect there | tee said
grep -q "^4 complete, 1 interrupted" said || fail "the cancelled point is not interrupted"
"$sigmaflow" sweep there --engine local -q || fail "going on here"
grep -q "goes on from strain" there/points/stress_16.log || fail "the cancelled point began anew"

echo "all points have the same bytes as without Slurm"
