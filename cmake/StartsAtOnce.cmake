# rmlcell_starts_at_once(TARGET)
#
# A command that people and editors run on each file has what it needs of gRPC inside: to find, map and bind its
# sixty shared libraries takes two thirds of the time of a small file. The archives are asked first, and a shared
# library that nothing is left of is not named. Where an archive is missing, or with a linker that asks in the order
# of the line, all is as it was.
function(rmlcell_starts_at_once target)
  if(NOT LLD OR RMLCELL_SANITIZE)
    return()
  endif()
  set(archives "")
  foreach(name IN ITEMS grpc++ grpc gpr upb address_sorting re2 cares protobuf ssl crypto png16 z)
    find_library(RMLCELL_ARCHIVE_${name} lib${name}.a)
    mark_as_advanced(RMLCELL_ARCHIVE_${name})
    if(NOT RMLCELL_ARCHIVE_${name})
      return()
    endif()
    list(APPEND archives ${RMLCELL_ARCHIVE_${name}})
  endforeach()
  cmake_path(GET RMLCELL_ARCHIVE_grpc PARENT_PATH folder)
  file(GLOB absl ${folder}/libabsl_*.a)
  # At a place of its own in memory: 0.8 ms of 4.8 go into moving it.
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  # What starts objects lies together, and what nearly never runs, and nothing that nobody calls is kept: of the code
  # that is mapped around each place that runs, 6 MB of 11 need not be there.
  target_link_options(${target} PRIVATE -no-pie -static-libgcc -static-libstdc++ LINKER:--as-needed
                      LINKER:-z,keep-text-section-prefix LINKER:--gc-sections ${archives} ${absl})
endfunction()
