"""Sessions with a real server over its web port: random calls of every kind, right ones and wrong ones, and all that it
answers. Each follows from its number alone; what a clock or the kernel gave (times, ports, paths) is left out."""
import base64
import dataclasses
import http.client
import io
import json
import random
import re
import signal
import subprocess
import tempfile
import time
import urllib.parse
import pathlib
import zipfile

from programs import OptimoWriter, random_rml1
from tool_programs import BYTES, TOKENS, broken, changed, contour
from trials import DATE

EACH = 12
START_S = 60
CALL_S = 120
STRANGE = ("", "x", -1, 0, 1, 64, 99, 100, 101, 0.5, 1e300, True, None, [], {}, "machines/none", "machines/mill-1", "machines/optimo-1/programs/1",
           "jobs/1", "a" * 300, "../x", "\u00e9", [1], {"a": "b"}, "99999999999999999999", "MODE", "!")
LEFT_OUT = ((re.compile(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z"), b"TIME"),
            (re.compile(rb'"(instanceId|logId)": ?"[^"]*"'), b'"ID":"ID"'),
            (re.compile(rb"127\.0\.0\.1:\d+"), b"HOST"),
            (re.compile(rb"behaviour-\w+"), b"FOLDER"), (re.compile(rb"id: [^\n]*"), b"id:"), (re.compile(rb"'content-length', '\d+'"), b"length"), (DATE, b"- DATE"))


class Session:
    """One server, what is asked of it, and what it answered."""

    def __init__(self, dice, binaries, folder, environment, limits, until):
        self.dice = dice
        self.binaries = binaries
        self.folder = folder
        self.environment = environment
        self.limits = limits
        self.until = until
        self.process = None
        self.port = 0
        self.said = []

    def start(self, *words):
        log = self.folder / "log"
        log.write_text("", encoding="utf-8")
        self.process = subprocess.Popen(
            [self.binaries / "rmlcelld", "--state.directory", self.folder / "state", "--listen.grpc", "127.0.0.1:0", "--listen.web", "127.0.0.1:0",
             "--workers.count", "1", "--machines.hosts", "enabled", "--log.file", log, *words], env=self.environment, preexec_fn=self.limits, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until = time.monotonic() + START_S
        while not (ready := re.search(r"web on http://127\.0\.0\.1:(\d+)/", log.read_text(errors="replace"))):
            if self.process.poll() is not None or time.monotonic() > until:
                raise RuntimeError("the server does not start")
            time.sleep(0.01)
        self.port = int(ready[1])

    def stop(self, by=signal.SIGTERM):
        self.process.send_signal(by)
        self.note(b"stopped", str(self.process.wait(timeout=START_S)).encode())

    def note(self, asked, answered):
        self.said += [b"== ", asked, b"\n", answered, b"\n"]

    def request(self, method, path, body=b"", headers=None, told=True):
        """(status, body); the answer to a head has no length of time in it."""
        if time.monotonic() > self.until:
            raise subprocess.TimeoutExpired("session", 0)
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=min(CALL_S, max(1.0, self.until - time.monotonic())))
        try:
            connection.request(method, path, body or None, headers or {})
            answer = connection.getresponse()
            status, content, names = answer.status, answer.read(), sorted((k.lower(), v) for k, v in answer.getheaders() if k.lower() != "date")
        except (OSError, http.client.HTTPException) as error:
            status, content, names = 0, type(error).__name__.encode(), []
        finally:
            connection.close()
        if b"TIME" not in without_clock(content) and re.search(r"(Get|List)Machines?\b", path):
            names, content = [pair for pair in names if pair[0] == "content-type"], b""  # times of day, in binary
        if told:
            self.note(f"{method} {path} {headers or ''} ".encode() + body[:2000], f"{status} {names}\n".encode() + content)
        return status, content

    def call(self, method, message, wrong=0.12, told=True):
        """The answer of a method as a value; now and then something is wrong with the question."""
        if self.dice.random() < wrong:
            message = spoilt(self.dice, message)
        service, name = method.split("/")
        _, content = self.request("POST", f"/rmlcell.v1.{service}/{name}", json.dumps(message).encode(), {"Content-Type": "application/json"}, told)
        try:
            return json.loads(content)
        except ValueError:
            return {}

    def watch(self, method, message, told=True):
        query = urllib.parse.urlencode({"message": json.dumps(message)})
        return self.request("GET", f"/rmlcell.v1.{method}?{query}", told=told)[1]


def spoilt(dice, message):
    """The same question with one field gone, strange, or unknown."""
    message = json.loads(json.dumps(message))
    place = message
    while True:
        inner = [value for value in place.values() if isinstance(value, dict) and value]
        if not inner or dice.random() < 0.4:
            break
        place = dice.choice(inner)
    chance = dice.random()
    if place and chance < 0.25:
        del place[dice.choice(sorted(place))]
    elif place and chance < 0.92:
        place[dice.choice(sorted(place))] = dice.choice(STRANGE)
    else:
        place["unknown"] = 1
    return message


def without_clock(said):
    for pattern, word in LEFT_OUT:
        said = pattern.sub(word, said)
    return said


def mostly(dice, usual, strange):
    return dice.choice(strange if dice.random() < 0.08 else usual)


def text_of(name, content):
    content = content if isinstance(content, bytes) else content.encode("latin-1")
    return {"fileName": name, "content": base64.b64encode(content).decode()}


def some_program(dice, family=None):
    """(family, file name, bytes): small, and mostly right."""
    family = family or dice.choice(("optimo", "rml1"))
    if family == "optimo":
        text = OptimoWriter(dice, dice.randrange(3, 14), dice.random() < 0.2).program()
        if dice.random() < 0.15:
            text = broken(dice, text, TOKENS)
        return family, "part.S", text.encode("latin-1", "replace")
    text = random_rml1(dice.randrange(1 << 30)).text[:4000]
    if dice.random() < 0.15:
        text = broken(dice, text.decode("latin-1"), BYTES).encode("latin-1")
    return family, "part.rml", text


def machine_of(family):
    return "machines/optimo-1" if family == "optimo" else "machines/mill-1"


def machines(session):
    dice, call = session.dice, session.call
    call("MachineService/ListFamilies", {}, 0)
    call("MachineService/ListMachines", {}, 0)
    etags = {}
    for _ in range(45):
        name = mostly(dice, ("mill-1", "optimo-1", "a", "b"), ("c2", "Ab", "x-", "m" * 64, "1a"))
        family = mostly(dice, ("rml1", "optimo"), ("plotter", ""))
        parameters = {dice.choice(("X_MAX", "Z_MIN", "F_MAX", "CUT_SPEED_MAX", "VX", "COORD", "none")): dice.choice(("100", "-5", "0", "x", "1e9", "12.5"))}
        machine = {"family": family, "title": dice.choice(("", "Mill", "t" * 200)), "profile": dice.choice(("", "srm-20", "t1", "none")),
                   "parameters": parameters if dice.random() < 0.4 else {}}
        full = f"machines/{name}"
        what = dice.randrange(9)
        if what == 0 or etags == {}:
            etags.setdefault(full, "")
            call("MachineService/CreateMachine", {"machineId": name, "machine": machine, "validateOnly": dice.random() < 0.2})
        elif what == 1:
            etags[full] = call("MachineService/GetMachine", {"name": full}).get("etag", "")
        elif what == 2:
            mask = dice.choice(("title", "parameters", "profile", "title,parameters", "family", "state", "", "none"))
            call("MachineService/UpdateMachine", {"machine": {"name": full, "etag": dice.choice(("", etags.get(full, ""), "old")), **machine},
                                                  "updateMask": mask, "validateOnly": dice.random() < 0.2})
        elif what == 3:
            page = call("MachineService/ListMachines", {"pageSize": dice.choice((0, 1, 2, 1000, -1))})
            if page.get("nextPageToken"):
                call("MachineService/ListMachines", {"pageSize": dice.choice((1, 2)), "pageToken": page["nextPageToken"]})
        elif what < 6:
            number = dice.choice((0, 1, 11, 63, 64))
            call("MachineService/PutLaserSchedule", {"laserSchedule": {"name": f"{full}/laserSchedules/{number}", "title": dice.choice(("", "steel")),
                                                                       "mode": dice.choice(("CW", "PULSE", "none", "")), "etag": dice.choice(("", "", "old")),
                                                                       "powerPercent": dice.choice((0, 1, 50.5, 100, 101))}})
        elif what == 6:
            call("MachineService/ListLaserSchedules", {"parent": full})
        elif what == 7:
            call("MachineService/DeleteLaserSchedule", {"name": f"{full}/laserSchedules/{dice.choice((1, 11, 63))}"})
        else:
            call("MachineService/" + dice.choice(("StartMachine", "StopMachine", "AcknowledgeAlarm", "ReadVariables", "SetMode", "WriteVariables")),
                 {"machine": full})
    call("MachineService/ListMachines", {}, 0)


def programs(session):
    dice, call = session.dice, session.call
    etags = {}
    for _ in range(60):
        family, file_name, content = some_program(dice)
        slot = mostly(dice, (1, 2, 3, 1, 2, 99, 101, 102), (0, 4, 50, 100, 199, "x"))
        machine = machine_of(family) if dice.random() < 0.9 else machine_of("rml1")
        full = f"{machine}/programs/{slot}"
        path = f"/v1/{full}/content"
        what = dice.randrange(12)
        if what < 3:
            put = call("ProgramService/PutProgram", {"name": full, "program": text_of(file_name, content), "title": dice.choice(("", "part", "t" * 100)),
                                                     "etag": dice.choice(("", "", etags.get(full, ""), "old")), "validateOnly": dice.random() < 0.1,
                                                     "force": dice.random() < 0.1})
            etags[full] = put.get("etag", "")
        elif what == 3:
            etags[full] = call("ProgramService/GetProgram", {"name": full}).get("etag", "")
        elif what == 4:
            call("ProgramService/GetProgramContent", {"name": full, "form": dice.choice((0, 1, 2, 3, 4))})
        elif what == 5:
            page = call("ProgramService/ListPrograms", {"parent": machine, "pageSize": dice.choice((0, 1, 2, 1000, -1))})
            while page.get("nextPageToken"):
                page = call("ProgramService/ListPrograms", {"parent": machine, "pageSize": 2, "pageToken": page["nextPageToken"]}, 0.1)
        elif what == 6:
            call("ProgramService/DeleteProgram", {"name": full, "etag": dice.choice(("", "", etags.get(full, ""), "old"))})
        elif what == 7:
            call("ProgramService/ListStaleExecutables", {"parent": machine})
        elif what == 8:
            form = dice.choice(("", "?form=source", "?form=object", "?form=executable", "?form=listing", "?form=none"))
            session.request("GET", path + form, headers={"If-None-Match": f'"{etags[full]}"'} if etags.get(full) and dice.random() < 0.5 else {})
        elif what == 9:
            words = {"file_name": file_name, "title": "of a URL", "etag": dice.choice(("", etags.get(full, ""), "old")), "sha256": dice.choice(("", "00")),
                     "form": dice.choice(("", "source", "object")), "validate_only": dice.choice(("true", "false", "x")), "force": "true"}
            some = {key: words[key] for key in sorted(words) if dice.random() < 0.35}
            session.request("POST", f"{path}?{urllib.parse.urlencode(some)}", content, {"Content-Type": "application/octet-stream"})
        elif what == 10:
            session.watch("ProgramService/DownloadProgram", {"name": full, "form": dice.choice((0, 1, 2, 3, 4))})
        else:
            job = call("JobService/SubmitJob", {"job": {"kind": "JOB_KIND_SIMULATE", "machine": machine, "program": full,
                                                        "budget": {"steps": 500, "virtualTimeNs": 100_000_000_000}}}, 0)
            if "name" in job:
                session.watch("JobService/WatchJob", {"name": job["name"], "afterSequence": 0}, told=False)
                until = time.monotonic() + 0.3  # the executable may come behind the end
                while time.monotonic() < until and b"executableBytes" not in session.watch("ProgramService/GetProgram", {"name": full}, told=False):
                    time.sleep(0.01)
    for family in ("optimo", "rml1"):
        call("ProgramService/ListPrograms", {"parent": machine_of(family)}, 0)


def helpers(session):
    dice, call = session.dice, session.call
    for _ in range(40):
        family, file_name, content = some_program(dice, "optimo" if dice.random() < 0.9 else "rml1")
        program = text_of(file_name, content)
        point = {"x": dice.choice((0, 10.5, -3)), "y": dice.choice((0, 2)), "z": dice.choice((0, 1))}
        turn = mostly(dice, ([], [0, 0, 0], [0.1, 0, -0.5]), ([1, 2], [1, 2, 3, 4]))
        what = dice.randrange(12)
        if what == 0:
            call("ProgramService/CheckProgram", {"family": dice.choice(("", family, "none")), "machine": dice.choice(("", machine_of(family))),
                                                 "program": program, "errorsOnly": dice.random() < 0.3})
        elif what == 1:
            made = call("ProgramService/CompileProgram", {"family": family, "program": program})
            call("ProgramService/DecompileProgram", {"object": made.get("object", ""), "name": dice.choice(("", "1.O"))})
        elif what == 2:
            call("ProgramService/FormatProgram", {"program": program})
        elif what == 3:
            call("ProgramService/FixProgram", {"family": family, "machine": dice.choice(("", machine_of(family))), "program": program,
                                               "errorsOnly": dice.random() < 0.3})
        elif what == 4:
            parts = [{"slot": slot, "program": text_of(f"{slot}.S", some_program(dice, "optimo")[2])} for slot in (1, 2, mostly(dice, (3, 4), (100, 2)))]
            call("ProgramService/LinkProgram", {"slot": dice.choice((1, 2, 9)), "programs": parts, "machine": dice.choice(("", "machines/optimo-1"))})
        elif what == 5:
            call("ProgramService/ConvertProgram", {"program": program, "target": dice.choice((0, 1, 2)), "outputName": dice.choice(("", "b.SI", "b.S")),
                                                   "date": "Mon Jan  1 00:00:00 2024"}, 0)
        elif what == 6:
            made = call("ProgramService/CompensateProgram", {"program": text_of("c.S", contour(dice))}, told=False)
            session.note(b"compensated", base64.b64decode(made.pop("content", "")) + json.dumps(made).encode())  # a date is in it
        elif what == 7:
            call("ProgramService/TransformProgram", {"program": program, "translation": point, "rotation": turn})
        elif what == 8:
            call("ProgramService/ShiftProgram", {"program": program, "translation": point, "rotation": turn})
        elif what == 9:
            call("ProgramService/MakeListing", {"program": program})
        elif what == 10:
            later = changed(dice, content.decode("latin-1")) if family == "optimo" else content[:-20]
            call("ProgramService/DiffPrograms", {"before": {"text": program}, "after": {"text": text_of(file_name, later)}, "picture": dice.random() < 0.3})
        else:
            call("ProgramService/ExplainError", {"code": dice.choice(("348", "OPT-E348", "none", "", "E2", "9003", "HOLE_RADIUS_ZERO"))})


def scripted_input(dice):
    def from_outside(name, value):
        return {"fromOutside": {"input": {"name": "%s[%d]" % (name, mostly(dice, (1, 2), (0, 300))), "value": value}}}
    return dice.choice((from_outside("IL", {"logical": dice.random() < 0.5}), from_outside("IA", {"real": dice.choice((0, 1, 50))}),
                        {"fromOutside": {"doorOpen": dice.random() < 0.5}}, {"resume": {}}, {"hold": "HOLD_REASON_HOLD"},
                        {"stop": "HOLD_REASON_STOP"}, {"emergencyStop": True}, {"overridePercent": dice.choice((0, 1, 50))},
                        {"power": True}))


def some_job(dice):
    family, file_name, content = some_program(dice)
    job = {"kind": mostly(dice, ("JOB_KIND_SIMULATE", "JOB_KIND_SIMULATE", "JOB_KIND_CHECK"), ("JOB_KIND_RUN", 0)), "machine": machine_of(family),
           "title": dice.choice(("", "first")), "inlineProgram": text_of(file_name, content), "inlineSlot": mostly(dice, (0, 0, 5), (100,)),
           "attemptsMax": dice.choice((0, 1, 3)), "budget": {"steps": dice.choice((20, 1000)), "virtualTimeNs": dice.choice((5, 200)) * 1_000_000_000}}
    options = {"mode": mostly(dice, (0, 2, 3, 4), (1, 5, 9)), "overridePercent": mostly(dice, (0, 100, 50, 145), (400, -1, 145.1)), "trace": dice.random() < 0.6,
               "variables": mostly(dice, ([], ["VR[1]", "VI[0..3]"]), (["none"],)), "toolpathToleranceMm": mostly(dice, (0, 0.1), (-1, 101)),
               "inputs": [{"virtualTimeNs": int(1e9 * dice.choice((0, 0.5, 2))), "input": scripted_input(dice)}
                          for _ in range(dice.randrange(3))],
               "parameters": mostly(dice, ({}, {"X_MAX": "120"} if family == "rml1" else {}), ({"none": "1"},))}
    if family == "optimo" and dice.random() < 0.3:
        options["programs"] = [{"slot": slot, "program": text_of(f"{slot}.S", some_program(dice, family)[2])} for slot in (2, 3)]
    if family == "rml1" and dice.random() < 0.5:
        options["milling"] = {"stock": {"sizeXMm": 100, "sizeYMm": 80, "sizeZMm": mostly(dice, (5, 9), (0,))},
                              "tool": {"shape": dice.choice((1, 2, 3)), "diameterMm": dice.choice((3, 6)), "angleRad": 1.0, "flutes": 2},
                              "cellMm": 1, "relief": True, "heightMap": dice.random() < 0.5, "stl": dice.random() < 0.5, "stlToleranceMm": 0.1,
                              "material": mostly(dice, ("", "wax"), ("none",)), "rpm": dice.choice((0, 8000)),
                              "target": dice.choice((None, {"inlineProgram": text_of("t.rml", b"PA;PU0,0;PD900,0;"), "toleranceMm": 0.1, "picture": True},
                                                     {"slot": 4}))}
        if options["milling"]["target"] is None:
            del options["milling"]["target"]
    if dice.random() < 0.7:
        job["simulation"] = {key: value for key, value in options.items() if dice.random() < 0.5 or key == "milling"}
    return job


def jobs(session):
    dice, call = session.dice, session.call
    names = []
    for number in range(22):
        asked = {"job": some_job(dice), "requestId": dice.choice(("", f"r{number}", "r1")), "validateOnly": dice.random() < 0.05}
        job = call("JobService/SubmitJob", asked, 0.15)
        name = job.get("name", "")
        if name:
            names.append(name)
            session.watch("JobService/WatchJob", {"name": name, "afterSequence": 0}, told=False)
        name = dice.choice(names) if names else "jobs/1"
        call("JobService/GetJob", {"name": name}, 0.05)
        session.watch("JobService/WatchJob", {"name": name, "afterSequence": dice.choice((1, 1, 2, 4, 1000)), "eventsOnly": True})
        what = dice.randrange(10)
        if what == 0:
            call("JobService/" + dice.choice(("CancelJob", "HoldJob", "StopJob", "ResumeJob", "SetJobOverride")), {"name": name})
        elif what == 1:
            filter_of = dice.choice(("", "state = SUCCEEDED", 'machine = "machines/mill-1"', "state=FAILED AND kind=SIMULATE", "kind = CHECK", "none", "state = ",
                                     'state = FAILED OR state = SUCCEEDED', 'title = "first"', 'caller = "x"'))
            page = call("JobService/ListJobs", {"pageSize": dice.choice((0, 1, 3, 1000, -1)), "filter": filter_of})
            while page.get("nextPageToken"):
                page = call("JobService/ListJobs", {"pageSize": 5, "filter": filter_of, "pageToken": page["nextPageToken"]}, 0.05)
        elif what < 4:
            call("JobService/" + dice.choice(("GetJobReport", "GetJobPicture")), {"name": name}, 0.1)
        elif what == 4:
            session.watch("JobService/StreamJobTrace", {"name": name})
        elif what == 5:
            session.watch("JobService/StreamJobToolpath", {"name": name, "level": dice.choice((0, 1, 2, 9))})
        elif what == 6:
            session.watch("JobService/StreamJobArtifact", {"name": name, "artifact": dice.choice(("program", "report", "target", "relief.png", "none"))})
        else:
            artifact = dice.choice(("report", "picture.svg", "relief.png", "height.png", "left.stl", "target.png", "toolpath", "program", "target", "none"))
            session.request("GET", f"/v1/{name}/artifacts/{artifact}")
    call("JobService/ListJobs", {}, 0)
    session.stop()
    session.start()
    call("JobService/ListJobs", {"pageSize": 50}, 0)


def some_project(dice):
    programs_of = []
    for slot in dice.sample((1, 2, 3, 9, 45, 99), dice.randrange(1, 4)) + ([100] if dice.random() < 0.04 else []):
        family, file_name, content = some_program(dice, "optimo" if dice.random() < 0.95 else "rml1")
        programs_of.append({"slot": slot, "title": dice.choice(("", "cut")), "source": text_of(file_name.replace("part", str(slot)), content),
                            "units": mostly(dice, (0, 1), (2, 9))})
    return {"title": dice.choice(("", "Bracket")), "notes": dice.choice(("", "clamp here")), "programs": programs_of,
            "laserSchedules": [{"number": number, "title": "s", "mode": mostly(dice, ("CW", "PULSE"), ("", "x")), "powerPercent": mostly(dice, (0, 10, 100), (101, -1))}
                               for number in dice.sample((1, 11, 63), dice.randrange(3)) + ([64] if dice.random() < 0.05 else [])],
            "processes": [{"kind": mostly(dice, (0, 1, 2), (3, 9)), "process": mostly(dice, (0, 1, 9), (10, -1)), "values": [1.5] * dice.choice((1, 2, 3, 4)), "note": "n"}
                          for _ in range(dice.randrange(2))]}


def projects(session):
    dice, call = session.dice, session.call
    etags = {}
    for _ in range(40):
        name = mostly(dice, ("bracket", "b2"), ("c", "Bad", ""))
        full = f"projects/{name}"
        what = dice.choice((0, 0, 1, 2, 3, 4, 4, 4, 5, 6, 6, 6, 7, 8))
        if what < 2:
            call("ProjectService/CreateProject", {"projectId": name, "project": some_project(dice), "validateOnly": dice.random() < 0.1})
        elif what == 2:
            etags[full] = call("ProjectService/GetProject", {"name": full}).get("etag", "")
        elif what == 3:
            page = call("ProjectService/ListProjects", {"pageSize": dice.choice((0, 1, 1000, -1))})
            if page.get("nextPageToken"):
                call("ProjectService/ListProjects", {"pageSize": 1, "pageToken": page["nextPageToken"]})
        elif what == 4:
            mask = dice.choice(("title", "notes", "programs", "laserSchedules", "processes", "title,notes", "", "none"))
            call("ProjectService/UpdateProject", {"project": {"name": full, "etag": dice.choice(("", etags.get(full, ""), "old")), **some_project(dice)},
                                                  "updateMask": mask, "validateOnly": dice.random() < 0.1})
        elif what == 5 and dice.random() < 0.4:
            call("ProjectService/DeleteProject", {"name": full, "etag": dice.choice(("", etags.get(full, ""), "old"))})
        elif what == 6:
            call("ProjectService/TransferProject", {"name": full, "machine": dice.choice(("machines/optimo-1", "machines/optimo-1", "machines/mill-1")),
                                                    "insertMissingDefinitions": dice.random() < 0.5, "validateOnly": dice.random() < 0.2})
        elif what == 7:
            call("ProjectService/TransferProjectFromMachine", {"machine": "machines/optimo-1", "projectId": dice.choice(("from", "from2", name)),
                                                               "slots": dice.choice(([], [1, 2], [9, 45, 99], [100], [1, 1]))})
        else:
            exported = session.watch("ProjectService/ExportProject", {"name": full}, told=False)
            archive = b"".join(base64.b64decode(chunk) for chunk in re.findall(rb'"chunk": ?"([^"]*)"', exported))
            session.note(b"archive", contents_of(archive))
            if dice.random() < 0.3:
                at = dice.randrange(len(archive) or 1)
                archive = archive[:at] + bytes([dice.randrange(256)]) + archive[at + 1:]
            call("ProjectService/ImportProject", {"projectId": dice.choice(("copy", "copy2", name)), "archive": base64.b64encode(archive).decode()}, 0.1)
    call("ProjectService/ListProjects", {}, 0)
    call("ProgramService/ListPrograms", {"parent": "machines/optimo-1"}, 0)
    call("MachineService/ListLaserSchedules", {"parent": "machines/optimo-1"}, 0)


def contents_of(archive):
    try:
        with zipfile.ZipFile(io.BytesIO(archive)) as file:
            return b"".join(name.encode() + b"\n" + file.read(name) + b"\n" for name in sorted(file.namelist()))
    except zipfile.BadZipFile:
        return archive


def http_requests(session):
    dice = session.dice
    _, file_name, content = some_program(dice, "rml1")
    session.request("POST", f"/v1/machines/mill-1/programs/7/content?file_name={file_name}&force=true", content, {"Content-Type": "application/octet-stream"})
    job = session.call("JobService/SubmitJob", {"job": {"kind": "JOB_KIND_SIMULATE", "machine": "machines/mill-1", "program": "machines/mill-1/programs/7",
                                                        "budget": {"steps": 500, "virtualTimeNs": 100_000_000_000}}}, 0, told=False)
    if "name" in job:
        session.watch("JobService/WatchJob", {"name": job["name"], "afterSequence": 0}, told=False)
    name = dice.choice((b"\n\x0fmachines/mill-1", b"\n\x11machines/optimo-1", b"\n\x03348"))
    frame = b"\0" + len(name).to_bytes(4, "big") + name
    paths = ("/", "/index.html", "/page.js", "/page.css", "/favicon.svg", "/none", "/v1", "/v1/jobs/1/artifacts/report", "/v1/jobs/1/artifacts/picture.svg",
             "/v1/jobs/0/artifacts/report", "/v1/jobs/1/artifacts/", "/v1/machines/mill-1/programs/7/content", "/v1/machines/mill-1/programs/7/content?form=source&x=1",
             "/v1/machines/mill-1/programs/7", "/v1/machines/mill-1/programs/0/content", "/v1/machines/%6dill-1/programs/7/content", "/v1/machines/%zz/programs/7/content",
             "/rmlcell.v1.MachineService/GetMachine", "/rmlcell.v1.MachineService/ListLaserSchedules", "/rmlcell.v1.ProgramService/ExplainError", "/rmlcell.v1.MachineService/ListMachines",
             "/rmlcell.v1.MachineService/SetMode", "/rmlcell.v1.MachineService/None", "/rmlcell.v1.None/GetMachine", "/rmlcell.v1.WorkerService/Work",
             "/rmlcell.v1.JobService/GetJobReport", "/rmlcell.v1.ProgramService/UploadProgram", "/grpc.health.v1.Health/Check", "/../etc/passwd", "/a" * 300)
    bodies = (b"", b"{}", b'{"name": "machines/mill-1"}', b'{"name": "machines/none"}', b"{", b'{"name": 1}', b'{"unknown": 1}', b"[]", name, frame, frame + frame,
              frame[:7], base64.b64encode(frame), b"\x80\0\0\0\0", b'{"name": "jobs/1"}')
    types = ("application/json", "application/json; charset=utf-8", "application/proto", "application/grpc-web", "application/grpc-web+proto",
             "application/grpc-web-text", "application/grpc", "application/connect+json", "application/connect+proto", "text/plain", "application/octet-stream", "")
    extras = (("Accept-Encoding", "gzip"), ("Content-Encoding", "gzip"), ("Content-Encoding", "none"), ("Origin", "http://example.com"),
              ("Sec-Fetch-Site", "cross-site"), ("Connect-Protocol-Version", "1"), ("Connect-Protocol-Version", "2"), ("Connect-Timeout-Ms", "5000"),
              ("Connect-Timeout-Ms", "x"), ("grpc-timeout", "5S"), ("grpc-timeout", "5Q"), ("If-None-Match", "*"), ("Range", "bytes=0-3"), ("Range", "bytes=9-3"),
              ("Last-Event-ID", "1"), ("Authorization", "Bearer x"), ("Cookie", "a=b"), ("Expect", "100-continue"), ("X-Grpc-Web", "1"), ("Host", "example.com"),
              ("Accept", "text/event-stream"), ("Accept", "application/json"))
    for _ in range(90):
        path, body = dice.choice(paths), dice.choice(bodies)
        kind = ("application/json" if body[:1] == b"{" else "application/grpc-web+proto" if body[:1] == b"\0" else "application/proto") \
            if dice.random() < 0.5 else dice.choice(types)
        headers = {"Content-Type": kind} if dice.random() < 0.9 else {}
        for key, value in dice.sample(extras, dice.choice((0, 0, 0, 1, 2))):
            headers[key] = value
        if dice.random() < 0.2:
            path += "?" + urllib.parse.urlencode(dice.sample((("message", '{"name": "machines/mill-1"}'), ("message", "{"), ("encoding", "json"), ("encoding", "proto"),
                                                              ("base64", "1"), ("connect", "v1"), ("download", "1")), 2))
        method = mostly(dice, ("GET", "GET", "POST", "POST", "HEAD"), ("OPTIONS", "PUT", "DELETE", "PATCH"))
        session.request(method, path, body if method not in ("GET", "HEAD") else b"", headers)


def killed(session):
    """The server dies in the middle of its work and comes again."""
    dice, call = session.dice, session.call
    for _ in range(3):
        for number in range(4):
            _, file_name, content = some_program(dice, "optimo")
            call("ProgramService/PutProgram", {"name": f"machines/optimo-1/programs/{number + 1}", "program": text_of(file_name, content)}, 0)
            call("ProjectService/CreateProject", {"projectId": f"p{dice.randrange(9)}", "project": some_project(dice)}, 0)
        job = call("JobService/SubmitJob", {"job": {**some_job(dice), "kind": "JOB_KIND_SIMULATE"}, "requestId": "again"}, 0)
        if "name" in job:
            session.watch("JobService/WatchJob", {"name": job["name"], "afterSequence": 0}, told=False)
        session.stop(dice.choice((signal.SIGKILL, signal.SIGTERM)))
        session.start()
        for asked, message in (("MachineService/ListMachines", {}), ("ProgramService/ListPrograms", {"parent": "machines/optimo-1"}),
                               ("ProjectService/ListProjects", {}), ("JobService/ListJobs", {})):
            call(asked, message, 0)


KINDS = {"machines": machines, "programs": programs, "helpers": helpers, "jobs": jobs, "projects": projects, "http": http_requests, "killed": killed}


@dataclasses.dataclass
class ServerTrial:
    name: str  # unique: "server/jobs/7"
    kind: str
    number: int

    def said(self, command, environment=None, seconds=600, limits=None):
        """All that the server beside this command answers, as bytes."""
        with tempfile.TemporaryDirectory(prefix="behaviour-", ignore_cleanup_errors=True) as folder:
            session = Session(random.Random(f"{self.kind} {self.number}"), pathlib.Path(command).parent, pathlib.Path(folder), environment, limits,
                              time.monotonic() + seconds)
            try:
                session.start()
                KINDS[self.kind](session)
                session.stop()
            except (RuntimeError, OSError, subprocess.TimeoutExpired) as error:
                session.note(b"broken off", type(error).__name__.encode())
            finally:
                if session.process:
                    session.process.kill()
                    session.process.wait()
        return without_clock(b"".join(session.said))


def all_server_trials():
    for kind in KINDS:
        for number in range(EACH):
            yield ServerTrial(f"server/{kind}/{number}", kind, number)
