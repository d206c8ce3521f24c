# The program as a module that a worker or node makes instances of: createProgram({…}) (tools/page/script/worker.js).
set(LIBCHAR_PAGE_LINK -O3 CACHE STRING "-O1 links in seconds: for work on the page")
target_sources(sensorchar PRIVATE "${PROJECT_SOURCE_DIR}/tools/page/digest.cpp")
target_link_options(
  sensorchar
  PRIVATE ${LIBCHAR_PAGE_LINK}
          "--pre-js=${PROJECT_SOURCE_DIR}/tools/page/program.js"
          -sMODULARIZE=1
          -sEXPORT_NAME=createProgram
          -sENVIRONMENT=worker,node
          -sINVOKE_RUN=0
          -sEXIT_RUNTIME=1
          -sALLOW_MEMORY_GROWTH=1
          -sMAXIMUM_MEMORY=4GB
          -sTOTAL_STACK=8MB
          -sFORCE_FILESYSTEM=1
          -sEXPORTED_RUNTIME_METHODS=FS,callMain,ccall
          -lworkerfs.js
          -lnodefs.js)
# Of an inline function that many objects have, the first one stays. Documents and verbs are compiled for size and use Eigen too: behind what is
# hot, a fit takes half the time.
target_link_options(sensorchar PRIVATE $<TARGET_OBJECTS:libchar_curves> $<TARGET_OBJECTS:libchar>)
set_property(TARGET sensorchar APPEND PROPERTY LINK_DEPENDS "${PROJECT_SOURCE_DIR}/tools/page/program.js")
# emcc's own scripts do not find acorn otherwise.
set_property(TARGET sensorchar PROPERTY RULE_LAUNCH_LINK "\"${CMAKE_COMMAND}\" -E env NODE_PATH=/usr/share/nodejs")
