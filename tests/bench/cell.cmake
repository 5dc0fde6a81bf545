find_package(SQLite3 3.40 REQUIRED)
if(NOT RMLCELL_ENGINE_ONLY)
  rmlcell_executable(bench_cell_submit
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_submit.cc
    LINKS rmlcell::proto SQLite::SQLite3)
  rmlcell_executable(bench_cell_stop
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_stop.cc
    LINKS rmlcell::proto)
  rmlcell_executable(bench_cell_status
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_status.cc
    LINKS rmlcell::proto)
  rmlcell_executable(bench_cell_watch
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_watch.cc
    LINKS rmlcell::proto)
  rmlcell_executable(bench_cell_watch_hour
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_watch_hour.cc
    LINKS rmlcell::proto)
  rmlcell_executable(bench_cell_live
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_live.cc
    LINKS rmlcell::proto SQLite::SQLite3)
  foreach(bench IN ITEMS submit status stop live watch watch_hour)
    set_property(TARGET bench_cell_${bench}
                 PROPERTY LINK_LIBRARY_OVERRIDE "WHOLE_ARCHIVE,rmlcell_proto")
  endforeach()
endif()
