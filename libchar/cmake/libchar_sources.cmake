# libchar_sources(ARCHIVE [SAMPLES FILE…] [DOCUMENTS FILE…] [TABLES FILE…]): the sources of the floor that this is called in.
#   SAMPLES    what runs over samples and curves: optimised as the build type says
#   DOCUMENTS  what reads, judges and writes documents, once a run: -O1 in a Release build, half the compile time
#   TABLES     documents that a program may link its own version of: an object each
# With LIBCHAR_UNITY the samples of a folder and the documents of a floor are compiled as one: their names in anonymous
# namespaces have to differ.
function(libchar_sources archive)
  cmake_parse_arguments(PARSE_ARGV 1 floor "" "" "SAMPLES;DOCUMENTS;TABLES")
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME name)
  foreach(kind SAMPLES DOCUMENTS TABLES)
    set(target ${archive})
    if(NOT kind STREQUAL SAMPLES)
      set(target ${archive}_documents)
    endif()
    foreach(file IN LISTS floor_${kind})
      cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
      target_sources(${target} PRIVATE "${file}")
      set(group ${name})
      if(kind STREQUAL SAMPLES)
        cmake_path(GET file PARENT_PATH folder)
        cmake_path(GET folder FILENAME folder)
        string(APPEND group "_${folder}")
      endif()
      set_source_files_properties("${file}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
      if(kind STREQUAL TABLES)
        set_source_files_properties("${file}" TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endforeach()
  endforeach()
endfunction()
