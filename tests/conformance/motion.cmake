# The reference cases of motion.md section 12, as a test and as a program for any file of that format.
find_package(nlohmann_json REQUIRED)
set(motion_case_sources mill_case_kinds.cc motion_case_kinds.cc motion_cases.cc)
rmlcell_test(motion_reference_test conformance
  SOURCES motion_reference_test.cc ${motion_case_sources}
  LINKS rmlcell::engine_motion rmlcell::engine_rml1 rmlcell::engine_simulation nlohmann_json::nlohmann_json)
rmlcell_executable(motion_reference
  SOURCES motion_reference.cc ${motion_case_sources}
  LINKS rmlcell::engine_motion rmlcell::engine_rml1 rmlcell::engine_simulation nlohmann_json::nlohmann_json)
