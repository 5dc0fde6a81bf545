rmlcell_executable(motion_planner_fuzz
  SOURCES motion_planner.cc motion_planner_input.cc LINKS rmlcell::engine_motion)
target_compile_options(motion_planner_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(motion_planner_fuzz PRIVATE -fsanitize=fuzzer)
