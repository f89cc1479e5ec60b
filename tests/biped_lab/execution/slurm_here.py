"""A SLURM cluster of this machine alone: one node, its daemons started by hand.

It keeps all state in a folder of its own, listens on free ports, and needs neither
systemd nor cgroups nor accounting.
"""

import contextlib
import getpass
import os
import secrets
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scancel")
TIMEOUT_S = 120.0
CPUS = 2

CONF = """
ClusterName=lab
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
CommunicationParameters=NoCtldInAddrAny
StateSaveLocation={folder}/controller
SlurmdSpoolDir={folder}/node
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
KillWait=5
MessageTimeout=60
MailProg=/bin/true
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=lab Nodes={host} Default=YES MaxTime=60 State=UP
"""


def is_installed() -> bool:
    """Whether this machine has the programs, in sbin or elsewhere."""
    return all(shutil.which(name, path=_path()) for name in PROGRAMS)


@contextlib.contextmanager
def slurm_here(folder: Path) -> Iterator[Path]:
    """Start a cluster, wait until its node is idle, and end it; yield its slurm.conf.

    Args:
        folder: for state and logs; its path must be short, for the socket's sake.
    """
    for name in ("controller", "node"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(128))
    key.chmod(0o600)
    folder.chmod(0o755)
    conf = folder / "slurm.conf"
    conf.write_text(
        CONF.format(
            host=socket.gethostname().partition(".")[0],
            user=getpass.getuser(),
            folder=folder,
            ports=_free_ports(2),
            cpus=min(CPUS, os.cpu_count() or 1),
        )
    )
    environment = os.environ | {"PATH": _path(), "SLURM_CONF": str(conf)}
    munge = [
        "munged", "--foreground", "--force", f"--key-file={key}",
        *(f"--{kind}={folder}/munge.{kind.partition('-')[0]}"
          for kind in ("socket", "log-file", "pid-file", "seed-file")),
    ]  # fmt: skip

    def answer(*words: str) -> list[str]:
        asked = subprocess.run(
            words, env=environment, capture_output=True, text=True, timeout=TIMEOUT_S
        )
        return asked.stdout.split()

    daemons: list[subprocess.Popen[bytes]] = []
    try:
        for words in (munge, ["slurmctld", "-D"], ["slurmd", "-D"]):
            with (folder / f"{words[0]}.out").open("w") as log:
                daemons.append(
                    subprocess.Popen(words, env=environment, stdout=log, stderr=log)
                )
            if words is munge:
                assert wait_for((folder / "munge.socket").exists)
        node = ("sinfo", "--noheader", "--format=%T")
        assert wait_for(lambda: answer(*node) == ["idle"]), "the cluster did not start"
        yield conf
    finally:
        answer("scancel", f"--user={getpass.getuser()}")
        wait_for(lambda: not answer("squeue", "--noheader"))
        for daemon in reversed(daemons):
            daemon.terminate()
            try:
                daemon.wait(30.0)
            except subprocess.TimeoutExpired:
                daemon.kill()


def _path() -> str:
    return f"{os.environ['PATH']}:/usr/sbin:/sbin"


def _free_ports(count: int) -> list[int]:
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def wait_for(condition: Callable[[], bool]) -> bool:
    """Return whether a condition came true in time."""
    end = time.monotonic() + TIMEOUT_S
    while not condition() and time.monotonic() < end:
        time.sleep(0.1)
    return condition()
