#!/usr/bin/env bash
# A study as a Slurm array on one node, by Debian's package: one member of the array is requeued in the middle of its share, and
# the tables must equal those of a serial run to the bit. Starts daemons of its own, on ports of its own, in a folder that goes.
# Usage: tests/slurm.sh FCT. Needs root; says that it skips where Slurm is not installed and cannot be.
set -euo pipefail
fct=$(realpath "$1")

skip() {
    echo "slurm: SKIPPED: $1" >&2
    exit 0
}
[ "$(id -u)" = 0 ] || skip "needs root, to start Slurm's daemons"
if ! command -v slurmctld >/dev/null || ! command -v slurmd >/dev/null || ! command -v munged >/dev/null; then
    command -v apt-get >/dev/null || skip "no Slurm here, and no Debian to install it from"
    (apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        slurmctld slurmd slurm-client munge) >/dev/null 2>&1 || skip "Debian's slurmctld, slurmd, slurm-client and munge could not be installed"
fi

here=$(mktemp -d)
cores=$(nproc)
host=$(hostname -s)
stop() {
    for daemon in slurmd slurmctld munged; do
        if [ -f "$here/$daemon.pid" ]; then kill "$(cat "$here/$daemon.pid")" 2>/dev/null || true; fi
    done
    sleep 1
    rm -rf "$here"
}
trap stop EXIT

# The key of this run alone: nothing of the machine's own Slurm is touched.
chmod 755 "$here"
mkdir -m 755 "$here/munge" "$here/state" "$here/spool"
dd if=/dev/urandom of="$here/key" bs=1 count=1024 status=none
chmod 400 "$here/key"
munged --force --key-file="$here/key" --socket="$here/munge/socket" --pid-file="$here/munged.pid" \
    --log-file="$here/munge/log" --seed-file="$here/munge/seed"

cat >"$here/slurm.conf" <<CONF
ClusterName=fct
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$here/munge/socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmctldPidFile=$here/slurmctld.pid
SlurmdPidFile=$here/slurmd.pid
SlurmctldLogFile=$here/slurmctld.log
SlurmdLogFile=$here/slurmd.log
SlurmdSpoolDir=$here/spool
StateSaveLocation=$here/state
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cores RealMemory=1024 State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$here/slurm.conf
slurmctld
slurmd
for _ in $(seq 30); do
    [ "$(sinfo -h -o %t 2>/dev/null)" = idle ] && break
    sleep 1
done
[ "$(sinfo -h -o %t)" = idle ] || {
    tail -5 "$here"/slurm*.log >&2
    echo "slurm: the node did not come up" >&2
    exit 1
}

# Four synthetic strips in two groups, each fitted thirteen times: a share must be long enough to be cut in two.
mkdir "$here/study" && cd "$here/study"
echo "file,group,donor,exclude" >table.csv
for k in $(seq 4); do
    cat >"s$k.toml" <<STRIP
name = "s$k"
[geometry]
length_mm = 8.0
width_mm = $((4 + k)).0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 5.0, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [16, 16, 1]
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[interface]
gc_N_per_mm = 0.1$k
sigma_c_MPa = 0.08
[solver]
step_mm = 0.05
[output]
noise = 0.003
seed = $k
fields = false
STRIP
    "$fct" simulate "s$k.toml" --quiet >/dev/null
    echo "runs/s$k/specimen.toml,$([ $((k % 2)) = 0 ] && echo even || echo odd),d$k," >>table.csv
done
cat >model.toml <<MODEL
[mesh]
divisions = [16, 16, 1]
MODEL
printf '%s\n' 'name = "strips"' 'table = "table.csv"' '[[models]]' 'name = "base"' 'config = "model.toml"' \
    '[repeats]' 'bootstrap = 12' 'seed = 5' >study.toml
cp -r . ../serial

"$fct" campaign slurm study.toml --array 4 --memory 200M --time 00:20:00 >job.sh
id=$(sbatch --parsable job.sh)
# Until it has done something of its share, and has something left.
for _ in $(seq 600); do
    [ "$(squeue -h -j "${id}_1" -o %T 2>/dev/null)" = RUNNING ] && [ -d study-strips/results ] && [ "$(ls study-strips/results | grep -c json)" -ge 2 ] && break
    sleep 0.1
done
scontrol requeue "${id}_1"
# Slurm lets a requeued job wait for two minutes.
for _ in $(seq 60); do
    scontrol update jobid="${id}_1" starttime=now 2>/dev/null && break
    sleep 1
done
for _ in $(seq 900); do
    [ -z "$(squeue -h -j "$id" 2>/dev/null)" ] && break
    sleep 1
done
[ -z "$(squeue -h -j "$id" 2>/dev/null)" ] || {
    squeue >&2
    echo "slurm: not done after a quarter of an hour" >&2
    exit 1
}
cat slurm-*.out
# What its second run did and what it found done are its share; both must be something, or it was not in the middle.
again=$(cat slurm-*_1.out)
[[ "$again" =~ ([0-9]+)\ done,\ 0\ failed\ now\;\ ([0-9]+)\ had\ a\ result ]] && ((BASH_REMATCH[1] > 0 && BASH_REMATCH[2] > 0)) || {
    echo "slurm: member 1 was not sent back in the middle of its share" >&2
    exit 1
}
echo "member 1 of job $id was sent back to the queue after ${BASH_REMATCH[2]} tasks, and did the other ${BASH_REMATCH[1]} when it came again"
"$fct" campaign status study.toml
"$fct" campaign report study.toml --quiet >/dev/null
(cd ../serial && "$fct" campaign run study.toml --quiet && "$fct" campaign report study.toml --quiet >/dev/null)
for table in specimens.csv groups.csv; do
    cmp "study-strips/$table" "../serial/study-strips/$table" 2>/dev/null || cmp "$(find . -name $table)" "../serial/$(cd ../serial && find . -name $table)"
done
echo "slurm $(slurmctld -V): an array of 4 on $cores cores gave the tables of the serial run to the bit"
