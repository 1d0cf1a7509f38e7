#!/usr/bin/env bash
# A Slurm of one node for tests: munged, slurmctld and slurmd of Debian's slurm-wlm and munge, with
# all their files in one folder and as the user who calls; no service of the system is touched.
#
# usage: tests/slurm/slurm.sh start FOLDER    until SLURM_CONF=FOLDER/slurm.conf sinfo shows it idle
#        tests/slurm/slurm.sh stop FOLDER
#
# Exit code 77: what it needs is missing; 1: it did not start, and FOLDER/*.log say why.

set -euo pipefail
export PATH=$PATH:/usr/sbin:/sbin

main() {
    [[ $# == 2 ]] || { sed -n '2,/^$/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
    mkdir -p "$2"
    folder=$(cd "$2" && pwd)
    case $1 in
        start) start ;;
        stop) stop ;;
        *) echo "slurm.sh: $1 is neither start nor stop" >&2; exit 2 ;;
    esac
}

start() {
    local tool
    for tool in munged slurmctld slurmd sbatch sinfo python3; do
        command -v "$tool" >/dev/null || { echo "slurm.sh: no $tool (Debian: slurm-wlm munge)" >&2; exit 77; }
    done
    configure
    # munged refuses a folder that others can write into.
    chmod 755 "$folder"
    munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
        --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" \
        --seed-file="$folder/munge.seed" --num-threads=2 2>"$folder/munged.err.log"
    slurmctld -f "$folder/slurm.conf" -L "$folder/slurmctld.log"
    slurmd -f "$folder/slurm.conf" -L "$folder/slurmd.log" -N "$(node)"
    local tries
    for ((tries = 0; tries < 60; ++tries)); do
        if SLURM_CONF=$folder/slurm.conf sinfo --noheader --format=%T 2>/dev/null | grep -qx idle; then
            return
        fi
        sleep 0.5
    done
    echo "slurm.sh: the node is not idle after 30 s; see $folder/*.log" >&2
    SLURM_CONF=$folder/slurm.conf sinfo >&2 || true
    stop
    exit 1
}

node() { hostname -s; }

configure() {
    mkdir -p "$folder/state" "$folder/spool"
    (umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
    local ports
    ports=$(python3 - <<'END'
import socket
sockets = [socket.create_server(("", 0)) for _ in range(2)]
print(*(s.getsockname()[1] for s in sockets))
END
)
    cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$(node)(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MinJobAge=300
# Two CPUs whatever the machine has, so that tasks run side by side.
SlurmdParameters=config_overrides
NodeName=$(node) NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=test Nodes=$(node) Default=YES MaxTime=INFINITE State=UP
END
}

# By the numbers in the files of its own processes only.
stop() {
    local name tries
    for name in slurmd slurmctld munged; do
        [[ -s $folder/$name.pid ]] || continue
        kill "$(<"$folder/$name.pid")" 2>/dev/null || true
    done
    for ((tries = 0; tries < 50; ++tries)); do
        compgen -G "$folder/*.pid" >/dev/null || return 0
        sleep 0.1
    done
}

main "$@"
