find_package(SQLite3 3.40 REQUIRED)
rmlcell_executable(bench_store_submit
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/store_submit.cc
  LINKS rmlcell::storage_sqlite SQLite::SQLite3)
rmlcell_executable(bench_store_open
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/store_open.cc
  LINKS rmlcell::storage_sqlite SQLite::SQLite3)
