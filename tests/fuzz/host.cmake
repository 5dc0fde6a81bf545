# The journal and the messages of a host, in the preset fuzz-server; their seeds are replayed by server_host_test.
if(RMLCELL_ENGINE_ONLY)
  return()
endif()
target_compile_options(rmlcell_server_host PRIVATE -fsanitize=fuzzer-no-link)
foreach(name IN ITEMS journal messages)
  rmlcell_executable(host_${name}_fuzz SOURCES host_${name}_target.cc host_input.cc
    LINKS rmlcell::server_host rmlcell::proto_recording)
  target_compile_options(host_${name}_fuzz PRIVATE -fsanitize=fuzzer)
  target_link_options(host_${name}_fuzz PRIVATE -fsanitize=fuzzer)
endforeach()
