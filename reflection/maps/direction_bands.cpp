#include "reflection/maps/direction_bands.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr double kSlack = 1e-6; // radians, for what the angles themselves are rounded by

double polar_angle(const glm::dvec3& direction) {
    return std::acos(std::clamp(direction.y, -1.0, 1.0));
}
double azimuth(const glm::dvec3& direction) {
    return std::atan2(direction.z, direction.x);
}

} // namespace

DirectionBands::DirectionBands(std::span<const glm::dvec3> directions)
    : bands_(std::max<std::size_t>(1, std::size_t(std::sqrt(double(directions.size()))))) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const std::size_t band = std::size_t(polar_angle(directions[i]) / kPiDouble * double(bands_.size()));
        bands_[std::min(band, bands_.size() - 1)].push_back({azimuth(directions[i]), std::uint32_t(i)});
    }
    for (std::vector<Entry>& band : bands_)
        std::sort(band.begin(), band.end(), [](const Entry& a, const Entry& b) {
            return a.azimuth != b.azimuth ? a.azimuth < b.azimuth : a.index < b.index;
        });
}

void DirectionBands::near(const glm::dvec3& axis, double angle, std::vector<std::uint32_t>& indices) const {
    const double polar = polar_angle(axis), middle = azimuth(axis), reach = angle + kSlack;
    const double from = polar - reach, to = polar + reach, count = double(bands_.size());
    // A cone that holds no pole spans asin(sin reach / sin polar) of azimuth to either side of its axis.
    const bool all_around = from <= 0 || to >= kPiDouble;
    const double half = all_around ? 0 : std::asin(std::min(1.0, std::sin(reach) / std::sin(polar))) + kSlack;
    const std::size_t first = std::size_t(std::clamp(from / kPiDouble * count, 0.0, count - 1));
    const std::size_t last = std::size_t(std::clamp(to / kPiDouble * count, 0.0, count - 1));
    for (std::size_t b = first; b <= last; ++b) {
        const std::vector<Entry>& band = bands_[b];
        const auto append = [&](double low, double high) {
            auto entry = std::lower_bound(band.begin(), band.end(), low,
                                          [](const Entry& e, double value) { return e.azimuth < value; });
            for (; entry != band.end() && entry->azimuth <= high; ++entry)
                indices.push_back(entry->index);
        };
        if (all_around) {
            append(-4, 4);
            continue;
        }
        append(middle - half, middle + half);
        if (middle - half < -kPiDouble)
            append(middle - half + 2 * kPiDouble, 4);
        if (middle + half > kPiDouble)
            append(-4, middle + half - 2 * kPiDouble);
    }
}

} // namespace kokage
