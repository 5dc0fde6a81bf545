rmlcell_executable(motion_planner_bench SOURCES motion_planner.cc LINKS rmlcell::engine_motion)
rmlcell_executable(motion_table_bench SOURCES motion_table.cc LINKS rmlcell::engine_motion)
rmlcell_executable(motion_linuxcnc_bench SOURCES motion_linuxcnc.cc bare_plan.cc LINKS rmlcell::engine_motion)
# A limit has all that this machine can do, ours what each machine can.
set_source_files_properties(bare_plan.cc PROPERTIES COMPILE_OPTIONS "-march=native" SKIP_UNITY_BUILD_INCLUSION ON)
target_link_libraries(motion_linuxcnc_bench PRIVATE ${CMAKE_DL_LIBS})
