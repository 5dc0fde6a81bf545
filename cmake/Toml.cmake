# TOML in our own library: the shared one of the package would be found, mapped and bound by every command that
# starts. rmlcell::toml
find_package(tomlplusplus REQUIRED CONFIG)
get_target_property(RMLCELL_TOML_HEADERS tomlplusplus::tomlplusplus INTERFACE_INCLUDE_DIRECTORIES)
add_library(rmlcell_toml STATIC ${CMAKE_CURRENT_LIST_DIR}/toml.cc)
add_library(rmlcell::toml ALIAS rmlcell_toml)
# As the package has it: text that makes it no sense is an error, and no reason to abort.
target_compile_definitions(rmlcell_toml PUBLIC TOML_HEADER_ONLY=0 PRIVATE TOML_IMPLEMENTATION NDEBUG)
if(RMLCELL_TOML_HEADERS)
  target_include_directories(rmlcell_toml SYSTEM PUBLIC ${RMLCELL_TOML_HEADERS})
endif()
