# Parser, object decoder, converter and compensation; their seeds are replayed by
# optimo_language_conformance_test.
# What is aimed at tells the fuzzer where it has been.
foreach(library IN ITEMS engine_optimo_language engine_optimo_offline)
  target_compile_options(rmlcell_${library} PRIVATE -fsanitize=fuzzer-no-link)
endforeach()
foreach(target IN ITEMS text:TryText object:TryObject convert:TryConvert compensate:TryCompensate)
  string(REPLACE ":" ";" parts ${target})
  list(GET parts 0 name)
  list(GET parts 1 input)
  rmlcell_executable(optimo_${name}_fuzz
    SOURCES optimo_target.cc optimo_language_input.cc LINKS rmlcell::engine_optimo_offline)
  target_compile_definitions(optimo_${name}_fuzz PRIVATE RMLCELL_FUZZ_INPUT=${input})
  target_compile_options(optimo_${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(optimo_${name}_fuzz PRIVATE -fsanitize=fuzzer)
endforeach()
