#include "reflection/relief/shell_step.h"

#include <algorithm>
#include <limits>

namespace kokage {

using Kind = ShellCrossing::Kind;

// The faces' corners: of a0 a1 a2 b2: a1 a2 b2 (side 12, upper), a0 a2 b2 (side 02, upper), a0 a1 b2, a0 a1 a2
// (outside); of a0 a1 b1 b2: a1 b1 b2 (side 12, lower), a0 b1 b2, a0 a1 b2, a0 a1 b1 (side 01, upper); of a0 b0 b1 b2:
// b0 b1 b2 (bottom), a0 b1 b2, a0 b0 b2 (side 02, lower), a0 b0 b1 (side 01, lower).
const std::array<std::array<ShellCrossing, 4>, 3> kCrossings{{
    {{{Kind::side, 0, 2, 0, true},
      {Kind::side, 0, 1, 0, true},
      {Kind::within, 1, 0, 2, false},
      {Kind::outside, 0, 0, 0, false}}},
    {{{Kind::side, 0, 2, 0, false},
      {Kind::within, 2, 0, 1, false},
      {Kind::within, 0, 0, 2, false},
      {Kind::side, 0, 0, 0, true}}},
    {{{Kind::bottom, 0, 0, 0, false},
      {Kind::within, 1, 0, 1, false},
      {Kind::side, 0, 1, 0, false},
      {Kind::side, 0, 0, 0, false}}},
}};

const std::array<std::array<SideEntry, 2>, 3> kSideEntries{{
    {{{2, 3}, {1, 3}}}, // 01: lower, upper
    {{{2, 2}, {0, 1}}}, // 02
    {{{1, 0}, {0, 0}}}, // 12
}};

ShellSegment shell_segment(const ReliefShell& shell, std::uint32_t prism_index, std::uint32_t tetrahedron,
                           std::uint32_t entry, const glm::dvec3& origin, const glm::dvec3& direction, double start) {
    const ReliefShell::Prism& prism = shell.prisms[prism_index];
    const auto& corners = kTetrahedra[tetrahedron];
    std::array<glm::dvec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i)
        p[i] = glm::dvec3(corners[i] < 3 ? shell.outer[prism.places[corners[i]]]
                                         : shell.inner[prism.places[corners[i] - 3]]) -
               origin;
    // Barycentric coordinates are linear: their gradients are the faces' normals over the volume.
    std::array<glm::dvec3, 4> gradients;
    const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0];
    gradients[1] = glm::cross(e2, e3);
    gradients[2] = glm::cross(e3, e1);
    gradients[3] = glm::cross(e1, e2);
    const double volume = glm::dot(e1, gradients[1]);
    for (std::size_t i = 1; i < 4; ++i)
        gradients[i] /= volume;
    gradients[0] = -(gradients[1] + gradients[2] + gradients[3]);

    ShellSegment segment;
    segment.end = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < 4; ++i) {
        const double weight = (i == 0 ? 1. : 0.) - glm::dot(gradients[i], p[0]);
        const double step = glm::dot(gradients[i], direction);
        const std::size_t column = corners[i] % 3;
        const glm::dvec3 value(prism.uvs[column], corners[i] < 3 ? 0. : 1.);
        segment.at += weight * value;
        segment.step += step * value;
        segment.weights[column] += weight;
        segment.weights_step[column] += step;
        segment.gradient_u += value.x * gradients[i];
        segment.gradient_v += value.y * gradients[i];
        segment.gradient_depth += value.z * gradients[i];
        if (step < 0 && i != entry && -weight / step < segment.end) {
            segment.end = -weight / step;
            segment.exit = i;
        }
    }
    if (segment.end == std::numeric_limits<double>::infinity()) { // along an edge, by rounding: back where it came from
        segment.end = start;
        segment.exit = entry < 4 ? entry : 0;
    }
    segment.end = std::max(segment.end, start);
    return segment;
}

} // namespace kokage
