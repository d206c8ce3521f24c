# Debian packages: `.ci/package`, or cpack in the folder of a build. sensorchar (the program), libchar-dev (the archives and headers),
# python3-libchar (the module, where it is built).
set(LIBCHAR_MAINTAINER "sensorchar maintainers <maintainers@sensorchar.invalid>" CACHE STRING "who answers for the Debian packages")
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON) # cpack packs what is built, and does not build the tests for it

add_custom_target(packed DEPENDS libchar libchar_curves sensorchar sensorchar_pages) # what goes into packages

# Debian's own files: copyright and both changelogs for each package, compressed without a time.
execute_process(COMMAND date -u -d "${LIBCHAR_RELEASED} 12:00" -R OUTPUT_VARIABLE debian_date OUTPUT_STRIP_TRAILING_WHITESPACE)
set(debian "${PROJECT_BINARY_DIR}/debian")
configure_file("${CMAKE_CURRENT_LIST_DIR}/debian/changelog.in" "${debian}/changelog.Debian" @ONLY)
configure_file("${PROJECT_SOURCE_DIR}/docs/changelog.md" "${debian}/changelog" COPYONLY)
find_program(GZIP gzip REQUIRED)
foreach(file changelog changelog.Debian)
  execute_process(COMMAND "${GZIP}" -9nkf "${debian}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
function(debian_documents component package)
  install(FILES "${PROJECT_SOURCE_DIR}/libchar/cmake/debian/copyright" "${debian}/changelog.gz" "${debian}/changelog.Debian.gz"
          DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
endfunction()
debian_documents(program sensorchar)
debian_documents(library libchar-dev)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/sensorchar" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/sensorchar/docs" COMPONENT program
        PATTERN "*.cpp" EXCLUDE PATTERN "CMakeLists.txt" EXCLUDE PATTERN "changelog.md" EXCLUDE PATTERN "examples" EXCLUDE)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/examples" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libchar-dev" COMPONENT library
        PATTERN "CMakeLists.txt" EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sensorchar)
set(CPACK_PACKAGE_VENDOR "${LIBCHAR_MAINTAINER}")
set(CPACK_PACKAGE_CONTACT "${LIBCHAR_MAINTAINER}")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program library)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS OFF)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME sensorchar)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bash-completion, python3-libchar, libchar-dev")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "noise, models and fusion of sensors from recordings
Measures the noise of a recorded sensor: Allan deviation, power spectral
density and noise coefficients with confidence intervals, as an HTML report.
It simulates sensors from the result, exports their numbers to Kalibr, Gazebo,
PX4, GTSAM and other programs, and compares many fusion algorithms on
recordings of sensor arrays.")

# package_of(FILE WORD): the package that installed FILE.
function(package_of file word)
  execute_process(COMMAND dpkg-query -S "${file}" OUTPUT_VARIABLE owner ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX MATCH "^[a-z0-9.+-]+" package "${owner}")
  set(${word} "${package}" PARENT_SCOPE)
endfunction()

# The archives link what readers of some formats use as well (libchar_optional): each library is in the package that installed it.
get_cmake_property(variables CACHE_VARIABLES)
list(FILTER variables INCLUDE REGEX "^LIBCHAR_[A-Z0-9]+_LIBRARY$")
set(optional_packages "")
foreach(variable IN LISTS variables)
  if(${variable})
    package_of("${${variable}}" package)
    if(package)
      string(APPEND optional_packages ", ${package}")
    endif()
  endif()
endforeach()

# What no tool finds in the program, because it is loaded when it is needed (libchar_late).
get_property(late_libraries GLOBAL PROPERTY LIBCHAR_LATE_LIBRARIES)
set(late_packages "")
foreach(library IN LISTS late_libraries)
  package_of("${library}" package)
  if(package)
    list(APPEND late_packages "${package}")
  endif()
endforeach()
list(JOIN late_libraries "\n" late_lines)
list(JOIN late_packages ", " late_packages)
file(WRITE "${CMAKE_BINARY_DIR}/late_libraries" "${late_lines}\n")
file(WRITE "${CMAKE_BINARY_DIR}/late_packages" "${late_packages}\n")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${late_packages}")

if(CAIRO_FOUND)
  string(APPEND optional_packages ", libcairo2-dev, pkg-config")
  # What figures have their text in; without it PDF and PNG take another font.
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS fonts-liberation2)
endif()
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libchar-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
    "libceres-dev, libeigen3-dev, libfftw3-dev, libfmt-dev, nlohmann-json3-dev, libyaml-cpp-dev, libboost-math-dev, libssl-dev, libtbb-dev${optional_packages}")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "characterization and fusion of sensors (development files)
The library behind sensorchar: readers of sensor logs, the Allan family of
deviations, spectra, fits of noise models, simulation and replays of fusion
algorithms. This package has its archives, headers and examples; CMake finds
it as libchar::libchar, and logs, Allan curves and spectra alone as
libchar::curves.")

if(TARGET libchar_python)
  add_dependencies(packed libchar_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  debian_documents(python python3-libchar)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-libchar)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # The module is for the interpreter that it was built with.
  math(EXPR next_minor "${LIBCHAR_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "sensorchar, python3 (>= 3.${LIBCHAR_PYTHON_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "characterization and fusion of sensors (Python module)
The library behind sensorchar for NumPy arrays: Allan deviations, spectra,
noise coefficients with intervals, whole characterizations, simulated sensors
and replays of fusion algorithms, without copies of the samples.")
endif()
include(CPack)
