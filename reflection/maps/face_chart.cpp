#include "reflection/maps/face_chart.h"

#include <cmath>

namespace kokage {

FacePlace face_place(const glm::vec3& d) {
    const glm::vec3 a = glm::abs(d);
    int face;
    float major, u, v;
    if (a.x >= a.y && a.x >= a.z) {
        face = d.x >= 0 ? 0 : 1, major = a.x, u = d.x >= 0 ? -d.z : d.z, v = -d.y;
    } else if (a.y >= a.z) {
        face = d.y >= 0 ? 2 : 3, major = a.y, u = d.x, v = d.y >= 0 ? d.z : -d.z;
    } else {
        face = d.z >= 0 ? 4 : 5, major = a.z, u = d.z >= 0 ? d.x : -d.x, v = -d.y;
    }
    const float scale = 4 / kPi;
    return {face, scale * std::atan(u / major), scale * std::atan(v / major)};
}

glm::dvec3 face_direction(int face, double u, double v) {
    const double p = std::tan(u * kPiDouble / 4), q = std::tan(v * kPiDouble / 4);
    const glm::dvec3 directions[6] = {{1, -q, -p}, {-1, -q, p}, {p, 1, q}, {p, -1, -q}, {p, -q, 1}, {-p, -q, -1}};
    return glm::normalize(directions[face]);
}

} // namespace kokage
