"""A Slurm cluster of one node for a test: daemons, configuration, keys and state of its own in one folder, on free
ports. Needs Slurm, munge and root."""

import ctypes
import os
import pathlib
import pwd
import re
import secrets
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "unshare")
START_LIMIT_S = 200
PR_SET_PDEATHSIG = 1

# Requeued jobs wait for cred_expire seconds.
CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=100000
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
ReturnToService=2
MessageTimeout=100
SlurmdTimeout=0
SlurmdParameters=config_overrides
NodeName=node NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 State=UNKNOWN
PartitionName=all Nodes=node Default=YES MaxTime=INFINITE State=UP
"""


class Unavailable(Exception):
    """Slurm cannot run here; says why."""


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


def end_with_parent():
    """However that ends."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class Cluster:
    """A context. Its environment `variables` make sbatch and the like speak to this cluster."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.variables = {"SLURM_CONF": str(self.folder / "slurm.conf")}
        self.environment = dict(os.environ, **self.variables)
        self.daemons = []

    def __enter__(self):
        missing = [name for name in PROGRAMS if not self.find(name)]
        if missing:
            raise Unavailable(f"not installed: {', '.join(missing)}")
        if os.geteuid() != 0:
            raise Unavailable("needs root")
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def command(self, name, *arguments):
        """Its standard output."""
        return subprocess.run([self.find(name), *arguments], env=self.environment, check=True, capture_output=True,
                              text=True, timeout=START_LIMIT_S).stdout

    @staticmethod
    def find(name):
        return shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/usr/local/sbin")

    def start(self):
        self.start_munge()
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        (self.folder / "slurm.conf").write_text(
            CONFIGURATION.format(folder=self.folder, host=socket.gethostname().split(".")[0], ports=free_ports(2)))
        conf = str(self.folder / "slurm.conf")
        # Newer versions do not start where no cgroups are mounted, as in a plain chroot; older ones know no word for it.
        if int(re.search(r"\d+", self.command("slurmctld", "-V"))[0]) >= 24:
            (self.folder / "cgroup.conf").write_text("CgroupPlugin=disabled\n")
        self.start_daemon("slurmctld", "-D", "-c", "-f", conf)
        # In a PID namespace, so that jobs end with it; the shell reaps them.
        self.start_daemon("unshare", "--pid", "--mount-proc", "--fork", "--kill-child", "sh", "-c", '"$@"; exit $?', "sh",
                          self.find("slurmd"), "-D", "-c", "-f", conf, "-N", "node")
        self.wait("the node", lambda: "State=IDLE" in self.command("scontrol", "show", "node", "node"))

    def start_munge(self):
        folder = self.folder / "munge"
        folder.mkdir(mode=0o755)
        key = folder / "key"
        key.touch(mode=0o600)
        key.write_bytes(secrets.token_bytes(128))
        try:
            user = pwd.getpwnam("munge")
        except KeyError:
            raise Unavailable("there is no user munge") from None
        for path in (folder, key):
            os.chown(path, user.pw_uid, user.pw_gid)
        self.folder.chmod(0o755)
        self.start_daemon("munged", "--foreground", f"--socket={folder}/socket", f"--key-file={key}",
                          f"--log-file={folder}/log", f"--pid-file={folder}/pid", f"--seed-file={folder}/seed",
                          user="munge", group="munge", extra_groups=[])
        self.wait("munged", lambda: (folder / "socket").exists())

    def start_daemon(self, name, *arguments, **options):
        log = (self.folder / f"{name}.log").open("wb")
        with log:
            self.daemons.append(subprocess.Popen(
                [self.find(name), *arguments], cwd=self.folder, env=self.environment, stdout=log,
                stderr=subprocess.STDOUT, preexec_fn=end_with_parent, **options))

    def wait(self, what, is_ready):
        end = time.monotonic() + START_LIMIT_S
        while time.monotonic() < end and all(daemon.poll() is None for daemon in self.daemons):
            try:
                if is_ready():
                    return
            except subprocess.SubprocessError:
                pass  # not yet
            time.sleep(0.1)
        logs = "".join(f"\n{path.name}: {path.read_text(errors='replace')[-1000:]}" for path in self.folder.glob("*.log"))
        raise Unavailable(f"{what} did not start:{logs}")

    def stop(self):
        for daemon in self.daemons:
            daemon.kill()
            daemon.wait()
        self.daemons = []
