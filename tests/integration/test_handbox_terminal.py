#!/usr/bin/env python3
"""`rmlcell handbox` on a terminal: keys and mouse, what holds a key down, and how it all ends (LIVE-7.11)."""
import os
import signal
import subprocess
import termios
import threading
import unittest

from cell import BIN, awaited, eventually, grpc
from live import Live, LiveTestCase
from pty_screen import Terminal
from rmlcell.v1 import handbox_pb2, handbox_pb2_grpc  # noqa: E402
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402
from rmlcell.v1.machine_control_pb2 import KeyAction  # noqa: E402

OPTIMO = "machines/optimo-1"
TO_MANUAL = "(((("
MOUSE_UP = "\x1b[<0;1;1m"


class HandboxTerminalTest(LiveTestCase):
    def setUp(self):
        super().setUp()
        self.optimo = Live(self, self.cell, OPTIMO)
        self.optimo.enable()
        self.optimo.wait("IDLE")

    def terminal(self, *words, rows=24, columns=80):
        made = Terminal(rows, columns).start("handbox", "optimo-1", "--server", self.cell.address, *words)
        self.addCleanup(made.end)
        return made

    def in_manual(self):
        terminal = self.terminal()
        self.assertTrue(terminal.shows("s START"), terminal.text())

        def is_turned():
            terminal.type(TO_MANUAL)  # it goes no further than that
            return eventually(lambda: " MANUAL  override" in terminal.text(), 5)
        # A key is refused while the disk of the host is late: then it is turned again.
        self.assertTrue(eventually(is_turned), terminal.text())
        return terminal

    def x(self):
        return self.optimo.status().axes[0].value

    def state(self):
        return MachineState.Name(self.optimo.status().state).removeprefix("MACHINE_STATE_")

    def assert_jogs(self, terminal, button, holds=lambda: True):
        """With the mouse down on that key, and so that all of it holds."""
        def jogs():
            terminal.mouse(button, True)
            # A terminal of a busy machine may answer too late, and it is let go: then it is pressed again.
            if eventually(lambda: self.state() == "JOGGING", 5) and holds():
                return True
            terminal.type(MOUSE_UP)
            self.optimo.wait("IDLE")
            self.assertTrue(terminal.shows(button), terminal.text())
            return False
        self.assertTrue(eventually(jogs, 120), terminal.text())

    def assert_stands(self):
        status = self.optimo.wait("IDLE")
        self.assertEqual(list(self.optimo.later(status).axes), list(status.axes))

    def assert_let_go(self, key):
        """It stands since the key went up, long before control would have run out (LIVE-7.05), and not at the end of its way."""
        self.assert_stands()

        def inputs():
            """Of the key and of control, since it was pressed, in the order in which they acted."""
            told = [one.input_applied.input for one in self.log_of_machines() if one.HasField("input_applied")]
            told = [one for one in told if one.HasField("control") or one.key.key == "HANDBOX " + key]
            pressed = [number for number, one in enumerate(told) if one.key.action == KeyAction.Value("KEY_ACTION_PRESS")]
            # It is told behind what is seen of it.
            return told[pressed[-1] + 1:] if pressed and told[pressed[-1] + 1:] else None
        first = awaited(inputs)[0]
        self.assertEqual(KeyAction.Name(first.key.action), "KEY_ACTION_RELEASE", first)

    def assert_given_back(self, terminal, code):
        """The terminal is as it was, and anybody may have control."""
        self.assertEqual(terminal.process.wait(timeout=60), code, terminal.text())
        self.assertEqual(termios.tcgetattr(terminal.slave), terminal.before)
        self.assertTrue(eventually(lambda: not terminal.modes - {25}), terminal.modes)  # 25: the cursor is seen
        self.assertIn(25, terminal.modes)
        for mode in ("1049", "1000", "1006", "1004", "2004"):
            self.assertEqual(terminal.seen.count(f"\x1b[?{mode}h".encode()), 1)
            self.assertEqual(terminal.seen.count(f"\x1b[?{mode}l".encode()), 1)
        self.assertTrue(eventually(self.may_acquire), "control is not given back")

    def message_of_handbox(self):
        stub = handbox_pb2_grpc.HandboxServiceStub(self.cell.channel())
        return next(stub.WatchHandbox(handbox_pb2.WatchHandboxRequest(machine=OPTIMO), timeout=60)).panel.message_code

    def may_acquire(self):
        try:
            return self.optimo.acquire()
        except grpc.RpcError:
            return None

    # LIVE-7.11
    def test_keys_are_typed_and_the_display_is_seen(self):
        terminal = self.in_manual()
        self.assertIn("(rmlcell handbox)", terminal.text())
        terminal.type("j")
        self.assertTrue(terminal.shows("T=0 M=0"), terminal.text())
        terminal.type("12\r")
        self.assertTrue(terminal.shows("P=12"), terminal.text())
        terminal.mouse("j JOB", True)
        terminal.mouse("j JOB", False)
        terminal.type("45")
        terminal.mouse("Ent ENT", True)
        terminal.mouse("Ent ENT", False)
        self.assertTrue(terminal.shows("P=45"), terminal.text())
        terminal.type("P")  # PAR has no function
        self.assertTrue(terminal.shows("PAR: OPT-E7601"), terminal.text())
        terminal.type("\t")
        self.assertTrue(terminal.shows("Tab*SHIFT"), terminal.text())
        terminal.type("q")
        self.assert_given_back(terminal, 0)

    # LIVE-7.11, LIVE-7.05: down and up are told.
    def test_the_mouse_holds_a_key(self):
        terminal = self.in_manual()
        shown = terminal.lines()[6]
        begin = self.x()
        self.assert_jogs(terminal, "x X+", lambda: eventually(
            lambda: "x>X+" in terminal.text() and " JOGGING " in terminal.text() and abs(self.x() - begin) > 0.5
            and terminal.lines()[6] != shown, 5))
        terminal.type(MOUSE_UP)
        self.assert_stands()
        self.assertTrue(terminal.shows("x X+"), terminal.text())
        terminal.type("\x03")
        self.assert_given_back(terminal, 0)

    # LIVE-7.05: a line that is cut tells of no release.
    def test_a_terminal_that_does_not_answer_holds_nothing(self):
        terminal = self.in_manual()
        terminal.answers = False
        terminal.mouse("X X-", True)
        self.assertTrue(terminal.shows("the terminal did not answer"), terminal.text())
        self.assert_let_go("X-")
        terminal.type("q")
        self.assert_given_back(terminal, 0)

    # LIVE-7.11: a tap moves nothing; what repeats is held, and is not when it repeats no more.
    def test_a_key_that_repeats_is_held(self):
        terminal = self.in_manual()
        begin = self.x()
        terminal.type("xP")  # keys go one behind the other
        self.assertTrue(terminal.shows("PAR: OPT-E7601"), terminal.text())
        self.assert_stands()
        self.assertEqual(self.x(), begin)

        up = threading.Event()

        def repeats():
            while not up.wait(0.03):
                terminal.type("x")
        finger = threading.Thread(target=repeats)
        finger.start()
        moved = eventually(lambda: abs(self.x() - begin) > 0.5)
        up.set()
        finger.join()
        self.assertTrue(moved, terminal.text())
        self.assert_let_go("X+")
        terminal.type("q")
        self.assert_given_back(terminal, 0)

    # LIVE-7.11, LIVE-7.05
    def test_killed_with_a_key_down(self):
        terminal = self.in_manual()
        self.assert_jogs(terminal, "y Y+")
        (inner,) = terminal.inner()
        os.kill(inner, signal.SIGKILL)
        self.assert_let_go("Y+")
        self.assert_given_back(terminal, 3)
        self.assertTrue(eventually(lambda: b"killed by signal 9" in terminal.seen), terminal.seen[-300:])

    # LIVE-7.11: the other one of the two processes.
    def test_who_waits_is_killed_with_a_key_down(self):
        terminal = self.in_manual()
        self.assert_jogs(terminal, "Y Y-")
        (inner,) = terminal.inner()
        os.kill(terminal.process.pid, signal.SIGKILL)
        self.assert_let_go("Y-")
        self.assertTrue(eventually(lambda: not os.path.exists(f"/proc/{inner}")))
        self.assert_given_back(terminal, -signal.SIGKILL)

    # LIVE-7.05: no beat comes of one that is stopped.
    def test_stopped_with_a_key_down(self):
        terminal = self.in_manual()
        self.assert_jogs(terminal, "x X+")
        (inner,) = terminal.inner()
        os.kill(inner, signal.SIGSTOP)
        self.assert_let_go("X+")
        os.kill(inner, signal.SIGCONT)
        terminal.type(MOUSE_UP + "q")
        self.assert_given_back(terminal, 0)

    # LIVE-7.11
    def test_orders_to_end(self):
        for order in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
            with self.subTest(order=order):
                terminal = self.in_manual()
                self.assert_jogs(terminal, "x X+")
                terminal.process.send_signal(order)
                self.assert_stands()
                self.assert_given_back(terminal, 0)
                self.optimo.ask("ReleaseControl")

    # LIVE-7.11
    def test_a_server_that_goes(self):
        terminal = self.in_manual()
        self.assert_jogs(terminal, "x X+")
        self.cell.kill()
        self.assertEqual(terminal.process.wait(timeout=60), 3, terminal.text())
        self.cell.start()
        self.assertTrue(eventually(lambda: self.optimo.status().axes))  # its host is heard of again
        self.assert_stands()
        self.assert_given_back(terminal, 3)
        self.assertTrue(eventually(lambda: b"rmlcell: " in terminal.seen.split(b"\x1b[?1049l")[-1]), terminal.seen[-300:])

    # LIVE-4.03
    def test_control_is_taken_over(self):
        terminal = self.in_manual()
        taker = self.terminal("--take-over", "shift change")
        self.assertTrue(taker.shows("s START"), taker.text())
        terminal.type("e")
        self.assert_ended(terminal)
        taker.type("q")
        self.assert_given_back(taker, 0)

    def assert_ended(self, terminal):
        self.assertNotEqual(terminal.process.wait(timeout=60), 0)
        self.assertEqual(termios.tcgetattr(terminal.slave), terminal.before)
        self.assertTrue(eventually(lambda: 1049 not in terminal.modes))

    # LIVE-7.11
    def test_a_terminal_that_is_too_small(self):
        terminal = self.terminal(rows=20, columns=70)
        self.assertTrue(terminal.shows("too small: 70 x 20"), terminal.text())
        terminal.type(TO_MANUAL + " ")  # STOP is heard, and refused in REMOTE
        self.assertTrue(eventually(self.message_of_handbox))
        terminal.resize(24, 80)
        self.assertTrue(terminal.shows("s START"), terminal.text())
        terminal.type("P")
        self.assertTrue(terminal.shows("PAR: OPT-E7601"), terminal.text())
        terminal.type("q")
        self.assertEqual(terminal.process.wait(timeout=60), 0)
        self.assertIn(" REMOTE  override", terminal.text())  # nobody saw the keys before: they did nothing

    def command(self, *words):
        return subprocess.run([os.path.join(BIN, "rmlcell"), "handbox", *words, "--server", self.cell.address],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)

    # LIVE-7.11
    def test_needs_a_terminal_and_a_machine_with_a_handbox(self):
        refused = self.command("optimo-1")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("no terminal", refused.stderr)
        self.live.enable()
        mill = Terminal().start("handbox", "mill-1", "--server", self.cell.address)
        self.addCleanup(mill.end)
        self.assertEqual(mill.process.wait(timeout=60), 3)
        self.assertTrue(eventually(lambda: b"has no handbox" in mill.seen), mill.seen)
        self.assertNotIn(b"1049", mill.seen)


if __name__ == "__main__":
    unittest.main()
