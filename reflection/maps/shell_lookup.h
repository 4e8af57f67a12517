#pragma once
// The vector code behind ShellMap's lookup of many directions. Inside of the shells alone.
#include "reflection/maps/shell_map.h"

#include <array>
#include <cstdint>

namespace kokage {

/// What the kernel reads of a map, in the form that vectors read.
struct ShellTable {
    static constexpr std::size_t most_shells = 256;
    LobeKind kind = LobeKind::phong;
    TexelFilter filter = TexelFilter::bilinear;
    TexelFormat format = TexelFormat::half_rgb;
    const std::byte* texels = nullptr; ///< aligned to 4 bytes, readable 4 bytes beyond the last
    float least_width = 0, most_width = 0, first_power = 0, shells_a_power = 0;
    std::int32_t last_interval = 0, last_shell = 0;
    std::array<float, most_shells> width;
    std::array<std::int32_t, most_shells> resolution, first;
};

/// Lookups are done in groups of so many.
std::size_t shell_lookup_lanes();
/// `count` is a multiple of shell_lookup_lanes(); 3 floats a direction and a result, 1 a parameter.
void look_up_shells(const ShellTable& table, const float* directions, const float* parameters, float* filtered,
                    std::size_t count);

} // namespace kokage
