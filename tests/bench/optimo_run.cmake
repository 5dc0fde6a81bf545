rmlcell_executable(optimo_run_bench SOURCES optimo_run.cc LINKS rmlcell::engine_optimo_control)
