# The tools for streams of mills; their seeds are replayed by rml1_board_test.
foreach(name IN ITEMS walk gcode png)
  rmlcell_executable(rml1_${name}_fuzz SOURCES rml1_${name}_target.cc rml1_tools_input.cc
    LINKS rmlcell::engine_rml1_board rmlcell::engine_rml1_offline)
  target_compile_options(rml1_${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(rml1_${name}_fuzz PRIVATE -fsanitize=fuzzer)
endforeach()
