# Files of machine profiles; their seeds are replayed by machine_test.
target_compile_options(rmlcell_engine_machine PRIVATE -fsanitize=fuzzer-no-link)
rmlcell_executable(profile_fuzz SOURCES profile_target.cc profile_input.cc LINKS rmlcell::engine_families)
target_compile_options(profile_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(profile_fuzz PRIVATE -fsanitize=fuzzer)
