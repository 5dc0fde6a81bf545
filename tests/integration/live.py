"""Machines that live, for the tests of them."""
import contextlib
import os
import pathlib
import signal
import sqlite3
import struct
import unittest
import uuid

from cell import Cell, awaited, cell_pb2, detail_of, eventually, grpc, job_pb2, machine_pb2, program_pb2, project_pb2
from rmlcell.v1 import host_pb2  # noqa: E402
from rmlcell.v1 import machine_control_pb2 as control  # noqa: E402
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402
from rmlcell.v1.machine_status_pb2 import HoldReason  # noqa: E402

MILL = "machines/mill-1"
# 80 mm at 1 mm/s.
SQUARE = "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;PD3000,1000,3000,3000,1000,3000,1000,1000;PU0,0;"


def new_id():
    return str(uuid.uuid4())


def passes(refused):
    """Whether it was refused for the moment alone: the host is silent, or its disk is late."""
    detail = detail_of(refused)
    return detail is not None and (detail.code == "CELL-E9429" or
                                   (detail.code == "CELL-E9424" and detail.message.endswith("its host is silent")))


def is_unheard(refused):
    """Whether it was refused since nobody hears its host: that is late, and is heard again, or its next one is."""
    detail = detail_of(refused)
    return detail is not None and detail.code == "CELL-E9424" and detail.message.endswith((
        "its host is not heard of", "its host is not heard of any more", "its host does not answer", "whether it halts is not known"))


def asked(call, request):
    """Its answer. LIVE-2.10, LIVE-3.21: what begins something is refused while nobody hears its host, or the disk is late, and the
    same request is taken a moment later; one that acts already is answered with what came of it."""
    def answer():
        try:
            return call(request)
        except grpc.RpcError as refused:
            if not passes(refused) and not is_unheard(refused):
                raise
            return None
    return awaited(answer)


class Live:
    """A machine that is enabled, with control of it."""

    def __init__(self, test, cell, machine=MILL):
        self.test, self.cell, self.machine, self.token = test, cell, machine, ""

    @property
    def stub(self):
        return self.cell.machines()

    def ask(self, method, **fields):
        request = method + "Request"
        made = getattr(control, request, None) or getattr(machine_pb2, request)
        names = made.DESCRIPTOR.fields_by_name
        if "control_token" in names:
            fields.setdefault("control_token", self.token)
        if "request_id" in names:
            fields.setdefault("request_id", new_id())
        call, message = getattr(self.stub, method), made(machine=self.machine, **fields)
        # A key that was refused has used up its number, and is refused again.
        return call(message) if "sequence" in names else asked(call, message)

    def enable(self):
        """How it stands, once it lives: the server waits for its host, but not for ever."""
        def lives():
            now = self.ask("EnableMachine")
            return None if MachineState.Name(now.state) in ("MACHINE_STATE_STARTING", "MACHINE_STATE_RECOVERING") else now
        return awaited(lives)

    def acquire(self, **fields):
        fields.setdefault("on_loss", 2)
        fields.setdefault("ttl", {"seconds": 60})  # as long as it may be: whoever asks may be late
        self.token = self.ask("AcquireControl", client="a test", **fields).control_token
        return self.token

    def store(self, slot=5, text=SQUARE, file_name="a.rml"):
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=f"{self.machine}/programs/{slot}",
            program={"file_name": file_name, "content": text.encode()}))

    def status(self):
        # A channel that found no server at first does not try again at once.
        return self.stub.GetMachine(machine_pb2.GetMachineRequest(name=self.machine), wait_for_ready=True, timeout=60).status

    def wait(self, state, patience=60):
        """Its status in this state; where it never comes to that, the test fails."""
        found = eventually(lambda: (lambda now: now if MachineState.Name(now.state) == "MACHINE_STATE_" + state
                                    else None)(self.status()), patience)
        if not found:
            self.test.fail(f"{self.machine} does not come to {state}: {self.status()}")
        return found

    def later(self, status, seconds=0.3):
        """How it stands when so much of its own time has gone by: what would have moved has moved. Not while its host is silent,
        which says nothing of how it stands."""
        def is_later(now):
            return now.state != MachineState.Value("MACHINE_STATE_LOST") and (
                now.fence != status.fence or now.virtual_time_ns >= status.virtual_time_ns + seconds * 1e9)
        return awaited(lambda: (lambda now: now if is_later(now) else None)(self.status()))

    def host(self):
        return int(self.status().host.split("/")[1])

    def disable(self):
        """Until the log has all that its host had to tell: that is stored before the store takes the machine back, which may be a
        moment behind the answer."""
        self.ask("DisableMachine")

        def is_given_back():
            with contextlib.closing(sqlite3.connect(self.cell.folder / "store" / "cell.db", timeout=60)) as store:
                return not store.execute("SELECT 1 FROM machine_lock WHERE machine = ?", (self.machine.split("/")[1],)).fetchall()
        awaited(is_given_back)

    def may_be_late(self, seconds):
        """Its host, by so much, before it holds what it moves. Before it lives."""
        self.stub.UpdateMachine(machine_pb2.UpdateMachineRequest(
            machine={"name": self.machine, "options": {"late_hold": {"seconds": seconds}}}, update_mask={"paths": ["options"]}))

    # --- what its host has on the disk ------------------------------------------------------------------
    def kept(self, suffix):
        return self.cell.folder / "store" / "hosts" / (self.machine.split("/")[1] + suffix)

    def journal(self):
        """The entries of the journal that are whole: each is its length, a checksum, and the entry."""
        data, entries, at = self.kept(".journal").read_bytes(), [], 0
        while at + 8 <= len(data):
            length = struct.unpack_from("<I", data, at)[0]
            if at + 8 + length > len(data):
                break
            entries.append(host_pb2.JournalEntry.FromString(data[at + 8:at + 8 + length]))
            at += 8 + length
        return entries

    def newest_mark(self):
        """Where a host that dies now is taken back to; nothing: there is no mark yet."""
        return next((one.mark for one in reversed(self.journal()) if one.HasField("mark")), None)

    def wait_until_held_by_itself(self, reason):
        """That is on the disk of the host, whether a server hears of it or not."""
        awaited(lambda: any(one.event.HasField("halted") and one.event.halted.reason == reason for one in self.journal()))

    def kill_host(self):
        """As it stands. Returns the newest mark that it has written: what comes next stands there."""
        process = self.host()
        os.kill(process, signal.SIGSTOP)
        awaited(lambda: stopped(process))
        mark = self.newest_mark()
        os.kill(process, signal.SIGKILL)
        return mark


def wall_ns(stamp):
    return stamp.seconds * 10**9 + stamp.nanos


def stopped(process):
    """No thread of it does anything until it is let go on."""
    try:
        states = [pathlib.Path(f"/proc/{process}/task/{task}/stat").read_text().rsplit(")", 1)[1].split()[0]
                  for task in os.listdir(f"/proc/{process}/task")]
    except (FileNotFoundError, ProcessLookupError):
        return False  # a thread that was about to end has ended meanwhile
    return set(states) == {"T"}


def hosts_of(cell):
    """Processes of its machines."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            words = pathlib.Path(f"/proc/{entry}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"--host" in words and any(str(cell.folder).encode() in word for word in words):
            found.append(int(entry))
    return found


def end_hosts(cell):
    for process in hosts_of(cell):
        with contextlib.suppress(ProcessLookupError):  # it was about to end by itself
            os.kill(process, signal.SIGKILL)


class LiveTestCase(unittest.TestCase):
    """A server with a machine that may live; its host ends with the test."""

    def setUp(self):
        self.cell = Cell(workers=1)
        self.cell.start()
        self.live = Live(self, self.cell)
        self.addCleanup(self.end_host)  # last: a server that is there starts another one
        self.addCleanup(self.cell.close)
        for machine in (MILL, "machines/optimo-1"):
            Live(self, self.cell, machine).may_be_late(60)  # its computer may be busy

    def end_host(self):
        end_hosts(self.cell)

    def hosts(self):
        return hosts_of(self.cell)

    def let_go_on(self, job):
        """LIVE-3.21, LIVE-3.31: a host whose disk is late, or that hears no server, holds what it moves. As a person would, where
        this job is held so."""
        machine = self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=job)).machine
        status = Live(self, self.cell, machine).status()
        by_itself = ("HOLD_REASON_LATE", "HOLD_REASON_SERVER_LOST")
        if status.run.job == job and HoldReason.Name(status.hold_reason) in by_itself:
            with contextlib.suppress(grpc.RpcError):  # it is otherwise by now: whoever asks looks again
                self.cell.jobs().ResumeJob(job_pb2.ResumeJobRequest(name=job, request_id=new_id()))

    def log(self):
        """All that the log of the cell tells, up to a mark that is set now."""
        self.marks_in_log = getattr(self, "marks_in_log", 0) + 1
        mark = f"projects/mark-{self.marks_in_log}"
        self.cell.projects().CreateProject(project_pb2.CreateProjectRequest(project_id=mark.split("/")[1], project={}))
        events = []
        for message in self.cell.cell_service().WatchCell(cell_pb2.WatchCellRequest(after_sequence=0), timeout=120):
            if message.HasField("event"):
                events.append(message.event)
                if message.event.resource == mark:
                    return events
        self.fail("the log ends")

    def log_of_machines(self):
        return [one.machine for one in self.log() if one.HasField("machine")]

    def refused(self, code, method, **fields):
        with self.assertRaises(grpc.RpcError) as caught:
            self.live.ask(method, **fields)
        self.assertEqual(detail_of(caught.exception).code, code)
        return caught.exception
