#!/usr/bin/env python3
"""The log of a server: nothing waits for whoever reads it, but what is written there."""
import contextlib
import os
import subprocess
import unittest

from cell import BIN, Cell, machine_pb2


class Log(unittest.TestCase):
    def test_one_that_nobody_reads_keeps_no_server_from_stopping(self):
        cell = Cell()
        self.addCleanup(cell.close)
        pipe = cell.folder / "pipe"
        os.mkfifo(pipe)
        full = os.open(pipe, os.O_RDWR | os.O_NONBLOCK)
        self.addCleanup(os.close, full)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(full, b"." * 4096)
        cell.process = subprocess.Popen(
            [BIN / "rmlcelld", "--state.directory", cell.folder / "store", "--listen.grpc", cell.address, "--listen.web", "",
             "--machines.hosts", "enabled", "--workers.count", "0", "--shutdown.timeout_s", "1", "--log.file", pipe])
        # It says nowhere that it is ready.
        cell.machines().ListMachines(machine_pb2.ListMachinesRequest(), wait_for_ready=True, timeout=60)
        self.assertEqual(cell.stop(), 0)


if __name__ == "__main__":
    unittest.main()
