# Objects and executables that are run; their seeds are replayed by optimo_run_conformance_test.
rmlcell_executable(optimo_run_fuzz SOURCES optimo_run_target.cc optimo_run_input.cc
  LINKS rmlcell::engine_families rmlcell::engine_optimo_language)
target_compile_options(optimo_run_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(optimo_run_fuzz PRIVATE -fsanitize=fuzzer)
