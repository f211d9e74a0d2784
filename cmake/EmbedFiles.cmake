# Writes a source that contains text files as string literals; run by the build:
#   cmake -DOUT=FILE.cpp -DFOLDER=DIR -DNAMES=a.html|b.js -P EmbedFiles.cmake
# The source defines rayloc::map_files() (daemon/live/http/map_files.h).
string(REPLACE "|" ";" names "${NAMES}")
set(text "// Written by cmake/EmbedFiles.cmake.\n#include \"daemon/live/http/map_files.h\"\n\n")
string(APPEND text "namespace rayloc {\n\nconst std::vector<MapFile>& map_files() {\n")
string(APPEND text "  static const std::vector<MapFile> files = {\n")
foreach(name IN LISTS names)
  file(READ "${FOLDER}/${name}" content)
  string(LENGTH "${content}" length)
  if(content MATCHES "\\)RAYLOC\"" OR length GREATER 60000)
    message(FATAL_ERROR "${name}: too long for one literal, or it holds its end")
  endif()
  string(APPEND text "      {\"${name}\", R\"RAYLOC(${content})RAYLOC\"},\n")
endforeach()
string(APPEND text "  };\n  return files;\n}\n\n}  // namespace rayloc\n")
file(WRITE "${OUT}" "${text}")
