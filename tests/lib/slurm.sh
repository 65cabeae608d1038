# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# slurm.sh: a Slurm cluster of one node in a folder, with its own configuration, ports and keys, as any user; to be sourced.

# shellcheck disable=SC2034 # who sources this reads slurm_why
# slurm_start FOLDER: starts munged, slurmctld and slurmd, and sets SLURM_CONF. False: it does not start, $slurm_why says why
slurm_start() {
    slurm=$1
    slurm_why=
    PATH=$PATH:/usr/sbin
    for program in munged slurmctld slurmd sbatch scontrol squeue sinfo; do
        command -v $program >/dev/null || { slurm_why="$program is not installed" && return 1; }
    done
    mkdir -p "$slurm/spool" "$slurm/state" || return 1
    (umask 077 && head -c 1024 /dev/urandom >"$slurm/munge.key")
    munged --force --key-file="$slurm/munge.key" --socket="$slurm/munge.socket" --pid-file="$slurm/munged.pid" \
        --log-file="$slurm/munged.log" --seed-file="$slurm/munge.seed" 2>"$slurm/said" ||
        { slurm_why="munged: $(head -n 1 "$slurm/said")" && return 1; }
    ports=$(/usr/bin/python3 -c 'import socket
s = [socket.socket() for _ in range(2)]
for one in s: one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in s))')
    host=$(hostname -s)
    cat >"$slurm/slurm.conf" <<YYY
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.socket
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
KillWait=2
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=8 Boards=1 SocketsPerBoard=1 CoresPerSocket=8 ThreadsPerCore=1 RealMemory=500 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
YYY
    SLURM_CONF=$slurm/slurm.conf
    export SLURM_CONF
    if ! slurmctld -c >"$slurm/said" 2>&1 || ! slurmd >>"$slurm/said" 2>&1; then
        slurm_why="slurmctld or slurmd: $(head -n 1 "$slurm/said")"
        return 1
    fi
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        sinfo -h -o %T 2>/dev/null | grep -q idle && return 0
        sleep 1
    done
    slurm_why="the node does not become idle: $(tail -n 1 "$slurm/slurmd.log" 2>/dev/null)"
    return 1
}

# slurm_stop: ends what slurm_start began, with its jobs
slurm_stop() {
    [ -z "$SLURM_CONF" ] || scancel --user "$(id -un)" 2>/dev/null
    for daemon in slurmctld slurmd munged; do
        pid=$(cat "$slurm/$daemon.pid" 2>/dev/null)
        [ -z "$pid" ] || kill "$pid" 2>/dev/null
        for _ in 1 2 3 4 5 6 7 8 9 10; do
            [ -n "$pid" ] && kill -0 "$pid" 2>/dev/null || break
            sleep 0.5
        done
    done
}
