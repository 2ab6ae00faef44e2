#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "host/text.h"
#include "host/vibration/vibration.h"

namespace forceshade {
namespace {

constexpr std::size_t kHighestOrder = 200, kMostModels = 10000;
constexpr double kHighestRate = 1e6; // Hz
constexpr double kMillimetre = 1e-3; // m

std::string_view text_of(const pugi::xml_node& node) {
    return std::string_view(node.text().get()).substr(0, 60);
}

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : name_(file.string()), text_(read_file(file)) {
        const pugi::xml_parse_result result = document_.load_buffer(
            text_.data(), text_.size(), pugi::parse_default | pugi::parse_trim_pcdata, pugi::encoding_utf8);
        if (!result)
            refuse(result.offset, fmt::format("damaged XML: {}", result.description()));
        set_ = document_.child("modelSet");
        if (!set_)
            refuse(0, "no <modelSet>; expected vibration models as in the Penn Haptic Texture Toolkit");
    }

    VibrationModels models() const {
        VibrationModels all;
        require_unit("AccelUnits", "m/s^2");
        require_unit("SpeedUnits", "mm/s");
        require_unit("ForceUnits", "N");
        all.material = set_.child("material").text().get();
        all.rate = above_zero("SampleRate");
        if (all.rate > kHighestRate)
            refuse(set_.child("SampleRate"), fmt::format("the sample rate exceeds {} Hz", kHighestRate));
        all.largest_speed = kMillimetre * above_zero("maxSpeed");
        all.largest_force = above_zero("maxForce");
        if (const pugi::xml_node friction = set_.child("mu"))
            all.friction = not_negative(friction);
        add_models(all);
        for (const pugi::xml_node& node : set_.children("tri"))
            all.triangles.push_back(triangle(node, all.models.size()));
        if (all.triangles.empty())
            refuse(set_, "no <tri>");
        require_count("numMod", all.models.size());
        require_count("numTri", all.triangles.size());
        require_count("numARCoeff", all.models.front().ar.size());
        require_count("numMACoeff", all.models.front().ma.size());
        return all;
    }

private:
    [[noreturn]] void refuse(std::ptrdiff_t offset, const std::string& why) const {
        const auto end = text_.begin() + std::clamp(offset, std::ptrdiff_t(0), std::ptrdiff_t(text_.size()));
        throw UsageError("{}:{}: {}", name_, 1 + std::count(text_.begin(), end, '\n'), why);
    }
    [[noreturn]] void refuse(const pugi::xml_node& node, const std::string& why) const {
        refuse(node.offset_debug(), why);
    }

    pugi::xml_node child(const pugi::xml_node& node, const char* name) const {
        const pugi::xml_node found = node.child(name);
        if (!found)
            refuse(node, fmt::format("<{}> has no <{}>", node.name(), name));
        return found;
    }

    double number(const pugi::xml_node& node) const {
        const auto value = number_in<double>(node.text().get());
        if (!value)
            refuse(node, fmt::format("<{}> must be a finite number, got \"{}\"", node.name(), text_of(node)));
        return *value;
    }
    double not_negative(const pugi::xml_node& node) const {
        const double value = number(node);
        if (value < 0)
            refuse(node, fmt::format("<{}> must not be negative, got {}", node.name(), value));
        return value;
    }
    double above_zero(const char* name) const {
        const pugi::xml_node node = child(set_, name);
        const double value = number(node);
        if (!(value > 0))
            refuse(node, fmt::format("<{}> must be positive, got {}", name, value));
        return value;
    }

    void require_unit(const char* name, std::string_view unit) const {
        const pugi::xml_node node = child(set_, name);
        if (node.text().get() != unit)
            refuse(node, fmt::format("<{}> must be \"{}\", got \"{}\"", name, unit, text_of(node)));
    }
    // A count that the file states, if it does.
    void require_count(const char* name, std::size_t count) const {
        if (const pugi::xml_node node = set_.child(name); node && number(node) != double(count))
            refuse(node, fmt::format("<{}> is {}, but the file has {}", name, text_of(node), count));
    }

    std::vector<pugi::xml_node> values(const pugi::xml_node& node, std::size_t most) const {
        std::vector<pugi::xml_node> all;
        for (const pugi::xml_node& value : node.children("value")) {
            if (all.size() == most)
                refuse(value, fmt::format("<{}> has more than {} values", node.name(), most));
            all.push_back(value);
        }
        return all;
    }
    std::vector<double> places(const char* name) const {
        std::vector<double> all;
        for (const pugi::xml_node& value : values(child(set_, name), kMostModels))
            all.push_back(not_negative(value));
        return all;
    }
    std::vector<double> frequencies(const pugi::xml_node& node) const {
        std::vector<double> all;
        for (const pugi::xml_node& value : values(node, kHighestOrder)) {
            const double low = all.empty() ? 0 : all.back(), one = number(value);
            if (!(one > low && one < std::numbers::pi))
                refuse(value, fmt::format("<{}> must ascend between 0 and pi, got {} after {}", node.name(), one, low));
            all.push_back(one);
        }
        return all;
    }

    void add_models(VibrationModels& all) const {
        const std::vector<double> speeds = places("speedList"), forces = places("forceList");
        for (const pugi::xml_node& node : set_.children("model")) {
            const std::size_t at = all.models.size();
            if (at >= speeds.size() || at >= forces.size())
                refuse(node, fmt::format("model {} has no place in <speedList> and <forceList>", at + 1));
            if (const pugi::xml_node own = child(node, "modNum"); number(own) != double(at + 1))
                refuse(own, fmt::format("<modNum> must be {}, got {}", at + 1, text_of(own)));
            VibrationModel one{kMillimetre * speeds[at],          forces[at],
                               frequencies(child(node, "ARlsf")), frequencies(node.child("MAlsf")),
                               not_negative(child(node, "var")),  1};
            if (one.ar.empty())
                refuse(node, "<ARlsf> is empty");
            if (!one.ma.empty()) // without moving average the toolkit's renderer knows no gain
                one.gain = number(child(node, "gain"));
            if (at > 0 && (one.ar.size() != all.models[0].ar.size() || one.ma.size() != all.models[0].ma.size()))
                refuse(node,
                       fmt::format("model {} has {} and {} line spectral frequencies, the first {} and {}", at + 1,
                                   one.ar.size(), one.ma.size(), all.models[0].ar.size(), all.models[0].ma.size()));
            all.models.push_back(std::move(one));
        }
        if (all.models.empty() || all.models.size() != speeds.size() || all.models.size() != forces.size())
            refuse(set_, fmt::format("{} <model>, but {} speeds and {} forces", all.models.size(), speeds.size(),
                                     forces.size()));
    }

    std::array<std::size_t, 3> triangle(const pugi::xml_node& node, std::size_t models) const {
        const std::vector<pugi::xml_node> corners = values(node, 3);
        if (corners.size() != 3)
            refuse(node, fmt::format("<tri> must have 3 values, got {}", corners.size()));
        std::array<std::size_t, 3> all{};
        for (std::size_t i = 0; i < 3; ++i) {
            const double corner = number(corners[i]);
            if (!(corner >= 1 && corner <= double(models) && corner == std::floor(corner)))
                refuse(corners[i], fmt::format("<tri> must name models 1 to {}, got {}", models, corner));
            all[i] = static_cast<std::size_t>(corner) - 1;
        }
        return all;
    }

    std::string name_, text_;
    pugi::xml_document document_;
    pugi::xml_node set_;
};

} // namespace

VibrationModels read_vibration(const std::filesystem::path& file) {
    return Reader(file).models();
}

} // namespace forceshade
