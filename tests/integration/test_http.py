"""The web port as curl meets it, and reflection."""
import hashlib
import json
import os
import socket
import subprocess
import unittest
import urllib.error
import urllib.parse
import urllib.request

from cell import (SQUARE, WithCell, grpc, inline_job, job_pb2, submit, wait_for_end)


class Web(WithCell):
    def post(self, method, body, **headers):
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}/{method}", json.dumps(body).encode(),
                                         {"Content-Type": "application/json", **headers})
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)

    def test_a_client_that_ends_its_sending_gets_its_answer(self):
        body = b"{}"
        head = ("POST /rmlcell.v1.MachineService/ListMachines HTTP/1.1\r\nHost: localhost\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n").encode()
        for request in (head + body, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"):
            for _ in range(10):
                with socket.create_connection(("127.0.0.1", self.cell.web_port), timeout=60) as connection:
                    connection.sendall(request)
                    connection.shutdown(socket.SHUT_WR)
                    answer = b""
                    while piece := connection.recv(65536):
                        answer += piece
                self.assertTrue(answer.startswith(b"HTTP/1.1 200"), answer[:80])

    def test_bytes_that_are_no_message_are_told_so(self):
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.MachineService/ListMachines", b"\xff\xff",
            {"Content-Type": "application/proto"})
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=60)
        self.assertEqual(caught.exception.code, 400)
        self.assertEqual(json.load(caught.exception)["code"], "invalid_argument")

    # What lists methods and what workers and hosts speak is nothing for pages, which are told of no such method.
    def test_services_that_are_not_for_browsers_are_not_found(self):
        for method in ("grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", "rmlcell.v1.WorkerService/Work",
                       "rmlcell.v1.HostService/Host"):
            with self.assertRaises(urllib.error.HTTPError) as caught:
                self.post(method, {})
            self.assertEqual(caught.exception.code, 404, method)
            answer = json.load(caught.exception)
            self.assertEqual(answer["code"], "unimplemented", method)
            self.assertIn(f"no method {method} on the web port", answer["message"])

    # RML1-E8007: what belongs to no command is refused with the reason, and stored where that is asked for.
    def test_an_upload_of_foreign_bytes_is_refused_unless_forced(self):
        def put(query):
            request = urllib.request.Request(
                f"http://127.0.0.1:{self.cell.web_port}/v1/machines/mill-1/programs/91/content?file_name=x.rml{query}",
                b"$" * 300, {"Content-Type": "application/octet-stream"}, method="POST")
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)
        for query in ("", "&force=false"):
            with self.assertRaises(urllib.error.HTTPError) as caught:
                put(query)
            self.assertEqual(caught.exception.code, 400)
            self.assertIn("RML1-E8007", caught.exception.read().decode())
        self.assertEqual(put("&force=true")["name"], "machines/mill-1/programs/91")

    def test_json_by_post_answers_like_the_call(self):
        machines = self.post("rmlcell.v1.MachineService/ListMachines", {})["machines"]
        self.assertEqual([machine["name"] for machine in machines], ["machines/mill-1", "machines/optimo-1"])
        with self.assertRaises(urllib.error.HTTPError) as caught:
            self.post("rmlcell.v1.MachineService/GetMachine", {"name": "machines/none"})
        self.assertEqual(caught.exception.code, 404)
        self.assertEqual(json.load(caught.exception)["code"], "not_found")

    def test_events_of_a_job_stream_and_resume_by_last_event_id(self):
        job = self.post("rmlcell.v1.JobService/SubmitJob", {"job": {
            "kind": "JOB_KIND_SIMULATE", "machine": "machines/mill-1",
            "inlineProgram": {"fileName": "a.rml", "content": "UFUxMDAwLDEwMDA7SDs="}}})
        def ids(**headers):
            message = urllib.parse.quote(json.dumps({"name": job["name"], "eventsOnly": True,
                                                     "afterSequence": 0}))
            request = urllib.request.Request(
                f"http://127.0.0.1:{self.cell.web_port}/rmlcell.v1.JobService/WatchJob?message={message}", None,
                {"Accept": "text/event-stream", **headers})
            with urllib.request.urlopen(request, timeout=60) as answer:
                return [line[3:].strip() for line in answer.read().decode().splitlines() if line.startswith("id:")]
        whole = ids()
        # The number, and behind a point the log; that of the snapshot is the number that the watch goes on after.
        self.assertEqual([int(one.split(".")[0]) for one in whole], list(range(len(whole))))
        self.assertEqual(len({one.split(".")[1] for one in whole}), 1)
        self.assertEqual(ids(**{"Last-Event-ID": whole[1]}), whole[1:])
        self.assertEqual(ids(**{"Last-Event-ID": "1"}), whole[1:])
        self.assertEqual(ids(**{"Last-Event-ID": "1.another-log"}), [])

    def test_products_have_stable_addresses_with_etag(self):
        stub = self.cell.jobs()
        job = submit(stub, inline_job("mill-1", "square.rml", SQUARE))
        wait_for_end(stub, job.name)
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/{job.name}/artifacts/picture.svg"
        with urllib.request.urlopen(url) as answer:
            etag = answer.headers["ETag"]
            self.assertEqual(answer.headers["Content-Type"], "image/svg+xml")
            self.assertIn(b"<svg", answer.read())
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(urllib.request.Request(url, headers={"If-None-Match": etag}))
        self.assertEqual(caught.exception.code, 304)
        with urllib.request.urlopen(f"http://127.0.0.1:{self.cell.web_port}/v1/{job.name}/artifacts/report") as answer:
            self.assertEqual(json.load(answer)["outcome"]["kind"], "KIND_COMPLETED")
        with urllib.request.urlopen(f"http://127.0.0.1:{self.cell.web_port}/") as page:
            self.assertIn(b"<html", page.read())

    def send(self, path, body):
        request = urllib.request.Request(f"http://127.0.0.1:{self.cell.web_port}{path}", data=body,
                                         headers={"Content-Type": "application/octet-stream"})
        with urllib.request.urlopen(request) as answer:
            return json.load(answer)

    def test_a_program_is_uploaded_without_a_slot_and_run(self):
        bytes_of_program = SQUARE if isinstance(SQUARE, bytes) else SQUARE.encode()
        digest = hashlib.sha256(bytes_of_program).hexdigest()
        for query in ("", "?sha256=" + digest):
            kept = self.send("/v1/uploads" + query, bytes_of_program)
            self.assertEqual((kept["sha256"], kept["size"]), (digest, str(len(bytes_of_program))))
            self.assertIn("expireTime", kept)
        stub = self.cell.jobs()
        job = job_pb2.Job(machine="machines/mill-1", kind=job_pb2.JOB_KIND_SIMULATE)
        job.uploaded_program.sha256 = digest.upper()
        job.uploaded_program.file_name = "square.rml"
        name = submit(stub, job).name
        wait_for_end(stub, name)
        ended = stub.GetJob(job_pb2.GetJobRequest(name=name))
        self.assertEqual(job_pb2.Job.State.Name(ended.state), "STATE_SUCCEEDED")
        self.assertEqual(ended.uploaded_program.file_name, "square.rml")
        job.uploaded_program.sha256 = "ab" * 32
        self.refused(stub.SubmitJob, job_pb2.SubmitJobRequest(job=job), grpc.StatusCode.NOT_FOUND, "CELL-E9004")
        with self.assertRaises(urllib.error.HTTPError) as caught:
            self.send("/v1/uploads?sha256=" + "ab" * 32, bytes_of_program)
        self.assertEqual(caught.exception.code, 400)
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(f"http://127.0.0.1:{self.cell.web_port}/v1/uploads")
        self.assertEqual((caught.exception.code, caught.exception.headers["Allow"]), (405, "POST"))

    def test_a_stored_program_is_drawn_without_a_job(self):
        bytes_of_program = SQUARE if isinstance(SQUARE, bytes) else SQUARE.encode()
        self.send("/v1/machines/mill-1/programs/8/content?file_name=square.rml", bytes_of_program)
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/machines/mill-1/programs/8/picture.svg"
        with urllib.request.urlopen(url + "?width=200") as answer:
            self.assertEqual(answer.headers["Content-Type"], "image/svg+xml")
            self.assertIn(b'width="200"', answer.read())
            etag = answer.headers["ETag"]
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(urllib.request.Request(url + "?width=200", headers={"If-None-Match": etag}))
        self.assertEqual(caught.exception.code, 304)
        with urllib.request.urlopen(url + "?width=300") as answer:
            self.assertNotEqual(answer.headers["ETag"], etag)
        self.send("/v1/machines/mill-1/programs/8/content?file_name=square.rml", bytes_of_program + b"PU0,0;")
        with urllib.request.urlopen(urllib.request.Request(url + "?width=200", headers={"If-None-Match": etag})) as answer:
            self.assertEqual(answer.status, 200)
        for query in ("?width=63", "?width=9000", "?width=x"):
            with self.assertRaises(urllib.error.HTTPError) as caught:
                urllib.request.urlopen(url + query)
            self.assertEqual(caught.exception.code, 400, query)

    def test_a_form_that_is_none_is_refused(self):
        url = f"http://127.0.0.1:{self.cell.web_port}/v1/machines/optimo-1/programs/61/content"
        def ask(query, body=None):
            request = urllib.request.Request(url + query, body, {"Content-Type": "application/octet-stream"} if body else {})
            try:
                with urllib.request.urlopen(request, timeout=60) as answer:
                    return answer.status, answer.read().decode()
            except urllib.error.HTTPError as error:
                return error.code, error.read().decode()
        self.assertEqual(ask("?file_name=a.S", b"SPEED 5\n")[0], 200)
        for query in ("", "?form=", "?form=source"):
            self.assertEqual(ask(query), (200, "SPEED 5\n"))
        self.assertEqual(ask("?form=listing")[0], 200)
        for query, body in (("?form=bogus", None), ("?form=SOURCE", None), ("?file_name=a.S&form=bogus", b"SPEED 6\n"),
                            ("?file_name=a.S&form=listing", b"SPEED 6\n")):
            status, text = ask(query, body)
            self.assertEqual(status, 400, query)
            self.assertIn("CELL-E9003", text)
        self.assertEqual(ask("?form=source"), (200, "SPEED 5\n"))

    def test_reflection_alone_is_enough_for_a_client(self):
        buf = os.environ.get("RMLCELL_BUF")
        if not buf:
            self.skipTest("buf is not here (RMLCELL_BUF)")
        base = [buf, "curl", "--protocol", "grpc", "--http2-prior-knowledge"]
        url = f"http://127.0.0.1:{self.cell.grpc_port}"
        listed = subprocess.run([*base, "--list-methods", url], capture_output=True, text=True, timeout=60)
        self.assertIn("rmlcell.v1.JobService/SubmitJob", listed.stdout, listed.stderr)
        said = subprocess.run([*base, "-d", '{"code":"348"}', f"{url}/rmlcell.v1.ProgramService/ExplainError"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(json.loads(said.stdout)["errors"][0]["code"], "OPT-E348")


if __name__ == "__main__":
    unittest.main(verbosity=2)
