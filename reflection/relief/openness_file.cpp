// Openness in files (common/services/checked_file.h).
#include "common/services/checked_file.h"
#include "reflection/relief/relief_openness.h"

#include <span>

namespace kokage {
namespace {

constexpr CheckedFileKind kOpennessFile{
    {'K', 'o', 'k', 'a', 'g', 'e', 'A', 'O'}, 1, "ambient occlusion", "another height field, or other settings"};

std::uint64_t openness_identity(const HeightField& field, const OpennessSettings& settings) {
    FileIdentity identity;
    for (const int value : {field.width, field.height, int(field.wrap), int(settings.normal), settings.azimuths})
        identity.add_value(value);
    for (const float value : {settings.scale.tile_m.x, settings.scale.tile_m.y, settings.scale.depth_m})
        identity.add_value(value);
    identity.add(std::as_bytes(std::span(field.depths)));
    return identity.value();
}

} // namespace

void save_openness(const ReliefOpenness& openness, const std::filesystem::path& path, const HeightField& field,
                   const OpennessSettings& settings) {
    const std::array<std::span<const std::byte>, 2> arrays{std::as_bytes(std::span(openness.texels)),
                                                           std::as_bytes(std::span(openness.corners))};
    write_checked_file(path, kOpennessFile, openness_identity(field, settings), arrays);
}

ReliefOpenness load_openness(const std::filesystem::path& path, const HeightField& field,
                             const OpennessSettings& settings) {
    constexpr std::uint64_t kHeader = 4096;
    const CheckedFile file(path, kOpennessFile, openness_identity(field, settings),
                           5 * std::uint64_t(field.depths.size()) + kHeader);
    ReliefOpenness openness{field.width, field.height, field.wrap, file.copied<std::uint8_t>(0),
                            file.copied<std::array<std::uint8_t, 4>>(1)};
    if (openness.texels.size() != field.depths.size() || openness.corners.size() != field.depths.size())
        file.refuse_altered("it has not one value for every texel");
    return openness;
}

} // namespace kokage
