#!/usr/bin/env python3
"""Guards the walls of the house: which room may include which, what a header may bring in, what the
engine may touch, how long a file may be, what nothing may be called, and that each test is built.

    check_structure.py [ROOT]     prints one line for each breach and ends with 1 when there is any

The tables below are docs/ARCHITECTURE.md as a program reads it: a wall that moves moves in both.
"""
import os
import re
import sys

# A room is a folder. Of each: the rooms whose headers it may include, apart from its own. A room that is not
# listed is a breach.
GEOMETRY = "engine/motion/geometry"
PROFILE = "engine/motion/profile"
KINEMATICS = "engine/motion/kinematics"
CORNER = "engine/motion/corner"
PLANNER = "engine/motion/planner"
RIDE = "engine/motion/ride"
JOG = "engine/motion/jog"
MOTION = [GEOMETRY, PROFILE, KINEMATICS, CORNER, PLANNER, RIDE, JOG]  # each may include those before it
ENGINE = ["engine/core", "engine/machine"] + MOTION
PATH = "engine/simulation/path"
REPORT = "engine/simulation/report"
TOOLPATH = "engine/simulation/toolpath"
PICTURE = "engine/simulation/picture"
MATERIAL = "engine/simulation/material"
VERDICT = "engine/simulation/verdict"
RUN = "engine/simulation/run"
SIMULATION = [PATH, REPORT, TOOLPATH, PICTURE, MATERIAL, VERDICT, RUN]
MAY_INCLUDE = {
    "engine/core": [],
    GEOMETRY: ["engine/core"],
    PROFILE: ["engine/core"],
    KINEMATICS: ["engine/core", GEOMETRY, PROFILE],
    CORNER: ["engine/core", GEOMETRY, PROFILE, KINEMATICS],
    PLANNER: ["engine/core", GEOMETRY, PROFILE, KINEMATICS, CORNER],
    RIDE: ["engine/core", GEOMETRY, PROFILE, KINEMATICS, PLANNER],
    JOG: ["engine/core", GEOMETRY, PROFILE, KINEMATICS],
    "engine/machine": ["engine/core"] + MOTION,
    "engine/rml1": ENGINE,
    "engine/rml1/offline": ENGINE + ["engine/rml1"],
    "engine/rml1/board": ENGINE + ["engine/rml1", "engine/rml1/offline"],
    # Points and directions, and nothing that moves.
    "engine/optimo/language": ["engine/core", GEOMETRY],
    "engine/optimo/offline": ENGINE + ["engine/optimo/language"],
    "engine/optimo/editing": ["engine/core", "engine/machine", "engine/optimo/language", "engine/optimo/offline"],
    "engine/optimo/machine": ENGINE + ["engine/optimo/language", "engine/optimo/offline"],
    "engine/optimo/ride": ENGINE + ["engine/optimo/language", "engine/optimo/machine"],
    "engine/optimo/handbox": ENGINE + ["engine/optimo/language"],
    "engine/optimo/control": ENGINE + ["engine/optimo/language", "engine/optimo/offline", "engine/optimo/editing", "engine/optimo/handbox",
                                       "engine/optimo/machine", "engine/optimo/ride"],
    "engine/families": ["engine/core", "engine/machine", "engine/rml1", "engine/rml1/offline", "engine/optimo/control"],
    PATH: ENGINE,
    REPORT: ENGINE + ["engine/families", PATH],
    TOOLPATH: ENGINE + [PATH],
    PICTURE: ENGINE + ["engine/families", PATH, REPORT],
    MATERIAL: ENGINE + [REPORT],
    VERDICT: ENGINE + ["engine/families", REPORT],
    RUN: ENGINE + ["engine/families", REPORT, TOOLPATH, PICTURE, MATERIAL, VERDICT],
    "storage": ["engine/core"],
    "storage/jobs": ["engine/core", "storage"],
    "storage/sqlite": ["engine/core", "storage", "storage/jobs"],
    "storage/opening": ["engine/core", "storage", "storage/sqlite"],
    "proto/bridge": ["engine/core", "engine/machine", "engine/families", REPORT, PICTURE, MATERIAL, RUN, "proto"],
    "proto/recording": ["engine/core", "engine/machine", "engine/families", "proto", "proto/bridge"],
    # What every room of the server may use.
    "server/base": ["engine/core", "storage"],
    "server/auth": ["engine/core", "proto", "server/base"],
    "server/events": ["engine/core", "server/base", "storage"],
    # What programs, projects and jobs share.
    "server/records": ["engine/core", "engine/machine", "engine/families", TOOLPATH, "proto", "proto/bridge", "server/base",
                       "storage", "storage/jobs"],
    "server/jobs": ["engine/core", "engine/machine", "engine/families", MATERIAL, "proto", "proto/bridge", "server/base",
                    "server/events", "server/records", "storage", "storage/jobs"],
    # How machines stand.
    "server/machines": ["engine/core", "engine/families", "engine/machine", "proto", "proto/bridge", "server/base", "server/events", "server/records", "storage", "storage/jobs"],
    # The host of a machine that lives: a process of its own, without the store.
    "server/host": ["engine/core", "engine/machine", "engine/families", MATERIAL, "proto", "proto/bridge", "proto/recording", "server/base"],
    # RUN jobs, between the queue and the host of their machine.
    "server/runs": ["engine/core", "engine/machine", "engine/families", "proto", "proto/bridge", "proto/recording", "server/base", "server/jobs", "server/machines", "server/records", "storage", "storage/jobs"],
    "server/programs": ["engine/core", "engine/machine", "engine/families", RUN, "proto", "proto/bridge", "server/base", "server/records", "storage"],
    "server/projects": ["engine/core", "engine/machine", "engine/families", "proto", "proto/bridge", "server/base", "server/records", "server/programs", "storage"],
    # What is asked of jobs that have ended.
    "server/results": ["engine/core", "engine/machine", "engine/families", "proto", "proto/bridge", "server/base", "server/records", "server/jobs", "server/programs",
                       "storage"],
    "server/web": ["engine/core", "proto", "proto/bridge"],
    "server/services": ["engine/core", "engine/machine", "engine/families", TOOLPATH, MATERIAL, "proto", "proto/bridge", "proto/recording",
                        "server/base", "server/auth", "server/events", "server/machines", "server/records", "server/jobs", "server/runs",
                        "server/programs", "server/projects", "server/results", "server/web", "storage"],
    # The engine worker: a process of its own, without the store.
    "server/worker": ["engine/core", "engine/machine", "engine/families", REPORT, MATERIAL, VERDICT, RUN, "proto", "proto/bridge", "proto/recording",
                      "server/base", "server/host", "server/records"],
    # The wiring of the server.
    "server/cell": ["engine/core", "proto/bridge", "server/base", "server/auth", "server/events", "server/records",
                    "server/jobs", "server/machines", "server/runs", "server/programs", "server/projects", "server/results", "server/services",
                    "server/web", "storage", "storage/opening"],
    # The language server: no server and no language.
    "clients/lsp": ["engine/core", "engine/machine", "engine/families", RUN],
    "clients/cli": ["clients/lsp", "engine/core", "engine/machine", "engine/families", "engine/rml1/offline", "engine/rml1/board", REPORT, MATERIAL, VERDICT, RUN, "proto", "proto/bridge", "proto/recording"],
}
# Of these rooms others may include no other header.
PUBLIC = {
    "engine/core": ["alignment.h", "catalogue.h", "characters.h", "check.h", "detail.h", "diagnostic.h", "hex.h", "indices.h", "keep_finding.h", "letters.h", "line_table.h", "untold_findings.h",
                    "near_words.h", "number_text.h", "result.h", "ring.h", "text_fixes.h", "units.h"],
    GEOMETRY: ["frames.h", "pose.h", "path.h", "hole.h", "corner_curve.h", "corner_table.h", "blend_curve.h", "least.h"],
    PROFILE: ["speed_profile.h", "speed_passes.h", "ramp_plan.h"],
    KINEMATICS: ["kinematics.h", "axes.h", "machine_limits.h", "axis_demand.h", "speed_bound.h"],
    CORNER: ["corner.h", "axes_corner.h"],
    PLANNER: ["planner.h", "feed_steps.h"],
    RIDE: ["trajectory.h", "interruption.h", "ride_protocol.h", "path_ride.h", "motion_under_way.h"],
    JOG: ["jog_drive.h"],
    "engine/machine": ["bytes.h", "driver.h", "family.h", "hand_motion.h", "language_word.h", "machine.h", "machine_input.h", "machine_note.h", "machine_states.h", "machine_status.h", "panel.h", "run.h", "standing.h", "virtual_driver.h", "observer.h", "shape.h", "parameters.h", "profile_files.h", "variable.h", "verdict.h", "reach_step.h", "start_preview.h", "step_entry.h", "handbox.h",
                       "tools.h", "editing.h", "run_setup.h", "outcome.h", "inputs.h", "part_on_table.h", "program_file.h"],
    "engine/rml1": ["rml1_family.h", "action.h", "clipping.h", "command_reader.h", "command_table.h", "device.h", "figures.h", "finding.h",
                    "number.h", "physical.h", "profile.h", "programmed.h", "registers.h", "verdict_rules.h"],
    "engine/rml1/offline": ["byte_sink.h", "explain.h", "from_gcode.h", "rewrite.h", "stream_diff.h", "tile.h", "to_gcode.h",
                            "phrase_words.h", "stream_writer.h", "work_check.h"],
    "engine/rml1/board": ["bitmap.h", "board_stream.h", "png_bitmap.h"],
    "engine/optimo/language": ["ast.h", "checker.h", "compiler.h", "evaluate.h", "formatter.h", "instruction_set.h",
                               "lexer.h", "linker.h", "operands.h", "printer.h", "program.h", "source_map.h", "staleness.h", "step_edit.h",
                               "units_of_variables.h", "words.h", "start_modes.h"],
    "engine/optimo/offline": ["compensate.h", "contour_advice.h", "convert.h", "fix_program.h", "house_programs.h",
                              "listing.h", "project.h", "semantic_diff.h", "transform.h", "translate.h"],
    "engine/optimo/editing": ["optimo_editing.h"],
    "engine/optimo/handbox": ["optimo_handbox.h", "override_steps.h", "steps.h"],
    "engine/optimo/machine": ["beam.h", "laser_unit.h", "machine_state.h", "motion_errors.h", "optimo_parameters.h",
                              "situation.h", "system_cycle.h", "telling.h"],
    "engine/optimo/ride": ["ride.h", "travel.h"],
    "engine/optimo/control": ["optimo_family.h"],
    PATH: ["part_curve.h", "part_shape.h", "path_extent.h", "polyline.h", "profile_phases.h", "motion_peaks.h"],
    REPORT: ["report.h", "report_recorder.h", "finding_list.h", "facts.h", "trace.h", "samples.h"],
    TOOLPATH: ["toolpath_recorder.h", "toolpath_level.h"],
    PICTURE: ["picture.h", "picture_difference.h", "plot.h", "time_envelope.h"],
    MATERIAL: ["height_grid.h", "height_map.h", "height_tiles.h", "milled_part.h", "milling_recorder.h", "milling_text.h", "parallel_for.h", "relief.h", "standard_cell.h", "stl.h", "target.h", "target_files.h"],
    VERDICT: ["verdict.h"],
    RUN: ["simulate.h", "version.h", "input_description.h", "motion_check.h", "rehearsal.h", "joint_check.h", "milled_target.h", "timetable.h", "trial_run.h"],
    "storage": ["content.h", "records.h", "store.h", "trouble.h"],
    "storage/jobs": ["job_rules.h", "queue_rules.h"],
    "storage/sqlite": ["sqlite_store.h"],
    "storage/opening": ["open_store.h"],
    "proto/bridge": ["comparison.h", "encoding.h", "files.h", "findings.h", "framing.h", "header_date.h", "inputs.h", "machine_inputs.h", "milling.h",
                     "program_stream.h", "report.h", "series.h", "setup.h", "standard_words.h", "start_blocker.h", "sha256.h", "spooled_bytes.h", "thread_pool.h", "ticket.h"],
    "proto/recording": ["records.h", "recording.h", "replay.h", "told.h"],
    "server/base": ["child_process.h", "config.h", "credentials.h", "executor.h", "host_protocol.h", "log.h", "names.h", "readable.h", "restart_delay.h", "secret.h", "steady_clock.h", "this_computer.h", "version.h"],
    "server/auth": ["caller.h", "socket_users.h"],
    "server/events": ["event_feed.h"],
    "server/jobs": ["dispatcher.h", "assignment.h", "followed.h", "job_book.h", "job_filter.h", "running_heights.h", "running_toolpath.h", "worker_processes.h"],
    "server/records": ["file_family.h", "job_messages.h", "known_machines.h", "machine_capabilities.h", "machine_messages.h", "machine_options.h", "program_memory.h", "program_place.h", "toolpath_levels.h", "update_mask.h"],
    "server/host": ["host_process.h"],
    "server/runs": ["run_products.h", "run_queue.h"],
    "server/machines": ["host_entries.h", "host_processes.h", "hosts.h", "machine_statuses.h", "recordings.h",
                        "teach_book.h"],
    "server/programs": ["content_upload.h", "language_tools.h", "memory_tools.h", "program_book.h", "program_result.h", "program_views.h",
                        "special_programs.h", "text_tools.h"],
    "server/projects": ["project_archive.h", "project_book.h", "project_transfer.h"],
    "server/services": ["account_service.h", "cell_service.h", "foreign_calls.h", "handbox_service.h", "host_service.h",
                        "job_service.h", "machine_service.h", "program_service.h",
                        "project_service.h", "web_resources.h", "worker_service.h"],
    "server/web": ["resource_source.h", "static_page.h", "web_server.h"],
    "server/worker": [],
    "server/cell": [],
    "clients/lsp": ["stdio.h"],
    "clients/cli": [],
}
# Public headers that are for some of the rooms only: doors between neighbours.
ONLY_FOR = {
    GEOMETRY: {"corner_curve.h": [CORNER], "corner_table.h": [CORNER, PATH], "blend_curve.h": [RIDE], "least.h": MOTION,
               "hole.h": ["engine/optimo/control"], "pose.h": ["engine/machine"]},
    PROFILE: {"speed_passes.h": [PLANNER], "ramp_plan.h": [PLANNER]},
    KINEMATICS: {"axes.h": MOTION, "axis_demand.h": MOTION},
    CORNER: {"corner.h": [PLANNER], "axes_corner.h": [PLANNER]},
    PLANNER: {"feed_steps.h": ["engine/rml1"]},
    RIDE: {"interruption.h": ["engine/optimo/ride"], "ride_protocol.h": ["engine/rml1"],
           "path_ride.h": ["engine/optimo/ride", "engine/rml1"], "motion_under_way.h": ["engine/machine"]},
    "engine/machine": {"editing.h": ["clients/lsp", "engine/optimo/editing", "server/programs"], "profile_files.h": ["engine/rml1"],
                       "program_file.h": ["engine/rml1/offline"]},
    "engine/optimo/machine": {header: ["engine/optimo/control"]
                              for header in ("laser_unit.h", "machine_state.h", "system_cycle.h")},
    PATH: {"part_curve.h": [REPORT], "motion_peaks.h": [REPORT]},
    "server/jobs": {"assignment.h": ["server/runs"]},
    "server/machines": {"host_entries.h": ["server/runs"]},
    "server/programs": {"program_result.h": ["server/projects", "server/results", "server/services"],
                        "text_tools.h": ["server/projects", "server/services"]},
    "server/web": {"web_server.h": ["server/cell"], "resource_source.h": ["server/services"], "static_page.h": ["server/services"]},
}
# Headers made of the .proto files.
PROTO_HEADERS = ("rmlcell/v1/", "google/rpc/", "google/api/", "grpc/health/")

# Headers that take seconds to read: only sources, and the few headers whose business they are.
HEAVY = re.compile(r"^(grpc|grpcpp|grpc\+\+|boost/beast|boost/asio|Eigen)([/.]|$)")
HEAVY_HEADERS = {
    GEOMETRY: "Eigen",               # the types of points, directions, frames
    "server/services": "grpc",       # the services are gRPC
    "clients/cli/remote_call.h": "grpc",
    "server/web/http_session.h": "boost/asio",
}

# The engine is a function of its inputs (design.md section 4).
ENGINE_HEADERS = {"thread", "mutex", "shared_mutex", "condition_variable", "future", "atomic", "stop_token",
                  "semaphore", "latch", "barrier", "fstream", "iostream", "filesystem", "ctime", "random",
                  "csignal", "syncstream", "pthread.h", "unistd.h", "time.h", "sys/time.h", "fcntl.h"}
ENGINE_WORDS = re.compile(
    r"\b(steady_clock|system_clock|high_resolution_clock|clock_gettime|gettimeofday|this_thread|thread_local"
    r"|std::(thread|jthread|async|mutex|atomic|cout|cerr|clog|cin|ifstream|ofstream|fstream|random_device)"
    r"|(f|v|vf)?printf|fopen|fwrite|fputs|getenv|std::rand|setlocale)\b")
ENGINE_EXCEPTIONS = {"engine/core/check.cc": {"fprintf"},  # the last words of a process that is wrong
                     "engine/motion/geometry/corner_nodes_maker.cc": {"printf"}}  # runs when the engine is built
# A variable at namespace scope or static in a function that can change. Constants are fine.
ENGINE_GLOBAL = re.compile(r"^\s*(inline\s+)?static\s+(?!const\b|constexpr\b|_assert|inline\s+const)"
                           r"[\w:<>,\s*&]+\s[\w]+\s*(=|\{|;)")

LINES_MAX = 600
# Longer ones that are known; none may grow.
LINES_KNOWN = {}

BAD_NAME = re.compile(r"(^|[_.-])(utils?|helpers?|misc|managers?)([_.-]|$)", re.IGNORECASE)
BAD_TYPE = re.compile(r"^\s*(?:class|struct)\s+(\w*(?:Manager|Utils?|Helpers?))\b")

# The numbers of a machine's manual: rows of engine/core/catalogue.def that only its own folder may name. The cell
# learns of them through engine/machine (FamilyInfo, CheckCodes, ToolCodes).
CATALOGUE = "engine/core/catalogue.def"
CATALOGUE_ROW = re.compile(r"^RMLCELL_ERROR\((\w+), \d+, (\w+),", re.MULTILINE)
CODE = re.compile(r"\bErrorCode::k(\w+)|\busing enum (?:\w+::)*ErrorCode\b")
NEUTRAL_ROWS = "Cell"

# An error is handed on in one form (docs/decisions/0001): never the whole answer, and the answer lives no longer
# than the line that looks at it.
STATUS_WHOLE = re.compile(r"if \((?:const )?Status (\w+) =[^;]*;\s*!\1\)\s*\{?\s*return \1;")
STATUS_CHANGES = re.compile(r"if \(Status \w+ =")
STATUS_APART = re.compile(r"\bStatus (\w+) =[^;]*;\s*if \(!\1\)\s*\{?\s*return \1\b")

# What an error or a finding says keeps its numbers as arguments (engine/core/detail.h): none of them becomes text
# but inside Told(...).
FINDING = re.compile(r"\bErrorCode::k|\b(InvalidArgument|Corrupt|Bad\w*)\(")
NUMBER_AS_TEXT = re.compile(r"\b(std::to_string|FixedText|TrimmedText|ShortestText|ShortNumber)\(")
TOLD = re.compile(r"\bTold\w*\(")

SOURCES = ("engine", "storage", "proto/bridge", "proto/recording", "server", "clients")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def room_of(path):
    return os.path.dirname(path)


def room_of_header(header):
    """The room whose header this is; None for one of the system."""
    if header.startswith("google/protobuf/"):  # of the library
        return None
    if header.startswith(PROTO_HEADERS) or header.endswith(".pb.h"):
        return "proto"
    if header.split("/")[0] in ("engine", "storage", "proto", "server", "clients", "tests"):
        return room_of(header)
    return None


def without_comments(text):
    """The text with comments and string contents blanked, line by line as before."""
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
    return re.sub(pattern, lambda found: re.sub(r"[^\n]", " ", found.group()), text, flags=re.DOTALL)


def check_includes(path, lines, breaches):
    room = room_of(path)
    if room not in MAY_INCLUDE:
        breaches.append(f"{path}:1: the room {room} does not stand in the table of tests/structure")
        return
    for number, line in enumerate(lines, 1):
        found = INCLUDE.match(line)
        if not found:
            continue
        header = found.group(2)
        other = room_of_header(header)
        if other is not None and other != room and other not in MAY_INCLUDE[room]:
            breaches.append(f"{path}:{number}: {room} may not include {header}")
        elif other != room and os.path.basename(header) not in PUBLIC.get(other, [os.path.basename(header)]):
            breaches.append(f"{path}:{number}: {header} is private to its room")
        elif other != room and room not in ONLY_FOR.get(other, {}).get(os.path.basename(header), [room]):
            breaches.append(f"{path}:{number}: {header} is not for {room}")
        if path.endswith(".h") and HEAVY.match(header):
            allowed = HEAVY_HEADERS.get(path) or HEAVY_HEADERS.get(room)
            if allowed is None or not header.startswith(allowed):
                breaches.append(f"{path}:{number}: a header may not include {header}")
        if path.startswith("engine/") and header in ENGINE_HEADERS:
            breaches.append(f"{path}:{number}: the engine may not include {header}")


def check_purity(path, text, breaches):
    allowed = ENGINE_EXCEPTIONS.get(path, set())
    for number, line in enumerate(without_comments(text).splitlines(), 1):
        for found in ENGINE_WORDS.finditer(line):
            if found.group() not in allowed:
                breaches.append(f"{path}:{number}: the engine may not use {found.group()}")
        if ENGINE_GLOBAL.match(line) and "(" not in line.split("=")[0]:
            breaches.append(f"{path}:{number}: the engine may not keep state outside its objects")


def machine_codes(root):
    """The rows of a machine family: symbol -> folder of the family."""
    try:
        with open(os.path.join(root, CATALOGUE), encoding="utf-8") as file:
            rows = CATALOGUE_ROW.findall(file.read())
    except FileNotFoundError:
        return {}
    return {symbol: "engine/" + family.lower() for family, symbol in rows if family != NEUTRAL_ROWS}


def check_codes(path, text, codes, breaches):
    for number, line in enumerate(without_comments(text).splitlines(), 1):
        for found in CODE.finditer(line):
            if found.group(1) is None:
                breaches.append(f"{path}:{number}: write ErrorCode::kName, so that its family can be seen")
                continue
            folder = codes.get(found.group(1))
            if folder is not None and not path.startswith((folder + "/", "engine/core/")):
                breaches.append(f"{path}:{number}: k{found.group(1)} is a number of {folder}, not for this room")


def check_errors(path, text, breaches):
    for form in (STATUS_WHOLE, STATUS_CHANGES, STATUS_APART):
        for found in form.finditer(text):
            number = text.count("\n", 0, found.start()) + 1
            breaches.append(f"{path}:{number}: write if (const Status done = F(); !done) return done.error();")


def without_told(code):
    """The code with what stands between the parentheses of Told(...) blanked."""
    kept = list(code)
    for found in TOLD.finditer(code):
        depth = 1
        for at in range(found.end(), len(code)):
            depth += (code[at] == "(") - (code[at] == ")")
            if depth == 0:
                break
            if kept[at] != "\n":
                kept[at] = " "
    return "".join(kept)


def check_findings(path, text, breaches):
    code = without_told(without_comments(text))
    for part in re.finditer(r"[^;{}]+", code):
        number = NUMBER_AS_TEXT.search(part.group())
        if number and FINDING.search(part.group()):
            line = code.count("\n", 0, part.start() + number.start()) + 1
            breaches.append(f"{path}:{line}: write Told(name, number ...), so that the finding knows its number")


def check_names(path, text, breaches):
    for part in path.split("/"):
        if BAD_NAME.search(os.path.splitext(part)[0]):
            breaches.append(f"{path}: '{part}' does not say what it does")
    for number, line in enumerate(text.splitlines(), 1):
        found = BAD_TYPE.match(line)
        if found:
            breaches.append(f"{path}:{number}: '{found.group(1)}' does not say what it does")


def files_under(root):
    for top in SOURCES + ("tests", "cmake", "deploy", "docs"):
        for folder, names, files in os.walk(os.path.join(root, top)):
            names[:] = sorted(n for n in names if n not in ("build", "corpus", "node_modules", "__pycache__"))
            for name in sorted(files):
                yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def check_listed(root, paths, breaches):
    """A test that no build description names is built by nobody, and missed by nobody."""
    named = set()
    for path in paths:
        if path.startswith("tests/") and path.endswith(("/CMakeLists.txt", ".cmake")):
            with open(os.path.join(root, path), encoding="utf-8") as file:
                named.update(re.findall(r"\w+", file.read()))
    for path in paths:
        if path.startswith("tests/") and path.endswith("_test.cc") and os.path.basename(path)[:-3] not in named:
            breaches.append(f"{path}: no CMakeLists.txt names it")


def check(root):
    breaches = []
    codes = machine_codes(root)
    paths = list(files_under(root))
    check_listed(root, paths, breaches)
    for path in paths:
        if not path.endswith((".h", ".cc", ".py", ".cmake", ".sh", ".js")):
            check_names(path, "", breaches)
            continue
        with open(os.path.join(root, path), encoding="utf-8", errors="replace") as file:
            text = file.read()
        lines = text.splitlines()
        check_names(path, text, breaches)
        if path.endswith((".h", ".cc")):
            limit = LINES_KNOWN.get(path, LINES_MAX)
            if len(lines) > limit:
                breaches.append(f"{path}: {len(lines)} lines, at most {limit}")
            if path.startswith(tuple(top + "/" for top in SOURCES)):
                check_includes(path, lines, breaches)
                check_codes(path, text, codes, breaches)
                check_errors(path, text, breaches)
            if path.startswith("engine/"):
                check_purity(path, text, breaches)
                check_findings(path, text, breaches)
    return breaches


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", "..")
    breaches = check(root)
    for breach in breaches:
        print(breach)
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
