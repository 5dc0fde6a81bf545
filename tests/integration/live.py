"""Machines that live, for the tests of them."""
import os
import pathlib
import signal
import struct
import unittest
import uuid

from cell import Cell, awaited, cell_pb2, detail_of, eventually, grpc, machine_pb2, program_pb2, project_pb2
from rmlcell.v1 import host_pb2  # noqa: E402
from rmlcell.v1 import machine_control_pb2 as control  # noqa: E402
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402

MILL = "machines/mill-1"
# 80 mm at 1 mm/s.
SQUARE = "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;PD3000,1000,3000,3000,1000,3000,1000,1000;PU0,0;"


def new_id():
    return str(uuid.uuid4())


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
        return getattr(self.stub, method)(made(machine=self.machine, **fields))

    def enable(self):
        return self.ask("EnableMachine")

    def acquire(self, **fields):
        fields.setdefault("on_loss", 2)
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
        """How it stands when so much of its own time has gone by: what would have moved has moved."""
        return awaited(lambda: (lambda now: now if now.fence != status.fence
                                or now.virtual_time_ns >= status.virtual_time_ns + seconds * 1e9 else None)(self.status()))

    def host(self):
        return int(self.status().host.split("/")[1])

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
    states = [pathlib.Path(f"/proc/{process}/task/{task}/stat").read_text().rsplit(")", 1)[1].split()[0]
              for task in os.listdir(f"/proc/{process}/task")]
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


class LiveTestCase(unittest.TestCase):
    """A server with a machine that may live; its host ends with the test."""

    def setUp(self):
        self.cell = Cell(workers=1)
        self.cell.start()
        self.live = Live(self, self.cell)
        self.addCleanup(self.end_host)  # last: a server that is there starts another one
        self.addCleanup(self.cell.close)

    def end_host(self):
        for process in self.hosts():
            os.kill(process, signal.SIGKILL)

    def hosts(self):
        return hosts_of(self.cell)

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
