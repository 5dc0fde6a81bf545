# States of machines; their seeds are replayed by machine_test.
target_compile_options(rmlcell_engine_rml1 PRIVATE -fsanitize=fuzzer-no-link)
rmlcell_executable(machine_state_fuzz SOURCES machine_state_target.cc machine_state_input.cc LINKS rmlcell::engine_families)
target_compile_options(machine_state_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(machine_state_fuzz PRIVATE -fsanitize=fuzzer)
