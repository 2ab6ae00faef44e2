#include "host/explore/path_writer.h"

#include <charconv>

namespace forceshade {
namespace {

constexpr std::size_t kText = std::size_t(1) << 18; // bytes gathered before they are written

} // namespace

PathWriter::PathWriter(const std::filesystem::path& path)
    : file_(path), text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n") {}

template <typename T> void PathWriter::number(T value, char after) {
    char digits[40]; // the shortest form of a double has 24 at most
    const char* const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    text_.append(digits, static_cast<std::size_t>(end - digits));
    text_ += after;
}

template <typename T> void PathWriter::add(const PathSample& sample, const reference::Contact<T>& contact) {
    number(sample.path, ',');
    number(sample.time, ',');
    for (int i = 0; i < 3; ++i)
        number(static_cast<T>(sample.probe[i]), ','); // where the law was evaluated
    for (const reference::Vector<T>& vector : {contact.proxy, contact.force})
        for (int i = 0; i < 3; ++i)
            number(vector[i], ',');
    number(contact.depth, ',');
    if (contact.facet == layout::kNoFacet)
        text_ += "-1\n";
    else
        number(contact.facet, '\n');
    if (text_.size() >= kText)
        flush();
}

void PathWriter::flush() {
    file_.write(text_);
    text_.clear();
}

void PathWriter::publish() {
    flush();
    file_.publish();
}

template void PathWriter::add<float>(const PathSample&, const reference::Contact<float>&);
template void PathWriter::add<double>(const PathSample&, const reference::Contact<double>&);

} // namespace forceshade
