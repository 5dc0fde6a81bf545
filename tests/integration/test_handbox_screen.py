"""What `rmlcell handbox` makes of what a machine says and a hand does, with a machine that is what it is told to."""
import fcntl
import itertools
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import time
import unittest

from cell import BIN, eventually, grpc, times_awake
from live import stopped
from pty_screen import Terminal
from told_machine import ToldMachine

# A shell: what it runs has the terminal, until it is told on its first argument to take that back.
SHELL = """
import os, signal, subprocess, sys

def take():
    before = signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    os.tcsetpgrp(0, os.getpgrp())
    signal.signal(signal.SIGTTOU, before)

def begin():
    os.setpgrp()
    take()

job = subprocess.Popen(sys.argv[2:], preexec_fn=begin)
os.read(int(sys.argv[1]), 1)
take()
sys.exit(job.wait())
"""


class HandboxScreenTest(unittest.TestCase):
    def setUp(self):
        self.machine = ToldMachine()
        self.addCleanup(self.machine.close)

    def terminal(self, *words, **more):
        made = Terminal(**more).start("handbox", "m", "--server", self.machine.address, *words)
        self.addCleanup(made.end)
        return made

    def on_screen(self, display="READY", **fields):
        self.machine.is_now()
        self.machine.shows(display, **fields)
        terminal = self.terminal()
        self.assertTrue(terminal.shows(display), terminal.text())
        return terminal

    def assert_told(self, terminal, text):
        """Where the terminal is as it was before."""
        self.assertTrue(eventually(lambda: text in terminal.seen.split(b"\x1b[?1049l")[-1]), terminal.seen[-300:])

    def assert_ended(self, terminal, code):
        self.assertEqual(terminal.process.wait(timeout=60), code, terminal.text())
        self.assertEqual(termios.tcgetattr(terminal.slave), terminal.before)

    # LIVE-7.11, LIVE-4.03: control for longer than it takes to notice that it is lost; all of it is given back.
    def test_control_and_a_session_are_taken_and_given_back(self):
        terminal = self.on_screen()
        self.assertTrue(eventually(lambda: self.machine.all_of("RenewControl")))
        terminal.type("q")
        self.assert_ended(terminal, 0)
        (taken,) = self.machine.all_of("AcquireControl")
        self.assertEqual(len(taken.pop("requestId")), 32)
        self.assertEqual(taken, {"machine": "machines/m", "ttl": "9s", "onLoss": "ON_LOSS_GO_ON", "client": "rmlcell handbox"})
        self.assertEqual(self.machine.all_of("CreateHandboxSession"), [{"machine": "machines/m", "controlToken": "t"}])
        self.assertEqual(self.machine.all_of("WatchHandbox"), [{"machine": "machines/m"}])
        self.assertEqual(self.machine.all_of("WatchMachine"), [{"name": "machines/m", "maxRateHz": 10.0}])
        self.assertEqual(self.machine.all_of("RenewControl")[0], {"machine": "machines/m", "controlToken": "t"})
        self.assertEqual(self.machine.all_of("DeleteHandboxSession"), [{"name": "machines/m/handboxSessions/1"}])
        self.assertEqual(self.machine.all_of("ReleaseControl"), [{"machine": "machines/m", "controlToken": "t"}])
        told = [name for name, _ in self.machine.asked]
        self.assertLess(told.index("DeleteHandboxSession"), told.index("ReleaseControl"))

    def test_it_is_taken_over_for_a_reason(self):
        self.machine.is_now()
        self.machine.shows("READY")
        terminal = self.terminal("--take-over", "shift change")
        self.assertTrue(terminal.shows("READY"), terminal.text())
        terminal.type("\x03")
        self.assert_ended(terminal, 0)
        (taken,) = self.machine.all_of("AcquireControl")
        self.assertEqual((taken["takeOver"], taken["reason"]), (True, "shift change"))

    # The bell is rung for a beep that is heard, not for those of before nor with a panel that is dark.
    def test_a_beep_rings_once(self):
        self.machine.shows("BEFORE", beeps=5)
        before = self.terminal()
        self.assertTrue(eventually(lambda: self.machine.all_of("WatchHandbox")))
        self.machine.is_now(overridePercent=53.0)
        self.assertTrue(before.shows("BEFORE"), before.text())
        self.machine.is_now(overridePercent=54.0)
        self.assertTrue(before.shows("override 54 %"), before.text())
        self.assertNotIn(b"\a", before.seen)
        before.type("q")
        self.assert_ended(before, 0)
        terminal = self.on_screen(beeps=0)
        self.assertEqual(terminal.seen.count(b"\a"), 0)
        self.machine.shows("ONE", beeps=1)
        self.assertTrue(terminal.shows("ONE"), terminal.text())
        self.assertTrue(eventually(lambda: terminal.seen.count(b"\a") == 1))
        for display in ("TWO", "THREE"):
            self.machine.shows(display, beeps=1)
            self.assertTrue(terminal.shows(display), terminal.text())
        self.machine.shows("", beeps=0)
        self.assertTrue(eventually(lambda: "THREE" not in terminal.text()), terminal.text())
        self.machine.shows("AGAIN", beeps=7)
        self.assertTrue(terminal.shows("AGAIN"), terminal.text())
        self.machine.is_now(overridePercent=55.0)
        self.assertTrue(terminal.shows("override 55 %"), terminal.text())
        self.assertEqual(terminal.seen.count(b"\a"), 1)
        self.machine.shows("AGAIN", beeps=8)  # and nothing else is new
        self.assertTrue(eventually(lambda: terminal.seen.count(b"\a") == 2))
        self.machine.is_now(overridePercent=56.0)
        self.assertTrue(terminal.shows("override 56 %"), terminal.text())

    # What begins as a sequence of the terminal and does not go on is none: the next key is one.
    def test_a_lone_escape_is_given_up(self):
        terminal = self.on_screen()

        pauses = (0.5 * 2**number for number in itertools.count())  # longer where the machine is too busy to see them

        def pressed():
            terminal.type("\x1b")
            time.sleep(next(pauses))
            terminal.type("j")
            return eventually(self.machine.pressed, 2)
        self.assertTrue(eventually(pressed))
        self.assertIn("JOB TAP", self.machine.pressed())

    # A slow line holds up a part of one, for less than that.
    def test_a_sequence_may_come_in_parts(self):
        terminal = self.on_screen()
        row, column = terminal.place_of("x X+")

        def pressed():
            time.sleep(0.5)  # what was read before is too old to count
            terminal.type("\x1b")
            time.sleep(0.1)
            terminal.type(f"[<0;{column + 2};{row + 1}M")
            found = eventually(lambda: "X+ PRESS" in self.machine.pressed(), 2)
            terminal.type("\x1b[<0;1;1m")
            return found
        self.assertTrue(eventually(pressed), self.machine.pressed())

    # LIVE-7.04: what the machine says to a key stands there until another one is pressed, released ones apart.
    def test_what_a_machine_says_to_a_key(self):
        terminal = self.on_screen()
        self.machine.answers["PressKey"] = {"message": {"code": "OPT-E12", "message": "no such program"}}
        terminal.type("j")
        self.assertTrue(terminal.shows("  JOB: OPT-E12: no such program"), terminal.text())
        self.machine.answers["PressKey"] = {}
        terminal.type("7")
        self.assertTrue(eventually(lambda: "OPT-E12" not in terminal.text()), terminal.text())
        # From the press on, and not from the answer: the next one waits for that.
        self.assertTrue(eventually(lambda: "7 TAP" in self.machine.pressed()), self.machine.pressed())
        self.machine.refused["PressKey"] = (grpc.StatusCode.FAILED_PRECONDITION, "the door is open")
        terminal.mouse("x X+", True)
        self.assertTrue(terminal.shows("  X+: the door is open"), terminal.text())
        terminal.type("\x1b[<0;1;1m")
        self.assertTrue(eventually(lambda: self.machine.pressed() == "JOB TAP, 7 TAP, X+ PRESS, X+ RELEASE"),
                        self.machine.pressed())
        self.machine.is_now(overridePercent=56.0)
        self.assertTrue(terminal.shows("override 56 %"), terminal.text())
        self.assertIn("X+: the door is open", terminal.text())

    # LIVE-7.05: it is asked whether it is there while the mouse is down, and no longer.
    def test_who_holds_a_key_says_so_again_and_again(self):
        terminal = self.on_screen()
        self.assertNotIn(b"\x1b[5n", terminal.seen)
        row, column = terminal.place_of("y Y+")
        begin = time.monotonic()

        def times(action):
            return self.machine.pressed().count(f"Y+ {action}")

        def held():
            # A busy machine may answer too late for a terminal that is there: then it is pressed again.
            if times("PRESS") == times("RELEASE"):
                before = times("PRESS")
                terminal.type(f"\x1b[<0;{column + 2};{row + 1}M")
                eventually(lambda: times("PRESS") > before, 5)
            return len(self.machine.all_of("HeartbeatHandbox")) > 30
        self.assertTrue(eventually(held), self.machine.pressed())
        # Not more often than every 50 ms, however fast it is; and at once with each press.
        self.assertLessEqual(len(self.machine.all_of("HeartbeatHandbox")),
                             (time.monotonic() - begin) / 0.05 + 1 + 2 * times("PRESS"))
        self.assertIn(b"y\x1b[0m>\x1b[7mY+   ", terminal.seen)
        self.assertIn(b"\x1b[5n", terminal.seen)
        terminal.type("\x1b[<0;1;1m")
        self.assertTrue(eventually(lambda: times("PRESS") == times("RELEASE")), self.machine.pressed())
        terminal.type("q")
        self.assert_ended(terminal, 0)
        beats = sorted(self.machine.all_of("HeartbeatHandbox"), key=lambda fields: int(fields["number"]))
        self.assertEqual([int(fields["number"]) for fields in beats], list(range(1, len(beats) + 1)))
        for fields in beats:
            self.assertEqual((fields["keysDown"], fields["controlToken"]), (["Y+"], "t"))
            self.assertEqual(fields["session"], "machines/m/handboxSessions/1")

    def times(self, key, action):
        return self.machine.pressed().count(f"{key} {action}")

    def hold(self, terminal, button, key):
        """With the mouse. A terminal of a busy machine may answer too late, and it is let go: then it is pressed again."""
        def is_down():
            before = self.times(key, "PRESS")
            terminal.mouse(button, True)
            return eventually(lambda: self.times(key, "PRESS") > before, 5) and self.times(key, "PRESS") > self.times(key, "RELEASE")
        self.assertTrue(eventually(is_down), self.machine.pressed())

    def assert_goes_up(self, key):
        """As often as it went down, and nothing else was pressed."""
        self.assertTrue(eventually(lambda: self.times(key, "PRESS") == self.times(key, "RELEASE")), self.machine.pressed())
        self.assertEqual(self.machine.pressed(), ", ".join([f"{key} PRESS, {key} RELEASE"] * self.times(key, "PRESS")))

    # A key that is down goes up before the end, and the axes are awaited.
    def test_the_end_lets_go(self):
        terminal = self.on_screen()
        self.hold(terminal, "b B+", "B+")
        self.machine.is_now(state="MACHINE_STATE_JOGGING")
        self.assertTrue(terminal.shows(" JOGGING "), terminal.text())
        terminal.type("q")
        self.assertTrue(eventually(lambda: len(self.machine.all_of("GetMachine")) > 2))
        self.assert_goes_up("B+")
        self.assertEqual(self.machine.all_of("ReleaseControl"), [])
        self.machine.is_now(state="MACHINE_STATE_IDLE")
        self.assert_ended(terminal, 0)
        self.assertEqual(len(self.machine.all_of("ReleaseControl")), 1)

    # Another window is typed into: nobody is there.
    def test_who_looks_away_lets_go(self):
        terminal = self.on_screen()
        self.hold(terminal, "c C+", "C+")
        terminal.type("\x1b[O")
        self.assert_goes_up("C+")
        self.assertIsNone(terminal.process.poll())

    # LIVE-7.05
    def test_a_terminal_that_is_silent_holds_nothing(self):
        terminal = self.on_screen()
        terminal.answers = False
        terminal.mouse("z Z+", True)
        self.assertTrue(terminal.shows("let go: the terminal did not answer in time"), terminal.text())
        self.assertTrue(eventually(lambda: self.machine.pressed() == "Z+ PRESS, Z+ RELEASE"), self.machine.pressed())

    # A server that is gone, or does not let it: with its reason. What is said of a machine that is OFF is none.
    def test_what_ends_it(self):
        for code, ends in ((grpc.StatusCode.UNAVAILABLE, True), (grpc.StatusCode.PERMISSION_DENIED, True),
                           (grpc.StatusCode.NOT_FOUND, True), (grpc.StatusCode.DEADLINE_EXCEEDED, True),
                           (grpc.StatusCode.INTERNAL, False), (grpc.StatusCode.RESOURCE_EXHAUSTED, False)):
            with self.subTest(code):
                terminal = self.on_screen()
                self.machine.refused["PressKey"] = (code, "because")
                terminal.type("j")
                if ends:
                    self.assert_ended(terminal, 3)
                    self.assert_told(terminal, b"because")
                    self.machine.refused.clear()
                else:
                    self.assertTrue(terminal.shows("  JOB: because"), terminal.text())
                    self.machine.refused.clear()
                    terminal.type("q")
                    self.assert_ended(terminal, 0)

    def test_a_stream_that_ends_is_a_server_that_ends(self):
        for stream in ("WatchMachine", "WatchHandbox"):
            with self.subTest(stream):
                terminal = self.on_screen()
                self.machine.say(stream, None)
                self.assert_ended(terminal, 3)
                self.assert_told(terminal, b"the server has ended")

    def test_control_that_is_lost_ends_it(self):
        terminal = self.on_screen()
        self.machine.refused["RenewControl"] = (grpc.StatusCode.FAILED_PRECONDITION, "somebody else has it")
        self.assertTrue(eventually(lambda: terminal.process.poll() is not None))
        self.assertNotEqual(terminal.process.returncode, 0)
        self.assert_told(terminal, b"somebody else has it")

    # Nothing is drawn before anything is known, and what does not change is not drawn again.
    def test_what_is_drawn(self):
        self.machine.shows("READY")
        terminal = self.terminal()
        self.assertTrue(eventually(lambda: self.machine.all_of("WatchMachine")))
        # With another size it clears the screen, and goes round its loop, where it draws, before it does so again.
        cleared = b"\x1b[2J"
        self.assertTrue(eventually(lambda: terminal.seen.count(cleared) == 2), terminal.seen)
        for times, rows in ((3, 25), (4, 24)):
            terminal.resize(rows, 80)
            self.assertTrue(eventually(lambda: terminal.seen.count(cleared) == times), terminal.seen)
        self.assertNotIn(b"START", terminal.seen)
        self.machine.is_now()
        self.assertTrue(terminal.shows("s START"), terminal.text())
        self.assertTrue(terminal.shows("READY"), terminal.text())
        drawn = len(terminal.seen)
        for percent in (57.0, 58.0, 59.0):
            self.machine.is_now(overridePercent=percent)
            self.assertTrue(terminal.shows(f"override {percent:.0f} %"), terminal.text())
        self.assertNotIn("let go: the terminal", terminal.text())  # nothing was down
        self.assertNotIn(b"START", terminal.seen[drawn:])
        self.assertNotIn(b"READY", terminal.seen[drawn:])

    def test_what_is_refused_at_first(self):
        for method in ("AcquireControl", "CreateHandboxSession"):
            with self.subTest(method):
                self.machine.refused = {method: (grpc.StatusCode.FAILED_PRECONDITION, "not now")}
                terminal = self.terminal()
                self.assertNotEqual(terminal.process.wait(timeout=60), 0)
                self.assertTrue(eventually(lambda: b"not now" in terminal.seen), terminal.seen)
                self.assertNotIn(b"1049", terminal.seen)
                self.machine.refused = {}
                self.assertEqual(self.machine.all_of("DeleteHandboxSession"), [])

    # The display flashes by itself, and stands still where it does not.
    def test_what_flashes_goes_on_and_off(self):
        terminal = self.on_screen("ALARM", flashing=True)
        dark, light = b"\x1b[7m ALARM", b"\x1b[1m ALARM"
        self.assertTrue(eventually(lambda: terminal.seen.count(dark) > 1 and terminal.seen.count(light) > 1))
        self.machine.shows("QUIET", flashing=False)
        self.assertTrue(terminal.shows("QUIET"), terminal.text())
        self.assertNotIn(b"\x1b[7m QUIET", terminal.seen)

    # The whole screen is drawn anew with its new size, with its own lines alone.
    def test_another_size(self):
        terminal = self.on_screen()
        terminal.resize(10, 40)
        self.assertTrue(terminal.shows("too small: 40 x 10"), terminal.text())
        self.assertNotIn("READY", terminal.text())
        terminal.type("j h")
        self.assertTrue(eventually(lambda: self.machine.pressed() == "STOP TAP, HOLD TAP"), self.machine.pressed())
        terminal.resize(30, 100)
        self.assertTrue(terminal.shows("READY"), terminal.text())
        terminal.type("j")
        self.assertTrue(eventually(lambda: self.machine.pressed() == "STOP TAP, HOLD TAP, JOB TAP"), self.machine.pressed())

    def test_each_order_to_end(self):
        for order in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            with self.subTest(order):
                terminal = self.on_screen()
                (inner,) = terminal.inner()
                os.kill(inner, order)
                self.assert_ended(terminal, 0)
                terminal = self.on_screen()
                terminal.process.send_signal(order)
                self.assert_ended(terminal, 0)

    # The window is closed: nothing can be drawn any more, and nobody waits for that.
    def test_a_terminal_that_is_gone(self):
        self.machine.is_now()
        self.machine.shows("READY")
        master, slave = pty.openpty()
        fcntl.ioctl(master, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        process = subprocess.Popen(["setsid", "--ctty", os.path.join(BIN, "rmlcell"), "handbox", "m", "--server",
                                    self.machine.address],
                                   stdin=slave, stdout=slave, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        os.close(slave)
        seen = b""
        while b"READY" not in seen:
            seen += os.read(master, 65536)
        os.close(master)
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertEqual(len(self.machine.all_of("ReleaseControl")), 1)

    # It is not stopped before it has given the terminal back.
    def test_a_terminal_that_a_shell_takes_back(self):
        self.machine.is_now()
        self.machine.shows("READY")
        terminal = Terminal()
        heard, told = os.pipe()
        terminal.process = subprocess.Popen(
            ["setsid", "--ctty", sys.executable, "-c", SHELL, str(heard), os.path.join(BIN, "rmlcell"), "handbox", "m",
             "--server", self.machine.address],
            stdin=terminal.slave, stdout=terminal.slave, stderr=terminal.slave, pass_fds=[heard])
        self.addCleanup(terminal.end)
        os.close(heard)
        self.assertTrue(terminal.shows("READY"), terminal.text())
        os.close(told)
        self.assert_ended(terminal, 0)

    # Who does not follow an order to end is killed in the end; who was given none never is.
    def test_only_who_does_not_follow_is_killed(self):
        other, terminal = self.on_screen(), self.on_screen()
        (inner,) = terminal.inner()
        os.kill(inner, signal.SIGSTOP)
        for _ in range(2):
            terminal.process.send_signal(signal.SIGTERM)
        self.assert_ended(terminal, 3)
        self.assert_told(terminal, b"killed by signal 9; axes stand by themselves")
        # It has looked a few times more after the one that reads keys, sleeping for a second each time.
        before = times_awake(other.process.pid)
        self.assertTrue(eventually(lambda: times_awake(other.process.pid) >= before + 4))
        self.machine.shows("STILL HERE")
        self.assertTrue(other.shows("STILL HERE"), other.text())
        other.type("q")
        self.assert_ended(other, 0)

    # It sees its keys, and shows what they do.
    def test_both_sides_of_a_terminal_are_needed(self):
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        self.addCleanup(os.close, slave)
        command = [os.path.join(BIN, "rmlcell"), "handbox", "m", "--server", self.machine.address]
        for streams in ({"stdin": slave, "stdout": subprocess.PIPE}, {"stdin": subprocess.DEVNULL, "stdout": slave}):
            done = subprocess.run(command, **streams, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn("a handbox needs a terminal", done.stderr)
        self.assertEqual(self.machine.asked, [])

    # However the terminal was set up: a read says what is there, and never waits.
    def test_a_terminal_whose_reads_wait(self):
        self.machine.is_now()
        self.machine.shows("READY")
        made = Terminal()
        settings = termios.tcgetattr(made.slave)
        settings[6][termios.VMIN], settings[6][termios.VTIME] = 9, 255
        termios.tcsetattr(made.slave, termios.TCSANOW, settings)
        made.before = termios.tcgetattr(made.slave)
        terminal = made.start("handbox", "m", "--server", self.machine.address)
        self.addCleanup(terminal.end)
        self.assertTrue(terminal.shows("READY"), terminal.text())
        for display in ("ONE", "TWO"):
            self.machine.shows(display)
            self.assertTrue(terminal.shows(display), terminal.text())
        terminal.type("q")
        self.assert_ended(terminal, 0)

    # What was typed and not read is not for the shell behind it.
    def test_what_is_left_is_read_by_nobody(self):
        terminal = self.on_screen()
        (inner,) = terminal.inner()
        os.kill(inner, signal.SIGSTOP)
        self.assertTrue(eventually(lambda: stopped(inner)))
        typed = "rm -r\n"
        terminal.type(typed)

        def to_be_read():
            return struct.unpack("i", fcntl.ioctl(terminal.slave, termios.FIONREAD, bytes(4)))[0]
        # A terminal hands on what is typed a moment later.
        self.assertTrue(eventually(lambda: to_be_read() >= len(typed)), to_be_read())
        os.kill(inner, signal.SIGKILL)
        self.assert_ended(terminal, 3)
        os.set_blocking(terminal.slave, False)
        with self.assertRaises(BlockingIOError):
            os.read(terminal.slave, 1)


if __name__ == "__main__":
    unittest.main()
