#pragma once
// One tetrahedron of a ReliefShell under a ray, in double precision. Private to relief.
#include "reflection/relief/relief_shell.h"

namespace kokage {

/// What a ray reads of a tetrahedron: along it, coordinates change linearly with the distance s.
struct ShellSegment {
    glm::dvec3 at{0.}, step{0.};              ///< u, v, depth at s = 0, and their change per metre
    glm::dvec3 weights{0.}, weights_step{0.}; ///< of the prism's own corners
    glm::dvec3 gradient_u{0.}, gradient_v{0.}, gradient_depth{0.};
    double end = 0;         ///< s where the ray leaves the tetrahedron
    std::uint32_t exit = 0; ///< through the face opposite to this corner of it
};

/// The corners of a prism's tetrahedra: 0, 1, 2 are a0, a1, a2; 3, 4, 5 are b0, b1, b2.
inline constexpr std::array<std::array<std::uint8_t, 4>, 3> kTetrahedra{{{0, 1, 2, 5}, {0, 1, 4, 5}, {0, 3, 4, 5}}};

/// What lies behind a face.
struct ShellCrossing {
    enum class Kind : std::uint8_t { within, side, outside, bottom } kind = Kind::within;
    std::uint8_t tetrahedron = 0; ///< within: the next one
    std::uint8_t side = 0;        ///< side: of the prism
    std::uint8_t entry = 0;       ///< within: the corner of the next one that is opposite to the face
    bool is_upper = false;        ///< side: the half that touches the outside
};
/// Of tetrahedron i, the face opposite to its corner k: [i][k].
extern const std::array<std::array<ShellCrossing, 4>, 3> kCrossings;

/// Behind a side: the tetrahedron of the neighbour's side and the corner opposite to the face: [side][is_upper].
struct SideEntry {
    std::uint8_t tetrahedron = 0, entry = 0;
};
extern const std::array<std::array<SideEntry, 2>, 3> kSideEntries;

inline constexpr std::uint32_t kNoEntry = 4;

/// The ray origin + s direction from s = `start` on, which came in opposite to corner `entry` (or began inside).
ShellSegment shell_segment(const ReliefShell& shell, std::uint32_t prism, std::uint32_t tetrahedron,
                           std::uint32_t entry, const glm::dvec3& origin, const glm::dvec3& direction, double start);

} // namespace kokage
