"""Machines that live, for the tests of them."""
import os
import pathlib
import signal
import unittest
import uuid

from cell import Cell, detail_of, eventually, grpc, machine_pb2, program_pb2
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

    def wait(self, state, patience=30):
        return eventually(lambda: (lambda now: now if MachineState.Name(now.state) == "MACHINE_STATE_" + state
                                   else None)(self.status()), patience)

    def host(self):
        return int(self.status().host.split("/")[1])


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

    def refused(self, code, method, **fields):
        with self.assertRaises(grpc.RpcError) as caught:
            self.live.ask(method, **fields)
        self.assertEqual(detail_of(caught.exception).code, code)
        return caught.exception
