# Keys of a handbox and inputs of machines over their time; their seeds are replayed by machine_test.
foreach(library IN ITEMS engine_optimo_handbox engine_optimo_control)
  target_compile_options(rmlcell_${library} PRIVATE -fsanitize=fuzzer-no-link)
endforeach()
foreach(name IN ITEMS keys inputs)
  rmlcell_executable(machine_${name}_fuzz SOURCES machine_${name}_target.cc machine_acts_input.cc
    LINKS rmlcell::engine_families)
  target_compile_options(machine_${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(machine_${name}_fuzz PRIVATE -fsanitize=fuzzer)
endforeach()
