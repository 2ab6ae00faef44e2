#include "device/haply/axes.h"

namespace forceshade::device {

std::optional<Axes> parse_basis(std::string_view permutation) {
    if (permutation.empty())
        return Axes{};
    Axes axes;
    std::size_t count = 0;
    unsigned seen = 0;
    double sign = 1;
    bool signed_already = false;
    for (const char letter : permutation) {
        if (letter == '+' || letter == '-') {
            if (signed_already || count == 3)
                return std::nullopt;
            sign = letter == '-' ? -1 : 1;
            signed_already = true;
            continue;
        }
        const int axis = letter == 'X' || letter == 'x'   ? 0
                         : letter == 'Y' || letter == 'y' ? 1
                         : letter == 'Z' || letter == 'z' ? 2
                                                          : -1;
        if (axis < 0 || count == 3 || (seen >> axis & 1u) != 0)
            return std::nullopt;
        seen |= 1u << axis;
        axes.from[count] = axis;
        axes.sign[static_cast<int>(count)] = sign;
        ++count;
        sign = 1;
        signed_already = false;
    }
    if (count != 3)
        return std::nullopt;
    return axes;
}

} // namespace forceshade::device
