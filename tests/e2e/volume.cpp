#include "tests/e2e/volume.h"

#include <algorithm>
#include <stdexcept>

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>

namespace forceshade::testing {
namespace {

const char* type_name(Imf::PixelType type) {
    return type == Imf::FLOAT ? "float" : type == Imf::HALF ? "half" : "uint";
}

ReadPart read_part(Imf::MultiPartInputFile& file, int index) {
    Imf::InputPart input(file, index);
    const Imath::Box2i window = input.header().dataWindow();
    ReadPart part{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}, {}};
    const auto pixels = static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height);
    const std::size_t row = sizeof(float) * static_cast<std::size_t>(part.width);
    Imf::FrameBuffer frame;
    for (auto channel = input.header().channels().begin(); channel != input.header().channels().end(); ++channel) {
        std::vector<float>& samples = part.channels[channel.name()];
        samples.resize(pixels);
        part.types[channel.name()] = type_name(channel.channel().type);
        frame.insert(channel.name(),
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float), row));
    }
    input.setFrameBuffer(frame);
    input.readPixels(window.min.y, window.max.y);
    return part;
}

} // namespace

ReadVolume read_exr(const std::filesystem::path& path) {
    Imf::MultiPartInputFile file(path.c_str(), 0, false);
    ReadVolume volume;
    for (int i = 0; i < file.parts(); ++i) {
        if (!file.partComplete(i))
            throw std::runtime_error(path.string() + " is not complete");
        const std::string name = file.header(i).hasName() ? file.header(i).name() : "";
        volume.parts[name] = read_part(file, i);
    }
    const Imf::Header& header = file.header(0);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
            volume.texts[attribute.name()] = text->value();
    const auto& grid = header.typedAttribute<Imf::V3iAttribute>("forceshade.grid").value();
    const auto& origin = header.typedAttribute<Imf::V3dAttribute>("forceshade.origin").value();
    const auto& spacing = header.typedAttribute<Imf::V3dAttribute>("forceshade.spacing").value();
    volume.grid = {grid.x, grid.y, grid.z};
    volume.origin = {origin.x, origin.y, origin.z};
    volume.spacing = {spacing.x, spacing.y, spacing.z};
    return volume;
}

} // namespace forceshade::testing
