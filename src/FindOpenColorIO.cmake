# OpenColorIO::OpenColorIO, from OpenColorIO's own package files or, where those cannot be used
# (Debian 12 installs them where CMake does not look), from pkg-config.
find_package(OpenColorIO ${OpenColorIO_FIND_VERSION} CONFIG QUIET)
if(NOT TARGET OpenColorIO::OpenColorIO)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(TonewrightOCIO REQUIRED IMPORTED_TARGET "OpenColorIO>=2.1")
  add_library(OpenColorIO::OpenColorIO INTERFACE IMPORTED)
  target_link_libraries(OpenColorIO::OpenColorIO INTERFACE PkgConfig::TonewrightOCIO)
endif()
set(OpenColorIO_FOUND TRUE)
