# Writes a text file as a C++ constant: cmake -DNAME=... -DINPUT=... -DOUTPUT=... -P embed.cmake
file(READ "${INPUT}" text)
set(delimiter "cullhull-asset")
string(FIND "${text}" ")${delimiter}\"" clash)
if(NOT clash EQUAL -1)
  message(FATAL_ERROR "${INPUT} contains the delimiter of the literal it is to become")
endif()
file(WRITE "${OUTPUT}" "#include \"viewer/assets.hpp\"
namespace cullhull::viewer::assets {
static constexpr char text[] = R\"${delimiter}(${text})${delimiter}\";
const std::string_view ${NAME}{text, sizeof text - 1};
}  // namespace cullhull::viewer::assets
")
