#!/usr/bin/env python3
"""What a person does at a machine that lives, over gRPC and with the command: keys, teaching, a start at a step (live.md 6 to 8)."""
import itertools
import os
import queue
import subprocess
import sys
import threading
import time
import unittest

from cell import BIN, awaited, detail_of, eventually, grpc, machine_pb2, processor_ticks, program_pb2, times_awake
from google.protobuf.timestamp_pb2 import Timestamp
from live import MILL, Live, LiveTestCase, new_id, passes
from rmlcell.v1 import handbox_pb2, handbox_pb2_grpc, project_pb2, project_pb2_grpc
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402
from rmlcell.v1.machine_control_pb2 import KeyAction  # noqa: E402

OPTIMO = "machines/optimo-1"
TOO_SLOW = "CELL-E9434"  # the line, for keys that are held
DISK_IS_LATE = "CELL-E9429"


def is_too_slow(refused):
    detail = detail_of(refused)
    return detail is not None and detail.code == TOO_SLOW


class Handbox:
    """A session: keys by their names, held ones with their beats."""

    def __init__(self, live):
        self.live = live
        self.stub = handbox_pb2_grpc.HandboxServiceStub(live.cell.channel())
        self.session = self.stub.CreateHandboxSession(handbox_pb2.CreateHandboxSessionRequest(
            machine=live.machine, control_token=live.token)).name
        self.sequence = self.beats = 0

    def press(self, key, action="KEY_ACTION_TAP"):
        """Again where it is refused for the moment alone, and has done nothing."""
        self.sequence += 1

        def pressed():
            try:
                return self.stub.PressKey(handbox_pb2.PressKeyRequest(
                    session=self.session, control_token=self.live.token, key=key, action=KeyAction.Value(action), sequence=self.sequence))
            except grpc.RpcError as refused:
                if not passes(refused):
                    raise
                # What came to the host has used up its number.
                self.sequence += detail_of(refused).code == DISK_IS_LATE
                return None
        return awaited(pressed)

    def keys(self, names):
        for name in names.split():
            answer = self.press(name)
        return answer

    def start(self):
        """Its run has begun then, and may be over before anybody has looked."""
        before = self.live.status().last_run.run
        self.keys("START")
        awaited(lambda: (lambda now: max(now.run.run, now.last_run.run) > before)(self.live.status()))

    def shows(self):
        return self.press("JOG_ROB").panel.display

    def records(self):
        panel = self.press("JOG_ROB").panel
        return panel.flashing and "ENTER" not in panel.display  # it asks for the next point

    def hold(self, key, seconds):
        """Not on a line that is too slow for it, nor while its host is silent: then it is let go."""
        answer = self.press(key, "KEY_ACTION_PRESS")
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.beats += 1
            sent = Timestamp()
            sent.GetCurrentTime()
            try:
                self.stub.HeartbeatHandbox(handbox_pb2.HeartbeatHandboxRequest(
                    session=self.session, control_token=self.live.token, number=self.beats, keys_down=[key], sent=sent))
            except grpc.RpcError as refused:
                if not is_too_slow(refused) and not passes(refused):
                    raise
                break
            time.sleep(0.04)
        self.press(key, "KEY_ACTION_RELEASE")
        self.live.wait("IDLE")
        return answer

    def jog(self, key, seconds):
        """Held until the axis has moved: where the beats come too late, the control lets go by itself."""
        axis = "XYZ".index(key[0])
        begin = self.live.status().axes[axis].value

        def moved():
            try:
                answer = self.hold(key, seconds)
            except grpc.RpcError as refused:
                if not is_too_slow(refused):
                    raise
                return None
            return answer if abs(self.live.status().axes[axis].value - begin) > 0.1 else None
        return awaited(moved)


class ByHandTest(LiveTestCase):
    def optimo(self):
        live = Live(self, self.cell, OPTIMO)
        live.enable()
        live.acquire(ttl={"seconds": 60})
        return live

    def lists(self, slot):
        """The steps of a program, as anybody reads them."""
        text = self.cell.programs().GetProgramContent(program_pb2.GetProgramContentRequest(
            name=f"{OPTIMO}/programs/{slot}", form="PROGRAM_FORM_LISTING")).content.decode()
        return [line.strip() for line in text.splitlines() if line.strip()]

    # LIVE-7.07, LIVE-7.08: a program that is taught is an ordinary one: listed, run at the handbox, kept in a project.
    def test_a_program_is_taught_and_run(self):
        live = self.optimo()
        box = Handbox(live)
        shown = []

        def watch():
            try:
                for message in box.stub.WatchHandbox(handbox_pb2.WatchHandboxRequest(machine=OPTIMO), timeout=60):
                    shown.append(message.panel.display)
            except grpc.RpcError:
                pass
        viewer = threading.Thread(target=watch)
        viewer.start()
        self.addCleanup(viewer.join)
        self.addCleanup(self.cell.stop)
        box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
        self.assertTrue(eventually(lambda: "P=12" in box.keys("OVERRIDE_MINUS").panel.display))
        # Who looks on is told a moment later, and only as long as it is shown.
        self.assertTrue(eventually(lambda: any("P=12" in display for display in shown)))
        for key in ("X+", "Y+"):
            answer = box.jog(key, 0.3)
            self.assertFalse(answer.HasField("message"), answer.message)
            steps = len(self.lists(12))
            box.keys("REC")
            self.assertTrue(eventually(lambda: len(self.lists(12)) > steps))
        self.assertEqual(sum("MOVE" in line for line in self.lists(12)), 2, self.lists(12))
        box.keys("MODE_RIGHT MODE_RIGHT")  # CYCLE
        box.start()
        self.assertIsNotNone(live.wait("IDLE"))
        project = project_pb2_grpc.ProjectServiceStub(self.cell.channel())
        project.TransferProjectFromMachine(project_pb2.TransferProjectFromMachineRequest(
            machine=OPTIMO, project_id="taught", slots=[12]))
        kept = project.GetProject(project_pb2.GetProjectRequest(name="projects/taught"))
        self.assertEqual([one.slot for one in kept.programs], [12])

    # LIVE-10.07: a shift at the handbox: a program with LIN, CIR and HOLE is taught, corrected, stopped at a breakpoint,
    # simulated to a step, run step by step and whole, and kept in a project.
    def test_a_shift_at_the_handbox(self):
        live = self.optimo()
        box = Handbox(live)

        def taught(keys, steps):
            """What is recorded is in the store when the name flashes no more."""
            live.ask("RenewControl")  # however long a shift takes
            box.keys(keys)
            self.assertTrue(eventually(lambda: len(self.lists(12)) == steps and not box.records()), box.shows())

        box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
        self.assertTrue(eventually(lambda: "P=12" in box.shows()), box.shows())
        end = len(self.lists(12))
        taught("DYN NEXT ENT REC", end + 1)  # COORD ABSOL
        taught("PATH NEXT ENT REC", end + 2)  # LIN
        box.jog("X+", 0.4)
        taught("REC", end + 3)
        taught("PATH NEXT ENT REC", end + 4)  # CIR
        box.jog("X+", 0.4)
        box.keys("REC")  # the via point
        box.jog("Y+", 0.4)
        taught("REC", end + 5)
        taught("PATH NEXT ENT DEL 5 ENT REC", end + 6)  # HOLE
        box.jog("Y+", 0.4)
        box.keys("REC")  # the centre
        box.jog("Z-", 0.2)
        taught("REC", end + 7)
        taught("DLY DEL 3 ENT REC", end + 8)
        listing = self.lists(12)
        self.assertEqual([word for line in listing for word in ("PATH LIN", "PATH CIR", "PATH HOLE", "/VIA", "DELAY") if word in line],
                         ["PATH LIN", "PATH CIR", "/VIA", "PATH HOLE", "/VIA", "DELAY"], listing)

        # The DELAY goes, and comes again shorter.
        taught("PREV DEL 1", end + 7)
        taught("DLY DEL 1 ENT REC", end + 8)
        self.assertIn("DELAY 1.0", self.lists(12)[7])

        def held_at(step):
            held = eventually(lambda: (lambda now: now if MachineState.Name(now.state) == "MACHINE_STATE_HELD"
                                       and now.run.place.step == step else None)(live.status()), 60)
            self.assertIsNotNone(held, live.status())
            self.assertEqual(held.run.program, 12)

        def ended():
            self.assertIsNotNone(live.wait("IDLE", 60))
            self.assertNotIn("ERROR", box.shows())

        # CYCLE, with a breakpoint behind the third step.
        box.keys("DEB NEXT ENT 3 ENT MODE_RIGHT MODE_RIGHT START")
        held_at(3)
        box.keys("START")
        ended()
        # Simulated up to its fourth step, which then moves.
        box.keys("MODE_LEFT MODE_LEFT DEB ENT F6 4 ENT MODE_RIGHT MODE_RIGHT")
        box.start()
        ended()
        # In SINGLE each START is a step.
        box.keys("MODE_RIGHT START")
        held_at(1)
        box.keys("START")
        held_at(2)
        live.ask("AbortRun")
        live.wait("IDLE")
        project_pb2_grpc.ProjectServiceStub(self.cell.channel()).TransferProjectFromMachine(
            project_pb2.TransferProjectFromMachineRequest(machine=OPTIMO, project_id="shift", slots=[12]))

    # LIVE-7.09, LIVE-9.15: what was taught is listed, and taken back as long as nobody else changed the program.
    def test_what_was_taught_is_taken_back(self):
        live = self.optimo()
        box = Handbox(live)
        box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
        self.assertTrue(eventually(lambda: "P=12" in box.keys("OVERRIDE_MINUS").panel.display))
        made = self.lists(12)
        box.jog("X+", 0.2)
        box.keys("REC")
        self.assertTrue(eventually(lambda: len(self.lists(12)) > len(made)))

        def entries():
            return box.stub.ListTeachEntries(handbox_pb2.ListTeachEntriesRequest(machine=OPTIMO)).entries
        # It is told a moment behind what was stored.
        taught = eventually(lambda: entries() if len(entries()) == 2 else None) or entries()
        acts = [handbox_pb2.TeachEntry.Act.Name(one.act) for one in taught]
        self.assertEqual(acts, ["ACT_INSERT", "ACT_CREATE"])
        self.assertIn("MOVE", taught[0].after)
        self.assertGreater(taught[0].axes[0].value, 0)
        self.assertEqual((taught[0].step.program, taught[0].caller), (12, "local"))

        def undo(number, token=None):
            return box.stub.UndoTeachEntries(handbox_pb2.UndoTeachEntriesRequest(
                program=f"{OPTIMO}/programs/12", down_to=number, request_id=new_id(),
                control_token=token or live.token)).entry
        with self.assertRaises(grpc.RpcError) as caught:
            undo(taught[0].number, "none")
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9420")
        self.assertEqual(handbox_pb2.TeachEntry.Act.Name(undo(taught[0].number).act), "ACT_UNDO")
        self.assertEqual(self.lists(12), made)
        self.assertEqual(len(entries()), 3)
        # The command lists it, oldest first, and takes it back.
        box.jog("X+", 0.2)
        box.keys("REC")
        self.assertTrue(eventually(lambda: len(entries()) == 4))
        live.ask("ReleaseControl")
        listed = self.command("taught", "optimo-1", "--slot", "12")
        lines = listed.stdout.splitlines()
        self.assertEqual(len(lines), 4, listed.stderr)
        self.assertRegex(lines[0], r"^1  \S+ \S+  local  12  create")
        self.assertRegex(lines[1], r"^2  \S+ \S+  local  12/1  insert  MOVE .*COORD")
        self.assertIn("undo    down to 2", lines[2])
        self.assertIn("there is no entry 40", self.command("taught", "optimo-1", "--undo", "40").stderr)
        undone = self.command("taught", "optimo-1", "--undo", "4")
        self.assertEqual(undone.returncode, 0, undone.stderr)
        self.assertIn("undo    down to 4", undone.stdout)
        self.assertEqual(self.lists(12), made)
        live.acquire()
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=f"{OPTIMO}/programs/12", program={"file_name": "a.S", "content": b"DELAY 1\n"}))
        with self.assertRaises(grpc.RpcError) as caught:
            undo(taught[1].number)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9006")

    # LIVE-9.15, LIVE-7.04: keys and beats in one stream; a refusal ends nothing.
    def test_a_handbox_in_one_stream(self):
        live = self.optimo()
        box = Handbox(live)
        sent = queue.Queue()
        answers = box.stub.HandboxStream(iter(sent.get, None), timeout=60)

        def key(name, sequence, action="KEY_ACTION_TAP", token=live.token):
            sent.put(handbox_pb2.HandboxStreamRequest(key=handbox_pb2.PressKeyRequest(
                session=box.session, control_token=token, key=name, action=KeyAction.Value(action), sequence=sequence)))
        for number in range(1, 5):
            key("MODE_LEFT", number)
        for number in range(1, 5):
            self.assertEqual(next(answers).key.sequence, number)
        numbers, beats = itertools.count(5), itertools.count(1)

        def taken(name, action):
            """Nothing: the line is too slow for keys that are held, or the disk."""
            number = next(numbers)
            key(name, number, action)
            answer = next(answers)
            if answer.HasField("refusal"):
                self.assertIn(answer.refusal.code, (TOO_SLOW, DISK_IS_LATE))
                return False
            self.assertEqual(answer.key.sequence, number)
            return True

        def held():
            begin = live.status().axes[0].value
            good = taken("X+", "KEY_ACTION_PRESS")
            for _ in range(8):
                now = Timestamp()
                now.GetCurrentTime()
                sent.put(handbox_pb2.HandboxStreamRequest(heartbeat=handbox_pb2.HeartbeatHandboxRequest(
                    session=box.session, control_token=live.token, number=next(beats), keys_down=["X+"], sent=now)))
                answer = next(answers)
                self.assertTrue(answer.HasField("heartbeat") or answer.refusal.code == TOO_SLOW, answer)
                good = good and answer.HasField("heartbeat")
                time.sleep(0.04)
            key("X+", 1000, "KEY_ACTION_RELEASE", token="none")
            self.assertEqual(next(answers).refusal.code, "CELL-E9420")
            sent.put(handbox_pb2.HandboxStreamRequest())
            self.assertEqual(next(answers).refusal.code, "CELL-E9003")
            self.assertTrue(taken("X+", "KEY_ACTION_RELEASE"))
            live.wait("IDLE")
            return good and live.status().axes[0].value > begin
        awaited(held)
        sent.put(None)
        self.assertEqual(list(answers), [])

    # LIVE-3.40, LIVE-7.07: a FUNCTION that was carried out from the handbox is played again, with the keys that entered it.
    def test_a_function_is_played_again(self):
        live = self.optimo()
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=f"{OPTIMO}/programs/44", program={"file_name": "a.S", "content": b"VR[1] = 7.5\nDELAY 0.1\nRETURN\n"}))
        box = Handbox(live)
        box.keys("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
        self.assertTrue(eventually(lambda: "P=12" in box.keys("OVERRIDE_MINUS").panel.display))
        box.keys("F3 4 4 ENT ENT 1")
        self.assertTrue(eventually(
            lambda: live.ask("ReadVariables", variables=["VR[1]"]).variables[0].value.real == 7.5))
        live.wait("IDLE")
        played = subprocess.run([os.path.join(BIN, "rmlcell"), "replay", OPTIMO, "--server", self.cell.address],
                                capture_output=True, text=True, timeout=60)
        self.assertEqual(played.returncode, 0, played.stdout + played.stderr)

    # LIVE-3.12: a standing machine sleeps, also when the server goes while its handbox has something to show.
    def test_a_handbox_that_nobody_sees_costs_nothing(self):
        live = self.optimo()
        box = Handbox(live)
        pid = live.host()
        gone = threading.Event()

        def press():
            try:
                while not gone.is_set():
                    box.keys("MODE_LEFT MODE_LEFT MODE_RIGHT MODE_RIGHT")
            except grpc.RpcError:
                pass
        presses = threading.Thread(target=press)
        presses.start()
        awaited(lambda: box.sequence > 100)
        self.cell.kill()
        gone.set()
        presses.join()
        awaited(lambda: "the line to the server is gone" in live.kept(".log").read_text(encoding="utf-8"))
        # Beside a process that never sleeps: long enough that it would have had its turns, too.
        busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
        self.addCleanup(busy.wait)
        self.addCleanup(busy.kill)
        begin, before, looked, before_busy = time.monotonic(), processor_ticks(pid), times_awake(pid), processor_ticks(busy.pid)
        awaited(lambda: processor_ticks(busy.pid) - before_busy >= 200, 600)
        used, awake, lasted = processor_ticks(pid) - before, times_awake(pid) - looked, time.monotonic() - begin
        # By the time that went by, of which a busy machine gives it more for the same.
        self.assertLess(used, 15 * lasted / 2)
        self.assertLess(awake, 10 + 12 * lasted)  # it looks for its server five times a second
        self.cell.start()
        live.wait("IDLE")
        self.assertEqual(live.host(), pid)

    # LIVE-2.11: a gate starts the program that it is set to.
    def test_a_gate_starts_its_program(self):
        live = self.optimo()
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=f"{OPTIMO}/programs/45", program={"file_name": "a.S", "content": b"VI[3] = 7\n"}))
        with self.assertRaises(grpc.RpcError) as caught:
            live.ask("SetInputs", inputs=[{"gate": 1}])
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9423")
        status = live.ask("SetGates", gate_programs=[45, 0])
        self.assertEqual(list(status.gate_programs), [45, 0])
        with self.assertRaises(grpc.RpcError) as caught:
            live.ask("SetGates", gate_programs=[45])
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9003")
        self.assertTrue(eventually(lambda: live.ask("SetInputs", inputs=[{"gate": 1}])))
        live.wait("IDLE")
        value = live.ask("ReadVariables", variables=["VI[3]"]).variables[0].value
        self.assertEqual(value.integer, 7)
        self.assertEqual(self.command("gates", "optimo-1", "0", "45", "--take-over", "a test").returncode, 0)
        self.assertEqual(list(live.status().gate_programs), [0, 45])

    # LIVE-7.02, LIVE-8.04.
    def test_only_an_optimo_has_a_handbox(self):
        self.live.enable()
        self.live.acquire()
        with self.assertRaises(grpc.RpcError) as caught:
            Handbox(self.live)
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9424")

    def command(self, *words):
        return subprocess.run([os.path.join(BIN, "rmlcell"), "machine", *words, "--server", self.cell.address],
                              capture_output=True, text=True, timeout=60)

    # LIVE-8.03, LIVE-7.05: the command holds a key of a mill's panel.
    def test_the_command_holds_a_key(self):
        self.live.enable()

        def last_of_key():
            keys = [one.input_applied for one in self.log_of_machines() if one.input_applied.input.HasField("key")]
            if not keys:  # it is told behind the answer
                return None
            self.assertEqual({one.input.key.key for one in keys}, {"X+"})
            return keys[-1] if keys[-1].input.key.action == KeyAction.Value("KEY_ACTION_RELEASE") else None

        def held():
            begin, since = self.live.status().axes[0].value, time.monotonic()
            done = self.command("key", "mill-1", "X+", "--for", "0.6")
            self.live.wait("IDLE")
            took = time.monotonic() - since
            if done.returncode != 0:
                self.assertRegex(done.stderr, f"{TOO_SLOW}|{DISK_IS_LATE}|its host is silent")
                return False
            moved = self.live.status().axes[0].value - begin
            self.assertLess(moved, took)  # at 1 mm/s
            # A dead-man alone would let it go 0.2 mm; and the command lets it go, too.
            return moved > 0.4 and awaited(last_of_key).caller == "local"
        awaited(held)
        self.assertEqual(self.command("key", "mill-1", "X+", "--for", "nan").returncode, 2)
        shown = self.command("key", "optimo-1", "MODE_LEFT")
        self.assertNotEqual(shown.returncode, 0)  # it does not live
        Live(self, self.cell, OPTIMO).enable()
        shown = self.command("key", "optimo-1", "MODE_LEFT", "MODE_LEFT")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("CYCLE", shown.stdout)

    # LIVE-6.03, LIVE-6.05, LIVE-6.08: seen first, asked for what a person sees to, then done.
    def test_a_start_at_a_step(self):
        self.live.enable()
        self.live.acquire()
        self.live.ask("SetFactor", factor=100.0)
        self.live.ask("ReleaseControl")
        self.live.store(7, "PA;PA;VS10;!PZ-50,100;!MC0;PU200,0;PD400,0;PD400,200;PU0,0;")
        seen = self.command("start-at", "mill-1", "8", "--slot", "7", "--preview")
        self.assertEqual(seen.returncode, 0, seen.stderr)
        for row in ("VS", "Z1", "tool", "ASK", "approach", "not checked against the part"):
            self.assertIn(row, seen.stdout)
        asked = self.command("start-at", "mill-1", "8", "--slot", "7")
        self.assertEqual(asked.returncode, 1)
        self.assertIn("--seen tool,clamps", asked.stderr)
        wrong = self.command("start-at", "mill-1", "8", "--slot", "7", "--seen", "tool,clamp")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("--seen 'clamp'", wrong.stderr)
        begun = self.command("start-at", "mill-1", "8", "--slot", "7", "--seen", "tool,clamps", "--halt")
        self.assertEqual(begun.returncode, 0, begun.stderr)
        held = self.live.wait("HELD")
        self.assertEqual(held.run.place.step, 8)
        self.live.acquire(take_over=True, reason="a test")
        self.live.ask("ResumeMachine")
        self.live.wait("IDLE")
        stale = self.live
        with self.assertRaises(grpc.RpcError) as caught:
            stale.ask("StartAtStep", preview_token="none")
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9428")
        self.assertEqual(self.command("start-at", "mill-1", "99", "--slot", "7").returncode, 1)


if __name__ == "__main__":
    unittest.main()
