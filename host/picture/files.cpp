#include "host/picture/files.h"

#include <span>

#include "host/output/files.h"

namespace forceshade::picture {

bool Endings::add(std::string_view name) {
    for (const auto& [known, wanted] : {std::pair("png", &png), {"svg", &svg}, {"pdf", &pdf}})
        if (name == known)
            return *wanted = true;
    return false;
}

std::vector<std::string> names_with(const std::string& stem, const Endings& endings) {
    std::vector<std::string> names;
    for (const auto& [wanted, ending] : {std::pair(endings.png, ".png"), {endings.svg, ".svg"}, {endings.pdf, ".pdf"}})
        if (wanted)
            names.push_back(stem + ending);
    return names;
}

std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture) {
    std::vector<FileRecord> records;
    for (const std::string& name : names_with(stem.filename().string(), endings)) {
        const std::string vectors = name.ends_with(".svg")   ? picture.svg()
                                    : name.ends_with(".pdf") ? picture.pdf()
                                                             : "";
        const auto bytes = vectors.empty() ? std::as_bytes(std::span(picture.png)) : std::as_bytes(std::span(vectors));
        write_file_atomically(stem.parent_path() / name, bytes);
        records.push_back({name, sha256_of(bytes), bytes.size()});
    }
    return records;
}

} // namespace forceshade::picture
