#!/usr/bin/env python3
"""Machines that live: hosts as processes, over gRPC and the web, held, killed and found again (live.md)."""
import os
import random
import re
import signal
import threading
import time
import unittest

from cell import Cell, awaited, cell_pb2, detail_of, eventually, grpc, machine_pb2, program_pb2
from command import ask
from live import MILL, Live, LiveTestCase, end_hosts, hosts_of, new_id
from rmlcell.v1 import machine_control_pb2 as control  # noqa: E402
from rmlcell.v1.common_pb2 import MachineState  # noqa: E402
from rmlcell.v1.machine_status_pb2 import HoldReason  # noqa: E402
from rmlcell.v1.report_pb2 import Outcome  # noqa: E402


class LiveTest(LiveTestCase):
    def test_a_machine_is_enabled_and_disabled(self):
        self.refused("CELL-E9424", "StopMachine")
        self.assertEqual(MachineState.Name(self.live.enable().state), "MACHINE_STATE_IDLE")
        self.assertEqual(len(self.hosts()), 1)
        first = self.live.status()
        self.assertGreater(first.fence, 0)
        self.assertEqual([axis.axis for axis in first.axes][:3], ["X", "Y", "Z"])
        self.live.enable()  # it is already
        self.assertEqual(self.live.status().fence, first.fence)
        self.assertEqual(MachineState.Name(self.live.ask("DisableMachine").state), "MACHINE_STATE_OFF")
        awaited(lambda: not self.hosts())
        self.assertEqual(MachineState.Name(self.live.status().state), "MACHINE_STATE_OFF")
        self.refused("CELL-E9424", "StopMachine")
        self.assertGreater(self.live.enable().fence, first.fence)
        for _ in range(10):
            self.live.ask("DisableMachine")
            self.assertEqual(MachineState.Name(self.live.enable().state), "MACHINE_STATE_IDLE")

    # LIVE-3.01: virtual machines live by themselves; one whose hosts die and die is OFF, says why, and lives again when a person says so.
    def test_machines_live_by_default(self):
        cell = Cell("--machines.hosts", "all", workers=1)
        cell.start()
        self.addCleanup(cell.close)
        mill, optimo = Live(self, cell), Live(self, cell, "machines/optimo-1")
        self.addCleanup(end_hosts, cell)
        mill.wait("IDLE")
        optimo.wait("IDLE")
        made = cell.machines().CreateMachine(machine_pb2.CreateMachineRequest(machine_id="mill-2", machine={"family": "rml1"}))
        second = Live(self, cell, made.name)
        second.wait("IDLE")
        cell.machines().DeleteMachine(machine_pb2.DeleteMachineRequest(name=made.name))
        awaited(lambda: len(hosts_of(cell)) == 2)
        optimo.ask("DisableMachine")
        self.assertFalse(cell.machines().GetMachine(machine_pb2.GetMachineRequest(name=optimo.machine)).options.enabled)
        deaths = 0
        while not mill.status().HasField("off_reason"):  # a computer that is busy takes longer than a minute for the first five
            fence = mill.wait("IDLE").fence
            os.kill(mill.host(), signal.SIGKILL)
            deaths += 1
            awaited(lambda: (lambda now: now.fence > fence or now.HasField("off_reason"))(mill.status()))
        self.assertGreaterEqual(deaths, 5)
        off = mill.wait("OFF")
        self.assertIn("ended 5 times within a minute", off.off_reason.message)
        awaited(lambda: not hosts_of(cell))  # that of the other one may end behind the answer that it is OFF
        self.assertEqual(MachineState.Name(mill.enable().state), "MACHINE_STATE_IDLE")
        cell.kill()
        cell.start()
        mill.wait("IDLE")
        # What a person has said stands. Another one is started where its host is late to come back, and ends.
        awaited(lambda: len(hosts_of(cell)) == 1)

    def test_a_run_is_held_resumed_and_aborted(self):
        self.live.enable()
        self.live.store()
        self.refused("CELL-E9420", "StartMachine", program=5)
        self.live.acquire()
        self.refused("CELL-E9408", "AcquireControl")
        started = self.live.ask("StartMachine", program=5)
        self.assertEqual(MachineState.Name(started.state), "MACHINE_STATE_RUNNING")
        # LIVE-5.03: what it is in stays.
        self.assertEqual(list(started.run.loaded_programs), [5])
        with self.assertRaises(grpc.RpcError) as in_use:
            self.cell.programs().DeleteProgram(program_pb2.DeleteProgramRequest(name=f"{MILL}/programs/5"))
        self.assertEqual(detail_of(in_use.exception).code, "CELL-E9421")
        seen = []
        threading.Thread(target=self.watch, args=(seen,), daemon=True).start()
        # Of the whole way: who comes late to look on does not see it go down.
        awaited(lambda: len({tuple(round(at, 3) for at in (one.tip.x, one.tip.y, one.tip.z)) for one in seen}) > 5)
        halt = self.live.ask("StopMachine")
        self.assertIn(MachineState.Name(halt.status.state), ("MACHINE_STATE_STOPPING", "MACHINE_STATE_HELD"))
        held = self.live.wait("HELD")
        self.assertEqual(HoldReason.Name(held.hold_reason), "HOLD_REASON_STOP")
        stands = held.tip
        self.assertEqual(self.live.later(held).tip, stands)
        self.refused("CELL-E9421", "StartMachine", program=5)
        self.refused("CELL-E9421", "DisableMachine")
        self.live.ask("ResumeMachine")
        awaited(lambda: self.live.status().tip != stands)
        over = self.live.ask("AbortRun")
        self.assertIn(MachineState.Name(over.state), ("MACHINE_STATE_STOPPING", "MACHINE_STATE_IDLE"))
        self.live.wait("IDLE")
        # Twenty a second while it moved, none of them out of order.
        times = [one.virtual_time_ns for one in seen]
        self.assertEqual(times, sorted(times))

    def watch(self, seen, machine=MILL):
        try:
            for message in self.cell.machines().WatchMachine(machine_pb2.WatchMachineRequest(name=machine)):
                seen.append(message.status)
        except grpc.RpcError:
            pass

    def test_status_lies_on_the_trajectory(self):
        """LIVE-10.21, LIVE-3.16: each position at its virtual time, with holds and overrides between, at factors 1 and 10."""
        self.live = live = Live(self, self.cell, "machines/optimo-1")
        live.enable()
        live.acquire(ttl={"seconds": 60})
        # Without an end: however late somebody looks, it goes on.
        moves = "".join(f"MOVE ({1000 + 37 * i % 200}., {500 + 53 * i % 170}., {-400 + 7 * i % 30}., 0., 0.)\n" for i in range(60))
        live.store(5, f"COORD ABSOL\nPATH LIN\nSPEED 20\n10 {moves}GOTO 10\n", "a.S")
        seen = []
        threading.Thread(target=self.watch, args=(seen, live.machine), daemon=True).start()
        live.ask("StartMachine", program=5)
        for factor in (1.0, 10.0):
            live.ask("SetFactor", factor=factor)
            for percent in (100.0, 40.0):
                live.ask("SetOverride", override_percent=percent)
                before = len(seen)
                awaited(lambda: len(seen) > before + 15)
                live.ask("StopMachine")
                live.wait("HELD")
                live.ask("ResumeMachine")
        live.ask("AbortRun")
        live.wait("IDLE")
        kept = str(self.cell.folder / "run.rmlj")
        self.cell.command("replay", "optimo-1", "-o", kept)
        moving = [one for one in seen if MachineState.Name(one.state) in ("MACHINE_STATE_RUNNING", "MACHINE_STATE_STOPPING")]
        self.assertGreater(len({tuple(round(axis.value, 3) for axis in one.axes) for one in moving}), 40)
        for one in random.Random(1).sample(moving, 24):
            told = ask("replay", kept, "--to", str(one.virtual_time_ns)).stdout.splitlines()[0]
            self.assertIn(MachineState.Name(one.state)[len("MACHINE_STATE_"):], told)
            for axis in one.axes:
                there = float(re.search(rf"  {axis.axis} (-?[0-9.]+) ", told + " ").group(1))
                self.assertLessEqual(abs(there - axis.value), 0.01, f"{one.virtual_time_ns}: {axis.axis}: {told}")

    def test_a_run_to_its_end_is_in_the_log(self):
        self.live.enable()
        self.live.store()
        self.live.acquire()
        self.live.ask("SetFactor", factor=100.0)
        self.live.ask("StartMachine", program=5)
        self.live.wait("IDLE")
        self.live.disable()  # behind all that its host had to tell
        told = [self.kind_of(one) for one in self.log_of_machines()]
        self.assertEqual([one for one in told if one in ("run_begun", "run_over")], ["run_begun", "run_over"])
        self.assertEqual(told.count("start"), 1)

    @staticmethod
    def kind_of(event):
        what = event.WhichOneof("what")
        return event.input_applied.input.WhichOneof("input") if what == "input_applied" else what

    def told_to(self, last):
        """What was told of the machine up to the first of that kind, which must come."""
        told = []
        for message in self.cell.cell_service().WatchCell(cell_pb2.WatchCellRequest(after_sequence=0), timeout=60):
            if message.HasField("event") and message.event.HasField("machine"):
                told.append(message.event.machine)
                if self.kind_of(told[-1]) == last:
                    break
        return told

    # LIVE-3.30: standing where the last mark says, a run that was open cut off.
    def test_a_host_that_is_killed_is_found_in_inspection(self):
        self.live.enable()
        self.live.store()
        self.live.acquire()
        self.live.ask("StartMachine", program=5)
        seen = awaited(lambda: (lambda now: now if now.tip.z < -0.3 else None)(self.live.status()))
        # A mark that was made on the way.
        awaited(lambda: (lambda mark: mark and mark.virtual_time_ns >= seen.virtual_time_ns)(self.live.newest_mark()))
        before = self.live.status()
        mark = self.live.kill_host()
        after = self.live.wait("INSPECT")
        self.assertGreater(after.fence, before.fence)
        self.assertFalse(after.HasField("run"))
        self.assertFalse(after.HasField("control"))
        told = self.told_to("recovered")
        self.assertEqual((told[-1].recovered.mark_fence, told[-1].recovered.mark_virtual_time_ns), (mark.fence, mark.virtual_time_ns))
        # Where it was at that time: from where it was seen it is as far as it moves in the time between, 5 mm/s down at most.
        between_s = abs(mark.virtual_time_ns - before.virtual_time_ns) * 1e-9
        self.assertLessEqual(abs(after.tip.z - before.tip.z), 5.0 * between_s + 0.01)
        self.assertEqual(self.live.later(after).tip, after.tip)
        kinds = [self.kind_of(one) for one in told]
        self.assertLess(kinds.index("host_lost"), kinds.index("recovered"))
        self.live.acquire()
        self.refused("CELL-E9409", "StartMachine", program=5)
        self.refused("CELL-E9409", "ConfirmMachine")
        self.live.ask("ConfirmMachine", confirmations=[1])
        self.assertEqual(MachineState.Name(self.live.ask("StartMachine", program=5).state), "MACHINE_STATE_RUNNING")

    # LIVE-3.31: the host lives; the run is held, and a person lets it go on.
    def test_a_server_that_is_killed_holds_the_run(self):
        self.live.enable()
        self.live.store()
        self.live.acquire(ttl={"seconds": 60})
        self.live.ask("StartMachine", program=5)
        awaited(lambda: self.live.status().tip.z < -0.3)
        before = self.live.status()
        self.cell.kill()
        self.assertEqual(len(self.hosts()), 1)
        self.live.wait_until_held_by_itself(HoldReason.Value("HOLD_REASON_SERVER_LOST"))
        self.cell.start()
        held = self.live.wait("HELD")
        self.assertEqual(HoldReason.Name(held.hold_reason), "HOLD_REASON_SERVER_LOST")
        self.assertEqual((held.fence, held.host, held.run.run), (before.fence, before.host, before.run.run))
        awaited(lambda: len(self.hosts()) == 1)  # another one is started where it is late to come back, and ends
        stands = self.live.status().tip
        self.live.ask("ResumeMachine")
        awaited(lambda: self.live.status().tip != stands)

    # LIVE-3.31: a run that is held waits for its server, however long that is away.
    @unittest.skipUnless(os.environ.get("RMLCELL_LONG"), "takes more than a minute")
    def test_a_held_run_waits_for_its_server(self):
        self.live.enable()
        self.live.store()
        self.live.acquire(ttl={"seconds": 60}, on_loss="ON_LOSS_GO_ON")
        self.live.ask("StartMachine", program=5)
        awaited(lambda: self.live.status().tip.z < -0.3)
        self.live.ask("StopMachine")
        before = self.live.wait("HELD")
        nothing_to_keep = Live(self, self.cell, "machines/optimo-1")
        nothing_to_keep.enable()
        process = nothing_to_keep.host()
        self.cell.kill()
        awaited(lambda: process not in self.hosts(), 600)
        self.cell.start()
        held = self.live.wait("HELD")
        self.assertEqual((held.fence, held.host, held.run.run, held.tip), (before.fence, before.host, before.run.run, before.tip))
        self.live.acquire()
        self.live.ask("ResumeMachine")
        awaited(lambda: self.live.status().tip != held.tip)

    # A server that hangs is as good as none: a machine that nobody can reach does not go on.
    def test_a_server_that_hangs_holds_the_run(self):
        self.live.enable()
        self.live.store()
        self.live.acquire(ttl={"seconds": 60})
        self.live.ask("StartMachine", program=5)
        awaited(lambda: self.live.status().tip.z < -0.3)
        before = self.live.status()
        self.cell.process.send_signal(signal.SIGSTOP)
        self.live.wait_until_held_by_itself(HoldReason.Value("HOLD_REASON_SERVER_LOST"))
        self.cell.process.send_signal(signal.SIGCONT)
        held = self.live.wait("HELD")
        self.assertEqual(HoldReason.Name(held.hold_reason), "HOLD_REASON_SERVER_LOST")
        self.assertEqual((held.fence, held.host), (before.fence, before.host))
        self.live.ask("ResumeMachine")
        awaited(lambda: self.live.status().tip != held.tip)

    # LIVE-10.04: kill -9 of the host, at random moments of a run: no input that was answered is missing in the log
    # or there twice, the machine stands where its last mark says, and each run that began has one end.
    def test_crash_rounds(self):
        rounds = int(os.environ.get("LIVE_ROUNDS", "5"))
        seed = int(os.environ.get("LIVE_SEED", "1"))
        choose = random.Random(seed)
        self.live.enable()
        self.live.store()
        answered, marks = [], []
        for round_ in range(rounds):
            self.live.acquire(take_over=True, reason="a test", ttl={"seconds": 60})
            for _ in range(choose.randrange(1, 4)):
                for method in ("StartMachine", "StopMachine", "ResumeMachine"):
                    fields = {"program": 5} if method == "StartMachine" else {}
                    request_id = new_id()
                    try:
                        self.live.ask(method, request_id=request_id, **fields)
                        if method != "StopMachine":  # that acts first, and is written behind
                            answered.append(request_id)
                    except grpc.RpcError:
                        pass
                    time.sleep(choose.random() * 0.1)
            before = self.live.status()
            mark = self.live.kill_host()
            marks.append((mark.fence, mark.virtual_time_ns))
            after = awaited(lambda: (lambda now: now if now.fence > before.fence and now.state not in (2, 3, 12)
                                     else None)(self.live.status()))
            place = f"seed {seed}, round {round_}: {MachineState.Name(before.state)}"
            self.assertEqual(MachineState.Name(after.state), "MACHINE_STATE_INSPECT", place)
            self.live.acquire(take_over=True, reason="a test")
            self.live.ask("ConfirmMachine", confirmations=[1])
            self.live.enable()  # a person knows why its hosts die
        self.live.disable()
        inputs, begun, over, times, recovered = [], [], [], [], []
        for event in self.log_of_machines():
            if event.HasField("input_applied"):
                inputs.append(event.input_applied.request_id)
                times.append((event.fence, event.virtual_time_ns))
            elif event.HasField("run_begun"):
                begun.append(event.run_begun.run)
            elif event.HasField("run_over"):
                over.append(event.run_over.run)
            elif event.HasField("recovered"):
                recovered.append((event.recovered.mark_fence, event.recovered.mark_virtual_time_ns))
        for request_id in answered:
            self.assertEqual(inputs.count(request_id), 1, f"seed {seed}: {request_id}")
        self.assertEqual(times, sorted(times))
        self.assertEqual(begun, sorted(set(begun)))
        self.assertEqual(over, begun)
        self.assertEqual(recovered, marks)

    # LIVE-4.03.
    def test_control_is_taken_over_with_a_reason(self):
        self.live.enable()
        old = self.live.acquire()
        self.refused("CELL-E9003", "AcquireControl", take_over=True)
        self.live.acquire(take_over=True, reason="shift change")
        with self.assertRaises(grpc.RpcError) as caught:
            self.live.stub.RenewControl(control.RenewControlRequest(machine=MILL, control_token=old))
        self.assertEqual(detail_of(caught.exception).code, "CELL-E9420")
        self.live.ask("ReleaseControl")
        self.assertFalse(self.live.status().HasField("control"))  # LIVE-3.16: told before it is answered

    def test_variables_inputs_and_breakpoints_of_an_optimo(self):
        live = Live(self, self.cell, "machines/optimo-1")
        live.enable()
        live.acquire()
        self.live = live
        written = live.ask("WriteVariables", variables=[{"name": "VR[3]", "value": {"real": 2.5}}])
        self.assertFalse(written.variables[0].HasField("error"))
        wrong = live.ask("WriteVariables", variables=[{"name": "VR[4]", "value": {"real": 1.0}},
                                                      {"name": "NONE", "value": {"real": 1.0}}])
        self.assertTrue(wrong.variables[1].HasField("error"))
        values = live.ask("ReadVariables", variables=["VR[3..4]"]).variables
        self.assertEqual([one.value.real for one in values], [2.5, 0.0])
        live.store(5, "WAIT IL[20]\nVR[5] = 7.\nPAUSE\n", "a.S")
        live.ask("StartMachine", program=5)
        live.wait("RUNNING")
        live.ask("SetInputs", inputs=[{"input": {"name": "IL[20]", "value": {"logical": True}}}])
        live.wait("IDLE")
        self.assertEqual(live.ask("ReadVariables", variables=["VR[5]"]).variables[0].value.real, 7.0)
        state = live.ask("SetBreakpoints", breakpoints=[{"step": {"program": 5, "step": 2}}])
        self.assertEqual(state.breakpoints[0].step.step, 2)
        self.assertEqual(live.ask("GetRunState").breakpoints[0].step.program, 5)

    # OPT-4.50, over gRPC: a machine that lost its reference finds it and goes home.
    def test_an_optimo_is_zeroed(self):
        self.live = live = Live(self, self.cell, "machines/optimo-1")
        live.enable()
        live.acquire(ttl={"seconds": 60})
        live.store(4, "COORD ABSOL\nMOVE (100.,200.,-30.,0.,0.)\n", "a.S")
        live.ask("SetFactor", factor=100.0)
        live.ask("SetInputs", inputs=[{"power": False}])
        live.ask("SetInputs", inputs=[{"power": True}])
        live.wait("NOT_ZEROED")
        self.refused("OPT-E7310", "StartMachine", program=4)
        self.assertEqual(MachineState.Name(live.ask("ZeroMachine").state), "MACHINE_STATE_JOGGING")
        at_home = live.wait("IDLE")
        self.assertTrue(at_home.zeroed)
        self.assertEqual([round(axis.value, 3) for axis in at_home.axes][:2], [100.0, 200.0])

    # OPT-B.82, OPT-4.50, OPT-10.13, OPT-10.15: a new machine has neither program 2 nor 4; the product has them.
    def test_a_new_optimo_is_given_the_special_programs(self):
        self.live = live = Live(self, self.cell, "machines/optimo-1")
        live.enable()
        live.acquire(ttl={"seconds": 60})
        live.store(12, "SYSDEF (10.,20.,30.,0.,0.,0.)\nCOORD ABSOL\nMOVE (1000.,900.,-600.,0.8,0.5)\nCALL 2\n"
                       "COORD ABSOL\nMOVE (1000.,900.,-600.,0.,0.)\nCALL 2\n", "12.S")
        live.ask("SetFactor", factor=100.0)
        live.ask("StartMachine", program=12)
        run = eventually(lambda: live.status().last_run if live.status().last_run.run else None)
        self.assertEqual((run.program, run.outcome.code), (12, "OPT-E7102"))
        programs = self.cell.programs()
        stored = programs.StoreSpecialPrograms(program_pb2.StoreSpecialProgramsRequest(parent=live.machine)).programs
        self.assertEqual([one.name.split("/")[-1] for one in stored], ["1", "2", "4", "90"])
        for one in stored:
            text = programs.GetProgramContent(program_pb2.GetProgramContentRequest(name=one.name)).content
            found = programs.CheckProgram(program_pb2.CheckProgramRequest(
                machine=live.machine, program={"file_name": one.file_name, "content": text})).findings
            self.assertEqual((found.ok, list(found.diagnostics)), (True, []), one.title)
        live.ask("SetInputs", inputs=[{"power": False}])
        live.ask("SetInputs", inputs=[{"power": True}])
        self.assertEqual(MachineState.Name(live.ask("ZeroMachine").state), "MACHINE_STATE_JOGGING")
        at_home = live.wait("IDLE")
        self.assertEqual([round(axis.value, 3) for axis in at_home.axes], [21.02, 2201.2, -50.0, 0.0, 0.0])
        live.ask("StartMachine", program=12)
        up = eventually(lambda: (lambda now: now if now.last_run.run > at_home.last_run.run else None)(live.status()))
        self.assertEqual(up.last_run.outcome.kind, Outcome.KIND_COMPLETED)
        # Not 10 mm beside it: the first CALL 2 left no offset.
        self.assertEqual([round(axis.value, 3) for axis in up.axes], [1000.0, 900.0, -50.0, 0.0, 0.0])


if __name__ == "__main__":
    unittest.main()
