"""A real server in a folder of its own, on free ports, for the integration tests.

The binaries and generated stubs come from the environment that CMake sets: RMLCELL_BIN, RMLCELL_STUBS.
"""
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from command import BIN, ask

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("RMLCELL_SHARED", ROOT.parent / "shared"))
sys.path.insert(0, os.environ["RMLCELL_STUBS"])

import grpc  # noqa: E402
from google.rpc import status_pb2  # noqa: E402
from rmlcell.v1 import (  # noqa: E402
    cell_pb2,
    cell_pb2_grpc,
    common_pb2,
    job_pb2,
    job_pb2_grpc,
    machine_pb2,
    machine_pb2_grpc,
    machine_status_pb2,
    program_pb2,
    program_pb2_grpc,
    project_pb2,
    project_pb2_grpc,
)

OPTIONS = [("grpc.max_receive_message_length", -1), ("grpc.max_send_message_length", -1)]


COMPLETED = 1
FAILED = 3


def free_port():
    """A port that nobody else is given while this socket is there: a server listens on it, and the next one, too."""
    port = socket.socket()
    port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    port.bind(("127.0.0.1", 0))
    return port


class Cell:
    """One server. Its state and its ports survive stop() and kill() until close()."""

    def __init__(self, *flags, workers=2):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rmlcell-"))
        self.flags = list(flags)
        self.workers = workers
        self.process = None
        # The same ports again after a restart, as a real server has.
        self.ports = [free_port(), free_port()]
        self.grpc_port, self.web_port = (port.getsockname()[1] for port in self.ports)

    def start(self):
        log = self.folder / "log"
        log.write_text("")
        # A process for each machine, for those who look at machines that live.
        hosts = [] if "--machines.hosts" in self.flags else ["--machines.hosts", "enabled"]
        paced = [] if "--workers.paced" in self.flags else ["--workers.paced", str(self.workers)]
        self.process = subprocess.Popen(
            [BIN / "rmlcelld", "--state.directory", self.folder / "store",
             "--listen.grpc", f"127.0.0.1:{self.grpc_port}", "--listen.web", f"127.0.0.1:{self.web_port}",
             "--workers.count", str(self.workers), *paced, *hosts, "--log.file", log, "--log.level", "debug", *self.flags])
        until = time.monotonic() + 60
        while "is ready" not in log.read_text(errors="replace"):
            if self.process.poll() is not None or time.monotonic() > until:
                raise RuntimeError("the server did not start:\n" + log.read_text(errors="replace")[-3000:])
            time.sleep(0.02)
        return self

    @property
    def address(self):
        return f"127.0.0.1:{self.grpc_port}"

    def channel(self):
        return grpc.insecure_channel(self.address, OPTIONS)

    def log(self):
        return (self.folder / "log").read_text(errors="replace")

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout=60)

    def close(self):
        if self.process is not None and self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(timeout=60)
            except subprocess.TimeoutExpired:
                self.process.kill()
        for port in self.ports:
            port.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def worker_processes(self):
        """Process ids of this server's workers."""
        found = []
        for entry in pathlib.Path("/proc").iterdir():
            try:
                if entry.name.isdigit() and int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1]) == self.process.pid:
                    found.append(int(entry.name))
            except (OSError, IndexError, ValueError):
                pass
        return found

    # --- shorthands -----------------------------------------------------------------------------------
    def cell_service(self):
        return cell_pb2_grpc.CellServiceStub(self.channel())

    def jobs(self):
        return job_pb2_grpc.JobServiceStub(self.channel())

    def programs(self):
        return program_pb2_grpc.ProgramServiceStub(self.channel())

    def machines(self):
        return machine_pb2_grpc.MachineServiceStub(self.channel())

    def projects(self):
        return project_pb2_grpc.ProjectServiceStub(self.channel())

    def command(self, *words, check=True):
        done = ask(*words, server=self.address)
        if check and done.returncode != 0:
            raise AssertionError(f"rmlcell {words} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
        return done


class WithCell(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell().start()
        cls.addClassCleanup(cls.cell.close)

    def refused(self, call, request, code, our_code):
        with self.assertRaises(grpc.RpcError) as caught:
            call(request, timeout=60)
        self.assertEqual(caught.exception.code(), code, caught.exception.details())
        detail = detail_of(caught.exception)
        self.assertIsNotNone(detail, "no ErrorDetail")
        self.assertEqual(detail.code, our_code)
        return detail


def inline_job(machine, file_name, content, kind=job_pb2.JOB_KIND_SIMULATE, **more):
    job = job_pb2.Job(kind=kind, machine=f"machines/{machine}", **more)
    job.inline_program.file_name = file_name
    job.inline_program.content = content if isinstance(content, bytes) else content.encode()
    return job


def endless_job(machine="optimo-1"):
    """Runs until somebody ends it: it waits in real time."""
    job = inline_job(machine, "endless.S", "10 DELAY 1\nGOTO 10\n")
    job.simulation.pace = 1.0
    return job


def submit(stub, job, request_id=""):
    return stub.SubmitJob(job_pb2.SubmitJobRequest(job=job, request_id=request_id), timeout=60)


def wait_for_end(stub, name, seconds=300):
    """Events of the job up to its end, in order."""
    events = []
    for message in stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=name, events_only=True), timeout=seconds):
        if message.HasField("event"):
            events.append(message.event)
    return events


def eventually(holds, seconds=60):
    """What `holds` says as soon as it is true; only a failing test waits so long."""
    until = time.monotonic() + seconds
    while not (answer := holds()) and time.monotonic() < until:
        time.sleep(0.02)
    return answer


def awaited(holds, seconds=60):
    """What `holds` says as soon as it is true. Where it never is, the test fails."""
    answer = eventually(holds, seconds)
    assert answer, "it never came"
    return answer


def wait_until_it_runs(stub, name):
    def runs():
        job = stub.GetJob(job_pb2.GetJobRequest(name=name))
        assert job.state in (job_pb2.Job.STATE_QUEUED, job_pb2.Job.STATE_RUNNING), job
        return job.state == job_pb2.Job.STATE_RUNNING
    assert eventually(runs), f"{name} does not run"


def wait_until_an_attempt_counts(stub, name, behind=0):
    """The first attempt behind this one of which its worker has told; 0: the job has ended. A worker that dies before that has
    begun nothing, and the job is tried again as if it had not been tried."""
    for message in stub.WatchJob(job_pb2.WatchJobRequest(name=name), timeout=300):
        if message.HasField("progress") and message.progress.attempt > behind:
            return message.progress.attempt
    return 0


def processor_ticks(process):
    """Of its threads, those that are over too; a hundred a second."""
    stat = pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    return sum(int(ticks) for ticks in stat.rsplit(")", 1)[1].split()[11:13])


def times_awake(process):
    """How often its first thread has gone to sleep."""
    status = pathlib.Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    return int(re.search(r"^voluntary_ctxt_switches:\s*(\d+)", status, re.M).group(1))


def detail_of(error):
    """Our ErrorDetail of a refused call."""
    rich = status_pb2.Status()
    for key, value in error.trailing_metadata() or ():
        if key == "grpc-status-details-bin":
            rich.ParseFromString(value)
    for any_detail in rich.details:
        detail = common_pb2.ErrorDetail()
        if any_detail.Is(detail.DESCRIPTOR):
            any_detail.Unpack(detail)
            return detail
    return None


SQUARE = "PA;PA;VS8;!VZ4;!PZ0,200;!MC1;PU1000,1000;Z1000,1000,-50;Z2000,1000,-50;Z2000,2000,-50;PU0,0;H;"
# Runs for as long as its budget lets it, in zero virtual time.
ENDLESS = "10 VI[2] = VI[3]\nGOTO 10\n"
# Much virtual time and many steps: about a second of a worker's time for each 100,000 rounds.
LONG = "COORD ABSOL\nPATH LIN\nSPEED 20\nVR[0] = 0.\n10 MOVE (1000. + VR[1], 1000., -400., 0., 0.)\n" \
       "MOVE (1010., 1000., -400., 0., 0.)\nVR[0] = VR[0] + 1.\nIF VR[0] < {rounds}. THEN 10\n"
