# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/farm.md as they stand there: a Slurm array of 4 tasks and GNU parallel over 40 frames.

Slurm runs on this machine's loopback, with files, ports and a key of its own, and is gone at the end.
"""

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from pictures import PROJECT, skip
from shots import apply, contents, leftovers, make_shot

FRAMES = range(1001, 1041)
DAEMONS = {"munged": "munge", "slurmctld": "slurmctld", "slurmd": "slurmd"}
PROGRAMS = {"sbatch": "slurm-client", "squeue": "slurm-client", "sinfo": "slurm-client"}


def example(word):
    """The block of code that has this word."""
    blocks = re.findall(r"^```\w*\n(.*?)^```$", (PROJECT / "docs" / "farm.md").read_text(), re.S | re.M)
    return next(block for block in blocks if word in block)


@pytest.fixture(scope="module")
def one_process(command, folder):
    """(options of the example, exit code, lines, files) of one process that makes all frames."""
    make_shot(folder, FRAMES, name="shot.{:04d}.exr")
    options = next(part for part in example("#SBATCH").split("out.%04d.png ")[1:]).split("\\")[0].split()
    code, lines = apply(command, "shot.%04d.exr", "out.%04d.png", *options, "--frames", "1001-1040", folder=folder)
    return options, code, lines, contents(folder)


@pytest.fixture
def truth(folder, one_process):
    """Files of all frames, which the folder does not have yet."""
    for path in folder.glob("out.*"):
        path.unlink()
    return one_process[-1]


def test_one_process(report, one_process):
    options, code, lines, made = one_process
    report.check(f"one process, {' '.join(options)}", code == 0 and not lines and len(made) == 40, lines)


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def why_no_slurm():
    missing = [package for program, package in {**DAEMONS, **PROGRAMS}.items()
               if not shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin")]
    if missing:
        return f"Debian: {' '.join(sorted(set(missing)))}"
    return "" if os.geteuid() == 0 else "slurmd needs root"


def write_config(folder):
    control, node = free_ports(2)
    (folder / "slurm.conf").write_text(f"""
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={control}
SlurmdPort={node}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName=localhost NodeAddr=127.0.0.1 NodeHostname={socket.gethostname()} CPUs=4 RealMemory=4096 State=UNKNOWN
PartitionName=main Nodes=localhost Default=YES State=UP
SlurmdParameters=config_overrides
ReturnToService=2
""")
    for name in ("state", "spool", "munge"):
        (folder / name).mkdir(mode=0o700)
    (folder / "munge" / "key").write_bytes(os.urandom(128))
    (folder / "munge" / "key").chmod(0o400)


def wait_until(true, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if true():
            return True
        time.sleep(0.1)
    return False


@contextlib.contextmanager
def slurm(folder):
    """Slurm's environment, or what went wrong; its daemons end with it, and with them what they run."""
    write_config(folder)
    environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf"), "PATH": os.environ["PATH"] + ":/usr/sbin"}
    munge = folder / "munge"
    with contextlib.ExitStack() as stack, open(folder / "output", "wb") as output:
        def start(*command):
            process = subprocess.Popen(list(map(str, command)), env=environment, stdout=output, stderr=output,
                                       start_new_session=True)
            stack.callback(stop, process)

        def said(*command):
            return subprocess.run(command, env=environment, capture_output=True, text=True, check=False).stdout

        start("munged", "--foreground", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
              f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed", "--num-threads=2")
        problem = ""
        if not wait_until((munge / "socket").exists, 20):
            problem = "munged did not start"
        else:
            start("slurmctld", "-D", "-c")
            start("slurmd", "-D", "-c", "-N", "localhost")
            stack.callback(wait_until, lambda: not said("squeue", "-h"), 20)
            stack.callback(said, "scancel", "--user=root")  # before the wait: callbacks run from the last to the first
            if not wait_until(lambda: "idle" in said("sinfo", "-h", "-o", "%T"), 60):
                problem = "slurmctld and slurmd did not start"
        if problem:
            logs = [path.read_text(errors="replace")[-1000:] for path in (*folder.glob("*.log"), munge / "log", folder / "output")
                    if path.exists()]
            problem += ": " + " | ".join(logs)
        yield environment, problem


def stop(process):
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def test_slurm(report, command, folder, truth):
    if reason := why_no_slurm():
        skip(f"Slurm ({reason})")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # and the daemons end, too
    # A short path: those of sockets have a limit.
    with tempfile.TemporaryDirectory(prefix="tonewright-slurm-") as name, slurm(Path(name)) as (environment, problem):
        if problem:
            skip(f"Slurm ({problem})")
        environment["PATH"] = f"{command.parent}:{environment['PATH']}"
        (folder / "tonewright.sh").write_text(example("#SBATCH"))

        def run_array(*options):
            """Lines of the tasks' logs; None: they did not end."""
            for log in folder.glob("tonewright-*.log"):
                log.unlink()
            done = subprocess.run(["sbatch", "--parsable", *options, "tonewright.sh"], cwd=folder, env=environment,
                                  capture_output=True, text=True, check=False)
            if not report.check(f"sbatch {' '.join(options)} tonewright.sh", done.returncode == 0, done.stderr):
                return None
            ended = wait_until(lambda: not subprocess.run(["squeue", "-h"], env=environment, capture_output=True,
                                                          check=True).stdout, 120)
            return [line for log in sorted(folder.glob("tonewright-*.log")) for line in log.read_text().splitlines()] \
                if ended else None

        lines = run_array()
        report.check("a Slurm array of 4 tasks over 40 frames: the bytes of one process",
                     lines == [] and contents(folder) == truth and not leftovers(folder), lines)
        for number in (1005, 1006, 1007, 1013, 1040):
            (folder / f"out.{number}.png").unlink()
        lines = run_array()
        summaries = [line.rpartition("apply: ")[2] for line in lines or []]
        report.check("the same sbatch again makes what is missing", contents(folder) == truth and summaries == [
            "10 frames: 2 written, 8 skipped", *["10 frames: 1 written, 9 skipped"] * 3], lines)
        for path in folder.glob("out.*"):
            path.unlink()
        few = {f"out.{number}.png": truth[f"out.{number}.png"] for number in (1001, 1002)}
        (folder / "tonewright.sh").write_text(example("#SBATCH").replace("last=1040", "last=1002"))
        lines = run_array()
        report.check("4 tasks over 2 frames", lines == [] and contents(folder) == few, lines)


def test_parallel(report, command, folder, truth):
    version = subprocess.run(["parallel", "--version"], capture_output=True, text=True, check=False).stdout \
        if shutil.which("parallel") else ""
    if not version.startswith("GNU parallel"):
        skip("GNU parallel (Debian: parallel)")
    environment = {**os.environ, "PATH": f"{command.parent}:{os.environ['PATH']}", "HOME": str(folder)}
    done = subprocess.run(["bash", "-c", example("| parallel")], cwd=folder, env=environment, capture_output=True, text=True,
                          check=False)
    report.check("GNU parallel, 4 processes over 40 frames: the bytes of one process", done.returncode == 0
                 and contents(folder) == truth and len((folder / "parallel.log").read_text().splitlines()) == 5, done.stderr)
