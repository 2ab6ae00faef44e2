// Writes every case's pictures into a folder, to be looked at.
#include "tests/picture/cases.h"

#include <cstdio>
#include <fstream>

using namespace forceshade::picture;

namespace {

bool write(const std::string& path, const Picture& picture) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(picture.png.data()), static_cast<std::streamsize>(picture.png.size()));
    std::printf("%s %d x %d, %zu bytes\n", path.c_str(), picture.width, picture.height, picture.png.size());
    return file.good();
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("usage: picture_gallery FOLDER\n", stderr);
        return 2;
    }
    const std::string folder = arguments[1];
    bool good = true;
    for (const test::Case& shown : test::cases()) {
        const test::Slices slices = test::collect(shown.grid, shown.law);
        good &= write(folder + "/" + shown.file + "_mosaic.png", draw_mosaic({shown.name}, slices.tiles));
        good &= write(folder + "/" + shown.file + "_arrows.png", draw_arrows({shown.name}, slices.xz, shown.lines));
    }
    return good ? 0 : 4;
}
