#!/usr/bin/env python3
"""What goes over the wire in parts: uploads, downloads, traces, toolpaths; and the same through the web."""
import hashlib
import json
import unittest
import urllib.error
import urllib.request

from cell import (WithCell, cell_pb2, common_pb2, detail_of, endless_job, grpc, inline_job, job_pb2, machine_pb2, program_pb2, project_pb2, submit,
                  wait_for_end, wait_until_it_runs)

BAD = grpc.StatusCode.INVALID_ARGUMENT
UNKNOWN = grpc.StatusCode.NOT_FOUND
LINE = b"PU100,100;PD200,200;\n"


def header(data, slot=9, **more):
    fields = {"name": f"machines/mill-1/programs/{slot}", "file_name": "a.rml", "size": len(data),
              "sha256": hashlib.sha256(data).hexdigest(), **more}
    return program_pb2.UploadProgramRequest(header=program_pb2.UploadProgramRequest.Header(**fields))


def chunk(data):
    return program_pb2.UploadProgramRequest(chunk=data)


class Uploads(WithCell):
    def refused_upload(self, messages, code, words):
        with self.assertRaises(grpc.RpcError) as caught:
            self.cell.programs().UploadProgram(iter(messages), timeout=60)
        detail = detail_of(caught.exception)
        self.assertEqual(detail.code, code)
        self.assertIn(words, detail.message)

    def test_what_is_sent_in_a_wrong_order_is_refused(self):
        data = LINE * 3
        self.refused_upload([chunk(data)], "CELL-E9003", "the first message must be the header")
        self.refused_upload([], "CELL-E9003", "no header")
        self.refused_upload([header(data), header(data)], "CELL-E9003", "a second header")
        self.refused_upload([header(data), chunk(data), chunk(b" ")], "CELL-E9016", "more bytes than the header says")
        self.refused_upload([header(data), chunk(data[:-1])], "CELL-E9016", f"{len(data) - 1} bytes came, {len(data)} were announced")
        self.refused_upload([header(data, sha256="0" * 64), chunk(data)], "CELL-E9016", "SHA-256 differs")
        self.refused_upload([header(b"")], "CELL-E9017", "a.rml")
        self.refused_upload([header(b""), chunk(data)], "CELL-E9003", "header.size is missing")
        self.refused(self.cell.programs().GetProgram, program_pb2.GetProgramRequest(name="machines/mill-1/programs/9"),
                     UNKNOWN, "CELL-E9004")

    def test_the_header_is_what_is_stored(self):
        stub = self.cell.programs()
        data = b"SPEED 20\n"
        dry = stub.UploadProgram(iter([header(data, name="machines/optimo-1/programs/20", file_name="x.S", validate_only=True),
                                       chunk(data)]))
        self.assertEqual(dry.file_name, "x.S")
        self.refused(stub.GetProgram, program_pb2.GetProgramRequest(name=dry.name), UNKNOWN, "OPT-E7102")
        kept = stub.UploadProgram(iter([header(data, name="machines/optimo-1/programs/20", file_name="x.S", title="Plate",
                                               form=common_pb2.PROGRAM_FORM_SOURCE), chunk(data[:4]), chunk(data[4:])]))
        self.assertEqual((kept.title, kept.file_name), ("Plate", "x.S"))
        late = stub.UploadProgram(iter([header(data, name=kept.name, file_name="x.S", etag=kept.etag), chunk(data)]))
        self.refused_upload([header(data, name=kept.name, file_name="x.S", etag=kept.etag + "0"), chunk(data)], "CELL-E9006", "")
        self.assertTrue(late.etag)

    def test_a_download_comes_with_a_header_and_in_chunks(self):
        stub = self.cell.programs()
        data = LINE * 30_000  # 630,000 bytes: two chunks of 256 KiB and a rest
        stub.UploadProgram(iter([header(data, slot=21, file_name="big.rml"), chunk(data)]))
        parts = list(stub.DownloadProgram(program_pb2.DownloadProgramRequest(name="machines/mill-1/programs/21")))
        self.assertEqual(parts[0].header.size, len(data))
        self.assertEqual(parts[0].header.sha256, hashlib.sha256(data).hexdigest())
        self.assertEqual(parts[0].header.file_name, "big.rml")
        self.assertNotEqual(parts[0].header.form, common_pb2.PROGRAM_FORM_UNSPECIFIED)
        self.assertEqual([len(part.chunk) for part in parts[1:]], [262144, 262144, len(data) - 524288])
        with self.assertRaises(grpc.RpcError) as caught:
            list(stub.DownloadProgram(program_pb2.DownloadProgramRequest(name="machines/mill-1/programs/99")))
        self.assertEqual(caught.exception.code(), UNKNOWN)

    def test_one_message_takes_three_mebibytes(self):
        stub = self.cell.programs()
        exact = (LINE * 200_000)[:(3 << 20) - 1] + b";"
        for slot, data in ((22, exact), (23, exact + b";")):
            stub.UploadProgram(iter([header(data, slot=slot), chunk(data)]))
        got = stub.GetProgramContent(program_pb2.GetProgramContentRequest(name="machines/mill-1/programs/22"))
        self.assertEqual(len(got.content), 3 << 20)
        self.assertEqual((got.file_name, got.sha256), ("a.rml", hashlib.sha256(exact).hexdigest()))
        detail = self.refused(stub.GetProgramContent,
                              program_pb2.GetProgramContentRequest(name="machines/mill-1/programs/23"),
                              grpc.StatusCode.RESOURCE_EXHAUSTED, "CELL-E9007")
        self.assertIn(f"{(3 << 20) + 1} bytes: use DownloadProgram", detail.message)


class Explanations(WithCell):
    def test_errors_are_explained_by_code_number_or_all(self):
        stub = self.cell.programs()
        every = stub.ExplainError(program_pb2.ExplainErrorRequest()).errors
        self.assertEqual(stub.ExplainError(program_pb2.ExplainErrorRequest(language="de-CH")).language, "en")
        self.assertGreater(len(every), 150)
        self.assertEqual([one.code for one in stub.ExplainError(program_pb2.ExplainErrorRequest(code="OPT-E348")).errors],
                         ["OPT-E348"])
        detail = self.refused(stub.ExplainError, program_pb2.ExplainErrorRequest(code="x" * 100), UNKNOWN, "CELL-E9004")
        self.assertEqual(detail.message, f"no error '{'x' * 80}'")


class Compiled(WithCell):
    def test_compile_gives_the_object_or_the_findings(self):
        stub = self.cell.programs()
        source = program_pb2.CompileProgramRequest(family="optimo")
        source.program.file_name, source.program.content = "1.S", b"SPEED 20\n"
        made = stub.CompileProgram(source)
        self.assertTrue(made.findings.ok and made.object)
        source.program.content = b"SPEDE 20\n"
        refused = stub.CompileProgram(source)
        self.assertFalse(refused.findings.ok or refused.object)
        self.assertEqual(len(refused.findings.diagnostics), 1)


class Products(WithCell):
    def test_a_trace_comes_in_messages_of_five_hundred_records(self):
        stub = self.cell.jobs()
        text = "".join(f"OL[20]={'ON' if n % 2 == 0 else 'OFF'}\n" for n in range(700))
        job = inline_job("optimo-1", "t.S", text)
        job.simulation.trace = True
        job = submit(stub, job)
        wait_for_end(stub, job.name)
        sizes = [len(part.records) for part in stub.StreamJobTrace(job_pb2.StreamJobTraceRequest(name=job.name))]
        self.assertGreaterEqual(sum(sizes), 700)
        self.assertTrue(all(size == 500 for size in sizes[:-1]))
        self.assertEqual(len(sizes), -(-sum(sizes) // 500))
        records = [record for part in stub.StreamJobTrace(job_pb2.StreamJobTraceRequest(name=job.name))
                   for record in part.records]
        self.assertEqual([record.number for record in records], list(range(1, len(records) + 1)))

    def test_streams_of_nothing_are_refused(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "p.rml", LINE))
        wait_for_end(stub, job.name)
        for level, refused in ((0, False), (-1, True), (100, True)):
            stream = stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name=job.name, level=level))
            if not refused:
                self.assertGreater(len(list(stream)), 0)
                continue
            with self.assertRaises(grpc.RpcError) as caught:
                list(stream)
            self.assertEqual(caught.exception.code(), BAD)
            self.assertIn(f"level is {level}, allowed are 0 to ", caught.exception.details())
        for stream in (stub.StreamJobTrace(job_pb2.StreamJobTraceRequest(name="jobs/999999")),
                       stub.StreamJobToolpath(job_pb2.StreamJobToolpathRequest(name="jobs/999999")),
                       stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name="jobs/999999"))):
            with self.assertRaises(grpc.RpcError) as caught:
                list(stream)
            self.assertEqual(caught.exception.code(), UNKNOWN)
        for request in (job_pb2.WatchJobRequest(name=job.name, after_sequence=-1),
                        job_pb2.WatchJobRequest(name=job.name, after_sequence=10_000)):
            with self.assertRaises(grpc.RpcError) as caught:
                list(stub.WatchJob(request))
            self.assertEqual(caught.exception.code(), BAD)

    def test_each_progress_is_told_once(self):
        stub = self.cell.jobs()
        job = submit(stub, endless_job())
        wait_until_it_runs(stub, job.name)
        for watch in (stub.WatchJob(job_pb2.WatchJobRequest(name=job.name)),
                      self.cell.cell_service().WatchCell(cell_pb2.WatchCellRequest())):
            times = []
            for message in watch:
                if message.HasField("progress"):
                    times.append(message.progress.virtual_time_ns)
                if len(times) == 10:
                    break
            watch.cancel()
            self.assertEqual(times, sorted(set(times)))
        stub.CancelJob(job_pb2.CancelJobRequest(name=job.name))
        wait_for_end(stub, job.name)

    def test_every_message_of_a_watch_names_the_cell_and_its_place(self):
        stub = self.cell.jobs()
        cell = self.cell.cell_service().GetCell(cell_pb2.GetCellRequest()).instance_id
        job = submit(stub, inline_job("mill-1", "p.rml", LINE))
        wait_for_end(stub, job.name)
        messages = list(stub.WatchJob(job_pb2.WatchJobRequest(after_sequence=0, name=job.name)))
        self.assertEqual({message.instance_id for message in messages}, {cell})
        self.assertTrue(messages[0].HasField("snapshot"))
        sequences = [message.sequence for message in messages[1:]]
        self.assertEqual(sequences, list(range(1, len(sequences) + 1)))
        self.assertEqual(messages[0].snapshot.last_sequence, sequences[-1])
        watch = self.cell.cell_service().WatchCell(cell_pb2.WatchCellRequest())
        self.assertEqual(next(iter(watch)).instance_id, cell)
        watch.cancel()

    def test_a_watch_of_named_jobs_tells_of_no_others(self):
        stub = self.cell.jobs()
        first = submit(stub, inline_job("mill-1", "p.rml", LINE))
        wait_for_end(stub, first.name)
        cell = self.cell.cell_service()
        sequence = next(cell.WatchCell(cell_pb2.WatchCellRequest())).sequence
        jobs = [submit(stub, inline_job("mill-1", f"{n}.rml", LINE)) for n in range(3)]
        for job in jobs:
            wait_for_end(stub, job.name)
        told = []
        named = cell_pb2.JobsSubscription(names=[jobs[1].name], events_only=True)
        watch = cell.WatchCell(cell_pb2.WatchCellRequest(subscriptions=[cell_pb2.Subscription(id="one", jobs=named)],
                                                         after_sequence=sequence))
        for message in watch:
            if message.HasField("bookmark"):
                continue
            self.assertTrue(message.instance_id)
            told.append((message.event.resource, message.sequence))
            if message.event.job.HasField("ended"):
                break
        watch.cancel()
        self.assertEqual({name for name, _ in told}, {jobs[1].name})
        self.assertEqual([position for _, position in told], sorted(position for _, position in told))
        with self.assertRaises(grpc.RpcError) as caught:
            misnamed = cell_pb2.JobsSubscription(names=["job/1"])
            next(cell.WatchCell(cell_pb2.WatchCellRequest(subscriptions=[cell_pb2.Subscription(id="one", jobs=misnamed)])))
        self.assertEqual(caught.exception.code(), BAD)


class Web(WithCell):
    def ask(self, path, body=None):
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}{path}", data=body,
                                         headers={"Content-Type": "application/octet-stream"} if body else {})
        try:
            with urllib.request.urlopen(request) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def test_a_program_goes_up_and_comes_down_in_each_form(self):
        text = b"SPEED 20\n"
        there = "/v1/machines/optimo-1/programs/30/content"
        status, _, answer = self.ask(f"{there}?file_name=a.S&title=Plate&sha256={hashlib.sha256(text).hexdigest()}", text)
        self.assertEqual(status, 200, answer)
        self.assertEqual(json.loads(answer)["title"], "Plate")
        status, headers, body = self.ask(f"{there}?form=source")
        self.assertEqual((status, body), (200, text))
        self.assertEqual(headers["Content-Type"], "text/plain; charset=utf-8")
        self.assertEqual(headers["ETag"].strip('"'), hashlib.sha256(text).hexdigest())
        self.assertIn("a.S", headers["Content-Disposition"])
        status, headers, body = self.ask(f"{there}?form=object")
        self.assertEqual((status, headers["Content-Type"]), (200, "application/octet-stream"))
        self.assertNotEqual(body, text)
        self.assertEqual(self.ask(f"{there}?form=executable")[0], 404)

    def test_what_differs_from_its_digest_is_not_stored(self):
        there = "/v1/machines/optimo-1/programs/31/content"
        status, _, answer = self.ask(f"{there}?file_name=a.S&sha256={'0' * 64}", b"SPEED 20\n")
        self.assertEqual(status, 400)
        self.assertIn(b"SHA-256 differs", answer)
        self.assertEqual(self.ask(there)[0], 404)
        status, _, answer = self.ask(f"{there}?file_name=a.S&validate_only=true", b"SPEED 20\n")
        self.assertEqual(status, 200)
        self.assertEqual(self.ask(there)[0], 404)
        status, _, answer = self.ask(f"{there}?file_name=a.S", b"SPEDE 20\n")
        self.assertEqual(status, 400)
        self.assertIn(b"SPEED", answer)

    def test_a_report_is_json(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "p.rml", LINE))
        wait_for_end(stub, job.name)
        status, headers, body = self.ask(f"/v1/{job.name}/artifacts/report")
        self.assertEqual((status, headers["Content-Type"]), (200, "application/json"))
        self.assertEqual(json.loads(body)["outcome"]["kind"], "KIND_COMPLETED")
        self.assertEqual(self.ask("/v1/jobs/999999/artifacts/report")[0], 404)
        self.assertEqual(self.ask(f"/v1/{job.name}/artifacts/none")[0], 404)


if __name__ == "__main__":
    unittest.main(verbosity=2)
