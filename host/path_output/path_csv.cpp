#include "host/path_output/path_csv.h"

#include <charconv>

#include "host/io/raw_rows.h"

namespace forceshade {
namespace {

constexpr std::size_t kText = std::size_t(1) << 18; // bytes gathered before they are written

} // namespace

PathCsvWriter::PathCsvWriter(const std::filesystem::path& path, const PathLabels& labels)
    : file_(path), labels_(labels), text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n") {}

template <typename T> void PathCsvWriter::number(T value, char after) {
    char digits[40]; // the shortest form of a double has 24 at most
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    text_ += after;
}

template <typename T> void PathCsvWriter::add_sample(const PathRows<T>& rows, std::size_t path, std::size_t step) {
    const std::size_t at = path * rows.pitch + step - rows.step_first;
    number(labels_.id(rows.path_first + path), ',');
    number(labels_.time(rows.path_first + path, step), ',');
    for (const std::span<const T>& vector : {rows.position, rows.proxy, rows.force})
        for (std::size_t i = 0; i < 3; ++i)
            number(vector[3 * at + i], ',');
    number(rows.depth[at], ',');
    if (rows.facet[at] == layout::kNoFacet)
        text_ += "-1\n";
    else
        number(rows.facet[at], '\n');
}

template <typename T> void PathCsvWriter::add(const PathRows<T>& rows) {
    for (std::size_t path = 0; path < rows.path_count; ++path)
        for (std::size_t i = 0; i < rows.samples(path); ++i) {
            add_sample(rows, path, rows.step_first + i);
            if (text_.size() < kText)
                continue;
            file_.write(text_);
            text_.clear();
        }
}

VolumeResult PathCsvWriter::finish() {
    file_.write(text_);
    text_.clear();
    return publish_raw(file_);
}

} // namespace forceshade
