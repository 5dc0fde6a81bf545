#!/usr/bin/env python3
"""The off-line tools over gRPC, and what the command says of the same."""
import os
import pathlib
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

from cell import Cell, common_pb2, detail_of, grpc, program_pb2
from command import ask
from optimo_text import LINE, first_move


class Services(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell(workers=0)
        cls.addClassCleanup(cls.cell.close)
        cls.cell.start()
        cls.stub = cls.cell.programs()

    def text(self, name, content):
        return common_pb2.ProgramText(file_name=name, content=content.encode())

    def refused(self, call, request, code, ours):
        with self.assertRaises(grpc.RpcError) as caught:
            call(request, timeout=60)
        self.assertEqual(caught.exception.code(), code)
        self.assertEqual(detail_of(caught.exception).code, ours)

    def test_format(self):
        answer = self.stub.FormatProgram(program_pb2.FormatProgramRequest(program=self.text("a.S", "speed   20 ; slow\n")))
        self.assertIn(b"SPEED 20", answer.content)
        self.assertIn(b"; slow", answer.content)
        self.refused(self.stub.FormatProgram, program_pb2.FormatProgramRequest(), grpc.StatusCode.INVALID_ARGUMENT,
                     "CELL-E9017")

    def test_convert(self):
        answer = self.stub.ConvertProgram(program_pb2.ConvertProgramRequest(
            program=self.text("part.SI", "MOVE (1.,2.,-3.,90.,0.)\n"), date="Thu Mar 04 08:52:34 1993"))
        self.assertEqual(answer.file_name, "part.S")
        self.assertIn("Thu Mar 04 08:52:34 1993", answer.content.decode().splitlines()[0])
        self.assertAlmostEqual(first_move(answer.content.decode())[0], 25.4, places=5)
        self.refused(self.stub.ConvertProgram,
                     program_pb2.ConvertProgramRequest(program=self.text("part.txt", "MOVE (1.,2.,-3.,90.,0.)\n")),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7704")

    def test_compensate(self):
        source = ";$dia=0.508\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\nMOVE (10.,0.,0.,0.,0.)\nWORK 0,0/OFF\n"
        answer = self.stub.CompensateProgram(program_pb2.CompensateProgramRequest(program=self.text("part.S", source)))
        self.assertIn(b"MOVE (10.00000,0.25400,", answer.content)
        broken = self.stub.CompensateProgram(program_pb2.CompensateProgramRequest(program=self.text("part.S", "MOVE (\n")))
        self.assertEqual(broken.content, b"")
        self.assertGreater(len(broken.findings.diagnostics), 0)

    def test_transform(self):
        request = program_pb2.TransformProgramRequest(program=self.text("part.S", LINE))
        request.translation.x = 1.5
        self.assertEqual(first_move(self.stub.TransformProgram(request).content.decode())[0], 1001.5)
        request.rotation.extend([1.0, 2.0])
        self.refused(self.stub.TransformProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")

    def test_listing(self):
        put = program_pb2.PutProgramRequest(name="machines/optimo-1/programs/12")
        put.program.file_name, put.program.content = "12.S", LINE.encode()
        self.stub.PutProgram(put)
        answer = self.stub.GetProgramContent(program_pb2.GetProgramContentRequest(
            name="machines/optimo-1/programs/12", form=common_pb2.PROGRAM_FORM_LISTING))
        self.assertRegex(answer.content.decode(), r"^    1     1  +COORD ABSOL\n")

    def put(self, slot, name, content):
        put = program_pb2.PutProgramRequest(name=f"machines/optimo-1/programs/{slot}")
        put.program.file_name = name
        put.program.content = content if isinstance(content, bytes) else content.encode()
        return self.stub.PutProgram(put, timeout=60)

    # OPT-8.74, OPT-8.75
    def test_shift(self):
        request = program_pb2.ShiftProgramRequest(program=self.text("part.S", "VR[86] = 0.\nVR[89] = 1.\n"))
        request.translation.x = 30.0
        request.rotation.extend([0.5, 0.0, 0.0])
        self.assertEqual(self.stub.ShiftProgram(request).content, b"VR[86] = 30.0\nVR[89] = 1.5\n")
        none = self.stub.ShiftProgram(program_pb2.ShiftProgramRequest(program=self.text("part.S", "STOP\n")))
        self.assertEqual((none.content, none.findings.ok), (b"", False))
        self.assertEqual(none.findings.diagnostics[0].code, "OPT-E7852")
        request.rotation.extend([1.0])
        self.refused(self.stub.ShiftProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")

    # OPT-8.73: of a text and of its object the same but for the layout.
    def test_list_a_text(self):
        answer = self.stub.MakeListing(program_pb2.MakeListingRequest(program=self.text("a.S", LINE)))
        self.assertRegex(answer.content.decode(), r"^    1     1  +COORD ABSOL\n")
        compiled = self.stub.CompileProgram(program_pb2.CompileProgramRequest(program=self.text("a.S", LINE)))
        request = program_pb2.MakeListingRequest()
        request.program.content, request.program.form = compiled.object, common_pb2.PROGRAM_FORM_OBJECT
        self.assertEqual(self.stub.MakeListing(request).content, answer.content)
        wrong = self.stub.MakeListing(program_pb2.MakeListingRequest(program=self.text("a.S", "SPEED 101\n")))
        self.assertEqual((wrong.content, wrong.findings.ok), (b"", False))

    def test_fix(self):
        answer = self.stub.FixProgram(program_pb2.FixProgramRequest(program=self.text("a.S", "SPEDE 20 ; slow\n")))
        self.assertEqual(answer.content, b"SPEED 20 ; slow\n")
        self.assertEqual([finding.code for finding in answer.fixed], ["OPT-E7011"])
        self.assertTrue(answer.findings.ok)

    # OPT-1.13, OPT-1.15: the query, the command and the warning of the run agree.
    def test_link_and_staleness(self):
        self.put(74, "74.S", "VI[2]=1\n")
        self.put(72, "72.S", "FUNCTION 74\n")
        linked = self.stub.LinkProgram(program_pb2.LinkProgramRequest(slot=72, machine="machines/optimo-1"))
        self.assertEqual(list(linked.functions), [74])
        with tempfile.NamedTemporaryFile(suffix=".X") as file:
            file.write(linked.executable)
            file.flush()
            said = self.cell.command("put", "optimo-1", "172", file.name).stdout
        self.assertIn("programs/172 stored", said)
        request = program_pb2.ListStaleExecutablesRequest(parent="machines/optimo-1")
        self.assertEqual(len(self.stub.ListStaleExecutables(request).executables), 0)
        self.assertIn("every executable", self.cell.command("stale", "optimo-1").stdout)
        self.put(74, "74.S", "VI[2]=2\n")
        stale = self.stub.ListStaleExecutables(request).executables
        self.assertEqual([(one.name, [(part.program, part.reason) for part in one.parts]) for one in stale],
                         [("machines/optimo-1/programs/172",
                           [("machines/optimo-1/programs/74", program_pb2.StaleExecutable.REASON_FUNCTION_CHANGED)])])
        self.assertRegex(self.cell.command("stale", "optimo-1").stdout, r"172 +74 +FUNCTION 74 was altered")
        self.cell.command("delete", "optimo-1", "172")
        self.assertIn("every executable", self.cell.command("stale", "optimo-1").stdout)

    # OPT-10.17, OPT-E.7413: stored, and told of.
    def test_reserved_numbers_are_told_of(self):
        codes = [finding.code for finding in self.put(5, "5.S", "VI[2]=1\n").findings.diagnostics]
        self.assertEqual(codes, ["OPT-E7413"])
        self.assertEqual(len(self.put(8, "8.S", "VI[2]=1\n").findings.diagnostics), 0)
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "5.S"
            source.write_text("VI[2]=1\n")
            done = self.cell.command("put", "optimo-1", "5", source)
        self.assertIn("OPT-E7413", done.stdout + done.stderr)

    # OPT-1.15: the executable of another program is none of this one.
    def test_a_foreign_executable_is_refused(self):
        self.put(64, "64.S", "VI[2]=1\n")
        self.put(65, "65.S", "VI[2]=2\n")
        linked = self.stub.LinkProgram(program_pb2.LinkProgramRequest(slot=65, machine="machines/optimo-1"))
        request = program_pb2.PutProgramRequest(name="machines/optimo-1/programs/164")
        request.program.content = linked.executable
        self.refused(self.stub.PutProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")
        request.name = "machines/optimo-1/programs/165"
        self.stub.PutProgram(request)

    # OPT-8.70: comments, names and layout come back while the object is the one that was made of them.
    def test_own_text_comes_back_until_the_object_is_replaced(self):
        own = "; mine\nDECLARE   FEED = VR[5]\nfeed  =  20. ; slow\n"
        self.put(75, "slow.S", own)
        name = "machines/optimo-1/programs/75"
        request = program_pb2.DecompileProgramRequest(name=name)
        answer = self.stub.DecompileProgram(request)
        self.assertEqual((answer.content.decode(), answer.own_text, answer.file_name), (own, True, "slow.S"))
        self.assertEqual(self.cell.command("get", "optimo-1", "75").stdout, own)
        content = self.stub.GetProgramContent(
            program_pb2.GetProgramContentRequest(name=name, form=common_pb2.PROGRAM_FORM_OBJECT)).content
        self.put(75, "other.O", content)
        answer = self.stub.DecompileProgram(request)
        self.assertFalse(answer.own_text)
        self.assertNotIn(b"mine", answer.content)
        again = self.stub.CompileProgram(program_pb2.CompileProgramRequest(
            program=common_pb2.ProgramText(file_name="75.S", content=answer.content)))
        self.assertEqual(again.object, content)

    # OPT-8.70: a program that was stored as an object is shown as text; a terminal gets no bytes.
    def test_get_of_an_object_is_text(self):
        compiled = self.stub.CompileProgram(program_pb2.CompileProgramRequest(program=self.text("a.S", LINE))).object
        self.put(77, "77.O", compiled)
        source = self.cell.command("get", "optimo-1", "77").stdout
        self.assertIn("COORD ABSOL\n", source)
        self.assertEqual(source.encode(), self.stub.DecompileProgram(
            program_pb2.DecompileProgramRequest(object=compiled)).content)
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder) / "77.O"
            self.cell.command("get", "optimo-1", "77", "-o", target)
            self.assertEqual(target.read_bytes(), compiled)
            self.cell.command("get", "optimo-1", "77", "-o", target.with_suffix(".S"))
            self.assertEqual(target.with_suffix(".S").read_text(), source)
        terminal, inside = os.openpty()
        try:
            done = ask("get", "optimo-1", "77", "--form", "object", server=self.cell.address, stdout=inside,
                       stderr=subprocess.PIPE)
        finally:
            os.close(inside)
            os.close(terminal)
        self.assertEqual(done.returncode, 2, done)
        self.assertTrue(done.stderr.startswith("rmlcell: CELL-E9026: "), done.stderr)
        self.assertIn("-o FILE", done.stderr)

    def test_diff(self):
        self.put(76, "76.S", LINE)
        request = program_pb2.DiffProgramsRequest(picture=True)
        request.before.name = "machines/optimo-1/programs/76"
        request.after.text.CopyFrom(self.text("new.S", LINE.replace("1010.", "1013.")))
        diff = self.stub.DiffPrograms(request)
        self.assertEqual([(step.step_before, step.step_after) for step in diff.steps], [(5, 5)])
        self.assertAlmostEqual(diff.steps[0].target_moved_mm, 3.0, places=6)
        self.assertIn("travel_length", [figure.name for figure in diff.figures])
        xml.etree.ElementTree.fromstring(diff.picture_svg)
        request.after.text.content = b"SPEED 101\n"
        self.refused(self.stub.DiffPrograms, request, grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7004")


if __name__ == "__main__":
    unittest.main(verbosity=2)
