rmlcell_executable(motion_planner_bench SOURCES motion_planner.cc LINKS rmlcell::engine_motion)
