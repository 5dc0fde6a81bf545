rmlcell_executable(motion_planner_bench SOURCES motion_planner.cc LINKS rmlcell::engine_motion)
rmlcell_executable(motion_table_bench SOURCES motion_table.cc LINKS rmlcell::engine_motion)
rmlcell_executable(motion_linuxcnc_bench SOURCES motion_linuxcnc.cc LINKS rmlcell::engine_motion)
target_link_libraries(motion_linuxcnc_bench PRIVATE ${CMAKE_DL_LIBS})
