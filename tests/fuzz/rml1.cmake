# The fuzz target of engine/rml1; included by tests/engine/rml1, whose tests replay its corpus.
#   build/fuzz/tests/rml1_device_fuzz -max_len=4096 tests/fuzz/corpus/rml1
if(RMLCELL_FUZZ AND NOT TARGET rml1_device_fuzz)
  add_executable(rml1_device_fuzz ${PROJECT_SOURCE_DIR}/tests/fuzz/rml1_device_fuzz.cc)
  target_link_libraries(rml1_device_fuzz PRIVATE rmlcell::engine_rml1 rmlcell_warnings)
  target_compile_definitions(rml1_device_fuzz PRIVATE RMLCELL_FUZZ_TARGET)
  target_compile_options(rml1_device_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(rml1_device_fuzz PRIVATE -fsanitize=fuzzer)
  set_target_properties(rml1_device_fuzz PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
endif()
