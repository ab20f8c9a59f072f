# OpenImageIO::OpenImageIO from OpenImageIO's own package files, without the include folders that do
# not exist (Debian 12's name OpenCV's, which OpenImageIO's headers need only for its OpenCV bridge).
# find_package() is to name no version: these files take none but their own series for compatible, and
# this source builds with several.
find_package(OpenImageIO CONFIG REQUIRED)
if(OpenImageIO_VERSION VERSION_LESS 2.4)
  message(FATAL_ERROR "OpenImageIO is ${OpenImageIO_VERSION}; expected 2.4 or newer")
endif()
foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
  get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
  set(existing "")
  foreach(folder IN LISTS folders)
    if(EXISTS "${folder}")
      list(APPEND existing "${folder}")
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing}")
endforeach()
