#pragma once
#include <cstdint>

/// What random numbers are drawn for: each purpose has its own streams, so that a change in one does not shift the
/// others.
namespace kokage::streams {

enum Purpose : std::uint64_t {
    crown_lobes = 1,
    attractors,
    trunk,
    limb,
    branch,
    shoot,
    leaf,
    textures,
    bark,
    bark_zone
};

/// The stream of the index-th thing of a purpose.
inline std::uint64_t of(Purpose purpose, std::uint64_t index) {
    return (std::uint64_t(purpose) << 48) + index;
}

} // namespace kokage::streams
