#!/usr/bin/env python3
"""RUN jobs whose program was simulated with the machine as it is: tickets (live.md 5.02), over gRPC and by the command."""
import os
import subprocess
import unittest

from cell import BIN, awaited, job_pb2, machine_pb2, program_pb2
from live import MILL, Live, LiveTestCase, new_id

MAIN = "CALL 44\n"
CALLED = "DELAY 1\n"
OPTIMO = "machines/optimo-1"
SHORT = "PA;PA;VS10;!VZ5;!PZ-50,100;!MC1;PU200,0;PD400,0;PU0,0;!MC0;H;"


class TicketsTest(LiveTestCase):
    def command(self, *words):
        done = subprocess.run([os.path.join(BIN, "rmlcell"), *words, "--server", self.cell.address],
                              capture_output=True, text=True, timeout=60)
        return done

    def submit(self, kind, machine, **fields):
        return self.cell.jobs().SubmitJob(job_pb2.SubmitJobRequest(request_id=new_id(), job={
            "kind": "JOB_KIND_" + kind, "machine": machine, **fields})).name

    def ended(self, name):
        final = ("SUCCEEDED", "FAILED", "CANCELLED", "INTERRUPTED")

        def job():
            now = self.cell.jobs().GetJob(job_pb2.GetJobRequest(name=name))
            if now.state == job_pb2.Job.STATE_RUNNING:
                self.let_go_on(name)
            return now if job_pb2.Job.State.Name(now.state)[len("STATE_"):] in final else None
        now = awaited(job)
        return job_pb2.Job.State.Name(now.state)[len("STATE_"):], now.outcome.code + " " + now.outcome.message

    def put(self, slot, text):
        self.cell.programs().PutProgram(program_pb2.PutProgramRequest(
            name=f"{OPTIMO}/programs/{slot}", program={"file_name": f"{slot}.S", "content": text.encode()}))

    def enable(self, live):
        live.enable()
        live.acquire(take_over=True, reason="a test")
        live.ask("SetFactor", factor=100.0)
        live.ask("ReleaseControl")

    # LIVE-5.02: the machine asks for it; then what was simulated runs, and nothing else.
    def test_a_machine_that_asks_for_tickets(self):
        live = Live(self, self.cell, OPTIMO)
        self.enable(live)
        changed = self.command("machine", "options", "optimo-1", "ticket-needed=on")
        self.assertEqual(changed.returncode, 0, changed.stderr)
        self.assertIn("ticket-needed=on", changed.stdout)
        self.put(10, MAIN)
        self.put(44, CALLED)
        stored = f"{OPTIMO}/programs/10"
        state, why = self.ended(self.submit("RUN", OPTIMO, program=stored, run={"unzeroed": True}))
        self.assertEqual(state, "FAILED")
        self.assertIn("CELL-E9407", why)

        simulated = self.submit("SIMULATE", OPTIMO, program=stored)
        self.assertEqual(self.ended(simulated)[0], "SUCCEEDED")
        run = {"unzeroed": True, "ticket": simulated}
        self.assertEqual(self.ended(self.submit("RUN", OPTIMO, program=stored, run=run)), ("SUCCEEDED", " "))

        # Programs that it calls are part of it.
        self.put(44, CALLED.replace("DELAY 1", "DELAY 2"))
        state, why = self.ended(self.submit("RUN", OPTIMO, program=stored, run=run))
        self.assertEqual(state, "FAILED")
        self.assertIn(f"other than in {simulated}: programs/44", why)
        again = self.submit("SIMULATE", OPTIMO, program=stored)
        self.assertEqual(self.ended(again)[0], "SUCCEEDED")
        self.assertEqual(self.ended(self.submit("RUN", OPTIMO, program=stored, run={"unzeroed": True, "ticket": again}))[0], "SUCCEEDED")

    # LIVE-5.02: a ticket that is still to come; by the command.
    def test_a_run_behind_its_simulation(self):
        live = Live(self, self.cell, MILL)
        self.enable(live)
        program = {"file_name": "a.rml", "content": SHORT.encode()}
        first = self.submit("SIMULATE", MILL, inline_program=program)
        file = os.path.join(self.cell.folder, "a.rml")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(SHORT)
        number = first.split("/")[1]
        sent = self.command("submit", "mill-1", file, "--kind", "run", "--ticket", number)
        self.assertEqual(sent.returncode, 0, sent.stderr)
        self.assertEqual(self.ended(sent.stdout.strip())[0], "SUCCEEDED")
        other = os.path.join(self.cell.folder, "b.rml")
        with open(other, "w", encoding="utf-8") as stream:
            stream.write(SHORT.replace("PD400", "PD401"))
        sent = self.command("submit", "mill-1", other, "--kind", "run", "--ticket", number)
        state, why = self.ended(sent.stdout.strip())
        self.assertEqual(state, "FAILED")
        self.assertIn(f"other than in {first}: program", why)

    # LIVE-5.02, LIVE-5.03: a machine that was changed is another one, and its host knows that at once.
    def test_a_parameter_that_was_changed_makes_it_stale(self):
        live = Live(self, self.cell, MILL)
        self.enable(live)
        program = {"file_name": "a.rml", "content": SHORT.encode()}
        first = self.submit("SIMULATE", MILL, inline_program=program)
        self.assertEqual(self.ended(first)[0], "SUCCEEDED")
        self.cell.machines().UpdateMachine(machine_pb2.UpdateMachineRequest(machine=machine_pb2.Machine(
            name=MILL, parameters={"SPIN_UP": "3"}), update_mask={"paths": ["parameters"]}))
        live.wait("IDLE")
        state, why = self.ended(self.submit("RUN", MILL, inline_program=program, run={"ticket": first}))
        self.assertEqual(state, "FAILED")
        self.assertIn("parameter SPIN_UP", why)

    # LIVE-3.03: a machine is given to a computer by hand, with a reason.
    def test_a_machine_is_taken_by_hand(self):
        live = Live(self, self.cell, MILL)
        self.enable(live)
        taken = self.command("machine", "take", "mill-1", "--reason", "the hall is without power")
        self.assertEqual(taken.returncode, 0, taken.stderr)
        self.assertIn("IDLE", taken.stdout)
        nameless = self.command("machine", "take", "mill-1", "--reason", "x", "--computer", "a/b")
        self.assertEqual(nameless.returncode, 2, nameless.stderr)
        unknown = self.command("machine", "take", "none", "--reason", "x")
        self.assertIn("CELL-E9009", unknown.stderr)


if __name__ == "__main__":
    unittest.main()
