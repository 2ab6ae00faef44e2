#!/bin/sh
# A sweep as an array of a Slurm of four nodes on one machine: tasks are killed and requeued, a node is lost, and the
# bytes are those of one process. Each task takes its own GPU.
# Needs slurmctld, slurmd, slurm-client and munge, and root for them; else it is skipped.
#     slurm_test.sh PROGRAM SOURCE
set -eu
program=$(readlink -f "$1")
source=$(readlink -f "$2")
for tool in slurmctld slurmd sbatch munged; do
    command -v $tool > /dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: Slurm's daemons need root"; exit 77; }

folder=$(mktemp -d)
end() {
    for name in slurmd.n1 slurmd.n2 slurmd.n3 slurmd.n4 slurmctld munged; do
        process=$(cat "$folder/$name.pid" 2> /dev/null) || continue
        kill "$process" 2> /dev/null || continue
        i=0
        while kill -0 "$process" 2> /dev/null && [ $i -lt 100 ]; do # it writes its state at the end
            i=$((i + 1))
            sleep 0.1
        done
    done
    rm -rf "$folder"
}
trap end EXIT
cd "$folder"
chmod 755 .

# Munge of its own, so that none of the machine's is touched.
mkdir -m 700 munge
dd if=/dev/urandom of=munge/key bs=1 count=1024 2> /dev/null
chmod 400 munge/key
munged --force --key-file="$folder/munge/key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"

node=$(hostname -s)
cat > slurm.conf << END
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
SlurmctldPort=17817
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.%n.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
KillWait=2
GresTypes=gpu
NodeName=n[1-4] NodeHostname=$node NodeAddr=127.0.0.1 Port=17821-17824 CPUs=2 Gres=gpu:2 State=UNKNOWN
PartitionName=all Nodes=n[1-4] Default=YES MaxTime=60 State=UP
END
echo "Name=gpu File=/dev/null,/dev/zero" > gres.conf # Slurm counts them: the tasks' GPU is found by nvidia-smi below
export SLURM_CONF="$folder/slurm.conf"
mkdir state
slurmctld
for name in n1 n2 n3 n4; do
    mkdir spool.$name
    slurmd -N $name
done
i=0
until [ "$(sinfo -h -N -o %T 2> /dev/null | grep -c idle)" = 4 ]; do
    i=$((i + 1))
    [ $i -lt 60 ] || { echo "skipped: Slurm does not come up here"; cat slurmctld.log slurmd.*.log; exit 77; }
    sleep 0.5
done

cat > study.toml << END
[surface]
radius = ["600 mil", "1000 mil", "1400 mil"]
facets = [1, 2, 3, 4]
[force]
shading = ["none", "reference"]
[grid]
size = [160, 120, 160]
origin = ["-25 mm", "-6 mm", "-10 mm"]
spacing = "0.3 mm"
[output]
compression = "zip"
END
"$program" sweep study.toml --out whole --engine cpu --quiet
export FORCESHADE="$program"
parts=4
job=$(sbatch --parsable --array=1-$parts --output=log.%a "$source/host/slurm/sweep.sbatch" study.toml out $parts \
    --engine cpu --quiet)
until [ -n "$(find out -name '*.json' 2> /dev/null | head -1)" ]; do sleep 0.1; done
scontrol requeue "${job}_1" || true          # ends it with SIGTERM, then SIGKILL, and begins it anew
pkill -KILL -f "sweep study.toml --out out --shard 2/$parts" || true # as when memory runs out
lost=$(squeue -h -j "${job}_3" -o %N)
if [ -n "$lost" ]; then # its tasks go on there, and begin anew elsewhere
    kill -KILL "$(cat "slurmd.$lost.pid")"
    scontrol update "NodeName=$lost" State=DOWN Reason=lost
fi
while squeue -h -j "$job" 2> /dev/null | grep -q .; do
    "$program" sweep --status out > status || true
    for task in 1 3 4; do # else what is requeued waits two minutes
        scontrol update "JobId=${job}_$task" StartTime=now 2> /dev/null || true
    done
    sleep 0.5
done
cat status

# What was killed is missing or not; some tasks once more, by number.
code=0
"$program" sweep study.toml --out out --merge --quiet || code=$?
if [ $code -ne 0 ]; then
    again=$(sbatch --parsable --array=1,2 --output=log.%a "$source/host/slurm/sweep.sbatch" study.toml out $parts \
        --engine cpu --quiet)
    while squeue -h -j "$again" 2> /dev/null | grep -q .; do sleep 0.5; done
fi
sbatch --parsable --wait --output=merge.log --wrap "$program sweep study.toml --out out --merge --quiet"
cat log.* merge.log
for file in study.toml summary.csv $(cd whole && ls ./*.exr); do
    cmp "whole/$file" "out/$file"
done
[ -z "$(find out -name '.*.tmp')" ] || { echo "temporaries are left"; exit 1; }
# An srun shares the study out among its tasks.
srun -n2 "$program" sweep study.toml --out tasks --shard slurm --only '*facets-[12]*none' --engine cpu --quiet
[ "$(find tasks/manifest.d/shards -name '*-of-2.json' | wc -l)" = 2 ]

# A task that is cancelled stays away, one whose time is nearly over comes back.
sed 's/160, 120, 160/640, 480, 640/' study.toml > long.toml
begin() {
    rm -rf long
    sbatch --parsable --array=1 --output=stopped "$source/host/slurm/sweep.sbatch" long.toml long 1 --engine cpu --quiet
    until [ -d long ]; do sleep 0.1; done
}
ended() {
    while squeue -h -j "$1" -t running,completing 2> /dev/null | grep -q .; do sleep 0.2; done
    squeue -h -j "$1" -o %T 2> /dev/null
}
job=$(begin)
scancel "$job"
[ -z "$(ended "$job")" ]
job=$(begin)
scancel --batch --signal=TERM "$job" # as --signal=B:TERM@60 does
[ "$(ended "$job")" = PENDING ]
scancel "$job"

# A task computes on the GPU that Slurm gives it.
mkdir bin
uuid=$("$program" gpus | sed -n 's/^ *UUID //p' | head -1)
cat > bin/nvidia-smi << END
#!/bin/sh
echo "\$3" >> $folder/asked
echo GPU-$uuid
END
chmod 755 bin/nvidia-smi
PATH="$folder/bin:$PATH" sbatch --wait --array=1-2 --gres=gpu:1 --output=gpu.%a "$source/host/slurm/sweep.sbatch" study.toml gpus 2 \
    --engine gpu --only '*facets-[12]*none' --quiet || { cat gpu.*; exit 1; }
sort asked | tr '\n' ' ' | grep -x -e '--id=0 --id=[01] '
[ "$(find gpus -name "*.exr" | wc -l)" = 6 ]
echo "the bytes are those of one process"
