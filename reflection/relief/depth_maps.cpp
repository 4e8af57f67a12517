#include "reflection/relief/depth_maps.h"
#include "common/services/checked_file.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace kokage {
namespace {

constexpr std::size_t kReadTogether = 4; ///< vector code reads bytes by fours
constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 30;
constexpr int kLargestMap = 1024;

constexpr CheckedFileKind kDepthMapFile{
    {'K', 'o', 'k', 'a', 'g', 'e', 'D', 'M'}, 1, "depth maps", "another height field, or other settings"};

std::uint64_t maps_identity(const HeightField& field, DepthMapKind kind, const DepthMapSettings& settings) {
    FileIdentity identity;
    identity.add_value(field.width);
    identity.add_value(field.height);
    identity.add_value(std::uint32_t(field.wrap));
    identity.add(std::as_bytes(std::span(field.depths)));
    identity.add_value(kind);
    for (const int value : {settings.azimuths, settings.zeniths, settings.size, settings.traced_size})
        identity.add_value(value);
    for (const float value : {settings.scale.tile_m.x, settings.scale.tile_m.y, settings.scale.depth_m})
        identity.add_value(value);
    return identity.value();
}

bool is_positive(float value) {
    return std::isfinite(value) && value > 0;
}

} // namespace

void DepthMapSettings::check() const {
    const auto refuse = [](const std::string& why) { throw InputError("depth maps: " + why); };
    if (azimuths < 1 || zeniths < 1 || azimuths > 4096 || zeniths > 4096)
        refuse(std::to_string(azimuths) + " x " + std::to_string(zeniths) +
               " directions make no maps; give 1 to 4096 of each");
    if (size < 1 || size > kLargestMap)
        refuse("an edge of " + std::to_string(size) + " texels; give 1 to " + std::to_string(kLargestMap));
    int larger = size;
    while (larger < traced_size)
        larger *= 2;
    if (traced_size != 0 && (traced_size < 0 || larger != traced_size || traced_size > 4 * kLargestMap))
        refuse("maps of " + std::to_string(traced_size) + "² can't be shrunk by halves to " + std::to_string(size) +
               "²; give the size times a power of two");
    if (!is_positive(scale.depth_m) || !is_positive(scale.tile_m.x) || !is_positive(scale.tile_m.y))
        refuse("a relief of no depth or extent has no directions; give a depth and a tile above 0 metres");
    const std::uint64_t bytes = std::uint64_t(maps()) * std::uint64_t(size) * std::uint64_t(size);
    if (bytes > kMostBytes)
        refuse(std::to_string(bytes >> 20) + " MiB are more than the " + std::to_string(kMostBytes >> 20) +
               " MiB that they may take; ask for smaller or fewer maps");
}

DepthMaps::DepthMaps(DepthMapKind kind, const DepthMapSettings& settings, LargeVector<std::uint8_t> depths)
    : kind_(kind), settings_(settings), depths_(std::move(depths)) {
    settings_.check();
    if (depths_.size() != bytes())
        throw InputError("depth maps: " + std::to_string(depths_.size()) + " depths for " + std::to_string(bytes()) +
                         " texels; one byte a texel is wanted");
    depths_.resize((bytes() + kReadTogether - 1) / kReadTogether * kReadTogether);
    std::fill(depths_.begin() + std::ptrdiff_t(bytes()), depths_.end(), std::uint8_t(0));
}

void DepthMaps::save(const std::filesystem::path& path, const HeightField& field) const {
    const std::array<std::span<const std::byte>, 1> arrays{std::as_bytes(std::span(depths_.data(), bytes()))};
    write_checked_file(path, kDepthMapFile, maps_identity(field, kind_, settings_), arrays);
}

DepthMaps DepthMaps::load(const std::filesystem::path& path, const HeightField& field, DepthMapKind kind,
                          const DepthMapSettings& settings) {
    settings.check();
    constexpr std::uint64_t kHeader = 4096;
    const CheckedFile file(path, kDepthMapFile, maps_identity(field, kind, settings), kMostBytes + kHeader);
    const std::span<const std::uint8_t> depths = file.array<std::uint8_t>(0);
    const std::size_t texels = std::size_t(settings.maps()) * std::size_t(settings.size) * std::size_t(settings.size);
    if (depths.size() != texels)
        file.refuse_altered("it has " + std::to_string(depths.size()) + " texels instead of " + std::to_string(texels));
    return DepthMaps(kind, settings, LargeVector<std::uint8_t>(depths.begin(), depths.end()));
}

glm::dvec2 sampling_slope(const DepthMapSettings& settings, int map) {
    const double azimuth = 2 * std::numbers::pi / settings.azimuths * (map % settings.azimuths);
    const double zenith = std::numbers::pi / 2 / settings.zeniths * (map / settings.azimuths);
    return std::tan(zenith) * glm::dvec2(std::cos(azimuth), std::sin(azimuth));
}

glm::dvec2 relief_slope(const ReliefScale& scale, const glm::dvec2& slope) {
    return slope * double(scale.depth_m) / glm::dvec2(scale.tile_m);
}

} // namespace kokage
