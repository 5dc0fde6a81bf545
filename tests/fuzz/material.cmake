# Blocks, tools and targets of mills; their seeds are replayed by simulation_test.
target_compile_options(rmlcell_engine_simulation PRIVATE -fsanitize=fuzzer-no-link)
rmlcell_executable(material_fuzz SOURCES material_target.cc material_input.cc LINKS rmlcell::engine_simulation)
target_compile_options(material_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(material_fuzz PRIVATE -fsanitize=fuzzer)
