#!/usr/bin/env python3
"""Hosts of machines that are killed or stopped while somebody jogs or teaches, while they recover, and in runs (live.md 10.04)."""
import contextlib
import os
import random
import signal
import sqlite3
import threading
import time
import unittest

from cell import awaited, eventually, grpc, program_pb2
from google.protobuf.timestamp_pb2 import Timestamp
from live import Live, LiveTestCase, hosts_of, new_id, stopped, wall_ns
from rmlcell.v1 import handbox_pb2  # noqa: E402
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402
from rmlcell.v1.machine_control_pb2 import KeyAction  # noqa: E402
from rmlcell.v1.machine_status_pb2 import HoldReason  # noqa: E402
from test_by_hand import OPTIMO, Handbox

ROUNDS = int(os.environ.get("LIVE_ROUNDS", "3"))
SEED = int(os.environ.get("LIVE_SEED", "1"))
STOPPED_S = float(os.environ.get("LIVE_STOPPED_S", "2.5"))  # a host is stopped for so long at most
RECOVERS = ("STARTING", "RECOVERING", "LOST")
STANDS = ("IDLE", "NOT_ZEROED", "INSPECT")


def name_of(status):
    return MachineState.Name(status.state)[len("MACHINE_STATE_"):]


def axes_of(status):
    return [round(one.value, 6) for one in status.axes]


class Panel:
    """Keys of a mill's panel, as Handbox has those of a laser."""

    def __init__(self, live):
        self.live, self.sequence, self.beats = live, 0, 0

    def press(self, key, action="KEY_ACTION_TAP"):
        self.sequence += 1
        return self.live.ask("PressPanelKey", key=key, action=action, sequence=self.sequence)

    def hold(self, key, seconds):
        self.press(key, "KEY_ACTION_PRESS")
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.beats += 1
            sent = Timestamp()
            sent.GetCurrentTime()
            self.live.ask("HeartbeatPanel", number=self.beats, keys_down=[key], sent=sent)
            time.sleep(0.04)
        self.press(key, "KEY_ACTION_RELEASE")


class LiveCrashesTest(LiveTestCase):
    def setUp(self):
        super().setUp()
        self.choose = random.Random(SEED)

    def optimo(self):
        self.live = Live(self, self.cell, OPTIMO)
        self.live.enable()
        return self.live

    def recovered(self, fence, killed=()):
        """How it stands with its next host, which is none of those that were killed: what they had told last is shown
        until it is noticed."""
        def stands(now):
            return now.fence > fence and name_of(now) not in RECOVERS and now.host.split("/")[1:2] not in [[str(one)] for one in killed]
        return awaited(lambda: (lambda now: now if stands(now) else None)(self.live.status()))

    def settle(self, status):
        """A person looks, and knows why its hosts die."""
        if name_of(status) == "INSPECT":
            self.live.acquire(take_over=True, reason="a test")
            self.live.ask("ConfirmMachine", confirmations=[1])
        self.live.enable()

    def stands_still(self, status, place):
        """LIVE-2.05: nothing moves by itself behind a recovery."""
        self.assertIn(name_of(status), STANDS, place)
        later = self.live.later(status)
        self.assertEqual(axes_of(later), axes_of(status), place)
        self.assertEqual(name_of(later), name_of(status), place)

    def told(self):
        """What the log tells of machines, in order, when their host has told all of it."""
        self.live.disable()
        return self.log_of_machines()

    def stands_at(self, marks, events):
        """LIVE-3.30: each that was killed was found where its newest mark was, whatever became of the next ones."""
        found = [(one.fence, one.recovered.mark_fence, one.recovered.mark_virtual_time_ns) for one in events if one.HasField("recovered")]
        for fence, mark in marks:
            first = min(one for one in found if one[0] > fence)
            self.assertEqual(first[1:], (mark.fence, mark.virtual_time_ns), f"seed {SEED}: {found}")

    # In the middle of a key that moves an axis: the machine stands behind, where the key had brought it to or before.
    def test_rounds_of_a_jog(self):
        live = self.optimo()

        def handbox():
            box = Handbox(live)
            box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT")
            return box
        self.rounds_of_a_key(live, handbox, "HANDBOX ", 300)

    def test_rounds_of_a_panel_key(self):
        self.live.enable()
        self.rounds_of_a_key(self.live, lambda: Panel(self.live), "", 5)

    def rounds_of_a_key(self, live, keys_of, told_as, mm_s):
        answered, marks = [], []
        for round_ in range(ROUNDS):
            live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
            box = keys_of()
            begun = live.status()
            key = self.choose.choice(("X+", "X-", "Y+", "Y-"))
            pressed = threading.Event()

            whole = box.press

            def press(name, action="KEY_ACTION_TAP"):
                answer = whole(name, action)
                if action == "KEY_ACTION_PRESS":
                    answered.append(told_as + name)
                    pressed.set()
                return answer
            box.press = press

            def jog():
                try:
                    box.hold(key, 5.0)
                except (grpc.RpcError, AssertionError):
                    pressed.set()
            hand = threading.Thread(target=jog, daemon=True)
            hand.start()
            self.assertTrue(pressed.wait(60))
            time.sleep(self.choose.random() * 0.5)
            before = live.status()
            marks.append((before.fence, live.kill_host()))
            between_s = abs(marks[-1][1].virtual_time_ns - before.virtual_time_ns) * 1e-9
            place = f"seed {SEED}, round {round_}: {key}, {name_of(before)}"
            after = self.recovered(before.fence)
            hand.join(60)
            self.stands_still(after, place)
            for axis, (seen, now) in enumerate(zip(axes_of(before), axes_of(after))):
                # From where it was seen it is as far as it moves in the time up to the mark.
                far = mm_s * between_s + 0.01 if axis < 2 else 1e-3
                self.assertLessEqual(abs(now - seen), far, f"{place}: {axis} {seen} {now} {between_s}")
            for axis, (first, now) in enumerate(zip(axes_of(begun), axes_of(after))):
                if axis == "XY".index(key[0]):
                    way = now - first if key[1] == "+" else first - now
                    self.assertGreaterEqual(way, -1e-3, f"{place}: {axis} {first} {now}")  # not behind where it began
                else:
                    self.assertLess(abs(now - first), 1e-3, f"{place}: {axis} {first} {now}")
            self.settle(after)
        events = self.told()
        keys = [one.input_applied.input.key for one in events if one.HasField("input_applied") and one.input_applied.input.HasField("key")]
        self.assertEqual([one.key for one in keys if one.action == KeyAction.Value("KEY_ACTION_PRESS")], answered)
        self.stands_at(marks, events)

    def test_a_host_whose_machine_is_another_ones(self):
        """LIVE-3.05: it brakes, ends, and what the log does not take from it is kept and told."""
        live = self.optimo()
        live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
        box = Handbox(live)
        box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT")
        host = live.host()
        with contextlib.closing(sqlite3.connect(self.cell.folder / "store" / "cell.db", timeout=60)) as store, store:
            changed = store.execute("UPDATE machine_lock SET fence = fence + 1, host = 'another/1'").rowcount
        self.assertEqual(changed, 1)
        with self.assertRaises((grpc.RpcError, AssertionError)):
            for _ in range(200):
                box.hold("X+", 0.3)
        awaited(lambda: not os.path.exists(f"/proc/{host}"))
        journals = self.cell.folder / "store" / "hosts"
        orphan = [name for name in os.listdir(journals) if name.endswith(".orphan")]
        self.assertEqual(len(orphan), 1, os.listdir(journals))
        self.assertGreater((journals / orphan[0]).stat().st_size, 0)
        told = (journals / "optimo-1.log").read_text(encoding="utf-8")
        self.assertIn("CELL-E9422", told)
        self.assertIn(orphan[0], told)

    # While steps are taught: the program has what was seen in it, perhaps what was on its way, and what the book of teaching tells.
    def test_rounds_of_teaching(self):
        live = self.optimo()
        slot = 12
        for round_ in range(ROUNDS):
            live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
            box = Handbox(live)
            box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT")
            if round_ == 0:
                box.keys("REC")
                awaited(lambda: self.steps(slot))
            seen = len(self.steps(slot))
            asked = 0
            after_s = 0.2 + self.choose.random() * 0.8
            host = live.host()
            dead = threading.Event()

            def kill():
                time.sleep(after_s)
                os.kill(host, signal.SIGKILL)
                dead.set()
            before = live.status()
            killer = threading.Thread(target=kill)
            killer.start()
            try:
                while True:
                    box.keys("DLY DEL 3 ENT")
                    asked += 1
                    box.keys("REC")
                    awaited(lambda: dead.is_set() or len(self.steps(slot)) == seen + 1)
                    if dead.is_set():
                        break
                    seen += 1
            except grpc.RpcError:
                self.assertTrue(dead.wait(60))  # before that nothing is refused
            killer.join()
            place = f"seed {SEED}, round {round_}: {seen} steps seen, {asked} asked for"
            after = self.recovered(before.fence)
            self.stands_still(after, place)
            steps = len(self.steps(slot))
            self.assertIn(steps, (seen, seen + 1), place)

            def inserted():
                book = box.stub.ListTeachEntries(handbox_pb2.ListTeachEntriesRequest(machine=OPTIMO, program=slot, page_size=1000))
                return sum(handbox_pb2.TeachEntry.Act.Name(one.act) == "ACT_INSERT" for one in book.entries)
            # It is told a moment behind what was stored.
            self.assertTrue(eventually(lambda: sum("DELAY" in line for line in self.steps(slot)) == inserted()), place)
            self.settle(after)

    def steps(self, slot):
        try:
            text = self.cell.programs().GetProgramContent(program_pb2.GetProgramContentRequest(
                name=f"{OPTIMO}/programs/{slot}", form="PROGRAM_FORM_LISTING")).content.decode()
        except grpc.RpcError:
            return []
        return [line.strip() for line in text.splitlines() if line.strip()]

    # And again while the next hosts take over: what was open is told to be over once, and it stands where the first mark says.
    def test_rounds_of_recovery(self):
        self.live.enable()
        self.live.store()
        marks = []
        for round_ in range(ROUNDS):
            self.live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
            self.live.ask("StartMachine", program=5)
            time.sleep(0.1 + self.choose.random() * 0.6)
            before = self.live.status()
            marks.append((before.fence, self.live.kill_host()))
            killed = []
            for _ in range(self.choose.randrange(1, 3)):
                process = awaited(lambda: hosts_of(self.cell))[0]
                time.sleep(self.choose.random() * 0.15)
                try:
                    os.kill(process, signal.SIGKILL)
                    killed.append(process)
                except ProcessLookupError:
                    continue
                awaited(lambda gone=process: gone not in hosts_of(self.cell))
                self.live.enable()
            place = f"seed {SEED}, round {round_}: {len(killed)} of its next hosts were killed"
            after = self.recovered(before.fence, killed)
            self.assertEqual(name_of(after), "INSPECT", place)
            self.stands_still(after, place)
            self.settle(after)
        events = self.told()
        self.stands_at(marks, events)
        begun = [one.run_begun.run for one in events if one.HasField("run_begun")]
        over = [one.run_over.run for one in events if one.HasField("run_over")]
        self.assertEqual(begun, sorted(set(begun)), f"seed {SEED}")
        self.assertEqual(over, begun, f"seed {SEED}")
        fences = [one.fence for one in events if one.fence]
        self.assertEqual(fences, sorted(fences), f"seed {SEED}")

    # Stopped and let go on: the same host has the machine, no time of it falls, and one that was late holds the run.
    def test_rounds_of_a_host_that_stands_still(self):
        self.live.may_be_late(1)
        self.live.enable()
        self.live.store()
        for round_ in range(ROUNDS):
            self.live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
            request_id = new_id()
            self.live.ask("StartMachine", program=5, request_id=request_id)
            time.sleep(0.1 + self.choose.random() * 0.3)
            before = self.live.status()
            stopped_s = 0.05 + self.choose.random() * (STOPPED_S - 0.05) if round_ else STOPPED_S
            process = self.live.host()
            os.kill(process, signal.SIGSTOP)
            awaited(lambda: stopped(process))
            stood_from = time.time_ns()
            time.sleep(stopped_s)
            stood_ns = time.time_ns() - stood_from
            os.kill(process, signal.SIGCONT)
            place = f"seed {SEED}, round {round_}: {stopped_s:.2f} s"
            # What it sent behind the stop.
            after = awaited(lambda: (lambda now: now if name_of(now) in ("RUNNING", "HELD") and wall_ns(now.send_time) > stood_from
                                     else None)(self.live.status()))
            self.assertEqual(after.fence, before.fence, place)
            self.assertGreaterEqual(after.virtual_time_ns, before.virtual_time_ns, place)
            if stopped_s > 1.3:
                held = self.live.wait("HELD")
                self.assertIn(HoldReason.Name(held.hold_reason), ("HOLD_REASON_LATE", "HOLD_REASON_SERVER_LOST"), place)
                # LIVE-3.14: it has no time of the stop; what it is late by otherwise it makes up for, up to 100 ms and a turn.
                went_on_ns = wall_ns(held.send_time) - wall_ns(before.send_time) - stood_ns
                self.assertLess(held.virtual_time_ns - before.virtual_time_ns, went_on_ns + 2 * 10**8, place)
            self.live.ask("StartMachine", program=5, request_id=request_id)  # answered again, begun no more
            self.live.ask("AbortRun")
            self.live.wait("IDLE")
        events = self.told()
        begun = [one.run_begun.run for one in events if one.HasField("run_begun")]
        self.assertEqual(len(begun), ROUNDS)
        self.assertEqual([one.run_over.run for one in events if one.HasField("run_over")], begun)
        times = [(one.fence, one.virtual_time_ns) for one in events if one.HasField("input_applied")]
        self.assertEqual(times, sorted(times))


if __name__ == "__main__":
    unittest.main()
