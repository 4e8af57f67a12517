#include "reflection/relief/bound_planes.h"
#include "common/services/checked_file.h"
#include "common/services/error.h"
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/fit_planes.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace kokage {
namespace {

void check(const HeightField& field) {
    const auto refuse = [](const std::string& why) { throw InputError("height field: " + why); };
    if (field.width < 1 || field.height < 1)
        refuse("has no texels");
    if (std::max(field.width, field.height) >= BoundPlanes::kMostSide)
        refuse(std::to_string(field.width) + " x " + std::to_string(field.height) + " texels; at most " +
               std::to_string(BoundPlanes::kMostSide - 1) + " on a side can be traced: make the map smaller");
    if (field.depths.size() != std::size_t(field.width) * std::size_t(field.height))
        refuse("holds " + std::to_string(field.depths.size()) + " depths for " + std::to_string(field.width) + " x " +
               std::to_string(field.height) + " texels");
    for (const float depth : field.depths)
        if (!(depth >= 0 && depth <= 1))
            refuse("holds a depth of " + std::to_string(depth) + "; depths lie within [0, 1]");
}

/// Columns, rows and depths at the corners of cells.
BoundPlanes cells_of(const HeightField& field) {
    BoundPlanes bounds;
    bounds.width = field.width;
    bounds.height = field.height;
    bounds.wrap = field.wrap;
    const int outside = field.wrap == HeightWrap::clamp ? 1 : 0;
    bounds.columns = field.width + outside;
    bounds.rows = field.height + outside;
    bounds.depths.resize(std::size_t(bounds.columns + 1) * std::size_t(bounds.rows + 1));
    float* to = bounds.depths.data();
    for (int y = 0; y <= bounds.rows; ++y) {
        const int row = texel_index(y - outside, field.height, field.wrap);
        for (int x = 0; x <= bounds.columns; ++x)
            *to++ = field.depth(texel_index(x - outside, field.width, field.wrap), row);
    }
    return bounds;
}

void add_levels(BoundPlanes& bounds) {
    bounds.levels = {{bounds.columns, bounds.rows, 0}};
    std::size_t count = 0;
    for (int level = 1; bounds.levels.back().columns > 1 || bounds.levels.back().rows > 1; ++level) {
        const int side = 1 << level;
        const BoundLevel next{(bounds.columns + side - 1) / side, (bounds.rows + side - 1) / side, count};
        count += std::size_t(next.columns) * std::size_t(next.rows);
        bounds.levels.push_back(next);
    }
    bounds.planes.resize(count);
}

/// All but the planes' values.
BoundPlanes unbounded(const HeightField& field) {
    check(field);
    BoundPlanes bounds = cells_of(field);
    add_levels(bounds);
    return bounds;
}

constexpr CheckedFileKind kStoredPlanes{
    {'K', 'o', 'B', 'o', 'u', 'n', 'd', 'P'}, 1, "relief bound planes", "another height field"};

std::uint64_t identity_of(const BoundPlanes& bounds) {
    FileIdentity identity;
    identity.add_value(bounds.width);
    identity.add_value(bounds.height);
    identity.add_value(int(bounds.wrap));
    identity.add(std::as_bytes(std::span(bounds.depths)));
    return identity.value();
}

} // namespace

BoundPlanes make_bound_planes(const HeightField& field) {
    BoundPlanes bounds = unbounded(field);
    fit_planes(bounds);
    return bounds;
}

void store_bound_planes(const BoundPlanes& bounds, const std::filesystem::path& path) {
    const std::array arrays{std::as_bytes(std::span(bounds.planes))};
    write_checked_file(path, kStoredPlanes, identity_of(bounds), arrays);
}

BoundPlanes load_bound_planes(const HeightField& field, const std::filesystem::path& path) {
    BoundPlanes bounds = unbounded(field);
    const CheckedFile file(path, kStoredPlanes, identity_of(bounds));
    std::vector<BoundPlane> planes = file.copied<BoundPlane>(0);
    if (planes.size() != bounds.planes.size())
        file.refuse_altered("it has " + std::to_string(planes.size()) + " planes, not " +
                            std::to_string(bounds.planes.size()));
    bounds.planes = std::move(planes);
    return bounds;
}

} // namespace kokage
