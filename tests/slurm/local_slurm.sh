#!/bin/bash
# A Slurm cluster of one machine, without munge, in a folder of its own while COMMAND runs:
#
#   local_slurm.sh FOLDER COMMAND …
#
# Ends with COMMAND's code; 77 when Slurm is not installed or this is not root.
set -euo pipefail

folder=${1:?usage: local_slurm.sh FOLDER COMMAND …}
shift
for program in slurmctld slurmd sinfo sbatch; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || { echo "no $program: install slurmctld, slurmd and slurm-client"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "slurmctld and slurmd want root"; exit 77; }
PATH=$PATH:/usr/sbin

host=$(hostname -s)
mkdir -p "$folder"/{state,spool}
export SLURM_CONF=$folder/slurm.conf
cat >"$SLURM_CONF" <<EOF
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmUser=root
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF

# Only what this script started, by its pid files.
finish() {
  for name in slurmd slurmctld; do
    [ -s "$folder/$name.pid" ] || continue
    pid=$(cat "$folder/$name.pid")
    kill "$pid" 2>/dev/null || true
    for _ in $(seq 50); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
  done
}
trap finish EXIT

slurmctld
sleep 1
slurmd
for _ in $(seq 150); do
  sinfo -h -o %T 2>/dev/null | grep -q idle && break
  sleep 0.2
done
sinfo -h -o %T | grep -q idle || { echo "Slurm did not come up"; tail -n 20 "$folder"/*.log; exit 1; }
"$@"
