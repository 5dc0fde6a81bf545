# Part programs as tests of the Optimo language: the expectation stands on the line that causes it.
rmlcell_test(optimo_language_conformance_test conformance
  SOURCES optimo_convert_test.cc optimo_corpus_test.cc optimo_fuzz_replay_test.cc optimo_programs_test.cc
          ../fuzz/optimo_language_input.cc
  LINKS rmlcell::engine_optimo_language rmlcell::engine_optimo_offline)
# Programs that run on the virtual machine: what it does, row by row.
rmlcell_test(optimo_run_conformance_test conformance
  SOURCES optimo_machine.cc optimo_run_motion_test.cc optimo_run_process_test.cc
          optimo_run_program_test.cc optimo_run_function_test.cc optimo_run_fly_test.cc optimo_run_replay_test.cc
          ../fuzz/optimo_run_input.cc
  LINKS rmlcell::engine_optimo_control rmlcell::engine_optimo_offline rmlcell::engine_families)
