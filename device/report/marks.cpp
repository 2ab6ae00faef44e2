#include "device/report/marks.h"

#include <algorithm>

namespace forceshade::device {
namespace {

// Labels that touch and are moved as one.
struct Cluster {
    std::size_t first = 0, count = 0;
    double wanted = 0; // sum of the begins that its labels would like for it
    double width = 0;  // with a gap behind each label
    double begin(double low, double high, double gap) const {
        const double mean = wanted / static_cast<double>(count);
        return std::max(low, std::min(mean, high - (width - gap)));
    }
};

} // namespace

void place_labels(std::vector<Mark>& marks, double low, double high, double gap) {
    std::stable_sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.at < b.at; });
    std::vector<Cluster> clusters;
    for (std::size_t i = 0; i < marks.size(); ++i) {
        clusters.push_back({i, 1, marks[i].at - marks[i].width / 2, marks[i].width + gap});
        while (clusters.size() > 1) {
            Cluster& before = clusters[clusters.size() - 2];
            const Cluster& last = clusters.back();
            if (before.begin(low, high, gap) + before.width <= last.begin(low, high, gap))
                break;
            before.wanted += last.wanted - static_cast<double>(last.count) * before.width;
            before.count += last.count;
            before.width += last.width;
            clusters.pop_back();
        }
    }
    for (const Cluster& cluster : clusters) {
        double begin = cluster.begin(low, high, gap);
        for (std::size_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
            marks[i].centre = begin + marks[i].width / 2;
            begin += marks[i].width + gap;
        }
    }
}

} // namespace forceshade::device
