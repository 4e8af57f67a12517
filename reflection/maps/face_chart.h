#pragma once
// The sphere in six square charts, as shells lay it out: cube faces whose rows and columns are spaced evenly in ANGLE.
//
// A direction belongs to the face of its largest component; a = ±that axis, and u, v run along the other two:
//
//        face   0 +X   1 -X   2 +Y   3 -Y   4 +Z   5 -Z
//        u      -Z     +Z     +X     +X     +X     -X          u = (4/π) arctan(d_u / d_a), v likewise, in [-1, 1]
//        v      -Y     -Y     +Z     -Z     -Y     -Y
//
// (the faces and axes of OpenGL's cube maps). Spacing in angle instead of in the plane makes the widest texel 1.4 times
// as wide as the narrowest (2.1 without, in the octahedral map 2.8, which has creases besides) and keeps the values
// along a face's edge the same in both faces that meet there: at an edge v(u) of one is v(u) of the other, so faces
// with texels ON their edges join without a step.
#include "common/types.h"

namespace kokage {

struct FacePlace {
    int face;   ///< 0 … 5
    float u, v; ///< in [-1, 1]
};

/// Of a direction of any length but 0.
FacePlace face_place(const glm::vec3& direction);
/// Unit direction; u, v may lie beyond ±1 by up to a face's half (up to ±2, exclusive).
glm::dvec3 face_direction(int face, double u, double v);

} // namespace kokage
