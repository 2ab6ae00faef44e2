#!/bin/sh
# The library by add_subdirectory, without the packages that only the rest of forceshade needs: what the examples print is
# what they print with the library of a build of everything.
#   subdirectory_test.sh BUILD
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cmake -DCMAKE_INSTALL_PREFIX="$folder/installed" -P "$1/host/library/cmake_install.cmake" > /dev/null
cmake -S "$here/../../host/library/examples" -B with_package -DCMAKE_PREFIX_PATH="$folder/installed" > /dev/null
cmake --build with_package > /dev/null
without=
for package in Eigen3 Vulkan OpenEXR Imath OpenSSL spdlog nlohmann_json CLI11 Python pybind11; do
    without="$without -DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"
done
cmake -S "$here/../../host/library/examples" -B beside -DFORCESHADE_SOURCE="$here/../.." -DCMAKE_BUILD_TYPE=Debug $without > /dev/null
cmake --build beside -j 2 > /dev/null

# Without libpng and pugixml it says what it cannot read; with GLM alone there are the headers.
cmake -S "$here/../../host/library/examples" -B lean -DFORCESHADE_SOURCE="$here/../.." -DCMAKE_BUILD_TYPE=Debug $without \
    -DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON -DCMAKE_DISABLE_FIND_PACKAGE_pugixml=ON > /dev/null
cmake --build lean -j 2 > /dev/null
printf '[surface]\nkind = "height_map"\nfunction = "file"\nfile = "map.png"\n[force]\nshading = "height_map"\n' > map.toml
printf '\211PNG\r\n\032\n' > map.png
lean/feel map.toml 2>&1 | grep -q "reads no PNG images"
mkdir headers
printf 'cmake_minimum_required(VERSION 3.25)\nproject(p CXX)\nadd_subdirectory("%s" f)\nadd_executable(headers "%s/headers.cpp")\ntarget_link_libraries(headers forceshade::reference)\n' \
    "$here/../.." "$here/../../host/library/examples" > headers/CMakeLists.txt
for package in fmt OpenMesh CGAL PkgConfig PNG pugixml; do
    without="$without -DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"
done
cmake -S headers -B alone $without > alone.txt
grep -q "forceshade::reference alone" alone.txt
cmake --build alone > /dev/null

cat > scene.toml <<END
[surface]
kind = "mesh"
file = "tetrahedron.off"
unit = "cm"
[force]
shading = "barycentric"
END
printf 'OFF\n4 4 0\n-1 -1 -1\n1 -1 0\n0 1 0\n0 0 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' > tetrahedron.off
for example in loop touch headers "feel scene.toml"; do
    with_package/$example > one.txt
    beside/$example > other.txt
    cmp one.txt other.txt
    lean/$example > other.txt
    cmp one.txt other.txt
done
with_package/headers > one.txt
alone/headers > other.txt
cmp one.txt other.txt
