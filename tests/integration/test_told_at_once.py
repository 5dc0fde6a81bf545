"""What is watched through a pipe is told when it happens, not when a buffer is full."""
import os
import subprocess
import threading
import unittest

from cell import BIN, eventually
from told_machine import ToldMachine


class ToldAtOnce(unittest.TestCase):
    def setUp(self):
        self.machine = ToldMachine()
        self.addCleanup(self.machine.close)

    def lines_of(self, *words):
        """Those that came so far, of a command that goes on."""
        process = subprocess.Popen([os.path.join(BIN, "rmlcell"), *words, "--server", self.machine.address],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        lines = []
        reader = threading.Thread(target=lambda: lines.extend(iter(process.stdout.readline, "")), daemon=True)
        reader.start()
        self.addCleanup(process.stdout.close)
        self.addCleanup(reader.join)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return lines

    def test_how_a_machine_stands(self):
        for words, told in (((), "RUNNING\n"), (("--json",), '"state":"MACHINE_STATE_RUNNING"')):
            with self.subTest(words):
                self.machine.is_now(state="MACHINE_STATE_IDLE")
                lines = self.lines_of("machine", "watch", "m", *words)
                self.assertTrue(eventually(lambda: len(lines) == 1), lines)
                self.machine.is_now(state="MACHINE_STATE_RUNNING")
                self.assertTrue(eventually(lambda: len(lines) == 2), lines)
                self.assertIn(told, lines[1])

    def test_what_happens_to_a_job(self):
        self.machine.say("WatchJob", {"sequence": "1", "event": {"sequence": "1", "message": {"text": "one"}}})
        lines = self.lines_of("watch", "17")
        self.assertTrue(eventually(lambda: lines == ["#1  one\n"]), lines)
        self.machine.say("WatchJob", {"sequence": "2", "event": {"sequence": "2", "message": {"text": "two"}}})
        self.assertTrue(eventually(lambda: lines[1:] == ["#2  two\n"]), lines)

    def test_what_happens_at_a_machine(self):
        self.machine.is_now()
        event = {"caller": "anna", "machine": {"inputApplied": {"input": {"power": True}}}}
        self.machine.say("WatchCell", {"sequence": "1", "event": event})
        lines = self.lines_of("machine", "log", "m", "--follow")
        self.assertTrue(eventually(lambda: len(lines) == 1), lines)
        self.assertIn("  anna: power on", lines[0])


if __name__ == "__main__":
    unittest.main()
