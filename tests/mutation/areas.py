"""The areas that are measured: the folders that are changed, and the tests of that part, by their names in CTest,
those first that notice most."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Area:
    folders: tuple  # every .cc file in them, not in folders below
    tests: tuple


AREAS = {
    "motion": Area(("engine/core", "engine/machine", "engine/motion/geometry", "engine/motion/profile",
                    "engine/motion/kinematics", "engine/motion/corner", "engine/motion/planner", "engine/motion/ride", "engine/motion/jog"),
                   ("core_test", "core_tables_test", "machine_test", "motion_test", "motion_reference_test", "rml1_test",
                    "simulation_test", "optimo_control_test", "optimo_language_test",
                    "motion_property_test")),
    "mill": Area(("engine/rml1",),
                 ("rml1_test", "rml1_examples_test", "simulation_test", "motion_test", "motion_reference_test",
                  "rml1_hostile_test", "machine_test", "rml1_corpus_test")),
    "language": Area(("engine/optimo/language",),
                     ("optimo_language_test", "optimo_language_conformance_test", "optimo_offline_test",
                      "optimo_control_test", "optimo_run_conformance_test", "lsp_test")),
    "tools": Area(("engine/rml1/offline", "engine/rml1/board"),
                  ("rml1_offline_test", "rml1_board_test", "integration_test_rml1_tools")),
    "offline": Area(("engine/optimo/offline",),
                    ("optimo_offline_test", "optimo_language_conformance_test", "lsp_test",
                     "server_programs_test")),
    "control": Area(("engine/optimo/machine", "engine/optimo/ride", "engine/optimo/handbox", "engine/optimo/control"),
                    ("optimo_control_test", "optimo_handbox_test", "optimo_run_conformance_test", "simulation_test",
                     "machine_test", "motion_reference_test")),
    "simulation": Area(("engine/families", "engine/simulation/path", "engine/simulation/report",
                        "engine/simulation/toolpath", "engine/simulation/picture", "engine/simulation/material",
                        "engine/simulation/run", "engine/simulation/verdict"),
                       ("simulation_test", "optimo_run_conformance_test", "rml1_test", "rml1_examples_test",
                        "integration_test_command")),
    "store": Area(("storage", "storage/jobs", "storage/opening", "storage/sqlite"),
                  ("storage_jobs_test", "storage_sqlite_conformance_test", "storage_sqlite_test", "storage_sqlite_crash_test",
                   "server_jobs_test", "server_projects_test")),
    "jobs": Area(("server/base", "server/cell", "server/records", "server/jobs", "server/events", "server/host", "server/machines", "server/runs", "server/worker", "server/programs", "server/projects", "server/results"),
                 ("server_test", "server_cell_test", "server_host_test", "server_machines_test", "server_runs_test", "server_command_line_test", "server_worker_test", "server_worker_runner_test", "server_projects_test",
                  "server_programs_test", "server_jobs_test", "server_results_test", "server_events_test",
                  "integration_test_cell", "integration_test_tools", "integration_test_programs")),
    "web": Area(("server/web",), ("server_web_test", "integration_test_http", "integration_test_web")),
    "services": Area(("server/auth", "server/services", "proto/bridge", "proto/recording"),
                     ("proto_bridge_test", "proto_recording_test", "server_auth_test", "server_services_test", "server_programs_test", "server_jobs_test", "server_host_test", "integration_test_machines",
                      "integration_test_transfers", "integration_test_tools", "integration_test_cell", "integration_test_toolpath",
                      "integration_test_programs", "integration_test_http", "integration_test_command", "integration_test_command_remote",
                      "integration_test_web")),
    "command": Area(("clients/cli", "clients/lsp", "engine/optimo/editing"),
                    ("lsp_test", "optimo_editing_test", "cli_test", "integration_test_command", "integration_test_command_remote", "integration_test_command_words", "integration_test_command_options", "integration_test_command_requests", "integration_test_lsp",
                     "integration_test_tools", "integration_test_rml1_tools", "integration_test_programs",
                     "integration_test_handbox_screen", "integration_test_told_at_once", "integration_test_handbox_terminal",
                     "integration_test_by_hand")),
}
