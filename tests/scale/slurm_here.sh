#!/usr/bin/env bash
# Slurm on this machine alone for as long as a command runs: slurm_here.sh COMMAND…   Needs slurm-wlm, and root.
set -euo pipefail
here=$(mktemp -d)
node=$(hostname -s)
mkdir "$here/state" "$here/spool"
cat > "$here/slurm.conf" <<CONF
ClusterName=here
SlurmctldHost=$node(127.0.0.1)
AuthType=auth/none
CredType=cred/none
SlurmUser=root
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
StateSaveLocation=$here/state
SlurmdSpoolDir=$here/spool
SlurmctldPidFile=$here/slurmctld.pid
SlurmdPidFile=$here/slurmd.pid
SlurmctldLogFile=$here/slurmctld.log
SlurmdLogFile=$here/slurmd.log
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(free -m | awk '/^Mem/ {print $2}') State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
export SLURM_CONF=$here/slurm.conf
slurmctld -D & ctld=$!
slurmd -D & daemon=$!
trap 'kill $daemon $ctld 2>/dev/null; wait $daemon $ctld 2>/dev/null; rm -rf "$here"' EXIT
for _ in $(seq 60); do
    if sinfo -h -o %T 2>/dev/null | grep -q idle; then
        "$@"
        exit
    fi
    sleep 0.5
done
cat "$here/slurmctld.log" "$here/slurmd.log" >&2
exit 3
