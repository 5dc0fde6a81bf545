# Writes a source file that holds the given files of clients/web as they are: .incbin is instant for any
# size, where an array of numbers is slow to compile.
function(rmlcell_embed_page target folder)
  set(body "// Written by server/web/embed.cmake.\n#include \"server/web/static_page.h\"\n\n")
  set(rows "")
  set(index 0)
  foreach(name IN LISTS ARGN)
    set(path ${folder}/${name})
    string(APPEND body "asm(R\"(\n.section .rodata\n.balign 16\nrmlcell_page_${index}:\n"
                       ".incbin \"${path}\"\nrmlcell_page_${index}_end:\n.byte 0\n.previous\n)\");\n"
                       "extern \"C\" const char rmlcell_page_${index}[];\n"
                       "extern \"C\" const char rmlcell_page_${index}_end[];\n")
    string(APPEND rows "      {\"${name}\", {rmlcell_page_${index}, static_cast<std::size_t>(\n"
                       "          rmlcell_page_${index}_end - rmlcell_page_${index})}},\n")
    list(APPEND paths ${path})
    math(EXPR index "${index} + 1")
  endforeach()
  string(APPEND body "\nnamespace rmlcell::web {\n\nstd::vector<EmbeddedFile> EmbeddedFiles() {\n"
                     "  return {\n${rows}  };\n}\n\n}  // namespace rmlcell::web\n")
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_page.cc)
  file(CONFIGURE OUTPUT ${source} CONTENT "${body}" @ONLY)
  # A source of its own: of one that is compiled together with others nobody sees what it depends on.
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${paths}" SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${source})
endfunction()
