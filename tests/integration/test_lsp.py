#!/usr/bin/env python3
"""`rmlcell lsp` as editors drive it: a scripted client of the language server protocol."""
import json
import os
import pathlib
import queue
import shutil
import subprocess
import tempfile
import threading
import time
import unittest

from command import BIN, ask, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE_S = 60


class Client:
    """Starts the server; a thread reads what it says."""

    def __init__(self, folder, start=True, capabilities=None):
        self.folder = pathlib.Path(folder)
        self.process = subprocess.Popen([BIN / "rmlcell", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, cwd=folder)
        self.answers = {}
        self.arrived = threading.Condition()
        self.notices = queue.Queue()
        self.unasked = []  # errors without an id
        self.next_id = 0
        threading.Thread(target=self._read, daemon=True).start()
        if start:
            self.capabilities = self.ask("initialize", {
                "processId": os.getpid(), "rootUri": None,
                "capabilities": capabilities or {"textDocument": {
                    "codeAction": {"codeActionLiteralSupport": {}},
                    "publishDiagnostics": {"versionSupport": True},
                    "documentSymbol": {"hierarchicalDocumentSymbolSupport": True}}}})["capabilities"]
            self.tell("initialized", {})

    def _read(self):
        while True:
            length = None
            while (line := self.process.stdout.readline().strip()):
                name, value = line.split(b":", 1)
                if name.lower() == b"content-length":
                    length = int(value)
            if length is None:
                return
            body = self.process.stdout.read(length)
            if len(body) < length:
                return  # it was ended in the middle
            message = json.loads(body)
            with self.arrived:
                if "method" in message:
                    self.notices.put(message)
                elif message.get("id") is None:
                    self.unasked.append(message)
                else:
                    self.answers[message["id"]] = message
                self.arrived.notify_all()

    def raw(self, data):
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def send(self, message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))

    def tell(self, method, params):
        self.send({"method": method, "params": params})

    def begin(self, method, params):
        self.next_id += 1
        self.send({"id": self.next_id, "method": method, "params": params})
        return self.next_id

    def wait(self, what):
        with self.arrived:
            if not self.arrived.wait_for(what, PATIENCE_S):
                raise TimeoutError("the server does not answer")

    def answer(self, number):
        self.wait(lambda: number in self.answers)
        return self.answers.pop(number)

    def ask(self, method, params):
        """The result; an error is raised."""
        answer = self.answer(self.begin(method, params))
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer["result"]

    def error(self, method, params):
        return self.answer(self.begin(method, params))["error"]

    def uri(self, name):
        return (self.folder / name).as_uri()

    def open(self, name, text, version=1):
        self.tell("textDocument/didOpen", {"textDocument": {"uri": self.uri(name), "languageId": "optimo-rml",
                                                            "version": version, "text": text}})

    def change(self, name, version, *changes):
        self.tell("textDocument/didChange", {"textDocument": {"uri": self.uri(name), "version": version},
                                             "contentChanges": list(changes)})

    def diagnostics(self, name, version=None):
        """The findings of a document, of this version of it."""
        until = time.monotonic() + PATIENCE_S
        while True:
            notice = self.notices.get(timeout=max(0.1, until - time.monotonic()))
            if notice["method"] != "textDocument/publishDiagnostics":
                continue
            told = notice["params"]
            if told["uri"] == self.uri(name) and (version is None or told.get("version") == version):
                return told["diagnostics"]

    def at(self, method, name, line, character, **more):
        return self.ask("textDocument/" + method, self.place(name, line, character, **more))

    def place(self, name, line, character, **more):
        return {"textDocument": {"uri": self.uri(name)}, "position": {"line": line, "character": character}, **more}

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for wire in (self.process.stdin, self.process.stdout, self.process.stderr):
            try:
                wire.close()
            except BrokenPipeError:
                pass


def span(line, start, end, last=None):
    return {"start": {"line": line, "character": start}, "end": {"line": line if last is None else last,
                                                                 "character": end}}


def applied(text, edits):
    """The text after edits, positions in UTF-16."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)

    def offset(position):
        line, left = position["line"], position["character"]
        if line >= len(lines):
            return len(text)
        at = 0
        while left > 0 and at < len(lines[line]):
            left -= 2 if ord(lines[line][at]) > 0xFFFF else 1
            at += 1
        return starts[line] + at

    for edit in sorted(edits, key=lambda one: offset(one["range"]["start"]), reverse=True):
        text = text[:offset(edit["range"]["start"])] + edit["newText"] + text[offset(edit["range"]["end"]):]
    return text


class Session(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def client(self, **how):
        client = Client(self.folder, **how)
        self.addCleanup(client.close)
        return client


class Features(Session):
    def setUp(self):
        super().setUp()
        self.editor = self.client()

    # OPT-2.35
    def test_findings_come_when_a_document_is_opened_and_changed(self):
        self.editor.open("12.S", "SPEED 101\n")
        found = self.editor.diagnostics("12.S", 1)
        self.assertEqual([(one["code"], one["range"]) for one in found], [("OPT-E7004", span(0, 6, 9))])
        self.assertIn("OPT-2.35", found[0]["message"])
        self.editor.change("12.S", 2, {"range": span(0, 6, 9), "text": "10"})
        self.assertEqual(self.editor.diagnostics("12.S", 2), [])

    def test_findings_are_those_of_check(self):
        source = self.folder / "12.S"
        text = (ROOT / "deploy" / "examples" / "bracket.S").read_text() + "VR[98] = 1.\nGOTO 77\nMOVE (1,2,3)\n"
        source.write_text(text)
        done = ask("check", source, "--json")
        wanted = [(one["code"], one["place"]["line"] - 1, one["place"]["column"] - 1)
                  for one in json.loads(done.stdout)["diagnostics"]]
        self.editor.open("12.S", text)
        found = [(one["code"], one["range"]["start"]["line"], one["range"]["start"]["character"])
                 for one in self.editor.diagnostics("12.S")]
        self.assertEqual(found, wanted)
        self.assertGreater(len(found), 2)

    # OPT-7.20, OPT-3.05
    def test_hover(self):
        self.editor.open("12.S", "WORKDEF 1,0 (8.,75.,1.,50.)\nGOSUB 100\nWORK 1,0/ON\nENDTASK\n100 RETURN\n")
        text = self.editor.at("hover", "12.S", 1, 7)["contents"]["value"]
        self.assertIn("line 5, step 5", text)
        text = self.editor.at("hover", "12.S", 2, 2)["contents"]["value"]
        self.assertIn("OPT-3.13", text)
        self.assertIn("dwell at peak, s: `1.`", text)
        self.assertIsNone(self.editor.at("hover", "12.S", 5, 0))

    # OPT-7.15, OPT-7.44, OPT-9.01
    def test_definition_goes_to_labels_names_and_files(self):
        (self.folder / "44.S").write_text("SPEED 5\n")
        self.editor.open("12.S", "DECLARE X = VR[5]\nGOTO 20\nFUNCTION 44 (X)\n20 STOP\n")
        self.assertEqual(self.editor.at("definition", "12.S", 1, 6),
                         [{"uri": self.editor.uri("12.S"), "range": span(3, 0, 2)}])
        self.assertEqual(self.editor.at("definition", "12.S", 2, 13),
                         [{"uri": self.editor.uri("12.S"), "range": span(0, 8, 9)}])
        self.assertEqual(self.editor.at("definition", "12.S", 2, 10),
                         [{"uri": self.editor.uri("44.S"), "range": span(0, 0, 0)}])

    def test_references_of_a_program_are_found_in_the_folder(self):
        (self.folder / "13.S").write_text("SPEED 5\nCALL 44\n")
        self.editor.open("12.S", "FUNCTION 44\n")
        found = self.editor.at("references", "12.S", 0, 10, context={"includeDeclaration": True})
        self.assertEqual(found, [{"uri": self.editor.uri("12.S"), "range": span(0, 9, 11)},
                                 {"uri": self.editor.uri("13.S"), "range": span(1, 5, 7)}])

    # OPT-7.46: the object is the same but for the name, and a reserved word is refused.
    def test_rename_gives_a_program_that_does_the_same(self):
        text = ("DECLARE XHOME = VR[5]\n; XHOME \U0001d11e\n10 xhome = 5. ; \u00e4\nIF XHOME > 1. THEN 10 ELSE 20\n"
                "20 MOVE (XHOME,0,0,0,0)/TIME (1.,10)\n")
        self.editor.open("12.S", text)
        edits = self.editor.at("rename", "12.S", 2, 4, newName="XNEAR")["changes"][self.editor.uri("12.S")]
        named = applied(text, edits)
        self.assertEqual(named, text.replace("XHOME =", "XNEAR =").replace("xhome", "XNEAR")
                         .replace("IF XHOME", "IF XNEAR").replace("(XHOME", "(XNEAR"))
        edits = self.editor.at("rename", "12.S", 2, 0, newName="900")["changes"][self.editor.uri("12.S")]
        self.assertEqual(applied(text, edits),
                         text.replace("10 xhome", "900 xhome").replace("THEN 10", "THEN 900")
                         .replace(",10)", ",900)"))
        self.assertIn("reserved", self.editor.error("textDocument/rename",
                                                    self.editor.place("12.S", 2, 4, newName="SPEED"))["message"])

    # OPT-B.40: what the editor has afterwards is what the command writes.
    def test_formatting_is_that_of_format(self):
        text = "10   speed 5   ; \U0001d11e slow\n\nmove(1.,2.,\n3.,0.,0.)/fly\n     STOP\n"
        self.editor.open("12.S", text)
        edits = self.editor.ask("textDocument/formatting", {
            "textDocument": {"uri": self.editor.uri("12.S")}, "options": {"tabSize": 4, "insertSpaces": True}})
        source = self.folder / "a.S"
        source.write_text(text)
        run("format", source)
        self.assertEqual(applied(text, edits), source.read_text())

    # OPT-7.37, OPT-7.91
    def test_fixes(self):
        text = "SPED 5\nMOVE (1.,2.,3.,0.,0.) /INF\n"
        self.editor.open("12.S", text)
        ask = {"textDocument": {"uri": self.editor.uri("12.S")}, "range": span(0, 0, 0, last=2), "context": {}}
        actions = {one["title"]: one for one in self.editor.ask("textDocument/codeAction", ask)}
        fix = actions["Replace 'SPED' by 'SPEED'"]
        self.assertEqual(fix["kind"], "quickfix")
        whole = actions["Apply all fixes of rmlcell"]["edit"]["changes"][self.editor.uri("12.S")]
        self.assertEqual(applied(text, whole), "SPEED 5\nMOVE (1.,2.,3.,0.,0.)\n")

    # OPT-3.13, OPT-7.20
    def test_folding_and_outline(self):
        self.editor.open("12.S", "; a\n; b\nWORK 0,0/ON\nSPEED 5\nWORK 0,0/OFF\nGOSUB 9\nENDTASK\n9\nRETURN\n")
        whole = {"textDocument": {"uri": self.editor.uri("12.S")}}
        folds = self.editor.ask("textDocument/foldingRange", whole)
        self.assertEqual([(one["startLine"], one["endLine"]) for one in folds], [(0, 1), (2, 4), (7, 8)])
        symbols = self.editor.ask("textDocument/documentSymbol", whole)
        self.assertEqual([one["name"] for one in symbols],
                         ["1 WORK 0,0/ON", "2 SPEED 5", "3 WORK 0,0/OFF", "4 GOSUB 9", "5 ENDTASK", "9"])

    # OPT-2.43, OPT-7.15
    def test_completion(self):
        self.editor.open("12.S", "10 MOVE (1,2,3,0,0)/\nGOTO \n")
        labels = lambda line, character: [one["label"] for one in
                                          self.editor.at("completion", "12.S", line, character)["items"]]
        self.assertEqual(set(labels(0, 20)), {"VIA", "FLY", "START", "END", "TIME", "NEXT"})
        self.assertEqual(labels(1, 5), ["10"])

    def test_incremental_changes_keep_both_texts_the_same(self):
        text = "SPEED 5 ; \u00e4\U0001d11e\r\nSPEED 6\r\n"
        self.editor.open("12.S", text)
        self.editor.change("12.S", 2,
                           {"range": span(0, 10, 13), "text": "x"},         # both characters, three units
                           {"range": span(1, 6, 7), "text": "101"},
                           {"range": span(2, 0, 0), "text": "SPEED 102"},
                           {"range": span(0, 0, 0), "text": "PATH LIN\r\n"})
        found = self.editor.diagnostics("12.S", 2)
        self.assertEqual([one["range"] for one in found], [span(2, 6, 9), span(3, 6, 9)])

    # RML1-E1
    def test_a_pair_that_is_cut_in_two_and_a_range_of_null_keep_the_texts_the_same(self):
        self.editor.open("12.S", "SPEED 5 ; \U0001d11e\nSPEED 101\n")
        self.editor.change("12.S", 2, {"range": span(0, 11, 12), "text": ""})        # inside the pair: before it
        self.editor.change("12.S", 3, {"range": span(0, 10, 11), "text": "\ud834"},  # as JavaScript has it
                           {"range": span(0, 11, 11), "text": "\nSPEED 102"})
        self.assertEqual([one["range"] for one in self.editor.diagnostics("12.S", 3)],
                         [span(1, 6, 9), span(2, 6, 9)])
        self.editor.change("12.S", 4, {"range": None, "text": "SPEED 103\n"})
        self.assertEqual([one["range"] for one in self.editor.diagnostics("12.S", 4)], [span(0, 6, 9)])

    def test_a_stream_for_a_mill_has_findings(self):
        self.editor.open("part.rml", "PU0,0;QQ;PD10,10;")
        found = self.editor.diagnostics("part.rml")
        self.assertTrue(found)
        self.assertTrue(all(one["code"].startswith("RML1-") for one in found), found)
        self.assertEqual(found[0]["range"]["start"]["line"], 0)
        self.assertIsNone(self.editor.at("completion", "part.rml", 0, 6))


class Wires(Session):
    def ends(self, client, code):
        self.assertEqual(client.process.wait(timeout=PATIENCE_S), code)
        self.assertEqual(client.process.stderr.read(), b"")

    def test_shutdown_then_exit_ends_with_0(self):
        client = self.client()
        self.assertIsNone(client.ask("shutdown", None))
        self.assertEqual(client.error("textDocument/hover", {})["code"], -32600)
        client.tell("exit", None)
        self.ends(client, 0)

    def test_exit_without_shutdown_ends_with_1(self):
        client = self.client()
        client.tell("exit", None)
        self.ends(client, 1)

    def test_an_editor_that_is_gone_ends_it_with_1(self):
        client = self.client()
        client.open("12.S", "SPEED 5\n")
        client.process.stdin.close()
        self.ends(client, 1)

    # Their numbers must not go to files that a library opens: it would wait on one of those.
    def test_without_standard_input_or_output_it_ends_with_1(self):
        session = b""
        for message in ({"id": 1, "method": "initialize", "params": {}}, {"id": 2, "method": "shutdown"},
                        {"method": "exit"}):
            body = json.dumps({"jsonrpc": "2.0", **message}).encode()
            session += b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
        for closed, code in ((None, 0), (0, 1), (1, 1)):
            done = subprocess.run([BIN / "rmlcell", "lsp"], input=session, timeout=PATIENCE_S, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE,
                                  preexec_fn=None if closed is None else lambda closed=closed: os.close(closed))
            self.assertEqual((done.returncode, done.stderr), (code, b""), closed)

    def test_a_parent_that_is_gone_ends_it(self):
        parent = subprocess.Popen(["sleep", "600"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(parent.kill)
        client = self.client(start=False)
        client.ask("initialize", {"processId": parent.pid, "capabilities": {}})
        for _ in range(3):  # as long as it lives, all is answered
            client.error("nothing/atAll", {})
        parent.kill()
        parent.wait()
        self.ends(client, 1)

    # A number of another world of processes, as from outside of a container.
    def test_a_parent_that_is_not_there_says_nothing(self):
        nobody = subprocess.Popen(["true"])
        nobody.wait()
        client = self.client(start=False)
        client.ask("initialize", {"processId": nobody.pid, "capabilities": {}})
        client.ask("shutdown", None)
        client.tell("exit", None)
        self.ends(client, 0)

    def test_requests_before_initialize_are_refused(self):
        client = self.client(start=False)
        self.assertEqual(client.error("textDocument/hover", {})["code"], -32002)
        client.tell("exit", None)
        self.ends(client, 1)

    def test_broken_messages_are_answered_and_the_session_goes_on(self):
        client = self.client()
        client.raw(b"Content-Length: 9\r\n\r\n{\"id\": 1,")
        client.wait(lambda: len(client.unasked) == 1)
        client.raw(b"Content-Length: 99999999999999\r\n\r\n{}")
        client.wait(lambda: len(client.unasked) == 2)
        client.open("12.S", "SPEED 101\n")
        client.raw(b"X" * 10_000_000)  # a header without end
        client.wait(lambda: len(client.unasked) == 3)
        self.assertEqual([one["error"]["code"] for one in client.unasked], [-32700] * 3)
        self.assertEqual(len(client.diagnostics("12.S")), 1)
        self.assertEqual(client.error("textDocument/unknown", {})["code"], -32601)

    def test_bytes_of_any_kind_do_not_end_it(self):
        client = self.client()
        client.raw(bytes(range(256)) * 400)
        client.raw(b"[" * 200_000)
        body = b"[" * 1_000_000
        client.raw(b"\r\n\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body))
        client.open("12.S", "".join(map(chr, range(1, 0x250))) + "\n#\n")
        self.assertGreater(len(client.diagnostics("12.S")), 0)

    # A client that writes all before it reads anything must not hang.
    def test_many_requests_at_once_are_answered_in_order(self):
        client = self.client()
        client.open("12.S", "SPEED 5\n" * 200)
        numbers = [client.begin("textDocument/documentSymbol", {"textDocument": {"uri": client.uri("12.S")}})
                   for _ in range(300)]
        self.assertEqual(len(client.answer(numbers[-1])["result"]), 200)
        self.assertTrue(all(number in client.answers for number in numbers[:-1]))

    def test_a_request_can_be_cancelled_while_it_waits(self):
        client = self.client()
        client.open("12.S", "SPEED 5\n" * 50_000)
        client.diagnostics("12.S", 1)  # all of it is read: what follows finds room in the pipe as one piece
        body = b""
        for number in range(1000, 1200):
            for message in ({"id": number, "method": "textDocument/foldingRange",
                             "params": {"textDocument": {"uri": client.uri("12.S")}}},):
                text = json.dumps({"jsonrpc": "2.0", **message}).encode()
                body += b"Content-Length: %d\r\n\r\n%s" % (len(text), text)
        text = json.dumps({"jsonrpc": "2.0", "method": "$/cancelRequest", "params": {"id": 1199}}).encode()
        client.raw(body + b"Content-Length: %d\r\n\r\n%s" % (len(text), text))
        self.assertEqual(client.answer(1199)["error"]["code"], -32800)
        self.assertIn("result", client.answer(1000))

    def test_a_program_of_100000_lines_stays_usable(self):
        client = self.client()
        line = "MOVE (%d.5, 2.25, -3.125, 0.5, 0.25) /FLY ; a comment\n"
        text = "COORD ABSOL\nPATH LIN\nSPEED 10\n" + "".join(line % (n % 1000) for n in range(100_000))
        client.open("12.S", text)
        client.diagnostics("12.S", 1)
        client.change("12.S", 2, {"range": span(50_000, 0, 0), "text": "SPEED 101\n"})
        begin = time.monotonic()
        found = client.diagnostics("12.S", 2)
        took = time.monotonic() - begin
        self.assertIn(50_000, [one["range"]["start"]["line"] for one in found])
        begin = time.monotonic()
        shown = client.at("hover", "12.S", 90_000, 2)
        hover = time.monotonic() - begin
        self.assertIn("MOVE", json.dumps(shown))
        print(f"100,000 lines: checked {took:.3f} s after a change, hover {hover:.3f} s", flush=True)


class Extension(unittest.TestCase):
    def test_the_extension_starts_the_server(self):
        node = shutil.which("node")
        if node is None:
            self.skipTest("node is not here")
        done = subprocess.run([node, ROOT / "clients" / "vscode" / "test" / "extension.test.js"],
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
